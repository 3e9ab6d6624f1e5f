# The outside headers that most files include, read once for each way of compiling instead of once for each file
# (-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without). Every file still includes what it uses, which clang-tidy, that
# compiles without them, confirms.
#
# GCC gives a file the optimisation level of the precompiled header that it uses, whatever the file's command line says.
# So each level has a holder of its own: `library` (-O2), `loops` (-O3) and `tests` (-O2, with GoogleTest).
set(MBK_PRECOMPILED_FOLDER ${CMAKE_CURRENT_LIST_DIR}/precompiled)
set(MBK_LOOPS $<$<CONFIG:Release>:-O3>)

add_library(mbk_precompiled_library STATIC ${MBK_PRECOMPILED_FOLDER}/library.cpp)
add_library(mbk_precompiled_loops STATIC ${MBK_PRECOMPILED_FOLDER}/library.cpp)
target_compile_options(mbk_precompiled_loops PRIVATE ${MBK_LOOPS})
set(holders library loops)
if(MBK_BUILD_TESTS)
  add_executable(mbk_precompiled_tests ${MBK_PRECOMPILED_FOLDER}/program.cpp)
  target_link_libraries(mbk_precompiled_tests PRIVATE GTest::gmock)
  list(APPEND holders tests)
endif()
foreach(kind IN LISTS holders)
  set(holder mbk_precompiled_${kind})
  target_include_directories(${holder} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${holder} PRIVATE mbk_settings Eigen3::Eigen fmt::fmt tl::expected)
  set_target_properties(${holder} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/precompiled)
endforeach()
target_precompile_headers(mbk_precompiled_library PRIVATE ${MBK_PRECOMPILED_FOLDER}/library.h)
target_precompile_headers(mbk_precompiled_loops PRIVATE ${MBK_PRECOMPILED_FOLDER}/library.h)
if(MBK_BUILD_TESTS)
  target_precompile_headers(mbk_precompiled_tests PRIVATE ${MBK_PRECOMPILED_FOLDER}/tests.h)
endif()

# mbk_precompile(TARGET library|loops|tests): TARGET is compiled with those headers and, for loops, at -O3. It is given
# what the headers need, for a module need not link that by itself; nobody who links TARGET is.
function(mbk_precompile target kind)
  if(kind STREQUAL loops)
    target_compile_options(${target} PRIVATE ${MBK_LOOPS})
  endif()
  target_precompile_headers(${target} REUSE_FROM mbk_precompiled_${kind})
  target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
endfunction()

# mbk_program(TARGET): a program beside mbk. It is position-independent code as the libraries are, whose precompiled
# headers it uses.
function(mbk_program target)
  target_compile_options(${target} PRIVATE -fPIC)
  mbk_precompile(${target} library)
endfunction()
