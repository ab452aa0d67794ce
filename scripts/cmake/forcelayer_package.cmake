# Install rules of headers and documents, and the package config for find_package(forcelayer).
include(CMakePackageConfigHelpers)

install(DIRECTORY formats runtime DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/forcelayer
        COMPONENT development
        FILES_MATCHING PATTERN "*.h" PATTERN "mesh" EXCLUDE PATTERN "command" EXCLUDE
        PATTERN "viewer" EXCLUDE PATTERN "voxinfo" EXCLUDE
        # Inside formats/ only: what readers and writers share.
        REGEX "/formats/(section_table|field_check|voxmap_sections|pshell_sections|temporary_files)" EXCLUDE)
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
