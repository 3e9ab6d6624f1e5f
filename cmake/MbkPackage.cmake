# Debian packages from the components of MbkInstall: mbk, which a laboratory installs; libmbk-dev, which only those need
# who write programs, because it brings compiler packages along; libmbk1, the library with the C interface; and python3-mbk,
# which stands on it.
# Those of the preset portable (MBK_STATIC) run on every Debian from 12 on; its libmbk-dev is for programs in C.
# tools/package makes them.
set(MBK_MAINTAINER "The mbk authors <maintainers@mbk.example>" CACHE STRING "Maintainer of the Debian packages")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME mbk)
set(CPACK_PACKAGE_VENDOR "the mbk authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "measurement of the mechanical impedance of the human arm")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)  # tools/package packs them anew
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program development)
if(MBK_C)
  list(APPEND CPACK_COMPONENTS_ALL c)
endif()
if(MBK_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${MBK_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME mbk)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "A rehabilitation robot perturbs the hand; from the recorded motion and force
mbk finds inertia, damping, stiffness and equilibrium of the arm, each with
its interval, the ellipses that they form, and warnings where an answer must
not be trusted. A simulated robot with a simulated arm makes recordings whose
truth is known.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmbk-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Header and link of libmbk.so: the commands of mbk, called by a program in
C or in a language that calls C.")
if(NOT MBK_STATIC)
  set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Static libraries for C++20 with headers and a CMake package (mbk::mbk):
reading of recordings, preparation of signals, identification of inertia,
damping and stiffness with their covariance, ellipses, and a simulated robot
and arm.")
endif()

# debian_files.cmake puts its header and the link for linkers into libmbk-dev.
set(CPACK_DEBIAN_C_PACKAGE_NAME libmbk1)
set(CPACK_DEBIAN_C_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_C_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_C_PACKAGE_GENERATE_SHLIBS ON)  # ldconfig runs, too
set(CPACK_COMPONENT_C_DESCRIPTION "The library of mbk for programs in C and in every language that calls C: each
command that computes something runs inside the calling process, on files or
on arrays in memory. The Python package stands on it.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mbk)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "libmbk1 (= ${version}), python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, python3-pandas")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-xarray, mbk")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "What the program mbk computes, for Python: recordings as NumPy arrays without
a copy, each command as a function with the same options, results with units,
tables for notebooks and pandas, and plots.")

# The packages that hold what the libraries link, asked of dpkg.
set(owners "")
find_program(MBK_DPKG_QUERY dpkg-query)
mark_as_advanced(MBK_DPKG_QUERY)
get_property(files GLOBAL PROPERTY MBK_OUTSIDE_FILES)
if(MBK_DPKG_QUERY AND files)
  execute_process(COMMAND ${MBK_DPKG_QUERY} --search ${files} OUTPUT_VARIABLE owners ERROR_QUIET)
  string(REGEX MATCHALL "[^\n]+" owners "${owners}")
  list(TRANSFORM owners REPLACE "[:,].*" "")
  list(SORT owners)
  list(REMOVE_DUPLICATES owners)
endif()
if(MBK_C)
  list(PREPEND owners "libmbk1 (= ${version})")
endif()
list(JOIN owners ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)

set(CPACK_MBK_MAINTAINER ${MBK_MAINTAINER})
set(CPACK_MBK_VERSION ${version})
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/debian_files.cmake)
include(CPack)
