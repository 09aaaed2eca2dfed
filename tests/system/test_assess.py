# SPDX-License-Identifier: Apache-2.0
"""Rubrics and agreement through the real program: what a teacher sees, and what other programs read."""

import json
import pathlib
import unittest
import xml.etree.ElementTree

from support import SystemTest, run

DATA = pathlib.Path(__file__).resolve().parent.parent.parent / "data" / "rubrics"

OWN = """format = 1
id = "own"
version = "1"
status = "proposal"
title = { en = "own", ja = "自作" }
pass_mark = 60
[[band]]
id = "good"
[[band]]
id = "bad"
[[criterion]]
id = "depth"
title = { en = "depth", ja = "深さ" }
measure = "floor-depth"
unit = "mm"
weight = 10
bands = [{ id = "good", from = 1, to = 2, points = 100 }, { id = "bad", to = 1, points = 0 }, { id = "bad", from = 2, points = 0 }]
"""


class Rubrics(SystemTest):
    def own(self, text=OWN, name="own.toml"):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def test_the_shipped_are_the_files_and_sound(self):
        names = [line.split()[0] for line in self.ok("rubric", "show").stdout.splitlines()]
        self.assertEqual(names, sorted(path.stem for path in DATA.glob("*.toml")))
        told = self.ok("rubric", "check", *names).stdout.splitlines()
        self.assertEqual(len(told), len(names), told)
        for name in names:
            self.assertEqual(self.ok("rubric", "hash", name).stdout, self.ok("rubric", "hash", DATA / f"{name}.toml").stdout)

    def test_show_speaks_both_languages_and_json(self):
        self.assertIn("unvalidated", self.ok("rubric", "show", "46-class-i").stdout)
        self.assertIn("未検証", self.ok("--language", "ja", "rubric", "show", "46-class-i").stdout)
        rubric = json.loads(self.ok("rubric", "show", "46-crown", "--json").stdout)
        self.assertEqual(sum(c["weight"] for c in rubric["criteria"]), 100)
        self.assertEqual(rubric["hash"], self.ok("rubric", "hash", "46-crown").stdout.strip())
        undercut = next(c for c in rubric["criteria"] if c["id"] == "undercut")
        self.assertEqual(undercut["excludes"], ["convergence-buccolingual"])
        self.assertEqual(undercut["knots"], [])

    def test_check_tells_where(self):
        self.assertIn("own.toml: 1 criteria", self.ok("rubric", "check", self.own()).stdout)
        wrong = self.own(OWN.replace("from = 2,", "from = 2.5,").replace('unit = "mm"\n', ""), "wrong.toml")
        done = run("rubric", "check", wrong)
        self.assertEqual(done.returncode, 1)
        self.assertIn("error: " + str(wrong) + ":11: criterion depth: the unit is missing", done.stdout)
        self.assertIn("no band has the values from 2 to 2.5", done.stdout)
        self.assertEqual(done.stderr, "handpiece: 2 errors (each is told above)\n")
        self.refused("rubric", "check", self.own("format = 1\nid = [", "no.toml"), mentions=("no.toml", "line 2"))
        self.refused("rubric", "show", "46-clown", mentions=("46-clown", "46-class-i"))
        self.refused("rubric", "show", self.folder / "nothing.toml", mentions=("nothing.toml",))
        self.refused("rubric", "show", self.folder, mentions=(str(self.folder),))

    def test_diff_and_hash_are_of_the_meaning(self):
        before = self.own()
        same = self.own("# mine\n" + OWN.replace("weight = 10", "weight = 1e1").replace("title = { en = \"depth\"", "title = { en = \"deep\""), "same.toml")
        after = self.own(OWN.replace("weight = 10", "weight = 20"), "after.toml")
        self.assertEqual(self.ok("rubric", "hash", before).stdout, self.ok("rubric", "hash", same).stdout)
        told = self.ok("rubric", "diff", before, same).stdout
        self.assertIn("no score changes", told)
        self.assertIn("scores are the same", told)
        told = self.ok("rubric", "diff", before, after).stdout
        self.assertEqual(told, "criterion depth: weight was 10, is 20\nscores may be others: the hash is another\n")
        self.assertIn("weight=10\n", self.ok("rubric", "hash", before, "--text").stdout)
        self.refused("rubric", "diff", before, self.own(OWN.replace("floor-depth", "depth"), "wrong.toml"), mentions=("wrong.toml:11", "no measure"))
        self.assertIn("nothing differs", self.ok("rubric", "diff", before, before).stdout)


class Agreement(SystemTest):
    def marks(self, text, name="marks.csv"):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def json(self, *arguments):
        return json.loads(self.ok("agree", *arguments, "--json").stdout)["criteria"]

    def test_published_data(self):
        table = [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]
        text = "item,rater,mark\n" + "".join(f"{i},judge {j},{mark}\n" for i, row in enumerate(table) for j, mark in enumerate(row))
        path = self.marks(text)
        found = self.json(path)[0]
        for name, value in {"1,1": .16574, "2,1": .28976, "3,1": .71484, "1,k": .44280, "2,k": .62005, "3,k": .90932}.items():
            self.assertAlmostEqual(found["icc"][name]["value"], value, 4)
            low, high = found["icc"][name]["ci95"]
            self.assertLess(low, value)
            self.assertGreater(high, value)
        self.assertEqual(found["items_marked_by_all"], 6)
        self.assertEqual(len(found["pairs"]), 6)
        self.assertEqual(self.ok("agree", path, "--json").stdout, self.ok("agree", path, "--json").stdout, "the same intervals")
        self.assertIn("ICC(2,1)                     0.2898", self.ok("agree", path).stdout)
        # Rows in another order: the same coefficients.
        lines = text.splitlines()
        other = self.json(self.marks("\n".join([lines[0]] + lines[:0:-1]) + "\n", "turned.csv"))[0]
        self.assertAlmostEqual(other["icc"]["2,1"]["value"], found["icc"]["2,1"]["value"], 12)
        self.assertAlmostEqual(other["alpha"]["interval"]["value"], found["alpha"]["interval"]["value"], 12)

    def test_bands_of_a_rubric_and_missing_marks(self):
        text = ("\ufeffcriterion,item,rater,mark,note\r\n"
                "isthmus,\"a, 1\",T,ideal,x\r\nisthmus,\"a, 1\",M,modify,\r\nisthmus,b,T,unacceptable,\r\nisthmus,b,M,unacceptable,\r\n"
                "isthmus,c,T,ideal,\r\nisthmus,c,M,,\r\nisthmus,d,T,ideal,\r\nisthmus,d,M,ideal,\r\ntotal,b,T,40,\r\ntotal,b,M,44.5,\r\ntotal,d,T,90,\r\ntotal,d,M,91,\r\n")
        isthmus, total = self.json(self.marks(text), "--rubric", "46-class-i", "--plots", self.folder / "plots")
        self.assertEqual(isthmus["categories"], ["ideal", "acceptable", "modify", "unacceptable"], "acceptable is there, though nobody gave it")
        self.assertEqual((isthmus["items"], isthmus["marks"], isthmus["items_marked_by_all"]), (4, 7, 3))
        self.assertEqual(isthmus["scale"], "ordered categories")
        pair = isthmus["pairs"][0]
        # By hand: three items; weights 1, 1/3, 1. Expected over the margins T (2/3, 0, 0, 1/3), M (1/3, 0, 1/3, 1/3).
        expected = (2 * 1 + 2 * 1 / 3 + 2 * 0 + 1 * 0 + 1 * 2 / 3 + 1 * 1) / 9
        self.assertAlmostEqual(pair["kappa_linear"]["value"], ((1 + 1 / 3 + 1) / 3 - expected) / (1 - expected), 12)
        self.assertEqual(total["scale"], "numbers")
        self.assertAlmostEqual(total["pairs"][0]["bland_altman"]["bias"], -2.75, 12)
        plots = sorted(path.name for path in (self.folder / "plots").iterdir())
        self.assertEqual(plots, ["bland-altman-2-1.svg"])
        xml.etree.ElementTree.parse(self.folder / "plots" / plots[0])
        # Without an order nothing is weighted.
        unordered = self.json(self.marks(text))[0]
        self.assertNotIn("kappa_linear", unordered["pairs"][0])

    def test_no_variance_is_undefined(self):
        found = self.json(self.marks("item,rater,mark\n1,a,good\n1,b,good\n2,a,good\n2,b,good\n"), "--categories", "good,bad")[0]
        self.assertIsNone(found["pairs"][0]["kappa"]["value"])
        self.assertIn("variance", found["pairs"][0]["kappa"]["reason"])
        self.assertIsNone(found["alpha"]["nominal"]["value"])
        found = self.json(self.marks("item,rater,mark\n1,a,5\n1,b,5\n2,a,5\n2,b,5\n"))[0]
        self.assertIsNone(found["icc"]["2,1"]["value"])

    def test_bad_files(self):
        for text, mentions in [("", ("no marks",)), ("item,rater\n1,a\n", ("marks.csv:1", "column", "mark")),
                               ("item,rater,mark\n1,a\n", ("marks.csv:2", "2 cells")),
                               ("item,rater,mark\n1,a,3\n1,a,4\n", ("marks.csv:3", "already")),
                               ("item,rater,mark\n1,\"a,3\n", ("marks.csv:2", "quote")),
                               ("item,rater,mark\n,a,3\n", ("marks.csv:2", "empty")),
                               ("item,rater,mark\n", ("no marks",)),
                               (b"item,rater,mark\n1,a,\0\n", ("marks.csv:2", "no text")),
                               ("item,rater,mark\n1,\"a\"b,3\n", ("marks.csv:2", "behind a closed quote")),
                               ("item,rater,mark\n" + "".join(f"1,r{i},1\n" for i in range(51)), ("marks.csv:52", "50 raters"))]:
            path = self.marks(text)
            self.refused("agree", path, mentions=mentions)
        path = self.marks("item,rater,mark\n1,a,good\n1,b,awful\n")
        self.refused("agree", path, "--categories", "good,bad", mentions=("awful", "good, bad"))
        self.assertEqual(run("agree", path, "--categories", "good,bad", "--rubric", "46-crown").returncode, 2)


if __name__ == "__main__":
    unittest.main()
