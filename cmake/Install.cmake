# SPDX-License-Identifier: MIT
# Installs the public headers as <batten/folder/x.h>, the libraries as batten::folder, the module and the program.
include(CMakePackageConfigHelpers)

# Programs that link batten::io statically find the module by their run path.
target_link_options(batten_io INTERFACE $<INSTALL_INTERFACE:LINKER:-rpath,$<INSTALL_PREFIX>/${BATTEN_MODULE_DIR}>)
install(TARGETS batten_geometry batten_fitting batten_io EXPORT battenTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS batten_opencascade LIBRARY DESTINATION ${BATTEN_MODULE_DIR})
install(TARGETS batten RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES cli/terminal/batten.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME batten)
install(EXPORT battenTargets NAMESPACE batten:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
configure_package_config_file(cmake/battenConfig.cmake.in ${PROJECT_BINARY_DIR}/battenConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/battenConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/battenConfig.cmake ${PROJECT_BINARY_DIR}/battenConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindPclParts.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
