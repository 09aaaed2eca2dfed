# SPDX-License-Identifier: Apache-2.0
"""What `make` writes, `mesh info` reads back; what is broken, `mesh repair` mends."""

import json
import math
import random
import unittest

from support import SystemTest, ball, box, open_arch, vertex_colours, write_coloured_ply, write_stl


class MakeAndMesh(SystemTest):
    def info(self, path):
        return json.loads(self.ok("mesh", "info", path, "--json").stdout)

    def expect_solid(self, report):
        for flaw in ("open_edges", "non_manifold_edges", "non_manifold_vertices", "flipped_faces", "degenerate_faces",
                     "crossing_faces", "duplicate_faces"):
            self.assertEqual(report[flaw], 0, flaw)
        self.assertTrue(report["closed"] and report["oriented"])
        self.assertEqual(report["probable_unit"], "mm")
        self.assertGreater(report["volume_mm3"], 0)

    def test_a_tooth(self):
        out = self.folder / "incisor"
        done = self.ok("make", "tooth", "--kind", "upper-incisor", "--faces", "3001", "--part-faces", "2000", "--out",
                       out)
        self.assertIn("outer", done.stdout)
        self.assertEqual(done.stderr, "")
        self.assertEqual(sorted(p.name for p in out.iterdir()),
                         ["caries.stl", "case.toml", "dentine.stl", "enamel.stl", "outer.stl", "pulp.stl"])
        outer = self.info(out / "outer.stl")
        self.expect_solid(outer)
        self.assertEqual((outer["faces"], outer["genus"], outer["shells"]), (3002, 0, 1))
        for part in ("enamel", "dentine", "pulp", "caries"):
            report = self.info(out / f"{part}.stl")
            self.assertEqual(report["faces"], 2000)
            self.assertTrue(report["closed"], part)
            self.assertLess(report["volume_mm3"], outer["volume_mm3"])
        toml = (out / "case.toml").read_text()
        for line in ("fdi = 11", "kind = ", "upper-incisor", "buccal = ", "+y"):
            self.assertIn(line, toml)

    def test_burs(self):
        for shape, diameter, length in (("round", 1.0, 1.0), ("inverted-cone", 1.2, 1.4), ("cylinder-flat", 1.0, 4.0),
                                        ("cylinder-round", 1.0, 4.0), ("taper-flat", 1.6, 4.0), ("taper-round", 1.6, 4.0),
                                        ("pear", 0.8, 1.5), ("flame", 1.2, 5.0), ("torpedo", 1.2, 6.0),
                                        ("wheel", 3.0, 1.0)):
            with self.subTest(shape=shape):
                path = self.folder / f"{shape}.stl"
                self.ok("make", "bur", "--shape", shape, "--diameter", diameter, "--length", length, "--out", path)
                report = self.info(path)
                self.expect_solid(report)
                low, size = report["box_min_mm"], report["box_size_mm"]
                self.assertAlmostEqual(low[2], 0.0, delta=1e-6, msg="tip at the origin")
                self.assertAlmostEqual(size[2], length, delta=2e-3)
                self.assertAlmostEqual(max(size[:2]), diameter, delta=0.02 * diameter)
                self.assertLess(report["volume_mm3"], math.pi / 4 * diameter ** 2 * length * 1.001)

    def test_the_papers_tool_and_plane(self):
        bur, turbine, plane, slab = (self.folder / f"{name}.stl" for name in ("bur", "turbine", "plane", "slab"))
        self.ok("make", "bur", "--name", "paper", "--out", bur)
        self.ok("make", "turbine", "--out", turbine)
        self.ok("make", "plane", "--out", plane)
        self.ok("make", "plane", "--slab", "--out", slab)
        self.assertEqual(self.info(bur)["vertices"], 170)
        report = self.info(turbine)
        self.assertAlmostEqual(report["faces"] / 20988, 1, delta=0.01)
        report = self.info(plane)
        self.assertEqual((report["vertices"], report["faces"], report["open_edges"]), (169, 288, 48))
        self.assertFalse(report["closed"])
        self.expect_solid(self.info(slab))

    def test_ply_keeps_more_than_stl(self):
        self.ok("make", "bur", "--name", "330", "--out", self.folder / "a.ply")
        self.ok("make", "bur", "--name", "330", "--out", self.folder / "a.stl")
        ply, stl = self.info(self.folder / "a.ply"), self.info(self.folder / "a.stl")
        self.assertEqual(ply["faces"], stl["faces"])
        self.assertAlmostEqual(ply["volume_mm3"], stl["volume_mm3"], delta=1e-5)

    def test_info_of_known_shapes(self):
        report = self.info(write_stl(self.folder / "box.stl", box((0, 0, 0), (6, 7, 8))))
        self.expect_solid(report)
        self.assertEqual((report["vertices"], report["faces"], report["edges"], report["genus"]), (8, 12, 18, 0))
        self.assertAlmostEqual(report["volume_mm3"], 336, delta=1e-9)
        self.assertAlmostEqual(report["area_mm2"], 292, delta=1e-9)
        self.assertEqual(report["box_size_mm"], [6, 7, 8])
        text = self.ok("mesh", "info", self.folder / "box.stl").stdout
        self.assertIn("336", text)

    def test_a_unit_is_guessed_named_and_taken(self):
        metres = write_stl(self.folder / "metres.stl", ball(0.00635, 8))
        self.assertIn("--unit m makes it", self.ok("mesh", "info", metres).stdout)
        report = json.loads(self.ok("mesh", "info", metres, "--unit", "m", "--json").stdout)
        self.assertEqual(report["probable_unit"], "mm")
        self.assertAlmostEqual(report["box_size_mm"][2], 12.7, delta=1e-3)
        twice = json.loads(self.ok("mesh", "info", metres, "--unit", "m", "--scale", "2", "--json").stdout)
        self.assertAlmostEqual(twice["box_size_mm"][2], 25.4, delta=1e-3)
        poses = "0,0,6.85,1,0,0,0\n"
        felt = self.ok("probe", "--tooth", metres, "--unit", "m", "--bur", "round-4", "--poses", "-", stdin=poses)
        self.assertAlmostEqual(float(felt.stdout.splitlines()[1].split(",")[0]), -0.5, delta=0.01)
        bur, tiny = self.folder / "bur.stl", self.folder / "bur-in-metres.stl"
        self.ok("make", "bur", "--name", "round-4", "--out", bur)
        self.ok("mesh", "repair", bur, tiny, "--scale", "0.001")
        with_bur = [self.ok("probe", "--tooth", metres, "--unit", "m", "--bur", *b, "--poses", "-", stdin=poses).stdout.splitlines()[1].split(",")[0]
                    for b in ((bur,), (tiny, "--bur-unit", "m"))]
        self.assertAlmostEqual(float(with_bur[0]), float(with_bur[1]), delta=1e-4)
        self.refused("probe", "--tooth", metres, "--unit", "m", "--bur", tiny, "--poses", "-", stdin=poses, mentions=["bur"])
        mended = self.folder / "mended.stl"
        self.ok("mesh", "repair", metres, mended, "--unit", "m")
        pictures = [self.folder / f"{name}.png" for name in ("metres", "mended")]
        self.ok("picture", metres, "--unit", "m", "--size", "64x64", "--out", pictures[0])
        self.ok("picture", mended, "--size", "64x64", "--out", pictures[1])
        self.assertEqual(*(p.read_bytes() for p in pictures))
        self.expect_solid(self.info(mended))
        self.assertAlmostEqual(self.info(mended)["box_size_mm"][2], 12.7, delta=1e-3)
        self.ok("case", "new", "--out", self.folder / "case", "--part", f"enamel={metres}", "--unit", "m")
        self.refused("run", "--tooth", metres, "--unit", "m", "--motion", "plunge", "--out", self.folder / "o",
                     mentions=["mesh repair"])

    def test_repair_mends_a_scan(self):
        # Holes, faces turned over, a speck of debris: as from a scanner.
        facets = ball(6, 12)
        rough = facets[40:-1]
        rough[100:140] = [f[::-1] for f in rough[100:140]]
        rough += ball(0.05, 2, (20, 0, 0))
        scan, mended = write_stl(self.folder / "scan.stl", rough), self.folder / "mended.stl"
        before = self.info(scan)
        self.assertFalse(before["closed"])
        self.assertEqual(before["shells"], 2)
        done = json.loads(self.ok("mesh", "repair", scan, mended, "--json").stdout)
        self.assertEqual(done["dropped_shells"], 1)
        self.assertGreaterEqual(done["closed_holes"], 2)
        self.assertGreaterEqual(done["turned_faces"], 40)
        after = self.info(mended)
        self.expect_solid(after)
        self.assertEqual((after["shells"], after["genus"]), (1, 0))
        whole = self.info(write_stl(self.folder / "whole.stl", facets))["volume_mm3"]
        self.assertAlmostEqual(after["volume_mm3"] / whole, 1, delta=0.05)
        # A mended mesh is felt.
        self.ok("probe", "--tooth", mended, "--bur", "round-4", "--poses", "-", stdin="0,0,9,1,0,0,0\n")

    def test_repair_keeps_the_colours_of_a_scan(self):
        def halves(place):
            return (190, 30, 30) if place[0] < 0 else (30, 170, 40)

        # Its left cap is missing.
        open_scan = [facet for facet in ball(4, 12) if sum(corner[0] for corner in facet) / 3 > -3.2]
        scan = write_coloured_ply(self.folder / "scan.ply", open_scan, halves)
        self.assertIn("at its vertices", self.ok("mesh", "info", scan).stdout)
        self.assertTrue(json.loads(self.ok("mesh", "info", scan, "--json").stdout)["colours"])
        self.assertIn("kept", self.ok("mesh", "repair", scan, self.folder / "mended.ply").stdout)
        mended = json.loads(self.ok("mesh", "info", self.folder / "mended.ply", "--json").stdout)
        self.assertTrue(mended["colours"])
        self.assertEqual(mended["open_edges"], 0)
        colours = vertex_colours(self.folder / "mended.ply")
        self.assertEqual(colours, {place: halves(place) for place in colours})
        self.assertIn("an STL holds none", self.ok("mesh", "repair", scan, self.folder / "mended.stl").stdout)
        self.assertFalse(json.loads(self.ok("mesh", "info", self.folder / "mended.stl", "--json").stdout)["colours"])
        # On a base, walls and floor have the border's.
        self.ok("mesh", "repair", scan, self.folder / "base.ply", "--base")
        colours = vertex_colours(self.folder / "base.ply")
        self.assertTrue(all(colour == (190, 30, 30) for place, colour in colours.items() if place[0] < -3.3))
        self.assertTrue(any(place[0] < -3.3 for place in colours))

    def test_an_open_arch_is_closed_or_stood_on_a_base(self):
        rng = random.Random(20261130)
        scan = write_stl(self.folder / "arch.stl", open_arch(rng))
        before = self.info(scan)
        self.assertFalse(before["closed"])
        self.assertEqual(before["repair"], {"possible": True, "base": False, "reason": None})
        self.assertIn("handpiece mesh repair mends it", self.ok("mesh", "info", scan).stdout)
        volumes = []
        for name, options in (("closed", ()), ("model", ("--base",)), ("deep", ("--base", "--base-depth", "8"))):
            with self.subTest(name):
                mended = self.folder / f"{name}.stl"
                done = json.loads(self.ok("mesh", "repair", scan, mended, *options, "--json").stdout)
                self.assertEqual(done["crossing_faces"], 0)
                self.assertEqual(len(done["bases"]), 1 if options else 0)
                report = self.info(mended)
                self.expect_solid(report)
                self.assertIsNone(report["repair"])
                self.ok("case", "new", "--out", self.folder / f"case-{name}", "--part", f"enamel={mended}")
                volumes.append(report["volume_mm3"])
                # Every place of the scan is there, to the bit.
                data = [path.read_bytes()[84:] for path in (scan, mended)]
                given, after = ({file[at + 12 + 12 * k:at + 24 + 12 * k] for at in range(0, len(file), 50) for k in range(3)}
                                for file in data)
                self.assertLessEqual(given, after)
        self.assertLess(volumes[0], volumes[1])
        self.assertLess(volumes[1], volumes[2])
        self.assertAlmostEqual(done["bases"][0]["depth_mm"], 8)
        self.assertIn("base", self.ok("mesh", "repair", scan, self.folder / "again.stl", "--base").stdout)

    def test_what_cannot_be_mended_is_refused_once_and_info_does_not_promise_it(self):
        # A cup with a rod that looks out of it; two balls that overlap.
        cup = [f for f in ball(5, 8) if sum(p[2] for p in f) > 0]
        for name, facets, reason in (("cup", cup + box((-1, -1, -7), (1.1, 1.2, 2)), "a hole cannot be closed"),
                                     ("balls", ball(5, 6) + ball(4, 6, (3, 0.2, 0.1)), "the surface crosses itself")):
            with self.subTest(name):
                path = write_stl(self.folder / f"{name}.stl", facets)
                self.refused("mesh", "repair", path, self.folder / "out.stl", mentions=[f"{name}.stl", reason, "editor"])
                self.assertFalse((self.folder / "out.stl").exists())
                told = self.info(path)["repair"]
                self.assertFalse(told["possible"])
                self.assertIn(reason, told["reason"])
                self.assertIn(f"handpiece mesh repair refuses it: {reason}", self.ok("mesh", "info", path).stdout)
        self.refused("mesh", "repair", write_stl(self.folder / "box.stl", box((0, 0, 0), (6, 7, 8))),
                     self.folder / "out.stl", "--base", mentions=["closed", "--base"])

    def test_a_lying_header_is_told(self):
        path = write_stl(self.folder / "box.stl", box((0, 0, 0), (6, 7, 8)))
        data = bytearray(path.read_bytes())
        data[80] = 3
        path.write_bytes(data)
        report = self.info(path)
        self.assertEqual(report["faces"], 12)
        self.assertTrue(report["notes"])


if __name__ == "__main__":
    unittest.main()
