# SPDX-License-Identifier: MIT
# Installs headers as <batten/folder/x.h>, the libraries as batten::folder, and the program.
include(CMakePackageConfigHelpers)

install(TARGETS batten_geometry batten_fitting batten_io EXPORT battenTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS batten RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES cli/batten.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME batten)
include(cmake/InternalHeaders.cmake)
foreach(folder geometry fitting io)
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${folder}/*.h)
  list(REMOVE_ITEM headers ${BATTEN_INTERNAL_HEADERS})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/batten/${folder})
endforeach()
install(EXPORT battenTargets NAMESPACE batten:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
configure_package_config_file(cmake/battenConfig.cmake.in ${PROJECT_BINARY_DIR}/battenConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/battenConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/battenConfig.cmake ${PROJECT_BINARY_DIR}/battenConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindPclParts.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
