# SPDX-License-Identifier: MIT
# Installs the public headers as <batten/folder/x.h>, the libraries and their packages for CMake and pkg-config, the module,
# the program and the documents. The target `uninstall` removes what the last installation wrote.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/batten)

# Programs that link batten::io statically find the module by their run path.
target_link_options(batten_io INTERFACE $<INSTALL_INTERFACE:LINKER:-rpath,$<INSTALL_PREFIX>/${BATTEN_MODULE_DIR}>)
install(TARGETS batten_geometry batten_fitting batten_io EXPORT battenStaticTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT battenStaticTargets NAMESPACE batten:: DESTINATION ${package_dir} COMPONENT development)
if(BATTEN_SHARED)
  install(TARGETS batten_shared EXPORT battenTargets
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development)
  install(EXPORT battenTargets NAMESPACE batten:: DESTINATION ${package_dir} COMPONENT development)
  file(RELATIVE_PATH BATTEN_PREFIX_FROM_PC ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
  configure_file(cmake/batten.pc.in ${PROJECT_BINARY_DIR}/batten.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/batten.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endif()
install(FILES include/batten/pcl.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/batten COMPONENT development)
install(TARGETS batten_opencascade LIBRARY DESTINATION ${BATTEN_MODULE_DIR} COMPONENT runtime)
install(TARGETS batten_reconstruction LIBRARY DESTINATION ${BATTEN_MODULE_DIR} COMPONENT reconstruction)

configure_package_config_file(cmake/battenConfig.cmake.in ${PROJECT_BINARY_DIR}/battenConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/battenConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/battenConfig.cmake ${PROJECT_BINARY_DIR}/battenConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindPclParts.cmake
        DESTINATION ${package_dir} COMPONENT development)

if(BATTEN_BUILD_PROGRAM)
  install(TARGETS batten batten-verify RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  install(FILES cli/terminal/batten.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME batten
          COMPONENT program)
  # zsh looks into site-functions below /usr/local, into vendor-completions below /usr.
  foreach(folder site-functions vendor-completions)
    install(FILES cli/terminal/batten.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder} RENAME _batten COMPONENT program)
  endforeach()
  install(FILES cli/terminal/batten.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program
          OPTIONAL FILES_MATCHING PATTERN *.1)
endif()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)

if(PROJECT_IS_TOP_LEVEL)
  include(cmake/Package.cmake)
  add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -DMANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt
                    -P ${PROJECT_SOURCE_DIR}/cmake/Uninstall.cmake)
endif()
