# SPDX-License-Identifier: Apache-2.0
"""Work judged by the command line: session and attempt agree, a session is proven, what does not fit is refused."""

import json
import pathlib
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
        bare = self.exercise("bare", "--no-rubric")
        self.refused("score", self.folder / "cut" / "attempt", "--exercise", bare, mentions=("no rubric", "--rubric"))
        self.assertGreater(self.score(self.folder / "cut" / "attempt", bare, "--rubric", "46-class-i")["score"], 0)


if __name__ == "__main__":
    unittest.main()
