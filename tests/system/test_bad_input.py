# SPDX-License-Identifier: Apache-2.0
"""Whatever is wrong with the input: one clear line, exit code 1, nothing left behind."""

import json
import math
import os
import struct
import subprocess
import unittest

from support import HANDPIECE, SystemTest, ball, box, poses, run, write_stl


class BadInput(SystemTest):
    def setUp(self):
        super().setUp()
        self.tooth = write_stl(self.folder / "tooth.stl", box((-4, -4, -8), (4, 4, 4)))
        self.poses = self.folder / "poses.csv"
        self.poses.write_text(poses((0, 0, 4.5)))

    def probe_refused(self, tooth=None, bur="round-4", pose_file=None, out="-", **options):
        return self.refused("probe", "--tooth", tooth or self.tooth, "--bur", bur, "--poses", pose_file or self.poses,
                            "--out", out, "--no-cache", **options)

    def run_refused(self, *arguments, tooth=None, out=None, **options):
        return self.refused("run", "--tooth", tooth or self.tooth, "--bur", "round-4", "--no-cache", "--out",
                            out or self.folder / "result", *arguments, **options)

    def file(self, name, data):
        path = self.folder / name
        path.write_bytes(data)
        return path

    def test_files_that_are_not_meshes(self):
        good = self.tooth.read_bytes()
        nan = bytearray(good)
        struct.pack_into("<f", nan, 84 + 12, math.nan)
        for name, data, mentions in (
                ("empty.stl", b"", ["empty"]),
                ("truncated.stl", good[:-30], []),
                ("header.stl", good[:60], []),
                ("nan.stl", bytes(nan), ["finite"]),
                ("huge.stl", good[:80] + struct.pack("<I", 0xffffffff), []),
                ("random.stl", bytes(range(256)) * 20, []),
                ("text.stl", b"solid nothing\nfacet normal 0 0\n", []),
                ("word.ply", b"ply\nformat ascii 1.0\nelement vertex 999999999999\n", []),
                ("none.obj", b"v 0 0 0\nf 1 2 3\n", [])):
            with self.subTest(file=name):
                path = self.file(name, data)
                for arguments in (["mesh", "info", path], ["mesh", "repair", path, self.folder / "out.stl"]):
                    self.refused(*arguments, mentions=[name, *mentions])
                self.probe_refused(tooth=path, mentions=[name])
                self.probe_refused(bur=path, mentions=[name])

    def test_files_of_other_kinds_are_named(self):
        text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfcaet\n"
        for name, data, mentions in (
                ("page.stl", b"<!DOCTYPE html><html><body>404</body></html>", ["web page", "download"]),
                ("wide.stl", text.encode("utf-16"), ["UTF-16", "save it as"]),
                ("packed.stl", b"PK\x03\x04" + bytes(200), ["zip archive", "unpack"]),
                ("pointer.stl", b"version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 1\n", ["Git LFS", "pull"]),
                ("typed.stl", (text * 2).encode(), ['no "endfacet"', '"endfcaet"', "export"]),
                ("nothing.stl", b"", ["empty", "download"])):
            with self.subTest(file=name):
                path = self.file(name, data)
                self.refused("mesh", "info", path, mentions=[name, *mentions])
                self.probe_refused(tooth=path, mentions=[name, *mentions])
        spelled = text.replace("endfcaet", "end facet").replace("endloop", "end loop") + "end solid\n"
        self.assertIn("open edges", self.ok("mesh", "info", self.file("spelled.stl", spelled.encode())).stdout)

    def test_what_is_left_out_is_told_once_by_every_command(self):
        first = box((-4, -4, -8), (4, 4, 4))
        second = write_stl(self.folder / "second.stl", box((10, 0, 0), (12, 2, 2))).read_bytes()
        glued = self.file("glued.stl", write_stl(self.folder / "first.stl", first).read_bytes() + second)
        case, out = self.folder / "case", self.folder / "out"
        toml = 'format = 1\nouter = "glued.stl"\n[[part]]\nname = "all"\nfile = "glued.stl"\ntissue = "enamel"\n'
        case.mkdir()
        (case / "case.toml").write_text(toml)
        (case / "glued.stl").write_bytes(glued.read_bytes())
        for arguments in (["mesh", "info", glued], ["mesh", "info", glued, "--json"],
                          ["mesh", "repair", glued, self.folder / "mended.stl"],
                          ["mesh", "repair", glued, self.folder / "mended.stl", "--json"],
                          ["case", "new", "--out", self.folder / "new", "--part", f"enamel={glued}"],
                          ["case", "info", case, "--json"], ["case", "check", case],
                          ["probe", "--tooth", glued, "--bur", "round-4", "--poses", self.poses, "--voxel", "400"],
                          ["probe", "--tooth", case, "--bur", "round-4", "--poses", self.poses, "--voxel", "400"],
                          ["run", "--tooth", glued, "--bur", "round-4", "--voxel", "400", "--motion", "drop", "--duration",
                           "0.05", "--json", "--out", out],
                          ["picture", glued, "--size", "64x64", "--out", self.folder / "a.png"]):
            with self.subTest(" ".join(map(str, arguments[:2]))):
                done = run(*arguments)
                told = [line for line in done.stderr.splitlines() if "only the first of 2 STL files" in line]
                self.assertEqual(len(told), 1, f"{done.stdout}\n{done.stderr}")
                self.assertTrue(told[0].startswith("handpiece: note: "), told[0])
                self.assertIn("glued.stl", told[0])
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                if "--json" in arguments:
                    self.assertIn("{", done.stdout)
                    json.loads(done.stdout)
                else:
                    self.assertNotIn("only the first", done.stdout)
        bur = self.folder / "bur.stl"
        self.ok("make", "bur", "--name", "round-4", "--out", bur)
        bur.write_bytes(bur.read_bytes() + second)
        done = self.ok("probe", "--tooth", self.tooth, "--bur", bur, "--poses", self.poses, "--voxel", "400")
        self.assertEqual(done.stderr.count("only the first of 2 STL files"), 1, done.stderr)

    def test_names_that_are_no_text_work(self):
        folder = os.fsencode(self.folder)
        odd = os.path.join(folder, b"M\xfcller \x80")
        os.mkdir(odd)
        tooth = os.path.join(odd, b"z\xe4hne.stl")
        with open(tooth, "wb") as file:
            file.write(self.tooth.read_bytes())

        def work(*arguments):
            done = subprocess.run([HANDPIECE, *arguments], capture_output=True, timeout=600, check=False)
            self.assertEqual(done.returncode, 0, f"{arguments}\n{done.stdout}\n{done.stderr}")
            return done.stdout

        self.assertIn(b"a solid", work("mesh", "info", tooth))
        json.loads(work("mesh", "info", tooth, "--json"))
        work("mesh", "repair", tooth, os.path.join(odd, b"mended\xff.stl"))
        work("probe", "--tooth", tooth, "--bur", "round-4", "--poses", os.fsencode(self.poses), "--voxel", "400")
        case = os.path.join(odd, b"f\xe4lle")
        work("case", "new", "--out", case, "--part", b"enamel=" + tooth)
        self.assertIn(b"enamel", work("case", "info", case))
        json.loads(work("case", "info", case, "--json"))
        work("case", "pack", case, os.path.join(odd, b"f\xe4lle.handpiece"))
        work("case", "check", os.path.join(odd, b"f\xe4lle.handpiece"))

    def test_a_missing_file(self):
        for arguments in (["mesh", "info", "gone.stl"], ["mesh", "repair", "gone.stl", "out.stl"]):
            self.refused(*arguments, mentions=["gone.stl", "no such file"], cwd=self.folder)
        self.probe_refused(tooth="gone.stl", mentions=["gone.stl"])
        self.probe_refused(tooth=self.folder, mentions=["case.toml"])
        self.probe_refused(bur="gone.stl", mentions=["gone.stl"])
        self.probe_refused(pose_file="gone.csv", mentions=["gone.csv"])
        self.run_refused("--motion", "gone.csv", mentions=["gone.csv"])
        self.refused("reproduce", "--quick", "--tooth", "gone.stl", "--out", self.folder / "report",
                     mentions=["gone.stl"])

    def test_names_there_are_not(self):
        self.probe_refused(bur="banana", mentions=["banana", "round-4", "330"])
        self.refused("make", "bur", "--name", "banana", "--out", self.folder / "b.stl", mentions=["330"])
        self.refused("make", "bur", "--shape", "banana", "--out", self.folder / "b.stl", mentions=["inverted-cone"])
        self.refused("make", "tooth", "--kind", "banana", "--out", self.folder / "t", mentions=["upper-incisor"])
        self.run_refused("--motion", "banana", mentions=["banana", "drop"])
        self.run_refused("--method", "banana", mentions=["banana", "field", "hull"])
        self.run_refused("--device", "banana", mentions=["banana", "simulated"])
        self.run_refused("--device-model", "banana", mentions=["banana", "touch"])
        self.run_refused("--hand", "banana", mentions=["banana", "loose"])
        self.run_refused("--force", "banana", mentions=["banana", "penalty"])

    def test_sizes_that_make_no_sense(self):
        self.refused("make", "tooth", "--faces", "12", "--out", self.folder / "t", mentions=["12", "2000"])
        self.refused("make", "bur", "--shape", "pear", "--diameter", "-1", "--length", "2", "--out",
                     self.folder / "b.stl")
        self.refused("make", "bur", "--shape", "pear", "--out", self.folder / "b.stl")
        self.refused("make", "tooth", "--faces", "2000", "--part-faces", "99999999", "--out", self.folder / "t",
                     mentions=["--part-faces"])
        self.refused("make", "tooth", "--kind", "upper-incisor", "--faces", "2000", "--out", "", mentions=["folder"])
        self.refused("passivity", "--stiffness-limit", "-1", "--out", self.folder / "p", mentions=["--stiffness-limit"])
        self.refused("bench", "--faces", "5", mentions=["--faces", "2000"])
        for arguments in (["make", "mouth", "--faces", "99999999999"], ["make", "mouth", "--faces", "5"]):
            self.refused(*arguments, "--out", self.folder / "t", mentions=["--faces", "2000"])
        self.refused("make", "bur", "--out", self.folder / "b.stl", mentions=["--shape"])
        self.refused("make", "bur", "--name", "330", "--out", self.folder / "b.doc", mentions=["b.doc"])
        for arguments, word in ((["--rate", "0"], "--rate"), (["--rate", "-5"], "--rate"), (["--rate", "nan"], "--rate"),
                                (["--duration", "-1"], "--duration"), (["--voxel", "0"], "--voxel"),
                                (["--speed", "0"], "speed"), (["--depth", "nan"], "depth"), (["--load", "nan"], "depth"),
                                (["--delay", "-1"], "delay"), (["--stiffness", "-1"], "stiffness"),
                                (["--at", "500", "500"], "meets")):
            with self.subTest(arguments=arguments):
                self.run_refused(*arguments, mentions=[word])

    def test_negative_numbers_where_none_can_be(self):
        # -5 was read as 18446744073709551611.
        out = self.folder / "t"
        for option, arguments in (("--faces", ["make", "mouth", "--faces", "-5", "--out", out]),
                                  ("--seed", ["make", "tooth", "--seed", "-1", "--out", out]),
                                  ("--threads", ["scan", "case", self.tooth, "--threads", "-1", "--out", out]),
                                  ("--faces", ["scan", "case", self.tooth, "--faces", "-1", "--out", out])):
            with self.subTest(arguments=arguments):
                done = run(*arguments)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(option, done.stderr)
                self.assertIn("not 0 or more", done.stderr)
                self.assertFalse(out.exists())
        for option, arguments in (("--seed", ["make", "tooth", "--seed", "18446744073709551616", "--out", out]),
                                  ("--threads", ["make", "mouth", "--threads", "100000", "--out", out])):
            done = run(*arguments)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(option, done.stderr)
            self.assertFalse(out.exists())

    def test_names_of_a_file_do_not_reach_the_terminal_raw(self):
        case = self.folder / "case"
        case.mkdir()
        (case / "o.stl").write_bytes(self.tooth.read_bytes())
        text = 'format = 3\nname = "\\u001b[31mRED\\u0007"\nouter = "o.stl"\n[[part]]\nname = "enamel"\n'
        (case / "case.toml").write_text(text + 'file = "o.stl"\ntissue = "enamel"\n')
        told = self.ok("case", "info", case).stdout
        self.assertIn("?[31mRED?", told)
        self.assertNotIn("\x1b", told)
        (case / "case.toml").write_text(text + 'file = "o.stl\\u0000x"\ntissue = "enamel"\n')
        self.refused("case", "info", case, mentions=["o.stl?x", "is not a file inside the case's folder"])

    def test_surfaces_that_are_no_solid(self):
        facets = box((-4, -4, -8), (4, 4, 4))
        open_box = write_stl(self.folder / "open.stl", facets[:-1])
        for refuse in (self.probe_refused, self.run_refused):
            refuse(tooth=open_box, mentions=["open.stl", "open edges", "handpiece mesh repair"])
        flipped = write_stl(self.folder / "flipped.stl", facets[:-1] + [facets[-1][::-1]])
        self.probe_refused(tooth=flipped, mentions=["handpiece mesh repair"])
        crossing = write_stl(self.folder / "crossing.stl", facets + box((0, 0, -2), (7, 1, 2)))
        self.probe_refused(tooth=crossing, mentions=["crossing.stl"])

    def test_a_tooth_in_another_unit(self):
        metres = write_stl(self.folder / "metres.stl", box((0, 0, 0), (0.008, 0.008, 0.012)))
        self.probe_refused(tooth=metres, mentions=["metres.stl", " m"])
        microns = write_stl(self.folder / "microns.stl", box((0, 0, 0), (8000, 8000, 12000)))
        self.probe_refused(tooth=microns, mentions=["microns.stl", "um"])

    def test_burs_that_are_none(self):
        flat = write_stl(self.folder / "flat.stl", [((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((0, 0, 0), (0, 1, 0), (1, 0, 0))])
        self.probe_refused(bur=flat, mentions=["flat.stl"])
        square = write_stl(self.folder / "plank.stl", box((-2, -0.3, 0), (2, 0.3, 4)))
        self.probe_refused(bur=square, mentions=["plank.stl"])
        large = write_stl(self.folder / "large.stl", ball(400))
        self.probe_refused(bur=large, mentions=["large.stl"])

    def test_poses(self):
        for name, text, mentions in (
                ("nan", poses((0, 0, 5)) + "0,0,nan,1,0,0,0\n", ["line 3", "nan"]),
                ("inf", poses((0, 0, 5)) + "0,-inf,0,1,0,0,0\n", ["line 3", "inf"]),
                ("word", "x,y,z,qw,qx,qy,qz\n0,0,five,1,0,0,0\n", ["line 2", "five"]),
                ("short", "x,y,z,qw,qx,qy,qz\n0,0,5\n", ["line 2"]),
                ("quaternion", poses((0, 0, 5), (0, 0, 5, 1, 1, 0, 0)), ["line 3", "quaternion"]),
                ("zero", poses((0, 0, 5, 0, 0, 0, 0)), ["line 2", "quaternion"]),
                ("columns", "a,b,c\n1,2,3\n", ["x,y,z,qw,qx,qy,qz"]),
                ("header", "x,y,z,qw,qx,qy,qz\n", ["no line of numbers"]),
                ("empty", "", ["no line of numbers"])):
            with self.subTest(poses=name):
                path = self.folder / f"{name}.csv"
                path.write_text(text)
                self.probe_refused(pose_file=path, out=self.folder / "out.csv", mentions=[path.name, *mentions])
                self.probe_refused(pose_file="-", stdin=text, mentions=["standard input", *mentions])

    def test_motions(self):
        head = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n"
        for name, text, mentions in (
                ("jump", head + "0,0,0,5,1,0,0,0\n1,0,0,10005,1,0,0,0\n", ["line 3", "10000 mm"]),
                ("fast", head + "0,0,0,5,1,0,0,0\n0.0001,0,0,60,1,0,0,0\n", ["line 3"]),
                ("back", head + "0,0,0,5,1,0,0,0\n1,0,0,5,1,0,0,0\n0.5,0,0,5,1,0,0,0\n", ["line 4"]),
                ("before", head + "-1,0,0,5,1,0,0,0\n", ["line 2"]),
                ("nan", head + "0,0,0,nan,1,0,0,0\n", ["line 2", "nan"]),
                ("quaternion", head + "0,0,0,5,2,0,0,0\n", ["line 2", "quaternion"])):
            with self.subTest(motion=name):
                path = self.folder / f"{name}.csv"
                path.write_text(text)
                self.run_refused("--motion", path, mentions=[path.name, *mentions])

    def test_places_that_cannot_be_written(self):
        in_the_way = self.file("occupied", b"a file")
        self.run_refused(out=in_the_way, mentions=["occupied"])
        self.run_refused(out=in_the_way / "below", mentions=["occupied"])
        self.refused("make", "tooth", "--kind", "upper-incisor", "--faces", "2000", "--out", in_the_way,
                     mentions=["occupied"])
        self.refused("reproduce", "--quick", "--out", in_the_way, mentions=["occupied"])
        self.probe_refused(out=self.folder, mentions=[str(self.folder)])
        self.probe_refused(out="/nowhere/out.csv", mentions=["/nowhere/out.csv"])
        for arguments in (["bur", "--name", "330"], ["turbine"], ["plane"]):
            self.refused("make", *arguments, "--out", "/nowhere/x.stl", mentions=["/nowhere/x.stl"])
        if os.geteuid() != 0:
            locked = self.folder / "locked"
            locked.mkdir(mode=0o500)
            self.run_refused(out=locked / "result", mentions=["locked"])

    @unittest.skipUnless(os.path.exists("/dev/full"), "this machine has no /dev/full")
    def test_a_full_disk(self):
        self.poses.write_text(poses(*[(0, 0, 4.5 + 1e-3 * i) for i in range(500)]))
        self.probe_refused(out="/dev/full", mentions=["/dev/full", "No space left"])
        with open("/dev/full", "w", encoding="ascii") as full:
            import subprocess
            from support import HANDPIECE
            done = subprocess.run([HANDPIECE, "probe", "--tooth", self.tooth, "--bur", "round-4", "--poses",
                                   self.poses, "--no-cache"], stdout=full, stderr=subprocess.PIPE, text=True,
                                  check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("standard output", done.stderr)

    def test_tables_in_tables_without_end(self):
        case = self.folder / "case"
        case.mkdir()
        for text in ("a." * 250_000 + "a = 1\n", "[" + "a." * 250_000 + "a]\n", "x = " + "[" * 100_000 + "\n",
                     "\"a b\" ." * 70_000 + "c = 1\n"):
            (case / "case.toml").write_text("format = 1\n" + text)
            for arguments in (["case", "info", case], ["case", "check", case]):
                self.refused(*arguments, mentions=["case.toml", "line 2", "in one another"])
        (case / "case.toml").write_text("format = 1\n" + "# and so on\n" * 100_000)
        self.refused("case", "info", case, mentions=["case.toml", "bytes"])
        # Everything that is TOML is read alike.
        deep = self.file("deep.toml", b"a." * 250_000 + b"a = 1\n")
        self.run_refused("--motion", "plunge", "--tissues", deep, mentions=["deep.toml", "in one another"])
        self.run_refused("--motion", "plunge", "--abilities", deep, mentions=["deep.toml", "in one another"])
        self.refused("scan", "case", "--job", deep, "--out", self.folder / "made", mentions=["deep.toml", "in one another"])
        attempt = self.folder / "attempt"
        attempt.mkdir()
        (attempt / "attempt.toml").write_bytes(deep.read_bytes())
        self.refused("case", "pack", attempt, self.folder / "packed", mentions=["attempt.toml", "in one another"])
        (attempt / "attempt.toml").write_text("format = 1\n" + "# and so on\n" * 100_000)
        self.refused("case", "pack", attempt, self.folder / "packed", mentions=["attempt.toml", "bytes"])

    def test_what_is_no_plain_file(self):
        pipe = self.folder / "pipe.stl"
        os.mkfifo(pipe)
        for path in (pipe, "/dev/zero"):
            self.refused("mesh", "info", path, mentions=["not a plain file"])
            self.probe_refused(tooth=path, mentions=["not a plain file"])
            self.probe_refused(pose_file=path, mentions=["not a plain file"])
            self.refused("replay", path, mentions=["not a plain file"])
            self.run_refused("--motion", "plunge", "--tissues", path, mentions=["not a plain file"])
        os.mkfifo(self.folder / "pipe")
        (self.folder / "pipe.mtl").write_text("newmtl a\nmap_Kd pipe\n")
        painted = self.folder / "painted.obj"
        painted.write_text("mtllib pipe.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 1\nusemtl a\n"
                           "f 1/1 3/2 2/1\nf 1/1 2/1 4/2\nf 1/1 4/2 3/2\nf 2/1 3/2 4/2\n")
        done = self.ok("mesh", "info", painted)
        self.assertIn("not a plain file", done.stdout + done.stderr)
        case = self.folder / "case"
        case.mkdir()
        os.mkfifo(case / "case.toml")
        self.refused("case", "info", case, mentions=["not a plain file"])

    def test_an_attempt_that_names_a_device(self):
        case, done = self.folder / "case", self.folder / "done"
        self.ok("case", "new", "--part", f"enamel={self.tooth}", "--out", case)
        self.ok("run", "--case", case, "--bur", "330", "--voxel", "200", "--motion", "plunge", "--depth", "0.5", "--dwell", "0.1",
                "--no-cache", "--out", done)
        attempt = done / "attempt" / "attempt.toml"
        good = attempt.read_text()
        self.assertIn('case = "../../case"', good)
        up = "../" * 20
        for path, word in (("/dev/zero", "from where the attempt lies"), (up + "dev/zero", "not a plain file"),
                           (up + "etc/passwd", "mesh")):
            attempt.write_text(good.replace('case = "../../case"', f'case = "{path}"'))
            self.refused("case", "pack", done / "attempt", self.folder / "packed", mentions=[word])

    def test_a_case_that_is_broken(self):
        case = self.folder / "case"
        case.mkdir()
        (case / "case.toml").write_text("format = 1\nouter = \"../tooth.stl\"\n")
        self.probe_refused(tooth=case, mentions=["inside the case's folder"])
        (case / "case.toml").write_text("format = 1\nname = \"\n")
        self.probe_refused(tooth=case, mentions=["case.toml", "line 2"])


if __name__ == "__main__":
    unittest.main()
