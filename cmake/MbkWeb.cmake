# The page of the HTML report: TypeScript in web/report that Vite makes into one file. Everything happens in the build
# folder, with the packages that package-lock.json names. Vite 8 needs Node 20.19 or newer; where the machine has an
# older one, npm's package node@22 runs it, so npm is all that is needed beside it.
option(MBK_WEB "Build the page of 'mbk measure --report' (needs Node.js and npm)" ON)

# mbk_node_command(RESULT VERSION): how to run a script with Node, given the version of the machine's own ("v18.20.4").
function(mbk_node_command result version)
  string(REGEX REPLACE "^v" "" number "${version}")
  if(number VERSION_GREATER_EQUAL 22.12 OR (number VERSION_GREATER_EQUAL 20.19 AND number VERSION_LESS 21))
    set(${result} ${MBK_NODE} PARENT_SCOPE)
  else()
    set(${result} ${MBK_NPX} --yes node@22 PARENT_SCOPE)
  endif()
endfunction()

if(MBK_WEB)
  find_program(MBK_NODE node)
  find_program(MBK_NPM npm)
  find_program(MBK_NPX npx)
  if(NOT MBK_NODE OR NOT MBK_NPM OR NOT MBK_NPX)
    message(FATAL_ERROR "the page of the HTML report is built with Node.js and npm, which are not here; install them "
                        "(tools/install-packages build), or configure with -DMBK_WEB=OFF and do without --report")
  endif()
  # In the folder where it will run, for a manager of versions may choose by folder.
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/web/report ${PROJECT_BINARY_DIR}/web/console
       ${PROJECT_BINARY_DIR}/web/reproduction)
  execute_process(COMMAND ${MBK_NODE} --version WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/web/report
                  OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  mbk_node_command(MBK_NODE_COMMAND "${version}")
endif()

# mbk_web_page(NAME [OTHER...]): web/NAME as ${PROJECT_BINARY_DIR}/web/NAME/dist/index.html, of target web_NAME. Its
# sources may import those of the OTHER pages.
function(mbk_web_page name)
  set(others "")
  foreach(other IN LISTS ARGN)
    list(APPEND others ${PROJECT_BINARY_DIR}/web/${other}/dist/index.html)
  endforeach()
  set(source ${PROJECT_SOURCE_DIR}/web/${name})
  set(folder ${PROJECT_BINARY_DIR}/web/${name})
  set(package ${source}/package.json ${source}/package-lock.json ${source}/.npmrc)
  file(GLOB_RECURSE code CONFIGURE_DEPENDS ${source}/src/*)
  set(settings ${source}/index.html ${source}/vite.config.ts ${source}/tsconfig.json)
  set(omit --omit=dev)
  if(MBK_BUILD_TESTS)
    set(omit --include=dev)
  endif()
  add_custom_command(
    OUTPUT ${folder}/installed
    COMMAND ${CMAKE_COMMAND} -E copy ${package} ${folder}
    COMMAND ${MBK_NPM} ci ${omit} --prefer-offline --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${folder}/installed
    DEPENDS ${package}
    WORKING_DIRECTORY ${folder}
    COMMENT "Installing the npm packages of web/${name} (without a network: -DMBK_WEB=OFF)"
    VERBATIM)
  add_custom_command(
    OUTPUT ${folder}/dist/index.html
    COMMAND ${CMAKE_COMMAND} -E rm -rf src dist
    COMMAND ${CMAKE_COMMAND} -E copy ${settings} ${folder}
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${source}/src ${folder}/src
    COMMAND ${MBK_NODE_COMMAND} node_modules/typescript/bin/tsc --noEmit
    COMMAND ${MBK_NODE_COMMAND} node_modules/vite/bin/vite.js build --logLevel warn
    DEPENDS ${folder}/installed ${code} ${settings} ${others}
    WORKING_DIRECTORY ${folder}
    COMMENT "Building the page web/${name}"
    VERBATIM)
  add_custom_target(web_${name} DEPENDS ${folder}/dist/index.html)
  foreach(other IN LISTS ARGN)
    add_dependencies(web_${name} web_${other})
  endforeach()
endfunction()

# mbk_embed_page(MODULE PAGE SYMBOL [USES OTHER...]): the page web/PAGE as bytes from SYMBOLBegin to SYMBOLEnd in MODULE,
# whose sources see MBK_WEB. Without MBK_WEB: nothing.
function(mbk_embed_page module page symbol)
  if(NOT MBK_WEB)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  mbk_web_page(${page} ${ARG_USES})
  set(MBK_PAGE_NAME ${page})
  set(MBK_PAGE_SYMBOL ${symbol})
  set(MBK_PAGE_FILE ${PROJECT_BINARY_DIR}/web/${page}/dist/index.html)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/page.S.in page.S @ONLY)
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/page.S PROPERTIES OBJECT_DEPENDS ${MBK_PAGE_FILE})
  add_library(mbk_${module}_page OBJECT ${CMAKE_CURRENT_BINARY_DIR}/page.S)
  add_dependencies(mbk_${module}_page web_${page})
  target_sources(mbk_${module} PRIVATE $<TARGET_OBJECTS:mbk_${module}_page>)
  target_compile_definitions(mbk_${module} PRIVATE MBK_WEB)
  if(TARGET ${module}_test)
    target_compile_definitions(${module}_test PRIVATE MBK_WEB)
  endif()
endfunction()
