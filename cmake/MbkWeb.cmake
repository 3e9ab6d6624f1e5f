# The pages: TypeScript in web/, one npm workspace that Vite makes into one file for each page. Everything happens in the
# build folder, with the packages that web/package-lock.json names. Vite 8 needs Node 20.19 or newer; where the machine
# has an older one, npm's package node@22 runs it, so npm is all that is needed beside it. What only tests need (a
# browser's driver, the compiler that checks types) is installed where tests are built.
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
  set(MBK_WEB_FOLDER ${PROJECT_BINARY_DIR}/web)
  file(MAKE_DIRECTORY ${MBK_WEB_FOLDER})
  execute_process(COMMAND ${MBK_NODE} --version WORKING_DIRECTORY ${MBK_WEB_FOLDER}
                  OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  mbk_node_command(MBK_NODE_COMMAND "${version}")
endif()

# mbk_web_copy(NAME): web/NAME in the build folder; web/NAME/copied says that it is there.
function(mbk_web_copy name)
  set(source ${PROJECT_SOURCE_DIR}/web/${name})
  set(folder ${MBK_WEB_FOLDER}/${name})
  file(GLOB_RECURSE code CONFIGURE_DEPENDS ${source}/src/*)
  list(FILTER code EXCLUDE REGEX "/documents\\.ts$")  # that someone had written beside the sources
  file(GLOB page CONFIGURE_DEPENDS ${source}/index.html)
  set(copy_page "")
  if(page)
    set(copy_page COMMAND ${CMAKE_COMMAND} -E copy ${page} ${folder})
  endif()
  add_custom_command(
    OUTPUT ${folder}/copied
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${folder}/src
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}/src
    COMMAND ${CMAKE_COMMAND} -E copy ${code} ${folder}/src
    ${copy_page}
    COMMAND ${CMAKE_COMMAND} -E touch ${folder}/copied
    DEPENDS ${MBK_WEB_FOLDER}/installed ${code} ${page}
    COMMENT "Copying web/${name}"
    VERBATIM)
endfunction()

# mbk_web_page(NAME): web/NAME as ${PROJECT_BINARY_DIR}/web/NAME/dist/index.html, of target web_NAME.
function(mbk_web_page name)
  add_custom_command(
    OUTPUT ${MBK_WEB_FOLDER}/${name}/dist/index.html
    COMMAND ${MBK_NODE_COMMAND} node_modules/vite/bin/vite.js build ${name} --config vite.config.ts --logLevel warn
    DEPENDS ${MBK_WEB_FOLDER}/installed ${MBK_WEB_FOLDER}/settings ${MBK_WEB_FOLDER}/shared/copied
            ${MBK_WEB_FOLDER}/${name}/copied
    WORKING_DIRECTORY ${MBK_WEB_FOLDER}
    COMMENT "Building the page web/${name}"
    VERBATIM)
  add_custom_target(web_${name} DEPENDS ${MBK_WEB_FOLDER}/${name}/dist/index.html)
endfunction()

# The packages of all pages, what the pages share, and, with tests, the types of everything: those of the documents are
# written from their schemas.
if(MBK_WEB)
  set(packages "")
  set(install "")
  foreach(file package.json package-lock.json .npmrc shared/package.json report/package.json console/package.json
          reproduction/package.json)
    list(APPEND packages ${PROJECT_SOURCE_DIR}/web/${file})
    list(APPEND install COMMAND ${CMAKE_COMMAND} -E copy ${PROJECT_SOURCE_DIR}/web/${file} ${MBK_WEB_FOLDER}/${file})
  endforeach()
  foreach(name shared report console reproduction)
    file(MAKE_DIRECTORY ${MBK_WEB_FOLDER}/${name})
  endforeach()
  set(omit --omit=dev)
  if(MBK_BUILD_TESTS)
    set(omit --include=dev)
  endif()
  add_custom_command(
    OUTPUT ${MBK_WEB_FOLDER}/installed
    ${install}
    COMMAND ${MBK_NPM} ci ${omit} --prefer-offline --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${MBK_WEB_FOLDER}/installed
    DEPENDS ${packages}
    WORKING_DIRECTORY ${MBK_WEB_FOLDER}
    COMMENT "Installing the npm packages of web/ (without a network: -DMBK_WEB=OFF)"
    VERBATIM)
  set(settings ${PROJECT_SOURCE_DIR}/web/vite.config.ts ${PROJECT_SOURCE_DIR}/web/tsconfig.json
      ${PROJECT_SOURCE_DIR}/web/types.mjs)
  add_custom_command(
    OUTPUT ${MBK_WEB_FOLDER}/settings
    COMMAND ${CMAKE_COMMAND} -E copy ${settings} ${MBK_WEB_FOLDER}
    COMMAND ${CMAKE_COMMAND} -E touch ${MBK_WEB_FOLDER}/settings
    DEPENDS ${settings}
    VERBATIM)
  mbk_web_copy(shared)
  foreach(page report console reproduction)
    mbk_web_copy(${page})
    mbk_web_page(${page})
  endforeach()
  if(MBK_BUILD_TESTS)
    add_custom_command(
      OUTPUT ${MBK_WEB_FOLDER}/checked
      COMMAND ${MBK_NODE_COMMAND} types.mjs ${PROJECT_BINARY_DIR}/schemas shared/src/documents.ts
      COMMAND ${MBK_NODE_COMMAND} node_modules/typescript/bin/tsc --noEmit
      COMMAND ${CMAKE_COMMAND} -E touch checked
      DEPENDS ${PROJECT_BINARY_DIR}/schemas.done ${MBK_WEB_FOLDER}/settings ${MBK_WEB_FOLDER}/shared/copied ${MBK_WEB_FOLDER}/report/copied
              ${MBK_WEB_FOLDER}/console/copied ${MBK_WEB_FOLDER}/reproduction/copied
      WORKING_DIRECTORY ${MBK_WEB_FOLDER}
      COMMENT "Checking the types of web/"
      VERBATIM)
    add_custom_target(web_types ALL DEPENDS ${MBK_WEB_FOLDER}/checked)
  endif()
endif()

# mbk_embed_page(MODULE PAGE SYMBOL): the page web/PAGE as bytes from SYMBOLBegin to SYMBOLEnd in MODULE, whose sources
# see MBK_WEB. Without MBK_WEB: nothing.
function(mbk_embed_page module page symbol)
  if(NOT MBK_WEB)
    return()
  endif()
  set(MBK_PAGE_NAME ${page})
  set(MBK_PAGE_SYMBOL ${symbol})
  if(WIN32)
    set(MBK_PAGE_SECTION ".rdata, \"dr\"")
    set(MBK_PAGE_END "")
  else()
    set(MBK_PAGE_SECTION .rodata)
    set(MBK_PAGE_END "        .section .note.GNU-stack, \"\", %progbits\n")
  endif()
  set(MBK_PAGE_FILE ${MBK_WEB_FOLDER}/${page}/dist/index.html)
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
