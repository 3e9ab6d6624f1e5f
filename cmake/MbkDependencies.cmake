# What mbk stands on. Everything comes from Debian 12's packages (tools/packages lists them), or, for what runs where none
# of them is installed, from a folder of static libraries that tools/third-party makes.
set(MBK_STATIC "" CACHE PATH "Link third-party libraries and the C++ runtime statically: the folder of tools/third-party")
if(MBK_STATIC)
  include(MbkThirdParty)
  return()
endif()
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

# mbk_link_statically(TARGET PROPERTY FILE): what few commands use stands in the program, where it costs nothing until it
# is called; to load it would be a third of what every start costs. Where there is no such archive it is loaded after all.
function(mbk_link_statically target property file)
  find_library(MBK_${file} ${file})
  mark_as_advanced(MBK_${file})
  if(MBK_${file})
    set_target_properties(${target} PROPERTIES ${property} ${MBK_${file}})
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
