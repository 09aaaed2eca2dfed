# What is installed, by component, one a package of debian/: `handpiece` the command line, `desktop` the window, `school`
# the server, `dev` what programs are built with, `doc`; and `archive`, what only the archive of tools/package needs.
# Nothing needs the build tree afterwards: data, icons and languages are in the programs.
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

set(packaging ${PROJECT_SOURCE_DIR}/packaging)
set(share ${CMAKE_INSTALL_DATADIR})
set(can_run TRUE)
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
    set(can_run FALSE)
endif()

# Manual pages and completion of a program, written by itself as soon as it is built.
function(handpiece_pages program component)
    if(NOT can_run)
        return()
    endif()
    set(pages ${PROJECT_BINARY_DIR}/pages/${program})
    add_custom_command(OUTPUT ${pages}/done
        COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}
        COMMAND ${program} manual ${pages}/man1
        COMMAND ${program} completion bash > ${pages}/bash
        COMMAND ${program} completion zsh > ${pages}/zsh
        COMMAND ${program} completion fish > ${pages}/fish
        COMMAND ${CMAKE_COMMAND} -E touch ${pages}/done
        DEPENDS ${program} VERBATIM COMMENT "Manual pages and completion of ${program}")
    add_custom_target(${program}_pages ALL DEPENDS ${pages}/done)
    install(DIRECTORY ${pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT ${component})
    install(FILES ${pages}/bash DESTINATION ${share}/bash-completion/completions RENAME ${program} COMPONENT ${component})
    install(FILES ${pages}/zsh DESTINATION ${share}/zsh/vendor-completions RENAME _${program} COMPONENT ${component})
    install(FILES ${pages}/fish DESTINATION ${share}/fish/vendor_completions.d RENAME ${program}.fish COMPONENT ${component})
endfunction()

if(HANDPIECE_BUILD_CLI)
    install(TARGETS handpiece RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT handpiece)
    handpiece_pages(handpiece handpiece)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${share}/doc/handpiece-doc COMPONENT doc)
    install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/LICENSE
            ${PROJECT_SOURCE_DIR}/debian/copyright DESTINATION ${share}/doc/handpiece COMPONENT archive)
    # For an administrator to put in place; packages do that themselves.
    install(FILES ${packaging}/udev/70-handpiece.rules ${packaging}/limits.d/handpiece.conf ${packaging}/settings.toml
            DESTINATION ${share}/handpiece/system COMPONENT archive)
endif()
if(TARGET handpiece-sandbox)
    install(TARGETS handpiece-sandbox RUNTIME DESTINATION libexec/handpiece COMPONENT handpiece)
endif()
if(TARGET handpiece-school)
    install(TARGETS handpiece-school RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT school)
    handpiece_pages(handpiece-school school)
    # `handpiece serve` is `handpiece-school serve`.
    install(CODE "file(CREATE_LINK handpiece-school-serve.1
        \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1/handpiece-serve.1\" SYMBOLIC)" COMPONENT school)
endif()
if(HANDPIECE_BUILD_DESKTOP)
    install(TARGETS handpiece-desktop RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT desktop)
    if(can_run)
        add_executable(handpiece_icon_maker ${packaging}/icon_maker.cpp)
        set_target_properties(handpiece_icon_maker PROPERTIES AUTOMOC OFF)
        find_package(Qt6 6.4 REQUIRED COMPONENTS Svg)
        target_link_libraries(handpiece_icon_maker PRIVATE Qt6::Svg)
        set(icon ${PROJECT_SOURCE_DIR}/apps/desktop/icons/app.svg)
        set(icons ${PROJECT_BINARY_DIR}/icons/hicolor)
        add_custom_command(OUTPUT ${icons}/scalable/apps/handpiece.svg COMMAND handpiece_icon_maker ${icon} ${icons}
            DEPENDS handpiece_icon_maker ${icon} VERBATIM)
        add_custom_target(handpiece_icons ALL DEPENDS ${icons}/scalable/apps/handpiece.svg)
        install(DIRECTORY ${icons} DESTINATION ${share}/icons COMPONENT desktop)
    endif()
    configure_file(${packaging}/man/handpiece-desktop.1.in ${PROJECT_BINARY_DIR}/pages/handpiece-desktop.1 @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/pages/handpiece-desktop.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT desktop)
    install(FILES ${packaging}/desktop/handpiece-desktop.desktop DESTINATION ${share}/applications COMPONENT desktop)
    install(FILES ${packaging}/desktop/org.handpiece.Handpiece.metainfo.xml DESTINATION ${share}/metainfo COMPONENT desktop)
    install(FILES ${packaging}/desktop/handpiece-mime.xml DESTINATION ${share}/mime/packages RENAME handpiece.xml COMPONENT desktop)
endif()
# The archive brings its libraries in lib/handpiece (packaging/bundle.py); packages drop this path. RPATH and not
# RUNPATH, so that libraries of libraries are found there too.
if(TARGET handpiece-sandbox)
    set_target_properties(handpiece-sandbox PROPERTIES INSTALL_RPATH "$ORIGIN/../../lib/handpiece")
    target_link_options(handpiece-sandbox PRIVATE LINKER:--disable-new-dtags)
endif()
foreach(program IN ITEMS handpiece handpiece-desktop)
    if(TARGET ${program})
        set_target_properties(${program} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/handpiece")
        target_link_options(${program} PRIVATE LINKER:--disable-new-dtags)
    endif()
endforeach()
