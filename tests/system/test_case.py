# SPDX-License-Identifier: Apache-2.0
"""Cases: looked into, checked, made, packed."""

import json
import unittest
import zipfile

from support import SystemTest, box, write_stl


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
