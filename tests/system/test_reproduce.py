# SPDX-License-Identifier: Apache-2.0
"""The paper's tables and figures from the program, and the starter molar that they stand on."""

import json
import unittest

from support import REAL_DATA, SystemTest, poses, rows_of
from test_picture import read_png


class Reproduce(SystemTest):
    def test_quick(self):
        out = self.folder / "paper"
        done = self.ok("reproduce", "--quick", "--out", out)
        self.assertIn("report.html", done.stdout)
        results = json.loads((out / "results.json").read_text())
        for key in ("table1", "table2", "table3", "table4", "figure8", "figure9", "figure10", "figure11", "figure12",
                    "figure13"):
            self.assertTrue(results[key], key)
        for row in results["table3"]:
            for key in ("resolution", "faces", "method", "touching_us", "hovering_us"):
                self.assertIn(key, row)
            self.assertGreater(row["touching_us"], 0)
            self.assertGreater(row["cutting_us"], 0)
            if row["method"] == "field":
                self.assertGreater(row["removed_mm3"], 0.1)
        six, = (r for r in results["table3"] if r["resolution"] == "6 %" and r["method"] == "field")
        self.assertEqual((six["paper_cutting_ms"], six["paper_noncutting_ms"]), (154.9, 0.95))
        self.assertLess(six["touching_us"], 1000 * six["paper_cutting_ms"])
        self.assertLess(six["cutting_us"], 1000 * six["paper_cutting_ms"])
        self.assertEqual({row["method"] for row in results["table3"]}, {"field", "hull"})
        # Without OpenGL there is no drawing to time, and the report says why.
        told = any("Table II, drawing" in remark for remark in results["remarks"])
        for row in results["table2"]:
            self.assertTrue(told if row["draw_ms"] is None else row["draw_ms"] > 0, row)
            if row.get("resolution") == "6 %":
                self.assertAlmostEqual(row["faces"] / 9760, 1, delta=0.01)
        # The same table from slices: exact percentages, closed surfaces have two vertices fewer than half their faces.
        scanned = results["table2_scanned"]["rows"]
        self.assertEqual([row["resolution"] for row in scanned], ["6 %", "12 %", "25 %", "50 %", "100 %"])
        for row, percent in zip(scanned, (6, 12, 25, 50, 100)):
            self.assertAlmostEqual(row["faces"], percent / 100 * scanned[-1]["faces"], delta=2)
            self.assertEqual(row["faces"] % 2, 0)
            self.assertTrue(told if row["draw_ms"] is None else row["draw_ms"] > 0, row)
            self.assertGreater(row["load_ms"], 0)
        steps = {row["step_um"] for row in results["table4"]}
        self.assertTrue({100, 50, 25, 20, 15, 10, 5, 1, 0.1, 0.01} <= steps, steps)
        for row in results["table4"]:
            if row.get("method") == "field":
                self.assertTrue(row["told_apart"], row)
        for row in results["figure9"]:
            self.assertEqual(len(row["drop_mm"]), len(row["depth_mm"]))
        for name in ("figure12", "figure13"):
            for row in results[name]:
                self.assertEqual(len(row["t_s"]), len(row["force_n"]))
                self.assertLessEqual(max(row["force_n"]), 3.3 + 1e-6)
        # Figure 11: what the field lost is what the mesh lost.
        for row in results["figure11"]:
            self.assertAlmostEqual(row["outer_mm3"] - row["cut_mm3"], row["removed_mm3"], delta=0.001 * row["cut_mm3"])
            self.assertEqual(len(row["cutting"]), len(row["tip_mm"]))
            self.assertTrue(any(row["cutting"]))
        pictures = [row["picture"] for name in ("figure8", "figure11") for row in results[name] if "picture" in row]
        self.assertEqual(len(pictures), 4)
        for name in pictures[::2]:
            if name is None:
                self.assertTrue(told)
            else:
                width, height, rows = read_png(out / name)
                self.assertEqual((width, height), (1120, 840))
                # The bur where it overlaps the tooth is red, and nothing else is.
                red = sum(row[4 * x] > row[4 * x + 1] + 40 for row in rows[::8] for x in range(0, width, 8))
                self.assertTrue(50 < red < 0.5 * (width // 8) * (height // 8), (name, red))
        # Figure 12: the same motion cutting and touching.
        for motion in ("press", "drag"):
            pair = {row["part"]: row for row in results["figure12"] if row["motion"] == motion and "pedal" in row}
            self.assertEqual(len(pair["a"]["t_s"]), len(pair["b"]["t_s"]))
            self.assertGreater(pair["a"]["removed_mm3"], 0.05)
            self.assertEqual(pair["b"]["removed_mm3"], 0)
        page = (out / "report.html").read_text()
        for word in ("Table I", "Table II", "Table III", "Table IV", "Figure 8", "Figure 9", "Figure 10", "Figure 11",
                     "Figure 12", "Figure 13", "<svg", "</html>"):
            self.assertIn(word, page)
        self.assertNotIn("http://", page.replace("http://www.w3.org", ""), "one page, nothing from elsewhere")
        if not REAL_DATA.is_dir():
            return
        # The tooth it made and a real bur.
        bur = REAL_DATA / "tools" / "tapered_bur.stl"
        text = self.ok("probe", "--tooth", out / "teeth" / "starter-006.stl", "--bur", bur, "--poses", "-",
                       stdin=poses((0, 0, 9), (0, 0, 5), (1, 1, 4.5))).stdout
        far, near, deep = (float(row["depth_mm"]) for row in rows_of(text))
        self.assertLess(far, near)
        self.assertLess(far, 0)
        self.assertGreater(deep, 0)


class Measure(SystemTest):
    def test_bench(self):
        rows = json.loads(self.ok("bench", "--quick", "--json").stdout)["rows"]
        self.assertEqual({(row["method"], row["where"]) for row in rows},
                         {(method, where) for method in ("exact", "exact with patches", "hull")
                          for where in ("touch", "hover")})
        for row in rows:
            self.assertEqual(row["faces"], 9760)
            self.assertTrue(0 < row["p50_us"] <= row["p99_us"] <= row["p999_us"] <= row["max_us"], row)

    def test_passivity(self):
        out = self.folder / "map"
        self.assertIn("passive in", self.ok("passivity", "--out", out).stdout)
        rows = rows_of((out / "passivity.csv").read_text())
        self.assertGreater(len(rows), 100)
        self.assertTrue((out / "passivity.svg").read_text().startswith("<svg"))


if __name__ == "__main__":
    unittest.main()
