# What mbk stands on. Everything comes from Debian 12's packages (tools/packages lists them).
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tl-expected REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Boost 1.74 REQUIRED CONFIG)
find_path(MBK_TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
add_library(mbk_tomlplusplus INTERFACE)
target_include_directories(mbk_tomlplusplus SYSTEM INTERFACE ${MBK_TOMLPLUSPLUS_INCLUDE_DIR})
pkg_check_modules(LIBDEFLATE REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(LIBLZF REQUIRED IMPORTED_TARGET liblzf)
pkg_check_modules(MINIZIP REQUIRED IMPORTED_TARGET minizip)
# Included as <minizip/unzip.h>: its folder has a zip.h as libzip has one.
set_target_properties(PkgConfig::MINIZIP PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "")
pkg_check_modules(PUGIXML REQUIRED IMPORTED_TARGET pugixml)
pkg_check_modules(LIBZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LIBLZ4 REQUIRED IMPORTED_TARGET liblz4)
find_package(BZip2 REQUIRED)
# A study's database. Debian's package brings SQLiteCpp as a static library.
find_package(SQLiteCpp 3.2 REQUIRED CONFIG)

# For what runs on any Linux: wheels and archives. tools/static-libraries makes those libraries that Debian does not have.
set(MBK_STATIC "" CACHE PATH "Link third-party libraries and the C++ runtime statically, with those in this folder")

# mbk_link_statically(TARGET PROPERTY FILE): what few commands use stands in the program, where it costs nothing until it
# is called; to load it would be a third of what every start costs. Where there is no such archive it is loaded after all.
function(mbk_link_statically target property file)
  find_library(MBK_${file} ${file} HINTS ${MBK_STATIC})
  mark_as_advanced(MBK_${file})
  if(MBK_${file})
    set_target_properties(${target} PROPERTIES ${property} ${MBK_${file}})
  elseif(MBK_STATIC)
    message(FATAL_ERROR "MBK_STATIC: there is no ${file}; tools/static-libraries ${MBK_STATIC} makes what Debian lacks")
  endif()
endfunction()
mbk_link_statically(PkgConfig::MINIZIP INTERFACE_LINK_LIBRARIES libminizip.a)
mbk_link_statically(PkgConfig::PUGIXML INTERFACE_LINK_LIBRARIES libpugixml.a)
mbk_link_statically(PkgConfig::LIBZSTD INTERFACE_LINK_LIBRARIES libzstd.a)
mbk_link_statically(PkgConfig::LIBLZ4 INTERFACE_LINK_LIBRARIES liblz4.a)
mbk_link_statically(SQLite::SQLite3 IMPORTED_LOCATION libsqlite3.a)
# orocos-kdl's CMake file names no target.
pkg_check_modules(OROCOS_KDL REQUIRED IMPORTED_TARGET orocos-kdl)
find_package(urdfdom REQUIRED)
if(MBK_STATIC)
  mbk_link_statically(PkgConfig::LIBDEFLATE INTERFACE_LINK_LIBRARIES libdeflate.a)
  mbk_link_statically(PkgConfig::LIBLZF INTERFACE_LINK_LIBRARIES liblzf.a)
  mbk_link_statically(PkgConfig::OROCOS_KDL INTERFACE_LINK_LIBRARIES liborocos-kdl.a)
  mbk_link_statically(ZLIB::ZLIB IMPORTED_LOCATION_RELEASE libz.a)
  mbk_link_statically(BZip2::BZip2 IMPORTED_LOCATION_RELEASE libbz2.a)
  mbk_link_statically(fmt::fmt IMPORTED_LOCATION_NONE libfmt.a)
  mbk_link_statically(console_bridge::console_bridge IMPORTED_LOCATION_NONE libconsole_bridge.a)
  mbk_link_statically(urdfdom::urdfdom_model IMPORTED_LOCATION_NONE liburdfdom_model.a)
  find_library(MBK_libtinyxml.a libtinyxml.a REQUIRED)
  set_target_properties(urdfdom::urdfdom_model PROPERTIES INTERFACE_LINK_LIBRARIES
                        "console_bridge::console_bridge;urdfdom_headers::urdfdom_headers;${MBK_libtinyxml.a}")
  # A name that the process has loaded already must not replace one of these.
  add_link_options(-static-libstdc++ -static-libgcc -Wl,--exclude-libs,ALL)
endif()

# mbk_runs_on_older_glibc(TARGET): see older_glibc.c.
function(mbk_runs_on_older_glibc target)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|aarch64)$")
    target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/older_glibc.c)
    target_link_options(${target} PRIVATE -Wl,--wrap=hypot)
  endif()
endfunction()

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

if(MBK_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
  # Readers of their own, against which files that are written are held.
  pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
  pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5-serial)
  pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
  # What documents are held to their schemas with (tests/support). Its CMake file names no target.
  find_path(RAPIDJSON_INCLUDE_DIR rapidjson/schema.h REQUIRED)
  # An independent physics engine for tests/physics, if it is installed (tools/test --all installs it). Debian's
  # mujocoConfig.cmake names a folder that its package does not have.
  find_path(MUJOCO_INCLUDE_DIR mujoco/mujoco.h)
  find_library(MUJOCO_LIBRARY mujoco)
endif()
