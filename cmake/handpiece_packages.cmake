# Packages of Debian by CPack: handpiece, handpiece-dev and handpiece-school. tools/package makes them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME handpiece)
set(CPACK_PACKAGE_VENDOR "The Handpiece authors")
set(CPACK_PACKAGE_CONTACT "The Handpiece authors <handpiece@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Open dental surgery simulator")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL handpiece dev)
if(TARGET handpiece-school)
    list(APPEND CPACK_COMPONENTS_ALL school)
endif()
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/handpiece_system_files.cmake)
set(CPACK_HANDPIECE_PACKAGING ${PROJECT_SOURCE_DIR}/packaging)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_NAME handpiece)
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_SECTION education)
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_SHLIBDEPS ON)
# Beyond what the programs link: a driver to draw with, Qt's picture formats for icons, the passwd tools for postinst.
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_DEPENDS "libegl-mesa0 | libegl-vendor, libgl1-mesa-dri, passwd")
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_RECOMMENDS "fonts-dejavu-core, qt6-translations-l10n, qt6-wayland")
# Loaded at run time where they are; without them the program does all the rest.
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_SUGGESTS "rtkit, spacenavd, libspnav0, libsdl2-2.0-0, fonts-ipafont-gothic")
set(CPACK_DEBIAN_HANDPIECE_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/packaging/debian/postinst ${PROJECT_SOURCE_DIR}/packaging/debian/prerm
    ${PROJECT_SOURCE_DIR}/packaging/debian/postrm ${PROJECT_SOURCE_DIR}/packaging/debian/conffiles)
set(CPACK_COMPONENT_HANDPIECE_DESCRIPTION
"Feel and cut teeth with a haptic arm, a simulated one or the mouse.
Window and command line: teeth from scans or made by the program, sessions that can be
replayed and measured, drivers for haptic arms that are loaded at run time.")

set(CPACK_DEBIAN_SCHOOL_PACKAGE_NAME handpiece-school)
set(CPACK_DEBIAN_SCHOOL_PACKAGE_SECTION education)
set(CPACK_DEBIAN_SCHOOL_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_SCHOOL_PACKAGE_DEPENDS "passwd, libegl-mesa0 | libegl-vendor, libgl1-mesa-dri")
set(CPACK_DEBIAN_SCHOOL_PACKAGE_SUGGESTS "postgresql-15, nginx | caddy")
set(CPACK_DEBIAN_SCHOOL_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/packaging/school/postinst ${PROJECT_SOURCE_DIR}/packaging/school/prerm
    ${PROJECT_SOURCE_DIR}/packaging/school/postrm ${PROJECT_SOURCE_DIR}/packaging/school/conffiles)
set(CPACK_COMPONENT_SCHOOL_DESCRIPTION
"A school's server for the dental surgery simulator.
People, classes, exercises; takes what stations push, cuts every session again and scores
it by itself; teachers and students look at it in a browser.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME handpiece-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "libeigen3-dev, libfmt-dev, libtbb-dev, libtomlplusplus-dev, libopenal-dev, libsndfile1-dev, libqhull-dev, libzip-dev, libhdf5-dev, zlib1g-dev, libpng-dev, libtiff-dev, libjpeg-dev, libgdcm-dev, libegl-dev, libopengl-dev, libdbus-1-dev, libsqlite3-dev, libpq-dev, libsodium-dev")
set(CPACK_COMPONENT_DEV_DESCRIPTION
"Build your own programs on the simulator's library.
Headers, static libraries and the files for find_package(handpiece).")
include(CPack)
