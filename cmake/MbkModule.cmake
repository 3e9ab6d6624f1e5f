# One module = one small library in mbk/<name>: name.h, name.cpp and name_test.cpp side by side.
#
#   mbk_module(identify DEPENDS core numeric trial [LIBRARIES PkgConfig::MATIO])
#
# DEPENDS lists every module whose headers this one includes; tests/layering.py reads the includes and fails
# where one is missing here or runs upward. SOURCES are further files, which the build writes. LIBRARIES are outside
# libraries that only the implementation uses; PUBLIC_LIBRARIES are those that stand in its headers, TEST_LIBRARIES
# those that only its tests link.
function(mbk_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;SOURCES;LIBRARIES;PUBLIC_LIBRARIES;TEST_LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  list(APPEND sources ${ARG_SOURCES})

  list(TRANSFORM ARG_DEPENDS PREPEND mbk:: OUTPUT_VARIABLE dependencies)
  if(sources)
    add_library(mbk_${name} STATIC ${sources})
    target_include_directories(mbk_${name} PUBLIC ${PROJECT_SOURCE_DIR})
    target_link_libraries(mbk_${name} PUBLIC ${dependencies} ${ARG_PUBLIC_LIBRARIES}
                          PRIVATE mbk_settings ${ARG_LIBRARIES})
  else()
    add_library(mbk_${name} INTERFACE)
    target_include_directories(mbk_${name} INTERFACE ${PROJECT_SOURCE_DIR})
    target_link_libraries(mbk_${name} INTERFACE ${dependencies} ${ARG_PUBLIC_LIBRARIES})
  endif()
  add_library(mbk::${name} ALIAS mbk_${name})

  if(MBK_BUILD_TESTS AND tests)
    mbk_test(${name}_test SOURCES ${tests} LIBRARIES mbk::${name} ${ARG_LIBRARIES} ${ARG_TEST_LIBRARIES})
  endif()
endfunction()

# A GoogleTest program whose cases CTest sees one by one. A case skipped for want of MBK_DATA_DIR counts as skipped.
function(mbk_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE mbk_settings ${ARG_LIBRARIES} GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  gtest_discover_tests(${name} TEST_PREFIX ${name}/ DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 300)
endfunction()
