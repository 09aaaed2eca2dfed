# SPDX-License-Identifier: Apache-2.0
"""Depths that are known by hand, through the real program."""

import math
import unittest

from support import REAL_DATA, SystemTest, ball, box, poses, rows_of, write_stl

HEADER = "depth_mm,nx,ny,nz,area_mm2,tissue,time_ns"
LYING = (math.sqrt(0.5), 0, math.sqrt(0.5), 0)  # the shank towards +x


class Probe(SystemTest):
    def setUp(self):
        super().setUp()
        self.cube = write_stl(self.folder / "cube.stl", box((-4, -4, -8), (4, 4, 4)))

    def probe(self, tooth, bur, lines, *more, method="field"):
        done = self.ok("probe", "--tooth", tooth, "--bur", bur, "--poses", "-", "--method", method, *more,
                       stdin=poses(*lines))
        self.assertEqual(done.stdout.splitlines()[0], HEADER)
        rows = rows_of(done.stdout)
        self.assertEqual(len(rows), len(lines))
        return rows

    def check(self, rows, expected, tolerance=1e-6):
        for row, depth in zip(rows, expected):
            self.assertAlmostEqual(float(row["depth_mm"]), depth, delta=tolerance)
            normal = [float(row[c]) for c in ("nx", "ny", "nz")]
            self.assertAlmostEqual(sum(n * n for n in normal), 1.0, delta=1e-6)
            self.assertGreater(float(row["time_ns"]), 0)
            decimals = row["depth_mm"].split(".")[1]
            self.assertGreaterEqual(len(decimals), 7)

    def test_a_ball_on_a_face_an_edge_and_a_corner(self):
        # A ball of radius 0.5, its centre 0.5 above the tip.
        lines, expected = [], []
        for gap in (3.0, 1.0, 0.1, 1e-3, 0.0, -1e-4, -0.01, -0.1, -0.4):
            lines.append((0.7, 0.3, 4 + gap))
            expected.append(-gap)
            for away in ((1, 0, 1), (1, 1, 1), (0, -1, 1)):  # edge, corner, edge
                length = math.sqrt(sum(c * c for c in away))
                centre = [at + c * (0.5 + gap) / length if c else at
                          for at, c in zip((4 if away[0] else 0.2, 4 * (away[1] or 0), 4), away)]
                if gap > -0.5:
                    lines.append((centre[0], centre[1], centre[2] - 0.5))
                    expected.append(-gap)
        rows = self.probe(self.cube, "round:1.0x1.0", lines)
        self.check(rows, expected)
        for row, line, depth in zip(rows, lines, expected):
            if line[:2] == (0.7, 0.3):
                self.assertAlmostEqual(float(row["nz"]), 1.0, delta=1e-6)
                self.assertEqual(float(row["area_mm2"]) > 0, depth > -0.02 + 1e-6)
            self.assertEqual(row["tissue"], "enamel")

    def test_a_ball_wholly_inside(self):
        # The deepest ball decides: centre 1.5 below the face plus its radius.
        self.check(self.probe(self.cube, "round:1.0x1.0", [(0, 0, 2.0)]), [1.5 + 0.5])

    def test_a_lying_cylinder(self):
        gaps = [2.0, 0.25, 0.001, -0.001, -0.2]
        rows = self.probe(self.cube, "cylinder-round:1.0x4.0", [(-2, 0.5, 4.5 + gap, *LYING) for gap in gaps])
        self.check(rows, [-gap for gap in gaps])
        for row in rows:
            self.assertAlmostEqual(float(row["nz"]), 1.0, delta=1e-6)

    def test_the_pole_of_a_sphere(self):
        sphere = write_stl(self.folder / "sphere.stl", ball(5))
        gaps = [2.5, 1.0, 0.02, 0.0, -0.005, -0.05]
        self.check(self.probe(sphere, "round:1.0x1.0", [(0, 0, 5 + gap) for gap in gaps])[:4],
                   [-gap for gap in gaps][:4])

    def test_beyond_reach_is_a_bound(self):
        row, = self.probe(self.cube, "round:1.0x1.0", [(0, 0, 30)])
        self.assertLessEqual(float(row["depth_mm"]), -5.0)
        self.assertGreaterEqual(float(row["depth_mm"]), -26.0)
        self.assertEqual([float(row[c]) for c in ("nx", "ny", "nz")], [0, 0, 0])
        self.assertEqual(float(row["area_mm2"]), 0)

    def test_hull_and_field_agree_on_a_convex_tooth(self):
        lines = [(0.3 * i - 1, 0.2 * i - 1, 4 + gap) for i, gap in enumerate((2, 0.5, 0.01, -0.01, -0.2, -0.45))]
        field = self.probe(self.cube, "cylinder-round:1.0x4.0", lines)
        hull = self.probe(self.cube, "cylinder-round:1.0x4.0", lines, method="hull")
        self.check(hull, [float(row["depth_mm"]) for row in field])
        for a, b in zip(field, hull):
            self.assertAlmostEqual(float(a["nz"]), float(b["nz"]), delta=1e-5)

    def test_turned_tooth_same_answers(self):
        """The same contact, all turned upside down."""
        gaps = (1.0, 0.1, -0.1)
        up = self.probe(self.cube, "pear:1.0x2.0", [(0.5, 0.5, 4 + gap) for gap in gaps])
        down = self.probe(self.cube, "pear:1.0x2.0", [(0.5, -0.5, -8 - gap, 0, 1, 0, 0) for gap in gaps])
        for a, b in zip(up, down):
            self.assertAlmostEqual(float(a["depth_mm"]), float(b["depth_mm"]), delta=1e-6)
            self.assertAlmostEqual(float(a["nz"]), -float(b["nz"]), delta=1e-6)

    def test_a_session_is_probed_as_it_left_the_tooth(self):
        block = write_stl(self.folder / "block.stl", box((-2, -2, -2), (2, 2, 0)))
        self.ok("run", "--tooth", block, "--bur", "330", "--voxel", "100", "--motion", "plunge", "--depth", "0.8", "--out",
                self.folder / "cut")
        session = self.folder / "cut" / "session.h5"
        in_it = (0, 0, -0.3)
        uncut = self.probe(block, "330", [in_it], "--voxel", "100")
        cut = self.probe(session, "330", [in_it])
        self.assertAlmostEqual(float(uncut[0]["depth_mm"]), 0.3, delta=1e-6)
        self.assertLess(float(cut[0]["depth_mm"]), 0.01)  # there is room now
        self.refused("probe", "--tooth", session, "--bur", "330", "--method", "hull", "--poses", "-", stdin=poses(in_it),
                     mentions=("--method hull",))

    def test_files_and_pipes_give_the_same(self):
        text = poses((0, 0, 4.1), (0, 0, 3.9))
        (self.folder / "poses.csv").write_text("# a comment\n\n" + text.replace("\n", "\r\n"))
        shared = ["probe", "--tooth", self.cube, "--bur", "round-4"]
        self.ok(*shared, "--poses", self.folder / "poses.csv", "--out", self.folder / "out.csv")
        piped = self.ok(*shared, "--poses", "-", "--out", "-", stdin=text).stdout
        bare = self.ok(*shared, "--poses", "-", stdin=text.split("\n", 1)[1]).stdout  # without its header
        no_cache = self.ok(*shared, "--no-cache", "--threads", "1", "--poses", "-", stdin=text).stdout

        def values(csv_text):
            return [row.rsplit(",", 1)[0] for row in csv_text.splitlines()]

        written = (self.folder / "out.csv").read_text()
        for other in (piped, bare, no_cache):
            self.assertEqual(values(written), values(other))
        self.assertNotIn("out.csv.part", str(list(self.folder.iterdir())))

    def test_a_bur_from_a_file(self):
        self.ok("make", "bur", "--shape", "cylinder-round", "--diameter", "1", "--length", "4", "--out",
                self.folder / "bur.stl")
        lines = [(0, 0, 4.3), (0.5, 0, 3.95)]
        self.check(self.probe(self.cube, self.folder / "bur.stl", lines), [-0.3, 0.05], tolerance=1e-5)

    def test_the_real_tapered_bur(self):
        bur = REAL_DATA / "tools" / "tapered_bur.stl"
        if not bur.is_file():
            self.skipTest(f"no real data here ({bur})")
        rows = self.probe(self.cube, bur, [(0, 0, 4.5), (0, 0, 4.0), (0, 0, 3.9)])
        self.check(rows, [-0.5, 0.0, 0.1], tolerance=2e-3)


if __name__ == "__main__":
    unittest.main()
