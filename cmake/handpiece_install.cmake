include(CMakePackageConfigHelpers)
get_property(rooms GLOBAL PROPERTY HANDPIECE_ROOMS)
install(TARGETS ${rooms} EXPORT handpieceTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT handpieceTargets NAMESPACE handpiece:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/handpiece)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/handpieceConfig.cmake.in
    ${PROJECT_BINARY_DIR}/handpieceConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/handpiece)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/handpieceConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/handpieceConfig.cmake ${PROJECT_BINARY_DIR}/handpieceConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/handpiece)
if(HANDPIECE_BUILD_CLI)
    install(TARGETS handpiece RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
