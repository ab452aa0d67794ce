# Install rules of headers and documents, and what find_package(forcelayer) and `pkg-config forcelayer` read.
include(CMakePackageConfigHelpers)

# The public headers: runtime/forcelayer, and of formats what those include. No room's header.
install(DIRECTORY runtime/forcelayer DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT development FILES_MATCHING PATTERN "*.h")
foreach(header result.h voxmap.h voxmap_format.h pshell.h pshell_format.h surface_distance.h file_format.h
        bricks/packed_bricks.h file/file_bytes.h)
  get_filename_component(folder formats/${header} DIRECTORY)
  install(FILES formats/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/forcelayer/${folder}
          COMPONENT development)
endforeach()
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
install(DIRECTORY formats/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development FILES_MATCHING PATTERN "*_format.md"
        PATTERN "mesh" EXCLUDE PATTERN "command" EXCLUDE)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/forcelayer)
install(EXPORT forcelayer NAMESPACE forcelayer:: FILE forcelayer-targets.cmake
        DESTINATION ${config_dir} COMPONENT development)
configure_package_config_file(scripts/cmake/forcelayer-config.cmake.in
                              ${CMAKE_BINARY_DIR}/forcelayer-config.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/forcelayer-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/forcelayer-config.cmake
              ${CMAKE_BINARY_DIR}/forcelayer-config-version.cmake
        DESTINATION ${config_dir} COMPONENT development)

# The prefix follows from where the file lies, so that a tree may be installed anywhere.
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" prefix_from_pc "${prefix_from_pc}")
configure_file(scripts/cmake/forcelayer.pc.in ${CMAKE_BINARY_DIR}/forcelayer.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/forcelayer.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
