# What `cmake --install` puts where. Components: program (what runs: mbk, its manual pages, its completion, the schemas of
# what it writes, the documents), development (what an application is built with: libraries, headers, the CMake package
# mbk), c (libmbk.so and its header), octave (the package of MATLAB and Octave) and python.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(MBK_BASH_COMPLETIONS ${CMAKE_INSTALL_DATADIR}/bash-completion/completions CACHE STRING "Where bash finds completions")
set(MBK_ZSH_COMPLETIONS ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where zsh finds completions")
set(MBK_FISH_COMPLETIONS ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d CACHE STRING "Where fish finds completions")
set(MBK_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/mbk)

# Called by mbk_module: the library and its headers, but for private ones, which are named, and those that only tests
# include: test_*.h.
function(mbk_install_module name)
  set_target_properties(mbk_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS mbk_${name} EXPORT mbk COMPONENT development
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  file(GLOB headers CONFIGURE_DEPENDS *.h)
  list(FILTER headers EXCLUDE REGEX "/test_[^/]*$")
  foreach(private IN LISTS ARGN)
    list(REMOVE_ITEM headers ${CMAKE_CURRENT_SOURCE_DIR}/${private})
  endforeach()
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT development)
  set_property(GLOBAL APPEND PROPERTY MBK_MODULES ${name})
endfunction()

# The lines of mbkConfig.cmake that find what the modules link, read from what they link: nothing is listed twice.
# Also the Debian packages that hold it, for the package libmbk-dev.
function(mbk_outside_libraries find_result files_result)
  get_property(modules GLOBAL PROPERTY MBK_MODULES)
  set(libraries "")
  foreach(module IN LISTS modules)
    get_target_property(linked mbk_${module} INTERFACE_LINK_LIBRARIES)
    list(APPEND libraries ${linked})
  endforeach()
  list(TRANSFORM libraries REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1")
  list(FILTER libraries EXCLUDE REGEX "^mbk::|^\\$<BUILD_INTERFACE:")
  list(SORT libraries)
  list(REMOVE_DUPLICATES libraries)

  set(lines "")
  set(files "")
  foreach(library IN LISTS libraries)
    if(library MATCHES "^([^:]+)::(.+)$")
      set(package ${CMAKE_MATCH_1})
      set(part ${CMAKE_MATCH_2})
    elseif(${library}_CONFIG)  # a package whose only library has its name
      set(package ${library})
      set(part ${library})
    else()
      message(FATAL_ERROR "${library}: a module may link only libraries that find_package names, as in zlib's ZLIB::ZLIB")
    endif()
    if(package STREQUAL PkgConfig)
      string(APPEND lines "find_dependency(PkgConfig)\npkg_check_modules(${part} QUIET IMPORTED_TARGET ${${part}_MODULE_NAME})\n"
             "if(NOT TARGET ${library})\n  set(mbk_FOUND FALSE)\n"
             "  set(mbk_NOT_FOUND_MESSAGE \"pkg-config does not find ${${part}_MODULE_NAME}\")\n  return()\nendif()\n")
      list(GET ${part}_LINK_LIBRARIES 0 file)
    else()
      if(package STREQUAL tl)
        set(package tl-expected)
      endif()
      string(STRIP "${package} ${${package}_VERSION}" requested)
      string(APPEND lines "find_dependency(${requested})\n")
      if(${package}_CONFIG)
        set(file ${${package}_CONFIG})
      else()
        get_target_property(file ${library} IMPORTED_LOCATION_RELEASE)
        if(NOT file)
          get_target_property(file ${library} IMPORTED_LOCATION)
        endif()
      endif()
    endif()
    list(APPEND files ${file})
  endforeach()
  set(${find_result} "${lines}" PARENT_SCOPE)
  set(${files_result} "${files}" PARENT_SCOPE)
endfunction()

# What the program says of itself, written by the program.
function(mbk_install_program_texts)
  set(folder ${PROJECT_BINARY_DIR}/texts)
  add_custom_command(
    OUTPUT ${folder}/done
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${folder}
    COMMAND mbk manual --pages ${folder}/man
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}/completion
    COMMAND mbk completion bash --out ${folder}/completion/mbk
    COMMAND mbk completion zsh --out ${folder}/completion/_mbk
    COMMAND mbk completion fish --out ${folder}/completion/mbk.fish
    COMMAND ${CMAKE_COMMAND} -E touch ${folder}/done
    DEPENDS mbk VERBATIM)
  add_custom_target(mbk_texts ALL DEPENDS ${folder}/done)
  install(DIRECTORY ${folder}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${folder}/completion/mbk DESTINATION ${MBK_BASH_COMPLETIONS} COMPONENT program)
  install(FILES ${folder}/completion/_mbk DESTINATION ${MBK_ZSH_COMPLETIONS} COMPONENT program)
  install(FILES ${folder}/completion/mbk.fish DESTINATION ${MBK_FISH_COMPLETIONS} COMPONENT program)
endfunction()

# The component development: static libraries, headers, CMake package.
function(mbk_install_development)
  get_property(modules GLOBAL PROPERTY MBK_MODULES)
  add_library(mbk_all INTERFACE)
  list(TRANSFORM modules PREPEND mbk:: OUTPUT_VARIABLE all)
  target_link_libraries(mbk_all INTERFACE ${all})
  set_target_properties(mbk_all PROPERTIES EXPORT_NAME mbk)
  install(TARGETS mbk_all EXPORT mbk COMPONENT development)

  # Plug-ins that were written for 0.1 name the header without its wing.
  file(WRITE ${PROJECT_BINARY_DIR}/forward/device_plugin.h
       "/* The old place of this header, for one version. */\n#include \"mbk/experiment/drivers/device_plugin.h\"\n")
  install(FILES ${PROJECT_BINARY_DIR}/forward/device_plugin.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mbk/drivers
          COMPONENT development)

  mbk_outside_libraries(MBK_FIND_DEPENDENCIES files)
  set_property(GLOBAL PROPERTY MBK_OUTSIDE_FILES ${files})
  set(folder ${PROJECT_BINARY_DIR}/cmake)
  configure_package_config_file(cmake/mbkConfig.cmake.in ${folder}/mbkConfig.cmake
                                INSTALL_DESTINATION ${MBK_CMAKE_FOLDER})
  # Each minor version may change what applications call: docs/guide/stability.md.
  write_basic_package_version_file(${folder}/mbkConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${folder}/mbkConfig.cmake ${folder}/mbkConfigVersion.cmake DESTINATION ${MBK_CMAKE_FOLDER}
          COMPONENT development)
  install(EXPORT mbk FILE mbkTargets.cmake NAMESPACE mbk:: DESTINATION ${MBK_CMAKE_FOLDER} COMPONENT development)
endfunction()

# Call it when every target is there.
function(mbk_install)
  # `mbk validate faults --link udp` looks for the other program beside itself.
  install(TARGETS mbk mbk_misbehaving_robot RUNTIME COMPONENT program)
  install(FILES apps/misbehaving_robot/mbk_misbehaving_robot.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  mbk_install_program_texts()

  # The JSON schemas that users' scripts may rely on: docs/guide/reference.md.
  install(DIRECTORY ${PROJECT_BINARY_DIR}/schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/mbk COMPONENT program)

  # The folders keep their places beside each other, so that the links between the documents hold.
  install(FILES README.md LICENSE CITATION.cff CHANGELOG.md THIRD_PARTY_NOTICES.md packaging/copyright
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(DIRECTORY docs examples bridge DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
          PATTERN docs/site EXCLUDE  # what builds the site out of them
          REGEX "/bridge/.*(_test\\.|CMakeLists|__pycache__)" EXCLUDE)

  if(MBK_STATIC)
    # Licences and versions of the libraries inside. To build on such modules would take these libraries, too.
    install(DIRECTORY ${MBK_STATIC}/licences DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
    install(FILES ${MBK_STATIC}/sources.tsv DESTINATION ${CMAKE_INSTALL_DOCDIR}/licences COMPONENT program)
  else()
    mbk_install_development()
  endif()
endfunction()
