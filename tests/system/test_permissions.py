# SPDX-License-Identifier: Apache-2.0
"""As an ordinary user, whom permissions stop: one clear line, exit code 1, nothing left behind. Root is asked for
nothing, so the program is run as nobody then."""

import hashlib
import os
import shutil
import unittest

from support import ORDINARY, SystemTest, poses, run


class Permissions(SystemTest):
    def setUp(self):
        super().setUp()
        self.ok("make", "tooth", "--kind", "upper-incisor", "--faces", "2000", "--out", self.folder / "tooth")
        self.ok("run", "--case", self.folder / "tooth", "--bur", "330", "--motion", "plunge", "--duration", "0.1",
                "--voxel", "200", "--out", self.folder / "cut")
        (self.folder / "poses.csv").write_text(poses((0, 0, 9)))
        self.session = self.folder / "cut" / "session.h5"
        self.assertTrue(self.session.exists(), os.listdir(self.folder / "cut"))
        if ORDINARY:
            for path in [self.folder, *self.folder.rglob("*")]:
                os.chown(path, ORDINARY["user"], ORDINARY["group"])
        try:
            ordinarily = run("--version", **ORDINARY)
        except PermissionError:
            # Of a folder above it: a clone in a folder of root's own, say.
            self.skipTest("nobody may run the program where it was built")
        self.assertEqual(ordinarily.returncode, 0, ordinarily.stderr)

    def listing(self):
        """What may be read, and the names of the rest."""
        found = {}
        for folder, _, names in os.walk(self.folder):
            if "cache" in os.path.relpath(folder, self.folder):
                continue
            found[folder] = None
            for name in names:
                path = os.path.join(folder, name)
                mode = os.stat(path).st_mode
                with open(path, "rb") if os.geteuid() == 0 or mode & 0o400 else open(os.devnull, "rb") as file:
                    found[path] = hashlib.sha256(file.read()).hexdigest()  # short: what differs is shown
        return found

    def barred(self, path, mode):
        """The folder or file, which only its owner could open again."""
        before = os.stat(path).st_mode & 0o777
        os.chmod(path, mode)
        self.addCleanup(os.chmod, path, before)
        return path

    def commands(self, out):
        """Every command that writes, writing below `out`."""
        tooth, bur = self.folder / "tooth", ["--bur", "330"]
        outer = tooth / "outer.stl"
        return {
            "make tooth": ["make", "tooth", "--kind", "upper-incisor", "--faces", "2000", "--out", out / "tooth"],
            "make bur": ["make", "bur", "--name", "330", "--out", out / "b.stl"],
            "make turbine": ["make", "turbine", "--out", out / "t.stl"],
            "make plane": ["make", "plane", "--out", out / "p.stl"],
            "make scan": ["make", "scan", "--voxel", "400", "--case", tooth, "--out", out / "slices"],
            "mesh repair": ["mesh", "repair", outer, out / "r.stl"],
            "case new": ["case", "new", "--out", out / "case", "--outer", outer, "--part", f"dentine={outer}"],
            "case pack": ["case", "pack", tooth, out / "tooth.handpiece"],
            "probe": ["probe", "--tooth", tooth, *bur, "--poses", self.folder / "poses.csv", "--voxel", "200", "--out",
                      out / "d.csv"],
            "run": ["run", "--tooth", tooth, *bur, "--duration", "0.05", "--voxel", "200", "--out", out / "run"],
            "export": ["export", self.session, "--csv", "--out", out / "s.csv"],
            "report": ["report", self.session, "--out", out / "r.html"],
            "picture": ["picture", tooth, "--out", out / "p.png"],
            "reproduce": ["reproduce", "--quick", "--out", out / "paper"],
            "passivity": ["passivity", "--out", out / "passivity"],
        }

    def refused_ordinarily(self, name, arguments, *mentions):
        with self.subTest(command=name):
            return self.refused(*arguments, mentions=mentions, **ORDINARY)

    def test_a_place_below_a_folder_one_may_not_enter(self):
        forbidden = self.folder / "forbidden"
        forbidden.mkdir(mode=0o755)
        (forbidden / "inner").mkdir()
        if ORDINARY:
            shutil.chown(forbidden, "nobody")
        self.barred(forbidden, 0o000)
        for place in (forbidden, forbidden / "inner"):
            for name, arguments in self.commands(place).items():
                self.refused_ordinarily(name, arguments, "forbidden", "Permission denied")

    def test_a_place_that_may_only_be_read(self):
        locked = self.folder / "locked"
        locked.mkdir()
        if ORDINARY:
            shutil.chown(locked, "nobody")
        self.barred(locked, 0o555)
        for name, arguments in self.commands(locked).items():
            self.refused_ordinarily(name, arguments, "locked", "Permission denied")

    def reading(self, tooth):
        out = self.folder / "out"
        return {
            "case info": ["case", "info", tooth],
            "case check": ["case", "check", tooth],
            "case pack": ["case", "pack", tooth, self.folder / "out.handpiece"],
            "probe": ["probe", "--tooth", tooth, "--bur", "330", "--poses", self.folder / "poses.csv", "--out",
                      self.folder / "out.csv"],
            "run": ["run", "--case", tooth, "--bur", "330", "--duration", "0.05", "--out", out],
            "picture": ["picture", tooth, "--out", self.folder / "out.png"],
            "make scan": ["make", "scan", "--case", tooth, "--out", out],
            "scan info": ["scan", "info", tooth],
        }

    def test_a_case_that_may_not_be_read(self):
        self.barred(self.folder / "tooth", 0o000)
        for name, arguments in self.reading(self.folder / "tooth").items():
            if name != "scan info":
                self.refused_ordinarily(name, arguments, "tooth", "Permission denied")
        self.refused_ordinarily("scan info", self.reading(self.folder / "tooth")["scan info"], "tooth")

    def test_files_of_a_case_that_may_not_be_read(self):
        for file in ("case.toml", "outer.stl"):
            path = self.folder / "tooth" / file
            os.chmod(path, 0o000)
            for name, arguments in self.reading(self.folder / "tooth").items():
                if name != "scan info":
                    self.refused_ordinarily(f"{name}: {file}", arguments, file, "Permission denied")
            os.chmod(path, 0o644)

    def test_a_session_that_may_not_be_read(self):
        for barred in (self.session, self.folder / "cut"):
            mode = os.stat(barred).st_mode & 0o777
            os.chmod(barred, 0o000)
            for command in (["replay"], ["export", "--csv"], ["report", "--out", self.folder / "r.html"],
                            ["picture", "--out", self.folder / "p.png"]):
                self.refused_ordinarily(command[0], [command[0], self.session, *command[1:]], "session.h5",
                                        "Permission denied")
            os.chmod(barred, mode)


if __name__ == "__main__":
    unittest.main()
