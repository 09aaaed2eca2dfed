# SPDX-License-Identifier: Apache-2.0
"""What is installed runs from any folder, and what goes with it is well formed. test_packaging.py BUILD SOURCE"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

BUILD, SOURCE = (pathlib.Path(p) for p in sys.argv[1:3])
PACKAGING = SOURCE / "packaging"


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-packaging-"))
        cls.log = subprocess.run(["cmake", "--install", BUILD, "--component", "handpiece", "--prefix", cls.folder / "first", "--strip"],
                                 capture_output=True, text=True, check=False)
        if cls.log.returncode == 0:
            (cls.folder / "first").rename(cls.folder / "moved")
        cls.tree = cls.folder / "moved"

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_runs_where_it_was_moved_to(self):
        self.assertEqual(self.log.returncode, 0, self.log.stderr)
        version = subprocess.run([self.tree / "bin/handpiece", "--version"], capture_output=True, text=True, check=False)
        self.assertEqual(version.returncode, 0, version.stderr)
        self.assertRegex(version.stdout, r"\d+\.\d+\.\d+")

    def test_has_all_that_it_needs_and_nothing_of_the_build(self):
        completion = (self.tree / "share/bash-completion/completions/handpiece").read_text()
        self.assertIn("complete", completion)
        for file in ("share/doc/handpiece/LICENSE", "share/doc/handpiece/devices.md", "share/handpiece/system/70-handpiece.rules",
                     "share/handpiece/system/handpiece.conf", "share/handpiece/system/settings.toml"):
            self.assertTrue((self.tree / file).is_file(), file)
        if (self.tree / "bin/handpiece-desktop").exists():
            for size in (48, 128, 256):
                picture = (self.tree / f"share/icons/hicolor/{size}x{size}/apps/handpiece.png").read_bytes()
                self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
                self.assertEqual(int.from_bytes(picture[16:20], "big"), size)
            self.assertTrue((self.tree / "share/icons/hicolor/scalable/apps/handpiece.svg").is_file())
        self.assertFalse(list(self.tree.rglob("*.a")) + list(self.tree.rglob("*.h")))
        for program in (self.tree / "bin").iterdir():
            paths = subprocess.run(["readelf", "-d", program], capture_output=True, text=True, check=True).stdout
            for path in re.findall(r"(?:RPATH|RUNPATH).*\[(.*)\]", paths):
                self.assertEqual(path, "$ORIGIN/../lib/handpiece")

    def test_programs_are_hardened_as_the_build_says(self):
        cache = (BUILD / "CMakeCache.txt").read_text()
        setting = lambda name: re.search(rf"^{name}:\w+=(.*)$", cache, re.M).group(1)
        if setting("HANDPIECE_SANITIZE"):
            self.skipTest("sanitizers watch more than that")
        for program in (self.tree / "bin").iterdir():
            read = lambda what: subprocess.run(["readelf", "-W", what, program], capture_output=True, text=True, check=True).stdout
            self.assertRegex(read("-h"), r"Type:\s+DYN", program)
            self.assertIn("GNU_RELRO", read("-l"), program)
            self.assertRegex(read("-d"), r"BIND_NOW|FLAGS_1.*\bNOW\b", program)
            if setting("CMAKE_BUILD_TYPE") == "Release":
                symbols = read("--dyn-syms")
                self.assertIn("__stack_chk_fail", symbols, program)
                self.assertRegex(symbols, r"__(mem|str|v?s?n?printf|read)\w*_chk", program)


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
        for script in ("postinst", "prerm", "postrm"):
            subprocess.run(["sh", "-n", PACKAGING / "school" / script], check=True)
            self.assertTrue(os.access(PACKAGING / "school" / script, os.X_OK), script)
        if shutil.which("systemd-analyze") and (BUILD / "bin/handpiece-school").exists():
            with tempfile.TemporaryDirectory() as folder:
                # As it is, with the program of the build and a user that this machine has.
                file = pathlib.Path(folder) / "handpiece-school.service"
                file.write_text(unit.replace("/usr/bin/handpiece-school", str(BUILD / "bin/handpiece-school")).replace("User=handpiece-school", "User=daemon")
                                .replace("Documentation=file:///usr/share/doc/handpiece-school/school-office.md", ""))
                result = subprocess.run(["systemd-analyze", "verify", "--man=no", file], capture_output=True, text=True, check=False)
                self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_scripts_and_descriptions_are_well_formed(self):
        for script in ("postinst", "prerm", "postrm"):
            subprocess.run(["sh", "-n", PACKAGING / "debian" / script], check=True)
            self.assertTrue(os.access(PACKAGING / "debian" / script, os.X_OK), script)
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
