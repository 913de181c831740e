# `cmake --install` puts the command with its man pages and completion, the headers and the libraries where shells, find_package(stribeck)
# and pkg-config find them. The real-time tier is headers alone: stribeck::control needs nothing else. stribeck::workflow has what the
# verbs do; it needs the libraries that stribeckConfig.cmake looks for. Component program: what runs; shared: the
# library that is loaded at run time; python; development: the rest.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
set(cmake_files ${CMAKE_INSTALL_LIBDIR}/cmake/stribeck)

set(modules core friction path control plant sim ident io report workflow targets)
list(TRANSFORM modules PREPEND stribeck_ OUTPUT_VARIABLE targets)
list(APPEND targets stribeck_capi stribeck_capi_plant)
install(TARGETS ${targets} EXPORT stribeckTargets)
install(TARGETS stribeck_shared EXPORT stribeckTargets LIBRARY COMPONENT shared NAMELINK_COMPONENT development)
foreach(module IN LISTS modules)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/stribeck/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stribeck
          FILES_MATCHING PATTERN "*.hpp" PATTERN "test_*" EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/capi/include/stribeck DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT stribeckTargets NAMESPACE stribeck:: DESTINATION ${cmake_files})
file(WRITE ${PROJECT_BINARY_DIR}/stribeckConfig.cmake
     "include(CMakeFindDependencyMacro)
foreach(library Threads Eigen3 Ceres Boost fmt nlohmann_json ZLIB EXPAT)
  find_dependency(\${library})
endforeach()
include(\${CMAKE_CURRENT_LIST_DIR}/stribeckTargets.cmake)
")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stribeckConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stribeckConfig.cmake ${PROJECT_BINARY_DIR}/stribeckConfigVersion.cmake DESTINATION ${cmake_files})

# For C: the controllers, and the virtual drive; both in one shared library. The folder is named relative to the file, so that an unpacked archive works anywhere.
string(REGEX REPLACE "[^/]+" ".." up ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
function(pkg_config_file name about libs requires)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${name}.pc @ONLY CONTENT
       "prefix=\${pcfiledir}/@up@
libdir=\${prefix}/@CMAKE_INSTALL_LIBDIR@
Name: @name@
Description: @about@
Version: @PROJECT_VERSION@
Requires: @requires@
Cflags: -I\${prefix}/@CMAKE_INSTALL_INCLUDEDIR@
Libs: -L\${libdir} @libs@
")
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
pkg_config_file(stribeck "Position controllers with friction compensation, in C" "-lstribeck_capi -lstdc++ -lm" "")
pkg_config_file(stribeck-plant "Virtual feed drives, in C" "-lstribeck_capi_plant -lstribeck_plant -lstdc++ -lm" stribeck)
pkg_config_file(stribeck-shared "Position controllers with friction compensation and virtual feed drives, in C, as a shared library" "-lstribeck" "")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/stribeck)

# ---- what runs
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
install(TARGETS stribeck RUNTIME)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/machines ${PROJECT_SOURCE_DIR}/controllers DESTINATION ${CMAKE_INSTALL_DATADIR}/stribeck)
# The page that computes in a browser, where tools/make-offline-page has made it.
install(FILES ${PROJECT_SOURCE_DIR}/build/offline/stribeck.html DESTINATION ${CMAKE_INSTALL_DATADIR}/stribeck OPTIONAL)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.png")
install(CODE "set(folder \"${CMAKE_INSTALL_DOCDIR}\")
set(data \"${CMAKE_INSTALL_DATADIR}/stribeck\")
foreach(path folder data)
  if(NOT IS_ABSOLUTE \"\${\${path}}\")
    set(\${path} \"\${CMAKE_INSTALL_PREFIX}/\${\${path}}\")
  endif()
  set(\${path} \"\$ENV{DESTDIR}\${\${path}}\")
endforeach()
include(\"${PROJECT_SOURCE_DIR}/cmake/installed_links.cmake\")")
# The program has made these pages when it was linked.
set(pages ${PROJECT_BINARY_DIR}/share)
install(DIRECTORY ${pages}/man/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(DIRECTORY ${pages}/bash-completion ${pages}/fish DESTINATION ${CMAKE_INSTALL_DATADIR})
# Debian's own zsh looks for those of packages in a folder of its own.
install(CODE "set(share \${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR})
set(folder site-functions)
if(CMAKE_INSTALL_PREFIX MATCHES \"(^|/)usr$\")
  set(folder vendor-completions)
endif()
file(INSTALL ${pages}/zsh/site-functions/_stribeck DESTINATION \${share}/zsh/\${folder})")
# The HAL components where LinuxCNC looks for them, when its prefix is the same; built only where its headers are.
if(TARGET hal_axis)
  install(TARGETS hal_axis hal_contour hal_plant LIBRARY DESTINATION lib/linuxcnc/modules OPTIONAL)
endif()
# Where Debian's Python looks, when the prefix is /usr; for another prefix PYTHONPATH names the folder.
if(TARGET stribeck_python)
  install(TARGETS stribeck_python LIBRARY DESTINATION lib/python3/dist-packages COMPONENT python OPTIONAL)
  set(python_package python3-stribeck)
endif()
set(shared_package libstribeck${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
foreach(package stribeck libstribeck-dev ${shared_package} ${python_package})
  set(component program)
  if(package STREQUAL "libstribeck-dev")
    set(component development)
  elseif(package STREQUAL shared_package)
    set(component shared)
  elseif(package STREQUAL "python3-stribeck")
    set(component python)
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component} RENAME copyright)
endforeach()
