# SPDX-License-Identifier: Apache-2.0
"""Work judged by the command line: session and attempt agree, a session is proven, what does not fit is refused."""

import json
import pathlib
import re
import unittest

from support import SystemTest

RUBRICS = pathlib.Path(__file__).resolve().parents[2] / "data" / "rubrics"


class Score(SystemTest):
    def setUp(self):
        super().setUp()
        self.tooth = self.folder / "molar"
        self.ok("make", "tooth", "--fdi", 46, "--seed", 1, "--faces", 6000, "--out", self.tooth)

    def exercise(self, name, *arguments, voxel_um=100):
        path = self.folder / name
        self.ok("exercise", "new", "--case", self.tooth, "--preparation", "class-one", "--id", name, "--voxel", voxel_um,
                "--out", path, *arguments)
        return path

    def score(self, work, exercise, *arguments):
        return json.loads(self.ok("score", work, "--exercise", exercise, "--json", *arguments).stdout)

    def test_the_ideal_has_nearly_all_points_and_less_is_less(self):
        # As narrow and deep as the rubric wants it, with ridges that have all points.
        wanted = self.exercise("wanted", "--rubric", RUBRICS / "46-class-i.toml", "--set", "ridge_mm=2.3")
        self.ok("exercise", "ideal", wanted, "--out", self.folder / "ideal")
        good = self.score(self.folder / "ideal", wanted)
        self.assertEqual((good["schema"], good["passed"], good["critical"]), ("handpiece-result-1", "yes", []))
        self.assertGreater(good["score"], 97.0)
        self.assertFalse(good["proven"], "an attempt proves nothing")
        deep = self.exercise("deep", "--rubric", RUBRICS / "46-class-i.toml", "--set", "depth_mm=3.2", "--set", "ridge_mm=2.3")
        self.ok("exercise", "ideal", deep, "--out", self.folder / "too-deep")
        bad = self.score(self.folder / "too-deep", deep)
        self.assertIn("depth", [one["criterion"] for one in bad["critical"]])
        self.assertEqual(bad["passed"], "no")
        self.assertEqual(bad, self.score(self.folder / "too-deep", deep), "the same bytes twice")

    def test_session_and_attempt_agree_and_what_does_not_fit_is_refused(self):
        exercise = self.exercise("one", "--rubric", RUBRICS / "46-class-i.toml")
        self.ok("run", "--case", exercise / "case", "--bur", "330", "--motion", "class-one", "--voxel", 100,
                "--out", self.folder / "cut")
        session = self.score(self.folder / "cut" / "session.h5", exercise, "--out", self.folder / "result")
        attempt = self.score(self.folder / "cut" / "attempt", exercise)
        self.assertTrue(session["proven"])
        self.assertEqual(len(session["session_hash"]), 1)
        self.assertEqual(session, json.loads((self.folder / "result" / "result.json").read_text()))
        for name in ("score", "passed", "exercise_hash", "case_key", "state_hash", "rubric_hash"):
            self.assertEqual(session[name], attempt[name], name)
        values = [[(c["id"], c["value"]) for c in one["criteria"]] for one in (session, attempt)]
        self.assertEqual(values[0], values[1])
        self.assertFalse(self.score(self.folder / "cut" / "session.h5", exercise, "--no-replay")["proven"])

        finer = self.exercise("finer", "--rubric", RUBRICS / "46-class-i.toml", voxel_um=90)
        self.refused("score", self.folder / "cut" / "session.h5", "--exercise", finer, mentions=("voxel", "100"))
        other = self.folder / "block"
        self.ok("make", "block", "--kind", "line", "--rubric", RUBRICS / "dexterity-line.toml", "--out", other)
        self.refused("score", self.folder / "cut" / "attempt", "--exercise", other, mentions=("another tooth",))
        self.refused("score", self.tooth, "--exercise", exercise, mentions=("neither a session nor an attempt",))
        bare = self.exercise("bare")
        self.refused("score", self.folder / "cut" / "attempt", "--exercise", bare, mentions=("no rubric", "--rubric"))
        self.assertGreater(self.score(self.folder / "cut" / "attempt", bare, "--rubric", "46-class-i")["score"], 0)

    def test_a_page_for_the_student_and_one_for_the_class(self):
        exercise = self.exercise("one", "--rubric", RUBRICS / "46-class-i.toml", "--title", "Class I", "--set", "ridge_mm=2.3")
        deep = self.exercise("deep", "--rubric", RUBRICS / "46-class-i.toml", "--set", "depth_mm=2.3", "--set", "ridge_mm=2.3")
        for made, name in ((deep, "deep"), (exercise, "good")):
            self.ok("exercise", "ideal", made, "--out", self.folder / f"{name}-work")
        results = self.folder / "results"
        for number, name in ((1, "deep"), (2, "good")):
            self.ok("score", self.folder / f"{name}-work", "--exercise", exercise, "--out", results / "A7" / str(number))
        page = (results / "A7" / "1" / "report.html").read_text()
        for part in ("Class I", "To work on first", "To practise", "data:image/png;base64,", "too much gone"):
            self.assertIn(part, page)
        self.assertIsNone(re.search(r'(src|href)="(?!data:)|url\(|<script', page), "it loads nothing")
        pictures = {file.stem for file in (results / "A7" / "1").glob("*.png")}
        for name in ("occlusal-own", "occlusal-ideal", "occlusal-deviation", "section-mesial-own", "error-depth"):
            self.assertIn(name, pictures)
        self.ok("--language", "ja", "score", self.folder / "deep-work", "--exercise", exercise, "--no-pictures",
                "--out", results / "B2")
        japanese = (results / "B2" / "report.html").read_text()
        self.assertIn('<html lang="ja">', japanese)
        self.assertNotIn("<img", japanese)
        self.ok("score", "--class", results, "--out", self.folder / "class.html")
        page = (self.folder / "class.html").read_text()
        for part in ("3 results of 2 students", "A7", "B2", "Learning curves", "What cost the class most"):
            self.assertIn(part, page)
        self.refused("score", "--class", exercise, "--out", self.folder / "none.html", mentions=("no result in it",))
        (results / "C3.json").write_text('{"schema": "handpiece-result-1"}')
        self.refused("score", "--class", results, "--out", self.folder / "none.html", mentions=("C3.json", "missing"))
        self.assertFalse((self.folder / "none.html").exists(), "nothing is half written")

    def test_a_scan_of_the_cut_tooth(self):
        exercise = self.exercise("one", "--rubric", RUBRICS / "46-class-i.toml")
        self.ok("run", "--case", exercise / "case", "--bur", "330", "--motion", "class-one", "--voxel", 100,
                "--out", self.folder / "cut")
        virtual = self.score(self.folder / "cut" / "attempt", exercise)
        scan = self.score(self.folder / "cut" / "cut.stl", exercise)
        self.assertEqual((scan["device"], scan["proven"]), ("scan", False))
        self.assertLess(scan["scan"]["rms_mm"], 0.01)
        for one, other in zip(virtual["criteria"], scan["criteria"]):
            if one["value"] is None:
                self.assertIn("scan", other["reason"])
            else:
                self.assertAlmostEqual(one["value"], other["value"], delta=one["uncertainty"] + other["uncertainty"], msg=one["id"])
        self.refused("score", self.tooth / "pulp.stl", "--exercise", exercise, mentions=("pulp.stl",))
        self.refused("score", self.folder / "cut" / "cut.stl", "--exercise", exercise, "--unit", "m", mentions=("--unit",))


if __name__ == "__main__":
    unittest.main()
