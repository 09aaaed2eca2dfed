#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the architecture: a room includes only itself and the rooms of its USES line, and third-party headers stay in
the files named below. Reads the USES lines of the CMakeLists, so there is one table. Exit 1 with one line a breach."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SRC = ROOT / "src" / "handpiece"

# Where a third-party header may stand: pattern of the include -> pattern of the files (relative to the root).
THIRD_PARTY = {
    r"(lib)?qhull(_r|cpp)?/": r"src/handpiece/base/geometry/convex_hull\.cpp",
    r"tiny_obj_loader\.h": r"tests/.*",
    r"tbb/|oneapi/tbb": r"src/handpiece/base/core/parallel\.cpp",
    r"toml\+\+|toml\.hpp": r"src/handpiece/base/config/\w+\.cpp",
    r"zip\.h": r"src/handpiece/model/case/(large_)?package\.cpp|src/handpiece/scan/volume/files\.cpp|tests/.*",
    r"hdf5\.h|H5": r"src/handpiece/record/session/\w+\.cpp|src/handpiece/app/tables/tables_hdf5\.cpp|tests/app/(tables|sandboxed)/.*",
    r"zlib\.h": r"src/handpiece/base/prepared/packed_bytes\.cpp|src/handpiece/record/history/\w+\.cpp|src/handpiece/model/tooth/state_file\.cpp|src/handpiece/scan/volume/(nifti|samples|write_scan)\.cpp|src/handpiece/app/report/review_data\.cpp|tests/.*",
    r"sqlite3\.h": r"src/handpiece/school/store/\w+\.cpp|tests/school/.*",
    r"libpq-fe\.h": r"src/handpiece/school/store/database_postgres\.cpp|tests/school/.*",
    r"sodium\.h": r"src/handpiece/base/prepared/prepared_files\.cpp|src/handpiece/school/(store/content_files|people/secret|exam/(seal|signing))\.cpp",
    r"openssl/": r"apps/school/jwt\.cpp",
    r"CLI/|CLI11": r"apps/cli/(app|command)\.cpp",
    r"pybind11/|Python\.h": r"apps/python/.*",
    r"httplib\.h": r"apps/school/(http\.h|\w+\.cpp)|tests/school/.*",
    r"nlohmann/": r"apps/(cli|studies|school|python)/.*|src/handpiece/app/\w+/\w+\.cpp|src/handpiece/base/config/outside_json\.cpp|bench/.*|tests/(app|school)/.*|tests/base/config/outside_json_test\.cpp",
    r"gtest/|gmock/|rapidcheck|mpfr\.h": r"tests/.*",
    r"benchmark/": r"bench/.*",
    r"ccd/|fcl/": r"tests/.*|bench/.*",
    r"btBullet|BulletCollision|LinearMath/|ode/|embree3/|openvdb/": r"bench/.*",
    r"EGL/|GL/": r"src/handpiece/senses/view/(\w+\.cpp|gl\.h)",
    r"png\.h": r"src/handpiece/senses/view/image\.cpp|src/handpiece/scan/volume/picture_png\.cpp",
    r"jpeglib\.h": r"src/handpiece/scan/volume/picture_jpeg\.cpp|tests/.*",
    r"tiffio\.h": r"src/handpiece/scan/volume/picture_tiff\.cpp|tests/.*",
    r"gdcm": r"src/handpiece/scan/volume/dicom_\w+\.(cpp|h)|tests/.*",
    r"nifti": r"tests/.*",
    r"sndfile\.h": r"src/handpiece/senses/sound/wav\.cpp",
    r"AL/": r"src/handpiece/senses/sound/\w+\.cpp",
    r"dbus/": r"src/handpiece/base/rt/realtime_kit\.cpp|tests/.*",
    r"boost/": r"src/handpiece/devices/drivers/\w+\.cpp|tests/devices/.*",
    r"Q[A-Z]\w+$|QtWidgets/|QtCore/|QtTest/": r"(apps|tests)/desktop/.*",
}
# The window's folders: whom each includes beside itself. A feature includes these and no other feature, unless a line
# here says so: ("features/result", "features/exercise").
DESKTOP = {
    "widgets": set(),
    "picture": {"widgets"},
    "framework": {"widgets", "picture"},
    "work": {"framework"},
    "features": {"widgets", "picture", "framework", "work"},
    "program": {"widgets", "picture", "framework", "work", "features"},
}
BETWEEN_FEATURES = set()
# The applications stand beside each other.
APPS = {"cli": {"studies"}, "studies": set(), "desktop": set(), "school": {"cli", "studies"}, "python": {"studies"}}
# What the tick's own rooms never include: anything that locks, waits, prints or touches a file. The device drivers and
# the loop's runner may talk to base/rt, which hides the threads.
TICK_FORBIDDEN = re.compile(r"<(mutex|shared_mutex|condition_variable|future|thread|iostream|fstream|sstream|filesystem|regex|unistd\.h|pthread\.h|stdio\.h)>")
# Files of the tick's wing that run beside it, not in it: the runner that starts the thread and feeds a listener.
OFF_TICK = {"src/handpiece/tick/loop/loop_run.cpp"}
POSIX = re.compile(r"<(pthread\.h|sched\.h|unistd\.h|time\.h|sys/[a-z]+\.h|dlfcn\.h|spawn\.h)>")
POSIX_ALLOWED = re.compile(r"src/handpiece/base/rt/.*\.cpp|src/handpiece/base/core/file\.cpp|src/handpiece/devices/(link|drivers)/\w+\.cpp|src/handpiece/base/sandbox/\w+\.cpp|apps/.*|tests/.*|bench/.*")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"][^>"]+[>"])', re.MULTILINE)


def rooms():
    uses = {}
    for path in SRC.glob("*/*/CMakeLists.txt"):
        text = path.read_text()
        name = re.search(r"handpiece_room\((\S+)", text).group(1)
        line = re.search(r"USES((?:\s+[a-z_]+)*)\s*(?:THIRD_PARTY|\))", text)
        uses[name] = set(line.group(1).split()) if line else set()
    return uses


def cycle(uses):
    by_room = {name.split("/")[1]: deps for name, deps in uses.items()}
    state = {}

    def visit(room, trail):
        if state.get(room) == 2:
            return None
        if state.get(room) == 1:
            return trail + [room]
        state[room] = 1
        for dep in sorted(by_room.get(room, ())):
            found = visit(dep, trail + [room])
            if found:
                return found
        state[room] = 2
        return None

    for room in sorted(by_room):
        found = visit(room, [])
        if found:
            return found
    return None


def app_breach(rel, name):
    """Why this file of an application (relative to the root) may not include this; None where it may."""
    own, target = re.match(r"apps/(\w+)/(.*)", rel), re.match(r"(cli|desktop|python|studies|school)/(.*)", name)
    if not own or not target:
        return None
    app, other = own.group(1), target.group(1)
    if app != other:
        return None if other in APPS[app] else f"{rel}: apps/{app} includes {name}"
    if app != "desktop":
        return None
    mine, theirs = own.group(2).split("/"), target.group(2).split("/")
    if mine[0] != theirs[0]:
        return None if theirs[0] in DESKTOP[mine[0]] else f"{rel}: {mine[0]} includes {name}"
    if mine[0] == "features" and len(mine) > 2 and mine[:2] != theirs[:2] and ("/".join(mine[:2]), "/".join(theirs[:2])) not in BETWEEN_FEATURES:
        return f"{rel}: a feature includes another ({name})"
    return None


def self_test():
    """What must be found, and what must not: a check that finds nothing looks like one that passes."""
    wrong = [("desktop/framework/docks.cpp", "desktop/features/sound/sound_control.h"), ("desktop/features/sound/a.cpp", "desktop/features/view/view_bar.h"),
             ("desktop/features/sound/a.cpp", "desktop/program/host.h"), ("desktop/widgets/theme.cpp", "desktop/framework/job.h"),
             ("desktop/work/simulator.cpp", "desktop/features/features.h"), ("cli/cli.cpp", "desktop/framework/job.h"),
             ("desktop/program/host.cpp", "cli/inputs.h"), ("studies/csv.cpp", "cli/inputs.h"), ("python/run.cpp", "cli/inputs.h"), ("studies/csv.cpp", "python/bind.h"), ("studies/csv.cpp", "desktop/framework/job.h")]
    right = [("desktop/features/sound/a.cpp", "desktop/features/sound/b.h"), ("desktop/features/features.cpp", "desktop/features/sound/b.h"),
             ("desktop/features/sound/a.cpp", "desktop/work/simulator.h"), ("desktop/program/host.cpp", "desktop/features/features.h"),
             ("cli/cli.cpp", "studies/csv.h"), ("cli/cli.cpp", "handpiece/base/core/error.h")]
    missed = [f"{rel} -> {name}" for rel, name in wrong if not app_breach("apps/" + rel, name)]
    return [f"self-test: not found: {line}" for line in missed] + [f"self-test: {app_breach('apps/' + rel, name)}" for rel, name in right if app_breach("apps/" + rel, name)]


def main():
    uses = rooms()
    breaches = self_test()
    loop = cycle(uses)
    if loop:
        breaches.append("rooms use each other in a circle: " + " -> ".join(loop))
    files = [p for folder in ("src", "apps", "tests", "bench", "examples") for p in (ROOT / folder).rglob("*") if p.suffix in (".h", ".cpp")]
    for path in sorted(files):
        rel = path.relative_to(ROOT).as_posix()
        for include in INCLUDE.findall(path.read_text(errors="replace")):
            name = include[1:-1]
            own = re.match(r"src/handpiece/(\w+/\w+)/", rel)
            target = re.match(r"handpiece/(\w+)/(\w+)/", name)
            if own and target:
                mine = own.group(1)
                if target.group(0)[10:-1] != mine and target.group(2) not in uses.get(mine, set()):
                    breaches.append(f"{rel}: includes {name}, but {mine} does not use '{target.group(2)}'")
            if breach := app_breach(rel, name):
                breaches.append(breach)
            if own and re.match(r"(cli|desktop|python|studies)/", name):
                breaches.append(f"{rel}: a room includes an application ({name})")
            if own and own.group(1).startswith("tick/") and rel not in OFF_TICK and TICK_FORBIDDEN.fullmatch(include):
                breaches.append(f"{rel}: the tick includes {include}")
            if POSIX.fullmatch(include) and not POSIX_ALLOWED.fullmatch(rel):
                breaches.append(f"{rel}: {include} belongs behind an interface of base/rt or a driver")
            for pattern, allowed in THIRD_PARTY.items():
                if include[0] == "<" and re.match(pattern, name) and not re.fullmatch(allowed, rel):
                    breaches.append(f"{rel}: <{name}> may stand only in {allowed}")
    for line in breaches:
        print(line)
    print(f"include check: {len(files)} files, {len(uses)} rooms, {len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
