# Settings that every target of this project shares.
add_library(mbk_settings INTERFACE)
target_compile_features(mbk_settings INTERFACE cxx_std_20)
target_compile_definitions(mbk_settings INTERFACE EIGEN_MPL2_ONLY)
if(MBK_COMPILER_CHECKS)
  target_compile_options(mbk_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                         -Wold-style-cast -Woverloaded-virtual -Wdouble-promotion
                         -Wno-missing-field-initializers)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 sees reads beyond small matrices in Eigen's copies, overlaps and (with precompiled headers) overflows in
    # std::string's, and members of a std::variant that nothing set, where there are none.
    target_compile_options(mbk_settings INTERFACE -Wno-array-bounds -Wno-stringop-overread -Wno-stringop-overflow
                           -Wno-restrict -Wno-maybe-uninitialized)
  endif()
else()
  # They are a twentieth of the time of compiling, and find nothing that the tests' build has not found.
  target_compile_options(mbk_settings INTERFACE -w)
  target_compile_definitions(mbk_settings INTERFACE FMT_CONSTEVAL=)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Its garbage is left lying until a gigabyte of it is there, which saves a tenth of the time of compiling.
  target_compile_options(mbk_settings INTERFACE --param=ggc-min-heapsize=1048576)
endif()
if(MBK_WARNINGS_AS_ERRORS AND NOT (CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^12"))
  message(STATUS "Warnings are not errors: only those of GCC 12 have been cleared")
elseif(MBK_WARNINGS_AS_ERRORS)
  target_compile_options(mbk_settings INTERFACE -Werror)
endif()

# What a program or shared library links to run with glibc 2.34, and to have paths in UTF-8 on Windows.
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|aarch64)$")
  add_library(mbk_wrapped OBJECT ${CMAKE_CURRENT_LIST_DIR}/older_glibc.c)
  target_link_options(mbk_wrapped INTERFACE -Wl,--wrap=hypot,--wrap=arc4random)
elseif(WIN32)
  add_library(mbk_wrapped OBJECT ${CMAKE_CURRENT_LIST_DIR}/windows_paths.cpp)
  target_link_options(mbk_wrapped INTERFACE -Wl,--wrap=_ZNKSt7codecvtIwciE5do_inERiPKcS3_RS3_PwS5_RS5_)
else()
  add_library(mbk_wrapped INTERFACE)
endif()
