#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bundle.py TREE: copies into an installed tree the libraries its programs need, so that it runs without root from any
folder. Left to the system: the C and C++ libraries, what belongs to its graphics driver and its display, fonts, sound."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

# By name up to ".so": theirs must be those of the system's kernel, driver, display server or configuration.
SYSTEM = """ld-linux-x86-64 libc libm libdl libpthread librt libresolv libstdc++ libgcc_s
libEGL libGL libGLX libGLdispatch libOpenGL libgbm libdrm libvulkan
libX11 libX11-xcb libxcb libXau libXdmcp libwayland-client libwayland-cursor libwayland-egl
libfontconfig libfreetype libexpat libz libuuid libasound libdbus-1 libsystemd libudev""".split()
# What Qt loads by itself: a display (X11, Wayland, none), icons, the pictures we use.
PLUGINS = ["platforms/libqxcb.so", "platforms/libqoffscreen.so", "platforms/libqminimal.so", "platforms/libqwayland-generic.so",
           "xcbglintegrations/libqxcb-egl-integration.so", "iconengines/libqsvgicon.so", "imageformats/libqsvg.so",
           "imageformats/libqjpeg.so", "wayland-shell-integration/libxdg-shell.so", "wayland-decoration-client/libbradient.so"]


def needed(file):
    """Name -> place of every library that `file` loads, theirs included."""
    out = subprocess.run(["ldd", file], capture_output=True, text=True, check=True).stdout
    missing = re.findall(r"(\S+) => not found", out)
    if missing:
        sys.exit(f"bundle: {file} needs {', '.join(missing)}, which is not here")
    return dict(re.findall(r"^\s*(\S+) => (/\S+)", out, re.M))


def stem(name):
    return name.split(".so")[0]


def packages_of(paths):
    """Path -> the package that owns it. Debian's list may know a file under /lib or under /usr/lib."""
    spellings = {}
    for path in paths:
        real = os.path.realpath(path)
        for name in (path, real, "/usr" + real, real.removeprefix("/usr")):
            spellings.setdefault(name, path)
    # It complains about the spellings it does not know, which is most of them.
    out = subprocess.run(["dpkg", "-S", *spellings], capture_output=True, text=True, check=False).stdout
    owners = {}
    for line in out.splitlines():
        owner, _, name = line.partition(": ")
        if name in spellings:
            owners[spellings[name]] = owner.split(":")[0].split(",")[0]
    for path in paths:
        if path not in owners:
            sys.exit(f"bundle: no package owns {path}: its licence is not known")
    return owners


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: bundle.py TREE")
    tree = pathlib.Path(sys.argv[1])
    libraries = tree / "lib/handpiece"
    plugins = libraries / "qt6/plugins"
    libraries.mkdir(parents=True, exist_ok=True)
    qt_plugins = pathlib.Path(subprocess.run(["qmake6", "-query", "QT_INSTALL_PLUGINS"], capture_output=True, text=True, check=True).stdout.strip())
    qt_words = pathlib.Path(subprocess.run(["qmake6", "-query", "QT_INSTALL_TRANSLATIONS"], capture_output=True, text=True, check=True).stdout.strip())
    programs = [tree / "bin/handpiece", tree / "bin/handpiece-desktop", tree / "libexec/handpiece/handpiece-sandbox"]
    sources = []
    for plugin in PLUGINS:
        if not (qt_plugins / plugin).exists():
            print(f"bundle: without {plugin}, which is not here")
            continue
        (plugins / plugin).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(qt_plugins / plugin, plugins / plugin)
        sources.append(str(qt_plugins / plugin))
    for words in ("qtbase_ja.qm",):
        if (qt_words / words).exists():
            (libraries / "qt6/translations").mkdir(parents=True, exist_ok=True)
            shutil.copy2(qt_words / words, libraries / "qt6/translations" / words)
    wanted, left = {}, set()
    # A plugin is looked at in its own place, where the loader knows the libraries beside it.
    for root in programs + [pathlib.Path(s) for s in sources]:
        for name, place in needed(root).items():
            if stem(name) in SYSTEM:
                left.add(name)
            else:
                wanted[name] = place
    for name, place in sorted(wanted.items()):
        shutil.copy2(os.path.realpath(place), libraries / name)
    (tree / "bin/qt.conf").write_text("[Paths]\nPrefix = ../lib/handpiece/qt6\nPlugins = plugins\nTranslations = translations\n")
    notices = tree / "share/doc/handpiece/third-party"
    notices.mkdir(parents=True, exist_ok=True)
    packages = {}
    for name in sorted(set(packages_of([*wanted.values(), *sources]).values())):
        packages[name] = subprocess.run(["dpkg-query", "-W", "-f=${Version}\n", name], capture_output=True, text=True, check=True).stdout.split("\n")[0]
        shutil.copyfile(os.path.realpath(f"/usr/share/doc/{name}/copyright"), notices / f"{name}.copyright")
    lines = ["Libraries in lib/handpiece, from these packages of Debian 12, unchanged; each may be replaced by another build of it.",
             "Their licences are beside this file; their sources are at https://snapshot.debian.org under these versions.", ""]
    lines += [f"{name} {version}" for name, version in sorted(packages.items())]
    lines += ["", "Expected of the system:"] + sorted(left)
    (notices / "LIBRARIES.txt").write_text("\n".join(lines) + "\n")
    size = sum(f.stat().st_size for f in libraries.rglob("*") if f.is_file())
    print(f"bundle: {len(wanted)} libraries of {len(packages)} packages, {size / 1e6:.0f} MB; {len(left)} are left to the system")


if __name__ == "__main__":
    main()
