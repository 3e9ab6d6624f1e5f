# Nothing of it is linked: an interface without libraries.
function(mbk_is_header_only library result)
  get_target_property(type ${library} TYPE)
  get_target_property(linked ${library} INTERFACE_LINK_LIBRARIES)
  if(type STREQUAL INTERFACE_LIBRARY AND NOT linked)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# mbk_of_this_system(SOURCES): without name_windows.cpp, or on Windows without name_posix.cpp. What names a system call
# stands in such a file; its headers give strange words to macros, so that it is compiled alone.
function(mbk_of_this_system list_name)
  set(kept ${${list_name}})
  if(WIN32)
    list(FILTER kept EXCLUDE REGEX "_posix\\.cpp$")
    set(own ${kept})
    list(FILTER own INCLUDE REGEX "_windows\\.cpp$")
    if(own)
      set_source_files_properties(${own} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
    endif()
  else()
    list(FILTER kept EXCLUDE REGEX "_windows\\.cpp$")
  endif()
  set(${list_name} ${kept} PARENT_SCOPE)
endfunction()

# One module = one small library in mbk/<wing>/<name>: name.h, name.cpp and name_test.cpp side by side.
#
#   mbk_module(identify DEPENDS core numeric trial [LIBRARIES PkgConfig::MATIO])
#
# DEPENDS lists every module whose headers this one includes; tests/layering.py reads the includes and fails
# where one is missing here or runs upward. SOURCES are further files, which the build writes. LIBRARIES are outside
# libraries that only the implementation uses, PRIVATE_HEADERS its own headers that are not installed; PUBLIC_LIBRARIES
# are those that stand in its headers, TEST_LIBRARIES those that only its tests link. NOT_INSTALLED: a part of the
# program that is no part of the library. LOOPS: its sources have numeric loops, and are compiled at -O3.
# TESTS_WAIT, TESTS_ALL: WAITS and ALL of its mbk_test.
#
# An application finds each as mbk::<name> (cmake/MbkInstall.cmake). Header-only LIBRARIES are built in and asked of
# nobody; what is linked is passed on.
function(mbk_module name)
  cmake_parse_arguments(ARG "LOOPS;NOT_INSTALLED;TESTS_WAIT" "TESTS_ALL"
                        "DEPENDS;SOURCES;PRIVATE_HEADERS;LIBRARIES;PUBLIC_LIBRARIES;TEST_LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  mbk_of_this_system(sources)
  list(APPEND sources ${ARG_SOURCES})

  set(private_libraries "")
  foreach(library IN LISTS ARG_LIBRARIES)
    mbk_is_header_only(${library} header_only)
    if(header_only)
      list(APPEND private_libraries $<BUILD_INTERFACE:${library}>)
    else()
      list(APPEND private_libraries ${library})
    endif()
  endforeach()

  list(TRANSFORM ARG_DEPENDS PREPEND mbk:: OUTPUT_VARIABLE dependencies)
  if(sources)
    set(public PUBLIC)
    add_library(mbk_${name} STATIC ${sources})
    if(ARG_LOOPS)
      mbk_precompile(mbk_${name} loops)
    else()
      mbk_precompile(mbk_${name} library)
    endif()
    target_link_libraries(mbk_${name} PRIVATE $<BUILD_INTERFACE:mbk_settings> ${private_libraries})
  else()
    add_library(mbk_${name} INTERFACE)
    set(public INTERFACE)
  endif()
  target_compile_features(mbk_${name} ${public} cxx_std_20)
  target_include_directories(mbk_${name} ${public} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_link_libraries(mbk_${name} ${public} ${dependencies} ${ARG_PUBLIC_LIBRARIES})
  add_library(mbk::${name} ALIAS mbk_${name})
  if(NOT ARG_NOT_INSTALLED AND NOT MBK_STATIC)
    mbk_install_module(${name} ${ARG_PRIVATE_HEADERS})
  endif()

  if(MBK_BUILD_TESTS AND tests)
    set(wait "")
    if(ARG_TESTS_WAIT)
      set(wait WAITS)
    endif()
    if(ARG_TESTS_ALL)
      list(APPEND wait ALL ${ARG_TESTS_ALL})
    endif()
    mbk_test(${name}_test ${wait} SOURCES ${tests} LIBRARIES mbk::${name} ${ARG_LIBRARIES} ${ARG_TEST_LIBRARIES})
  endif()
endfunction()

# A GoogleTest program whose cases CTest sees one by one. A case skipped for want of MBK_DATA_DIR counts as skipped.
# tools/test leaves out the labels waits and all, which only `tools/test --all` runs. WAITS: it waits for a socket or runs
# in real time, so a busy machine may fail it (label waits; one second chance in .ci/run). ALL FILTER: these cases, as
# --gtest_filter names them, have the label all; the reason stands beside the call. OWN_FLAGS: it is compiled otherwise than the rest, so that it has no precompiled headers.
function(mbk_test name)
  cmake_parse_arguments(ARG "WAITS;OWN_FLAGS" "ALL" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE mbk_settings ${ARG_LIBRARIES} GTest::gmock GTest::gtest_main)
  if(NOT ARG_OWN_FLAGS)
    mbk_precompile(${name} tests)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  set(discover TEST_PREFIX ${name}/ DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 300)
  if(ARG_WAITS)
    gtest_discover_tests(${name} ${discover} LABELS waits)
  elseif(ARG_ALL)
    gtest_discover_tests(${name} TEST_FILTER ${ARG_ALL} TEST_LIST ${name}_all ${discover} LABELS all)
    if(NOT ARG_ALL STREQUAL "*")
      gtest_discover_tests(${name} TEST_FILTER -${ARG_ALL} ${discover})
    endif()
  else()
    gtest_discover_tests(${name} ${discover})
  endif()
endfunction()

# mbk_test_each_simd(TEST FILTER): the cases that FILTER names, as processors run them that have less than this one.
function(mbk_test_each_simd test filter)
  if(NOT MBK_BUILD_TESTS)
    return()
  endif()
  foreach(simd any v3)
    add_test(NAME ${test}/simd_${simd} COMMAND ${test} --gtest_filter=${filter})
    set_tests_properties(${test}/simd_${simd} PROPERTIES ENVIRONMENT MBK_SIMD=${simd} TIMEOUT 300)
  endforeach()
endfunction()

# mbk_ready_files(NAME FOLDER TYPE): the files FOLDER/*.toml become part of the program: NAME.cpp.in, where it says
# @MBK_READY_FILES@, gets a TYPE{"name", "text"} of each, and is written to the build folder as NAME.cpp.
function(mbk_ready_files name folder type)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.toml)
  set(MBK_READY_FILES "")
  foreach(file IN LISTS files)
    get_filename_component(file_name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND MBK_READY_FILES "    ${type}{\"${file_name}\", R\"toml(${text})toml\"},\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endforeach()
  configure_file(${name}.cpp.in ${name}.cpp @ONLY)
endfunction()
