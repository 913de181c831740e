# `cmake --install` puts the command, the headers and the libraries where find_package(stribeck) finds them. The real-time tier is
# headers alone: stribeck::control needs nothing else. stribeck::workflow has what the verbs do; it needs the libraries that
# stribeckConfig.cmake looks for.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(modules core friction path control plant sim ident io report workflow targets)
list(TRANSFORM modules PREPEND stribeck_ OUTPUT_VARIABLE targets)
list(APPEND targets stribeck_capi stribeck_capi_plant)
install(TARGETS ${targets} EXPORT stribeckTargets)
install(TARGETS stribeck RUNTIME)
foreach(module IN LISTS modules)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/stribeck/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stribeck
          FILES_MATCHING PATTERN "*.hpp" PATTERN "test_*" EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/capi/include/stribeck DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT stribeckTargets NAMESPACE stribeck:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/stribeck)
file(WRITE ${PROJECT_BINARY_DIR}/stribeckConfig.cmake
     "include(CMakeFindDependencyMacro)
foreach(library Threads Eigen3 Ceres Boost fmt nlohmann_json ZLIB EXPAT)
  find_dependency(\${library})
endforeach()
include(\${CMAKE_CURRENT_LIST_DIR}/stribeckTargets.cmake)
")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stribeckConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stribeckConfig.cmake ${PROJECT_BINARY_DIR}/stribeckConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/stribeck)
