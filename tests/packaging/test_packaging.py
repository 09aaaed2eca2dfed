# SPDX-License-Identifier: Apache-2.0
"""What is installed runs from any folder, every file of it is of one package, each command has its page, and debian/ is
whole. test_packaging.py BUILD SOURCE"""

import fnmatch
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

BUILD, SOURCE = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
PACKAGING, DEBIAN = SOURCE / "packaging", SOURCE / "debian"
CACHE = dict(re.findall(r"^([\w-]+):\w+=(.*)$", (BUILD / "CMakeCache.txt").read_text(), re.M))

# What each of CMake's components may hold, its package, and how many megabytes it may be, stripped.
PAGES = "share/man/man1"
COMPLETION = ["share/bash-completion/completions/{}", "share/zsh/vendor-completions/_{}", "share/fish/vendor_completions.d/{}.fish"]
COMPONENTS = {
    "handpiece": ("handpiece", 40, ["bin/handpiece", "libexec/handpiece/handpiece-sandbox", PAGES + "/handpiece*.1", *(c.format("handpiece") for c in COMPLETION)]),
    "desktop": ("handpiece-desktop", 40,
                ["bin/handpiece-desktop", PAGES + "/handpiece-desktop.1", "share/applications/handpiece-desktop.desktop",
                 "share/icons/hicolor/*/apps/handpiece.*", "share/metainfo/*.xml", "share/mime/packages/handpiece.xml"]),
    "school": ("handpiece-school", 40, ["bin/handpiece-school", PAGES + "/handpiece-school*.1", PAGES + "/handpiece-serve.1",
                                        *(c.format("handpiece-school") for c in COMPLETION)]),
    "dev": ("libhandpiece-dev", 400, ["include/handpiece/*.h", "lib/*libhandpiece_*.a", "lib/*cmake/handpiece/*.cmake"]),
    "python": ("python3-handpiece", 20, ["lib/python3/dist-packages/handpiece/*", "share/doc/python3-handpiece/examples/*.py"]),
    "doc": ("handpiece-doc", 40, ["share/doc/handpiece-doc/*"]),
    "archive": (None, 1, ["share/doc/handpiece/*", "share/handpiece/system/*"]),
}
IS_PREPARED = CACHE.get("HANDPIECE_PREPARED") == "ON"
if IS_PREPARED:
    # The first teeth, ready made: at most 100 MB more.
    package, megabytes, patterns = COMPONENTS["desktop"]
    COMPONENTS["desktop"] = (package, megabytes + 100, [*patterns, "share/handpiece/prepared/*.packed-*"])
OPTIONAL = {"desktop": "HANDPIECE_BUILD_DESKTOP", "school": "HANDPIECE_BUILD_SCHOOL", "python": "HANDPIECE_BUILD_PYTHON"}


def is_built(component):
    return component not in OPTIONAL or CACHE.get(OPTIONAL[component]) == "ON"


def said(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, check=True, **more).stdout


def files(tree):
    return {p.relative_to(tree).as_posix() for p in tree.rglob("*") if not p.is_dir()}


def stanzas(path):
    """Fields of each paragraph of a control file; continued lines joined, comments left out."""
    text = re.sub(r"^#.*\n", "", path.read_text(), flags=re.M)
    return [dict(re.findall(r"^([\w-]+):[ \t]*(.*(?:\n[ \t].*)*)", part, re.M)) for part in re.split(r"\n\s*\n", text) if part.strip()]


def packages_in(field):
    return [re.match(r"\S+", alternative.strip()).group().split(":")[0]
            for entry in field.split(",") if entry.strip() for alternative in entry.split("|")[:1]]


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-packaging-"))
        cls.trees = {}
        for name in ["all", *filter(is_built, COMPONENTS)]:
            cls.trees[name] = cls.folder / name
            part = [] if name == "all" else ["--component", name]
            subprocess.run(["cmake", "--install", BUILD, *part, "--prefix", cls.trees[name], "--strip"], stdout=subprocess.DEVNULL, check=True)
        cls.programs = sorted(p for name in cls.trees if name != "all" for p in (cls.trees[name] / "bin").glob("*"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_every_file_is_of_one_component_and_where_it_belongs(self):
        owner = {}
        for name, tree in self.trees.items():
            if name == "all":
                continue
            patterns = COMPONENTS[name][2]
            found = files(tree)
            for file in sorted(found):
                self.assertNotIn(file, owner, f"{file}: of {name} and of {owner.get(file)}")
                owner[file] = name
                self.assertTrue(any(fnmatch.fnmatchcase(file, p) for p in patterns), f"{file} has no business in {name}")
            for pattern in patterns:
                self.assertTrue(fnmatch.filter(found, pattern), f"{name} lacks {pattern}")
        self.assertEqual(files(self.trees["all"]) - set(owner), set(), "installed, but of no package")

    def test_sizes(self):
        for name, tree in self.trees.items():
            if name != "all":
                size = sum(p.stat().st_size for p in tree.rglob("*") if p.is_file()) / 1e6
                print(f"{name} {size:.1f} MB")
                self.assertLess(size, COMPONENTS[name][1], name)

    def test_runs_where_it_was_moved_to(self):
        for program in self.programs:
            moved = program.rename(program.with_name("moved-" + program.name))
            version = said(moved, "--version", env={**os.environ, "QT_QPA_PLATFORM": "offscreen"})
            self.assertRegex(version, r"\d+\.\d+\.\d+")
            moved.rename(program)

    def test_what_is_prepared_is_what_the_window_believes(self):
        if not IS_PREPARED:
            self.skipTest("built without (HANDPIECE_PREPARED)")
        folder = self.trees["desktop"] / "share/handpiece/prepared"
        program = (self.trees["desktop"] / "bin/handpiece-desktop").read_bytes()
        kinds = set()
        for file in folder.iterdir():
            kinds.add(file.suffix)
            self.assertIn(file.name.encode(), program, file.name)
            self.assertIn(hashlib.sha256(file.read_bytes()).hexdigest().encode(), program, file.name)
        self.assertEqual(kinds, {".packed-case", ".packed-field", ".packed-tissues"})
        self.assertTrue(list(folder.glob("mouth-*.packed-case")) and list(folder.glob("tooth-*-46-*.packed-case")))

    def test_icons(self):
        if "desktop" not in self.trees:
            self.skipTest("without the window")
        for size in (48, 128, 256):
            picture = (self.trees["desktop"] / f"share/icons/hicolor/{size}x{size}/apps/handpiece.png").read_bytes()
            self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(int.from_bytes(picture[16:20], "big"), size)

    def test_programs_look_for_libraries_where_the_archive_has_them_and_nowhere_of_the_build(self):
        for program in self.programs:
            paths = re.findall(r"(?:RPATH|RUNPATH).*\[(.*)\]", said("readelf", "-d", program))
            self.assertLessEqual(set(paths), {"$ORIGIN/../lib/handpiece"}, program)
        for file in (self.trees["dev"]).rglob("*.cmake"):
            self.assertNotIn(str(SOURCE), file.read_text(), file)

    def test_programs_are_hardened_as_the_build_says(self):
        if CACHE["HANDPIECE_SANITIZE"]:
            self.skipTest("sanitizers watch more than that")
        for program in self.programs:
            read = lambda what: said("readelf", "-W", what, program)
            self.assertRegex(read("-h"), r"Type:\s+DYN", program)
            self.assertIn("GNU_RELRO", read("-l"), program)
            self.assertRegex(read("-d"), r"BIND_NOW|FLAGS_1.*\bNOW\b", program)
            if CACHE["CMAKE_BUILD_TYPE"] == "Release":
                symbols = read("--dyn-syms")
                self.assertIn("__stack_chk_fail", symbols, program)
                self.assertRegex(symbols, r"__(mem|str|v?s?n?printf|read)\w*_chk", program)


class Pages(unittest.TestCase):
    """Found by asking --help, not by what wrote the pages."""

    @staticmethod
    def words(program, path, heading):
        text = said(BUILD / "bin" / program, *path, "--help")
        part = re.search(rf"^{heading}:\n((?:  .*\n)+)", text, re.M)
        return re.findall(r"^  ([a-z]\S*)", part.group(1), re.M) if part else []

    def commands(self, program, path=()):
        yield path
        for word in self.words(program, path, "Subcommands"):
            yield from self.commands(program, (*path, word))

    def test_each_command_has_its_page_which_tells_every_option_and_is_not_stale(self):
        for program in ("handpiece", "handpiece-school"):
            if not (BUILD / "bin" / program).exists():
                continue
            folder = BUILD / "pages" / program / "man1"
            paths = list(self.commands(program))
            self.assertGreater(len(paths), 20)
            self.assertEqual({"-".join((program, *path)) + ".1" for path in paths}, {p.name for p in folder.glob("*.1")})
            for path in paths:
                page = (folder / ("-".join((program, *path)) + ".1")).read_text()
                plain = re.sub(r"\\f[BIR]", "", page).replace("\\-", "-")
                for option in re.findall(r"^  (?:-\w, )?(--[a-z][\w-]*)", said(BUILD / "bin" / program, *path, "--help"), re.M):
                    self.assertRegex(plain, rf"(?m)^(-\w, )?{option}\b|^--\S+, {option}\b", f"{program} {path}")
            with tempfile.TemporaryDirectory() as again:
                said(BUILD / "bin" / program, "manual", again)
                for page in pathlib.Path(again).iterdir():
                    self.assertEqual(page.read_text(), (folder / page.name).read_text(), f"{page.name} is stale: build {program}_pages")

    def test_the_windows_page_tells_its_options(self):
        if not is_built("desktop"):
            self.skipTest("without the window")
        told = re.findall(r"(--[a-z-]+)", said(BUILD / "bin/handpiece-desktop", "--help"))
        page = (BUILD / "pages/handpiece-desktop.1").read_text().replace("\\-", "-")
        self.assertEqual(set(told), set(re.findall(r"\\fB(--[a-z-]+)\\fR", page)))

    def test_pages_are_set_without_a_warning(self):
        if not shutil.which("man"):
            self.skipTest("no man")
        for page in sorted((BUILD / "pages").rglob("*.1")):
            shown = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", page], capture_output=True, text=True, check=False,
                                   env={**os.environ, "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "MANWIDTH": "80"})
            self.assertEqual((shown.returncode, shown.stderr), (0, ""), page)

    def test_completion_in_each_shell(self):
        script = lambda shell: BUILD / "pages/handpiece" / shell
        asked = (("handpiece make to", "tooth"), ("handpiece score work.h5 --rub", "--rubric"), ("handpiece mesh repair --we", "--weld"))
        for line, wanted in asked:
            words = line.split()
            ask = (f"source {script('bash')}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _handpiece; echo ${{COMPREPLY[@]}}")
            self.assertEqual(said("bash", "-c", ask).split(), [wanted])
            if shutil.which("fish"):
                ask = f"source {script('fish')}; complete -C '{line}'"
                self.assertEqual([a.split("\t")[0] for a in said("fish", "--no-config", "-c", ask).splitlines()], [wanted])
            if shutil.which("zsh"):
                # What the function hands on is looked at: a terminal is needed for more.
                ask = (f"_describe() {{ local list=$4; for entry in ${{(P)list}}; do echo ${{entry%%:*}}; done }}; _files() {{ : }}; compdef() {{ : }};"
                       f"source {script('zsh')}; words=({line}); CURRENT={len(words)}; PREFIX={words[-1]}; _handpiece")
                self.assertIn(wanted, said("zsh", "-f", "-c", ask).split())


class Debian(unittest.TestCase):
    def test_each_component_has_its_package(self):
        described = {s["Package"]: s for s in stanzas(DEBIAN / "control") if "Package" in s}
        self.assertEqual({c[0] for c in COMPONENTS.values() if c[0]}, set(described))
        rules = (DEBIAN / "rules").read_text()
        self.assertEqual({(p, c) for p, c in re.findall(r"^part_(\S+) = (\S+)$", rules, re.M)},
                         {(c[0], name) for name, c in COMPONENTS.items() if c[0]})
        for name, package in described.items():
            lines = package["Description"].splitlines()
            self.assertLessEqual(len(lines[0]), 80, name)
            self.assertLessEqual(max(map(len, lines)), 80, name)

    def test_what_is_built_with_is_what_tools_install(self):
        listed = set(re.sub(r"^\w+:", "", (SOURCE / "tools/packages.txt").read_text(), flags=re.M).split())
        for field in ("Build-Depends", "Build-Depends-Indep"):
            for name in packages_in(stanzas(DEBIAN / "control")[0].get(field, "")):
                if not re.match(r"debhelper-compat|dh-sequence-", name):
                    self.assertIn(name, listed, field)

    def test_version_is_the_programs(self):
        version = re.match(r"handpiece \(([^)+]+)", (DEBIAN / "changelog").read_text()).group(1)
        self.assertEqual(version, CACHE["CMAKE_PROJECT_VERSION"])

    def test_what_copyright_and_lists_name_is_there(self):
        for stanza in stanzas(DEBIAN / "copyright"):
            for pattern in stanza.get("Files", "").split():
                self.assertTrue(next(SOURCE.glob(pattern), None), pattern)
        for listing in DEBIAN.glob("*.install"):
            for line in listing.read_text().splitlines():
                self.assertTrue(next(SOURCE.glob(line.split()[0]), None), line)

    def test_scripts_are_well_formed(self):
        asked = re.findall(r"^Tests: (.*)$", (DEBIAN / "tests/control").read_text(), re.M)
        for script in [*(DEBIAN / "tests" / name for name in asked), *DEBIAN.glob("*.p*inst"), *DEBIAN.glob("*.p*rm")]:
            subprocess.run(["sh", "-n", script], check=True)
        for name in asked:
            self.assertTrue(os.access(DEBIAN / "tests" / name, os.X_OK), name)


class Files(unittest.TestCase):
    def test_rules_open_devices_to_who_sits_there_and_to_nobody_else(self):
        text = (PACKAGING / "udev/70-handpiece.rules").read_text()
        rules = [line for line in text.splitlines() if line and not line.startswith("#")]
        self.assertGreater(len(rules), 8)
        for rule in rules:
            for part in re.split(r",\s*", rule):
                self.assertRegex(part, r'^(ACTION|SUBSYSTEM|KERNEL|ENV\{\w+\}|ATTRS?\{\w+\}|TAG|GOTO|LABEL)(==|\+=|=)"[^"]+"$')
        self.assertNotIn("MODE", "".join(rules))
        for vendor in re.findall(r'idVendor\}=="(\w+)"', "".join(rules)):
            self.assertRegex(vendor, r"^[0-9a-f]{4}$")

    def test_limits_are_for_the_group_alone(self):
        lines = [line.split() for line in (PACKAGING / "limits.d/handpiece.conf").read_text().splitlines() if line and line[0] != "#"]
        self.assertEqual(lines, [["@handpiece", "-", "rtprio", "95"], ["@handpiece", "-", "memlock", "unlimited"]])

    def test_a_schools_server_runs_with_no_rights_but_its_folder(self):
        unit = (PACKAGING / "school/handpiece-school.service").read_text()
        for line in ("Type=notify", "User=handpiece-school", "StateDirectory=handpiece-school", "ProtectSystem=strict", "NoNewPrivileges=yes",
                     "CapabilityBoundingSet=", "PrivateDevices=yes", "ProtectHome=yes"):
            self.assertIn("\n" + line + "\n", unit)
        if shutil.which("systemd-analyze") and (BUILD / "bin/handpiece-school").exists():
            with tempfile.TemporaryDirectory() as folder:
                # As it is, with the program of the build and a user that this machine has.
                file = pathlib.Path(folder) / "handpiece-school.service"
                file.write_text(unit.replace("/usr/bin/handpiece-school", str(BUILD / "bin/handpiece-school")).replace("User=handpiece-school", "User=daemon"))
                result = subprocess.run(["systemd-analyze", "verify", "--man=no", file], capture_output=True, text=True, check=False)
                self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_descriptions_are_well_formed(self):
        for file in (PACKAGING / "desktop").glob("*.xml"):
            xml.etree.ElementTree.parse(file)
        desktop, metainfo = PACKAGING / "desktop/handpiece-desktop.desktop", PACKAGING / "desktop/org.handpiece.Handpiece.metainfo.xml"
        if shutil.which("desktop-file-validate"):
            result = subprocess.run(["desktop-file-validate", desktop], capture_output=True, text=True, check=False)
            self.assertEqual((result.returncode, result.stdout), (0, ""))
        if shutil.which("appstreamcli"):
            result = subprocess.run(["appstreamcli", "validate", "--no-net", metainfo], capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, 0, result.stdout)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
