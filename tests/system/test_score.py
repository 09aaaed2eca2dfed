# SPDX-License-Identifier: Apache-2.0
"""Work judged by the command line: session and attempt agree, a session is proven, what does not fit is refused."""

import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

from support import HANDPIECE, SystemTest, rows_of, run

RUBRICS = pathlib.Path(__file__).resolve().parents[2] / "data" / "rubrics"


# Coarse, and a class I cavity in a third of its usual time: each of some forty runs cuts it again.
VOXEL_UM = 140
CUT = ("--bur", "330", "--motion", "class-one", "--speed", 6, "--voxel", VOXEL_UM)


class Score(SystemTest):
    @classmethod
    def setUpClass(cls):
        """One tooth and one cavity for all tests."""
        folder = tempfile.mkdtemp(prefix="handpiece-system-")
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        os.environ["XDG_CACHE_HOME"] = folder
        cls.tooth, cls.cut = pathlib.Path(folder) / "molar", pathlib.Path(folder) / "cut"
        for command in (("make", "tooth", "--fdi", 46, "--seed", 1, "--faces", 12000, "--out", cls.tooth),
                        ("run", "--case", cls.tooth, *CUT, "--out", cls.cut)):
            made = run(*command)
            if made.returncode != 0:
                raise AssertionError(made.stderr)

    def exercise(self, name, *arguments, voxel_um=VOXEL_UM):
        path = self.folder / name
        self.ok("exercise", "new", "--case", self.tooth, "--preparation", "class-one", "--id", name, "--voxel", voxel_um,
                "--out", path, *arguments)
        return path

    def samples(self, session):
        return rows_of(self.ok("export", session, "--csv").stdout)

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
        session = self.score(self.cut / "session.h5", exercise, "--out", self.folder / "result")
        attempt = self.score(self.cut / "attempt", exercise)
        self.assertTrue(session["proven"])
        self.assertEqual(len(session["session_hash"]), 1)
        self.assertEqual(session, json.loads((self.folder / "result" / "result.json").read_text()))
        for name in ("score", "passed", "exercise_hash", "case_key", "state_hash", "rubric_hash"):
            self.assertEqual(session[name], attempt[name], name)
        hand = ("time", "path", "smoothness")
        values = [[(c["id"], c["value"]) for c in one["criteria"] if c["id"] not in hand] for one in (session, attempt)]
        self.assertEqual(values[0], values[1])
        # Of the hand an attempt alone knows nothing, and says so; the session's time is that of its samples.
        for name in hand:
            had, none = (next(c for c in one["criteria"] if c["id"] == name) for one in (session, attempt))
            self.assertIsNotNone(had["value"], had["reason"])
            self.assertIsNone(none["value"])
            self.assertEqual(none["standing"], "not-measured")
            self.assertIn("no samples", none["reason"])
        rows = self.samples(self.cut / "session.h5")
        had = {c["id"]: c for c in session["criteria"]}
        self.assertAlmostEqual(had["time"]["value"], float(rows[-1]["t_s"]) + 1e-3, delta=had["time"]["uncertainty"] + 1e-6)
        # Where the floor is deepest the bur was, cutting, at the time that is told.
        deepest = had["depth"]["evidence"][0]
        at = min(rows, key=lambda row: abs(float(row["t_s"]) - deepest["t_s"]))
        self.assertEqual(deepest["session"], 0)
        self.assertGreaterEqual(int(at["flags"]) & 32, 32)
        self.assertLess(math.dist([float(at[c]) for c in ("x_mm", "y_mm", "z_mm")], deepest["xyz_mm"]), 2.0)
        self.assertFalse(self.score(self.cut / "session.h5", exercise, "--no-replay")["proven"])

        finer = self.exercise("finer", "--rubric", RUBRICS / "46-class-i.toml", voxel_um=90)
        self.refused("score", self.cut / "session.h5", "--exercise", finer, mentions=("voxel", str(VOXEL_UM)))
        other = self.folder / "block"
        self.ok("make", "block", "--kind", "line", "--rubric", RUBRICS / "dexterity-line.toml", "--out", other)
        self.refused("score", self.cut / "attempt", "--exercise", other, mentions=("another tooth",))
        self.refused("score", self.tooth, "--exercise", exercise, mentions=("neither a session nor an attempt",))
        bare = self.exercise("bare", "--no-rubric")
        self.refused("score", self.cut / "attempt", "--exercise", bare, mentions=("no rubric", "--rubric"))
        self.assertGreater(self.score(self.cut / "attempt", bare, "--rubric", "46-class-i")["score"], 0)

    def test_random_works_score_alike_from_session_attempt_and_store_on_any_machine(self):
        seed = int(os.environ.get("HANDPIECE_TEST_SEED", 20261126))
        print(f"HANDPIECE_TEST_SEED={seed}", flush=True)
        draw = random.Random(seed)
        exercise = self.exercise("one", "--rubric", RUBRICS / "46-class-i.toml")
        hand = ("time", "path", "smoothness")
        for number in range(int(os.environ.get("HANDPIECE_WORKS", 1))):
            cut = self.folder / f"cut{number}"
            self.ok("run", "--case", exercise / "case", "--bur", draw.choice(["330", "245"]), "--motion", "class-one", "--voxel", VOXEL_UM,
                    "--depth", round(draw.uniform(0.6, 2.2), 3), "--isthmus", round(draw.uniform(1.1, 2.0), 3),
                    "--tremor", round(draw.uniform(0, 150)), "--seed", draw.randrange(1000), "--duration", 12, "--speed", 6, "--out", cut)

            def scored(work, *arguments, **machine):
                os.environ.update(machine)
                try:
                    return self.ok("score", work, "--exercise", exercise, "--json", *arguments).stdout
                finally:
                    for name in machine:
                        del os.environ[name]

            session = cut / "session.h5"
            first = scored(session, "--threads", 1)
            self.assertTrue(json.loads(first)["proven"])
            for simd, threads in (("base", 2), ("avx2", 1), ("avx512", 2)):
                self.assertEqual(scored(session, "--threads", threads, "--anew", HANDPIECE_SIMD=simd), first, (simd, threads))
            self.assertEqual(scored(session), first, "proven before")

            def of_tooth(text):
                read = json.loads(text) if isinstance(text, str) else text
                # Only what sessions tell of a place is left out: when it was cut, and with what load.
                for one in read["criteria"]:
                    for place in one["evidence"]:
                        place.update(t_s=None, session=None, force_n=None)
                return json.dumps([c for c in read["criteria"] if c["id"] not in hand])

            tooth = of_tooth(first)
            self.assertEqual(of_tooth(scored(session, "--no-replay")), tooth, "from the record")
            self.assertEqual(of_tooth(scored(cut / "attempt")), tooth, "from the attempt")

            work = self.folder / f"work{number}"
            work.mkdir()
            shutil.copy(session, work)
            rescore = ("rescore", work, "--exercise", exercise, "--rubric", RUBRICS / "46-class-i.toml", "--json", "--out")
            for _ in ("measured", "as measured before"):
                again = json.loads(self.ok(*rescore, self.folder / "table.csv").stdout)[0]
                del again["work"]
                self.assertEqual(json.dumps(again), json.dumps(json.loads(first)))

    def test_a_chain_of_sessions_and_a_class_under_another_rubric(self):
        exercise = self.exercise("one", "--rubric", RUBRICS / "46-class-i.toml")
        self.ok("run", "--case", self.cut / "attempt", *CUT, "--out", self.folder / "second")
        first, second = self.cut / "session.h5", self.folder / "second" / "session.h5"
        work = self.folder / "class"
        work.mkdir()
        (work / "both").mkdir()
        # Named against their order: the teeth tell it.
        shutil.copy(first, work / "both" / "z.h5")
        shutil.copy(second, work / "both" / "a.h5")
        both, alone = self.score(work / "both", exercise), self.score(first, exercise)
        self.assertTrue(both["proven"])
        self.assertEqual(both["session_hash"][0], alone["session_hash"][0])
        self.assertEqual(len(both["session_hash"]), 2)
        time = [next(c["value"] for c in one["criteria"] if c["id"] == "time") for one in (both, alone)]
        self.assertAlmostEqual(time[0], 2 * time[1], places=6)
        last = self.score(second, exercise)
        self.assertFalse(last["proven"])
        self.assertEqual(last["state_hash"], both["state_hash"])
        (self.folder / "gap").mkdir()
        shutil.copy(second, self.folder / "gap" / "a.h5")
        # One is missing: scored as the last leaves it, told, and not proven.
        told = self.ok("score", self.folder / "gap", "--exercise", exercise).stdout
        self.assertIn("not proven: a.h5 goes on from a tooth that no other session here leaves", told)
        self.assertEqual(self.score(self.folder / "gap", exercise)["state_hash"], both["state_hash"])
        # Two works are none.
        shutil.copy(first, self.folder / "gap" / "b.h5")
        shutil.copy(first, self.folder / "gap" / "c.h5")
        self.refused("score", self.folder / "gap", "--exercise", exercise, mentions=("c.h5", "several works"))

        # A class: a session, a chain, an attempt, a damaged session, things that are no work.
        shutil.copy(first, work / "anna.h5")
        shutil.copytree(self.cut / "attempt", work / "cleo")  # which names its tooth by the way there
        shutil.copytree(self.tooth, self.folder / "molar")
        (work / "dan.h5").write_bytes(first.read_bytes()[:30000])
        (work / "notes.txt").write_text("x")
        rescore = ("rescore", work, "--exercise", exercise, "--rubric", "46-class-i", "--out")
        once = json.loads(self.ok(*rescore, self.folder / "once.csv", "--json").stdout)
        self.assertEqual([one["work"] for one in once], ["anna.h5", "both", "cleo", "dan.h5"])
        self.assertEqual([one.get("proven") for one in once], [True, True, False, None])
        self.assertIn("damaged", once[3]["error"])
        for one, scored in ((once[0], alone), (once[1], both)):
            del one["work"]
            self.assertEqual(one, scored, "as score says it")
        rows = rows_of((self.folder / "once.csv").read_text())
        self.assertEqual([row["proven"] for row in rows], ["yes", "yes", "no", ""])
        self.assertEqual(float(rows[1]["depth"]), next(c["value"] for c in both["criteria"] if c["id"] == "depth"))
        # From what was kept: the same to the byte, and nothing is cut again, not even where it could no longer be.
        for file in self.folder.rglob("*.field"):
            file.unlink()
        again = self.ok(*rescore, self.folder / "again.csv")
        self.assertIn("3 scored, 3 of them as measured before; 1 could not be scored", again.stdout)
        self.assertEqual((self.folder / "once.csv").read_bytes(), (self.folder / "again.csv").read_bytes())
        self.assertEqual(list(self.folder.rglob("*.field")), [])
        # Kept measures that somebody changed are not believed.
        kept = sorted((self.folder / "cache" / "handpiece" / "measures").iterdir())
        self.assertGreaterEqual(len(kept), 3)
        for file in kept:
            file.write_text(file.read_text().replace('"proven":false', '"proven":true'))
        forged = rows_of(self.table(*rescore, self.folder / "forged.csv"))
        self.assertEqual([row["proven"] for row in forged], ["yes", "yes", "no", ""])
        # Another rubric: only what is not known yet is measured; a folder without work; Ctrl-C.
        other = rows_of(self.table("rescore", work, "--exercise", exercise, "--rubric", "block-channel", "--out",
                                   self.folder / "other.csv"))
        self.assertEqual([row["rubric"] for row in other], ["block-channel"] * 3 + [""])
        self.refused("rescore", exercise / "case", "--rubric", "46-class-i", "--out", self.folder / "none.csv",
                     mentions=("nothing to score",))
        process = subprocess.Popen([HANDPIECE, *map(str, rescore), str(self.folder / "stopped.csv"), "--anew"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            process.wait(0.4)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=60)[1]
        self.assertEqual((process.returncode, said), (1, "handpiece: cancelled\n"))
        self.assertFalse((self.folder / "stopped.csv").exists())

    def table(self, *arguments):
        self.ok(*arguments)
        return pathlib.Path(arguments[-1]).read_text()

    def test_a_page_for_the_student_and_one_for_the_class(self):
        exercise = self.exercise("one", "--rubric", RUBRICS / "46-class-i.toml", "--title", "Class I", "--set", "ridge_mm=2.3")
        deep = self.exercise("deep", "--rubric", RUBRICS / "46-class-i.toml", "--set", "depth_mm=2.3", "--set", "ridge_mm=2.3")
        for made, name in ((deep, "deep"), (exercise, "good")):
            self.ok("exercise", "ideal", made, "--out", self.folder / f"{name}-work")
        results = self.folder / "results"
        for number, name in ((1, "deep"), (2, "good")):
            self.ok("score", self.folder / f"{name}-work", "--exercise", exercise, "--out", results / "A7" / str(number))
        page = (results / "A7" / "1" / "report.html").read_text()
        for part in ("Class I", "To work on first", "What to do", "data:image/png;base64,", "too much gone"):
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
        virtual = self.score(self.cut / "attempt", exercise)
        scan = self.score(self.cut / "cut.stl", exercise)
        self.assertEqual((scan["device"], scan["proven"]), ("scan", False))
        self.assertLess(scan["scan"]["rms_mm"], 0.01)
        for one, other in zip(virtual["criteria"], scan["criteria"]):
            if one["value"] is None:
                self.assertIn("scan", other["reason"])
            else:
                self.assertAlmostEqual(one["value"], other["value"], delta=one["uncertainty"] + other["uncertainty"], msg=one["id"])
        self.refused("score", self.tooth / "pulp.stl", "--exercise", exercise, mentions=("pulp.stl",))
        self.refused("score", self.cut / "cut.stl", "--exercise", exercise, "--unit", "m", mentions=("--unit",))


if __name__ == "__main__":
    unittest.main()
