# `cpack -G DEB` and `cpack -G TGZ` in a build folder: Debian packages, stribeck (what runs), libstribeck-dev (headers, libraries,
# examples), libstribeck0.1 (the shared library of the C interface) and, where the module was built, python3-stribeck; and one archive with everything, which works wherever it is unpacked.
set(CPACK_PACKAGE_NAME stribeck)
set(CPACK_PACKAGE_VENDOR "The Stribeck authors")
set(CPACK_PACKAGE_CONTACT "The Stribeck authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_FILE_NAME stribeck-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR TGZ)
set(CPACK_COMPONENTS_ALL program development shared)
if(TARGET stribeck_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME stribeck)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libstribeck-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "The command stribeck with its man pages, completion, documents and machine
files, and components for LinuxCNC where they were built.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Headers and libraries for C++ and C, with files for CMake and pkg-config, and
example programs.")
# Only what really is linked, as dpkg-shlibdeps finds it. Plots of reports come from gnuplot, netCDF from a library that is loaded when
# it is asked for.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot-qt | gnuplot-x11")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "linuxcnc-uspace, libnetcdf19 | libnetcdf22, libmosquitto1")
# What find_package(stribeck) looks for. A program in C needs none of them.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libstdc++-12-dev | libstdc++-dev, ${shared_package} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS
    "libeigen3-dev, libceres-dev, libnlopt-dev, libfmt-dev, libboost-dev, nlohmann-json3-dev, libudunits2-dev, libexpat1-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS stribeck)
set(CPACK_DEBIAN_SHARED_PACKAGE_NAME ${shared_package})
set(CPACK_DEBIAN_SHARED_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_SHARED_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_SHARED_DESCRIPTION "Position controllers with friction compensation and virtual feed drives behind a
C interface, as a library that programs load at run time.")
# The linker of the system learns of the library.
file(WRITE ${PROJECT_BINARY_DIR}/package/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_SHARED_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/triggers)
if(TARGET stribeck_python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-stribeck)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python module stribeck: logs as arrays, identification, friction models,
simulation, comparison, circular test.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # A module belongs to one version of Python.
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS stribeck)
endif()
include(CPack)
