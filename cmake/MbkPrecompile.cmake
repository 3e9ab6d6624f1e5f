# The outside headers that most files include, read once for each way of compiling instead of once for each file:
# cmake/precompiled/library.h, with GoogleTest tests.h. Every file still includes what it uses, which clang-tidy, that
# compiles without them, confirms. docs/guide/build.md shows what it saves.
#
# What is precompiled keeps the level of optimisation that it was compiled with, and hands it to every file that takes
# it, whatever the command line of that file says: so each level has a holder of its own.
option(MBK_PRECOMPILE "Precompile the outside headers that most files include" ON)

# The compiler optimises fully (-O3) what has loops that a user waits for: modules with LOOPS, whose commands would
# execute a fifth to twice as many instructions at -O2. The rest compiles in two thirds of the time so.
set(MBK_LITTLE_OPTIMISATION $<$<CONFIG:Release>:-Og>)

set(MBK_PRECOMPILED_FOLDER ${CMAKE_CURRENT_LIST_DIR}/precompiled)

# One holder for each way of compiling, for the flags have to be the same: libraries are position-independent, programs
# are compiled as programs are.
if(MBK_PRECOMPILE)
  add_library(mbk_precompiled_library STATIC ${MBK_PRECOMPILED_FOLDER}/library.cpp)
  target_compile_options(mbk_precompiled_library PRIVATE ${MBK_LITTLE_OPTIMISATION})
  target_precompile_headers(mbk_precompiled_library PRIVATE ${MBK_PRECOMPILED_FOLDER}/library.h)

  add_library(mbk_precompiled_loops STATIC ${MBK_PRECOMPILED_FOLDER}/library.cpp)
  target_precompile_headers(mbk_precompiled_loops PRIVATE ${MBK_PRECOMPILED_FOLDER}/library.h)

  set(holders mbk_precompiled_library mbk_precompiled_loops)

  if(MBK_BUILD_TESTS)
    add_executable(mbk_precompiled_tests ${MBK_PRECOMPILED_FOLDER}/program.cpp)
    target_compile_options(mbk_precompiled_tests PRIVATE ${MBK_LITTLE_OPTIMISATION})
    target_link_libraries(mbk_precompiled_tests PRIVATE GTest::gmock)
    target_precompile_headers(mbk_precompiled_tests PRIVATE ${MBK_PRECOMPILED_FOLDER}/tests.h)
    list(APPEND holders mbk_precompiled_tests)
  endif()
  foreach(holder IN LISTS holders)
    target_include_directories(${holder} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${holder} PRIVATE mbk_settings Eigen3::Eigen fmt::fmt tl::expected)
    set_target_properties(${holder} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/precompiled)
  endforeach()
endif()

# mbk_precompile(TARGET library|loops|tests): TARGET is compiled with those headers. What they need it is given, for a
# module need not link it by itself; nobody who links TARGET is.
function(mbk_precompile target kind)
  if(MBK_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM mbk_precompiled_${kind})
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  endif()
endfunction()

# mbk_optimise(TARGET library|loops|tests): fully where it has loops that a user waits for, and with the headers that are
# precompiled so.
function(mbk_optimise target kind)
  if(NOT kind STREQUAL loops)
    target_compile_options(${target} PRIVATE ${MBK_LITTLE_OPTIMISATION})
  endif()
  mbk_precompile(${target} ${kind})
endfunction()

# mbk_program(TARGET library|loops): a program beside mbk, compiled as those libraries are, position-independent too, for
# the sake of their precompiled headers.
function(mbk_program target kind)
  target_compile_options(${target} PRIVATE -fPIC)
  mbk_optimise(${target} ${kind})
endfunction()
