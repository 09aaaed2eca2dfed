# What is installed, in three parts: `handpiece` is what people run, `school` a school's server, `dev` what programs are
# built with. Nothing needs the build tree afterwards: data, icons and languages are in the programs.
include(CMakePackageConfigHelpers)
get_property(rooms GLOBAL PROPERTY HANDPIECE_ROOMS)
install(TARGETS ${rooms} EXPORT handpieceTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(EXPORT handpieceTargets NAMESPACE handpiece:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/handpiece COMPONENT dev)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/handpieceConfig.cmake.in
    ${PROJECT_BINARY_DIR}/handpieceConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/handpiece)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/handpieceConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/handpieceConfig.cmake ${PROJECT_BINARY_DIR}/handpieceConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/handpiece COMPONENT dev)

# The archive brings its libraries in lib/handpiece (packaging/bundle.py); a package of Debian has no such folder. RPATH
# and not RUNPATH, so that libraries of libraries are found there too.
foreach(program IN ITEMS handpiece handpiece-desktop)
    if(TARGET ${program})
        install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT handpiece)
        set_target_properties(${program} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/handpiece")
        target_link_options(${program} PRIVATE LINKER:--disable-new-dtags)
    endif()
endforeach()

set(packaging ${PROJECT_SOURCE_DIR}/packaging)
set(share ${CMAKE_INSTALL_DATADIR})
if(HANDPIECE_BUILD_CLI)
    install(CODE "
        set(place \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${share}/bash-completion/completions\")
        file(MAKE_DIRECTORY \"\${place}\")
        execute_process(COMMAND \"$<TARGET_FILE:handpiece>\" completion bash OUTPUT_FILE \"\${place}/handpiece\" COMMAND_ERROR_IS_FATAL ANY)
    " COMPONENT handpiece)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT handpiece)
    install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/LICENSE
            ${packaging}/debian/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT handpiece)
    # For an administrator to put in place; the package of Debian does that itself.
    install(FILES ${packaging}/udev/70-handpiece.rules ${packaging}/limits.d/handpiece.conf ${packaging}/settings.toml
            DESTINATION ${share}/handpiece/system COMPONENT handpiece)
endif()
if(TARGET handpiece-school)
    install(TARGETS handpiece-school RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT school)
    file(GLOB school_pages ${PROJECT_SOURCE_DIR}/docs/school*.md)
    install(FILES ${school_pages} ${PROJECT_SOURCE_DIR}/LICENSE ${packaging}/debian/copyright DESTINATION ${share}/doc/handpiece-school COMPONENT school)
endif()
if(HANDPIECE_BUILD_DESKTOP)
    add_executable(handpiece_icon_maker ${packaging}/icon_maker.cpp)
    set_target_properties(handpiece_icon_maker PROPERTIES AUTOMOC OFF)
    find_package(Qt6 6.4 REQUIRED COMPONENTS Svg)
    target_link_libraries(handpiece_icon_maker PRIVATE Qt6::Svg)
    install(CODE "
        execute_process(COMMAND \"$<TARGET_FILE:handpiece_icon_maker>\" \"${PROJECT_SOURCE_DIR}/apps/desktop/icons/app.svg\"
            \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${share}/icons/hicolor\" COMMAND_ERROR_IS_FATAL ANY)
    " COMPONENT handpiece)
    install(FILES ${packaging}/desktop/handpiece-desktop.desktop DESTINATION ${share}/applications COMPONENT handpiece)
    install(FILES ${packaging}/desktop/org.handpiece.Handpiece.metainfo.xml DESTINATION ${share}/metainfo COMPONENT handpiece)
    install(FILES ${packaging}/desktop/handpiece-mime.xml DESTINATION ${share}/mime/packages RENAME handpiece.xml COMPONENT handpiece)
endif()
if(PROJECT_IS_TOP_LEVEL)
    include(handpiece_packages)
endif()
