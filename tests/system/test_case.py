# SPDX-License-Identifier: Apache-2.0
"""Cases: looked into, checked, made, packed."""

import json
import re
import unittest
import zipfile

from support import SystemTest, ball, box, vertex_colours, write_coloured_ply, write_stl


class Case(SystemTest):
    def parts(self):
        write_stl(self.folder / "outer.stl", box((-4, -4, -8), (4, 4, 6)))
        write_stl(self.folder / "enamel.stl", box((-4, -4, 2), (4, 4, 6)))
        write_stl(self.folder / "dentine.stl", box((-4, -4, -8), (4, 4, 2)))
        write_stl(self.folder / "caries.stl", box((-1, -1, 1), (1, 1, 5)))

    def new(self, out, *more):
        f = self.folder
        return ["case", "new", "--out", f / out, "--outer", f / "outer.stl", "--part", f"enamel={f}/enamel.stl",
                "--part", f"dentine={f}/dentine.stl", *more]

    def test_new_info_check_pack(self):
        self.parts()
        self.ok(*self.new("molar", "--part", f"caries:70={self.folder}/caries.stl", "--fdi", "46", "--buccal", "-y"))
        info = json.loads(self.ok("case", "info", self.folder / "molar", "--json").stdout)
        self.assertEqual(info["name"], "molar")
        self.assertEqual(info["fdi"], 46)
        self.assertEqual([(p["tissue"], p["priority"]) for p in info["parts"]],
                         [("enamel", 10), ("dentine", 20), ("caries", 70)])
        self.assertAlmostEqual(info["outer"]["volume_mm3"], 8 * 8 * 14)
        self.assertEqual(info["tissues"]["dentine"]["colour"], "#e2c78c")
        self.assertIn("caries", self.ok("case", "info", self.folder / "molar").stdout)
        self.assertIn("can be felt and cut", self.ok("case", "check", self.folder / "molar").stdout)
        self.ok("case", "pack", self.folder / "molar", self.folder / "m.handpiece")
        packed = json.loads(self.ok("case", "info", self.folder / "m.handpiece", "--json").stdout)
        self.assertEqual(packed["content_key"], info["content_key"])
        self.assertIn("case.toml", zipfile.ZipFile(self.folder / "m.handpiece").namelist())
        self.ok("case", "pack", self.folder / "m.handpiece", self.folder / "again")
        self.assertEqual((self.folder / "again" / "outer.stl").read_bytes(),
                         (self.folder / "molar" / "outer.stl").read_bytes())

    def test_a_scan_in_colour_stays_so(self):
        def halves(place):
            return (190, 30, 30) if place[0] < 0 else (30, 170, 40)

        scan = write_coloured_ply(self.folder / "scan.ply", ball(4, 12), halves)
        made = self.ok("case", "new", "--out", self.folder / "c", "--part", f"enamel={scan}", "--scenery", f"gum={scan}")
        self.assertIn("with the scan's colours", made.stdout)
        self.assertIn("with the scan's colours", self.ok("case", "info", self.folder / "c").stdout)
        info = json.loads(self.ok("case", "info", self.folder / "c", "--json").stdout)
        self.assertTrue(info["outer"]["colours"])
        self.assertTrue(info["scenery"][0]["colours"])
        self.assertFalse(info["parts"][0]["colours"], "what lies within is not seen")
        colours = vertex_colours(self.folder / "c" / "outer.ply")
        self.assertTrue(colours)
        self.assertEqual(colours, {place: halves(place) for place in colours})
        self.ok("case", "pack", self.folder / "c", self.folder / "c.handpiece")
        self.ok("case", "pack", self.folder / "c.handpiece", self.folder / "again")
        self.assertEqual((self.folder / "again" / "outer.ply").read_bytes(),
                         (self.folder / "c" / "outer.ply").read_bytes())
        plain = write_stl(self.folder / "plain.stl", ball(4, 12))
        self.ok("case", "new", "--out", self.folder / "p", "--part", f"enamel={plain}")
        other = json.loads(self.ok("case", "info", self.folder / "p", "--json").stdout)
        self.assertFalse(other["outer"]["colours"])
        self.assertEqual(other["content_key"], info["content_key"], "the colours make no other tooth")
        broken = self.folder / "c" / "outer.ply"
        broken.write_bytes(broken.read_bytes()[:-20])
        self.refused("case", "info", self.folder / "c", mentions=["outer.ply", "ends"])

    def test_what_is_wrong_is_told_and_nothing_written(self):
        self.parts()
        write_stl(self.folder / "far.stl", box((-1, -1, 1), (1, 1, 6.5)))
        self.refused(*self.new("x", "--part", f"caries={self.folder}/far.stl"),
                     mentions=["caries", "sticks out", "0.500 mm"])
        self.refused(*self.new("x", "--part", f"caries:10={self.folder}/caries.stl"), mentions=["crosses", "priority 10"])
        self.refused(*self.new("x", "--part", f"cheese={self.folder}/caries.stl"), mentions=["cheese", "enamel"])
        self.refused(*self.new("x", "--part", f"caries:high={self.folder}/caries.stl"), mentions=["high", "priority"])
        self.refused(*self.new("x", "--part", "caries"), mentions=["TISSUE=FILE"])
        self.refused(*self.new("x", "--part", "caries=gone.stl"), mentions=["gone.stl"])
        self.refused(*self.new("x", "--fdi", "49"), mentions=["49"])
        self.refused("case", "new", "--out", self.folder / "x", "--part", f"enamel={self.folder}/enamel.stl", "--part",
                     f"dentine={self.folder}/dentine.stl", mentions=["no outer surface"])
        (self.folder / "t.toml").write_text("format = 1\n[enamel]\ncutting = -1\n")
        self.refused(*self.new("x", "--tissues", self.folder / "t.toml"), mentions=["t.toml", "cutting of enamel is -1"])
        self.ok(*self.new("good"))
        toml = self.folder / "good" / "case.toml"
        toml.write_text(toml.read_text().replace("format = 1", "format = 2") + '\n[exercise]\nbur = "excalibur"\n')
        done = self.refused("case", "check", self.folder / "good", mentions=["excalibur"])
        self.assertNotIn("sticks", done)

    OTHER = """
[[tooth]]
fdi = 45
outer = "45.stl"
position_mm = [8.0, 0, 0]
orientation = [1, 0, 0, 0]
[[landmark]]
kind = "cusp-tip"
points_mm = [1, 1, 6]
"""

    def mouth(self):
        """A tooth of boxes at the place of 46 and one beside it."""
        self.parts()
        self.ok(*self.new("mouth", "--fdi", "46"))
        folder = self.folder / "mouth"
        write_stl(folder / "45.stl", box((-3.5, -4, -8), (4, 4, 6)))
        toml = (folder / "case.toml").read_text()
        text = re.sub("format = [0-9]", "format = 3", toml) + self.OTHER
        (folder / "case.toml").write_text(text)
        return folder, text

    def test_a_mutilated_mouth_is_told_in_one_line(self):
        folder, good = self.mouth()
        self.ok("case", "check", folder)
        stl = (folder / "45.stl").read_bytes()
        turned = "orientation = [1, 0, 0, 0]"

        def cut(old, new, *mentions):
            self.assertIn(old, good)
            return good.replace(old, new, 1), stl, mentions

        mutilated = [
            cut("fdi = 45", "fdi = 46", "46", "twice"),
            cut("fdi = 45", "fdi = 99", "99"),
            cut("fdi = 45", 'fdi = "molar"', "fdi"),
            cut('outer = "45.stl"', "", "outer"),
            cut('outer = "45.stl"', 'outer = "gone.stl"', "gone.stl"),
            cut('outer = "45.stl"', 'outer = "../outer.stl"', "inside the case"),
            cut('outer = "45.stl"', 'outer = "/etc/passwd"', "passwd"),
            cut('outer = "45.stl"', "outer = 45", "outer"),
            cut("position_mm = [8.0, 0, 0]", "position_mm = [8.0, 0]", "three numbers"),
            cut("position_mm = [8.0, 0, 0]", "position_mm = [nan, 0, 0]", "nan"),
            cut("position_mm = [8.0, 0, 0]", "position_mm = [1e9, 0, 0]", "mm off"),
            cut("position_mm = [8.0, 0, 0]", "", "three numbers"),
            cut("position_mm = [8.0, 0, 0]", "position_mm = [6.5, 0, 0]", "cross"),
            cut("position_mm = [8.0, 0, 0]", "position_mm = [0, 0, 0]", "cross"),
            cut(turned, "orientation = [0, 0, 0, 0]", "unit quaternion"),
            cut(turned, "orientation = [1, 0, 0]", "four numbers"),
            cut(turned, turned + "\ncuttable = 3", "cuttable"),
            cut(turned, turned + "\ncolour = 3", "colour"),
            cut('kind = "cusp-tip"', 'kind = "nose"', "nose"),
            cut("points_mm = [1, 1, 6]", "points_mm = [1, 1]", "2 numbers"),
            cut("points_mm = [1, 1, 6]", "points_mm = [1, 1, inf]", "points_mm"),
            cut("format = 3", "format = 4", "newer"),
            cut("format = 3", "format = 2", "no key"),
            (good[:len(good) // 2], stl, ()),
            (good, stl[:-40], ("45.stl",)),
            (good, stl[:84] + bytes(len(stl) - 84), ("45",)),
            (good, b"", ("45.stl",)),
        ]
        for i, (text, mesh, mentions) in enumerate(mutilated):
            with self.subTest(number=i, mentions=mentions):
                (folder / "case.toml").write_text(text)
                (folder / "45.stl").write_bytes(mesh)
                line = self.refused("case", "check", folder, mentions=mentions)
                self.assertLess(len(line), 400)
        (folder / "case.toml").write_text(good)
        (folder / "45.stl").write_bytes(stl)
        self.ok("case", "check", folder)

    def test_a_tooth_beside_is_nicked_and_counted(self):
        folder, _ = self.mouth()
        # The neighbour's wall stands at x = 4.5, 0.5 mm off: the bur's edge goes 0.1 mm into it, its tip 1 mm deep.
        (self.folder / "along.csv").write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,4.1,-5,7,1,0,0,0\n"
                                               "0.2,4.1,-5,5,1,0,0,0\n1.2,4.1,5,5,1,0,0,0\n1.4,4.1,5,7,1,0,0,0\n")
        out = self.folder / "cut"
        summary = json.loads(self.ok("run", "--case", folder, "--bur", "cylinder-flat:1.0x3.0", "--full-removal", "--motion",
                                     self.folder / "along.csv", "--no-cache", "--json", "--out", out).stdout)
        (tooth,) = summary["other_teeth"]
        self.assertEqual(tooth["fdi"], 45)
        # 0.1 mm deep, 8 mm long, 1 mm high.
        self.assertAlmostEqual(sum(tooth["removed_mm3"].values()), 0.8, delta=0.008)
        again = json.loads(self.ok("replay", out / "session.h5", "--no-cache", "--json").stdout)
        self.assertTrue(again["matches"])
        self.assertEqual(again["other_teeth"], summary["other_teeth"])

    def test_hostile_packages_are_refused(self):
        for name, mentions in (("../evil", "leads outside"), ("/tmp/evil", "absolute")):
            with zipfile.ZipFile(self.folder / "p.handpiece", "w") as out:
                out.writestr(name, "text")
            self.refused("case", "info", self.folder / "p.handpiece", mentions=[mentions])
        with zipfile.ZipFile(self.folder / "p.handpiece", "w", zipfile.ZIP_DEFLATED) as out:
            out.writestr("outer.stl", bytes(50_000_000))
        self.refused("case", "info", self.folder / "p.handpiece", mentions=["times its size"])
        (self.folder / "p.handpiece").write_bytes(b"no zip")
        self.refused("case", "check", self.folder / "p.handpiece", mentions=["p.handpiece"])


if __name__ == "__main__":
    unittest.main()
