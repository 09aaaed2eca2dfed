# SPDX-License-Identifier: Apache-2.0
"""Exercises as files, by the command line: made, checked, packed, worked on, refused."""

import json
import unittest

from support import SystemTest


class Exercise(SystemTest):
    def block(self, *arguments, name="block"):
        self.ok("make", "block", "--out", self.folder / name, *arguments)
        return self.folder / name

    def test_blocks_of_every_kind_check_pack_and_list(self):
        for kind in ("line", "channel", "cross", "circle", "hollow-circle", "d-circle", "steps"):
            block = self.block("--kind", kind, "--level", 2, name=kind)
            told = json.loads(self.ok("exercise", "check", block, "--json").stdout)
            self.assertEqual((told["id"], told["problems"]), (f"block-{kind}-2", []))
            self.ok("exercise", "pack", block, self.folder / f"{kind}.handpiece")
            packed = json.loads(self.ok("exercise", "check", self.folder / f"{kind}.handpiece", "--json").stdout)
            self.assertEqual(packed, told)
        (self.folder / "broken.handpiece").write_text("no zip")
        rows = json.loads(self.ok("exercise", "list", self.folder, "--json").stdout)
        self.assertEqual(len(rows), 15)
        self.assertEqual([row["file"] for row in rows if "error" in row], ["broken.handpiece"])

    def test_its_case_is_worked_on(self):
        block = self.block("--kind", "line", "--layers", "layered", "--set", "depth_mm=0.8")
        self.ok("run", "--case", block / "case", "--bur", "330", "--motion", "plunge", "--depth", 0.4,
                "--duration", 1, "--voxel", 100, "--out", self.folder / "run")
        self.assertTrue((self.folder / "run" / "session.h5").is_file())

    def test_a_preparation_on_a_tooth(self):
        self.ok("make", "tooth", "--fdi", 46, "--faces", 4000, "--out", self.folder / "molar")
        new = ("exercise", "new", "--case", self.folder / "molar", "--id", "two-46", "--out", self.folder / "two")
        self.refused(*new, "--preparation", "class-two", mentions=("side",))
        self.ok(*new, "--preparation", "class-two", "--side", "mesial", "--title", "Class II MO", "--minutes", 45)
        first = json.loads(self.ok("exercise", "check", self.folder / "two", "--json").stdout)
        self.assertEqual((first["fdi"], first["minutes"], first["title"]), (46, 45, {"en": "Class II MO"}))
        self.ok(*new, "--preparation", "class-two", "--side", "mesial", "--set", "axial_mm=1.3")
        second = json.loads(self.ok("exercise", "check", self.folder / "two", "--json").stdout)
        self.assertNotEqual(first["hash"], second["hash"])
        gone = self.ok("exercise", "ideal", self.folder / "two", "--out", self.folder / "ideal").stdout
        self.assertGreater(float(gone.split()[1]), 10.0)
        self.ok("case", "info", self.folder / "two" / "case")
        self.ok("picture", self.folder / "ideal", "--size", "64x48", "--out", self.folder / "ideal.png")

    def test_an_onlay_is_judged_by_its_cusps(self):
        self.ok("make", "tooth", "--fdi", 46, "--faces", 8000, "--out", self.folder / "molar")

        def onlay(name, capMm, *more):
            self.ok("exercise", "new", "--case", self.folder / "molar", "--id", name, "--voxel", 100, "--preparation", "onlay", "--side", "mesial",
                    "--set", f"cap_mesiobuccal_mm={capMm}", "--set", f"cap_distobuccal_mm={capMm}", *more, "--out", self.folder / name)
            self.ok("exercise", "ideal", self.folder / name, "--out", self.folder / f"{name}-work")
            return self.folder / f"{name}-work"

        ideal = onlay("asked", 1.75)
        self.assertEqual(json.loads(self.ok("exercise", "check", self.folder / "asked", "--json").stdout)["problems"], [])

        def lost(work):
            """Points that were not given, by criterion."""
            told = json.loads(self.ok("score", work, "--exercise", self.folder / "asked", "--json").stdout)
            return {c["id"]: round(c["max_points"] - c["points"], 2) for c in told["criteria"] if c["max_points"] and c["points"] != c["max_points"]}, told

        none, told = lost(ideal)
        self.assertEqual(none, {})
        self.assertEqual(told["max_score"], 100)
        value = {c["id"]: c["value"] for c in told["criteria"]}
        self.assertAlmostEqual(value["cusp-mesiobuccal"], 1.75, delta=0.01)
        self.assertAlmostEqual(value["cusp-distobuccal"], 1.75, delta=0.01)
        self.assertAlmostEqual(value["wall-lingual"], 6.0, delta=0.5)
        self.assertNotIn("cusp-mesiolingual", value)
        self.assertEqual(told["passed"], "teacher", "no tooth stands beside it")
        short, _ = lost(onlay("short", 1.35))
        self.assertEqual(set(short), {"outline", "cusp-mesiobuccal", "cusp-distobuccal"})
        deep, _ = lost(onlay("deep", 2.15))
        # So deep the cap cuts into the floor beside it, too, and where cusps are low its depth is another.
        self.assertEqual(set(deep) - {"depth"}, {"cusp-mesiobuccal", "cusp-distobuccal", "shoulder-buccal", "floor"})
        self.refused("exercise", "new", "--case", self.folder / "molar", "--id", "low", "--preparation", "onlay", "--side", "mesial", "--set",
                     "cap_mesiobuccal_mm=9", "--out", self.folder / "low", mentions=("0 to 3",))
        self.ok("make", "tooth", "--fdi", 11, "--faces", 4000, "--out", self.folder / "incisor")
        self.refused("exercise", "new", "--case", self.folder / "incisor", "--id", "no", "--preparation", "onlay", "--side", "mesial", "--out",
                     self.folder / "no", mentions=("fissure",))

    def test_what_is_wrong_is_told_in_one_line_and_nothing_is_written(self):
        block = self.block("--kind", "line")
        new = ("exercise", "new", "--case", block / "case", "--id", "x", "--out", self.folder / "x")
        for arguments, word in ((("--preparation", "class-one"), "landmark"),
                                (("--preparation", "class-one", "--set", "depth_mm=99"), "0.5 to 4"),
                                (("--preparation", "class-one", "--set", "depth"), "NAME=NUMBER"),
                                (("--preparation", "class-one", "--set", "deep_mm=1"), "deep_mm"),
                                (("--preparation", "lesion"), "no carious tissue")):
            self.refused(*new, *arguments, mentions=(word,))
        self.refused("exercise", "check", self.folder / "nothing", mentions=("no such",))
        (block / "exercise.toml").write_text("format = 1\nid = 'a b'\n")
        self.refused("exercise", "check", block, mentions=("exercise.toml",))


    def test_those_that_come_along(self):
        rows = json.loads(self.ok("exercise", "list", "--json").stdout)
        self.assertEqual([row["number"] for row in rows[:10]], list(range(1, 11)))
        self.assertEqual([row["id"] for row in rows if row["neighbours"]],
                         ["46-class-i", "46-class-ii-mo", "11-class-iii", "33-class-v", "46-crown"])
        told = self.ok("exercise", "list").stdout
        for row in rows:
            self.assertIn(row["title"]["en"], told)
            self.assertIn(row["instructions"]["en"], told)
        self.ok("exercise", "pack", "block-caries", self.folder / "caries.handpiece")
        packed = json.loads(self.ok("exercise", "check", self.folder / "caries.handpiece", "--json").stdout)
        self.assertEqual(packed, json.loads(self.ok("exercise", "check", "block-caries", "--json").stdout))
        self.assertEqual((packed["level"], packed["minutes"]), ("beginner", 15))
        self.refused("exercise", "check", "block-none", mentions=("no such exercise",))

    def test_the_teachers_own_work_comes_along(self):
        block = self.block("--kind", "line", "--set", "depth_mm=0.5")
        run = ("--bur", "330", "--motion", "plunge", "--depth", 0.4, "--duration", 1)
        self.ok("run", "--case", block / "case", *run, "--out", self.folder / "run")
        session, packed = self.folder / "run" / "session.h5", self.folder / "with.handpiece"
        self.ok("exercise", "pack", block, packed, "--teacher-work", session)
        self.assertEqual(self.ok("exercise", "check", packed, "--json").stdout, self.ok("exercise", "check", block, "--json").stdout)
        self.ok("exercise", "pack", packed, self.folder / "again")
        self.assertEqual((self.folder / "again" / "teacher.h5").read_bytes(), session.read_bytes())
        # Work on another tooth, or what is no session, is none.
        other = self.block("--kind", "line", "--layers", "layered", name="layered")
        self.refused("exercise", "pack", other, self.folder / "no.handpiece", "--teacher-work", session, mentions=("another tooth",))
        self.refused("exercise", "pack", block, self.folder / "no.handpiece", "--teacher-work", block, mentions=("no session",))
        self.assertFalse((self.folder / "no.handpiece").exists())

    def test_a_hand_in_is_scored_as_the_work_itself(self):
        block = self.block("--kind", "line", "--set", "depth_mm=0.5")
        self.ok("run", "--case", block / "case", "--bur", "330", "--motion", "plunge", "--depth", 0.4,
                "--duration", 1, "--out", self.folder / "run")
        hand_in = ("exercise", "hand-in", self.folder / "run" / "session.h5", "--exercise", block)
        self.refused(*hand_in, "--out", self.folder / "a7", mentions=(".handpiece",))
        file = self.folder / "a7.handpiece"
        self.ok(*hand_in, "--student", "A7", "--expected", 80, "--words", "rough", "--out", file)
        own = json.loads(self.ok("score", self.folder / "run" / "session.h5", "--exercise", block, "--json").stdout)
        again = json.loads(self.ok("score", file, "--exercise", block, "--json").stdout)
        self.assertTrue(again["proven"])
        self.assertEqual(again, own)
        told = self.ok("score", file, "--exercise", block).stdout
        self.assertIn("its student expected 80 %: rough", told)
        self.assertNotIn("is not the one", told)
        other = self.block("--kind", "line", "--set", "depth_mm=1", name="other")
        self.assertIn("is not the one", self.ok("score", file, "--exercise", other).stdout)


if __name__ == "__main__":
    unittest.main()
