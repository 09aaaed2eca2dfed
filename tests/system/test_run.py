# SPDX-License-Identifier: Apache-2.0
"""The loop from end to end: a simulated hand, a bur, a tooth, a trace."""

import json
import math
import unittest

from support import OWN_LAW, OWN_METHOD, SystemTest, ball, box, rows_of, run, write_stl

FIRST_COLUMNS = ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,vx_mm_s,vy_mm_s,vz_mm_s,fx_n,fy_n,fz_n,depth_mm,work_us,late_us")
DEVICE_LIMIT_N = 3.3


def without_times(trace):
    return [[cell for name, cell in row.items() if name not in ("work_us", "late_us")] for row in trace]


def number(row, *names):
    return [float(row[name]) for name in names]


class Run(SystemTest):
    def setUp(self):
        super().setUp()
        self.tooth = write_stl(self.folder / "tooth.stl", ball(5, 24))

    def go(self, out, *arguments, tooth=None, **options):
        done = self.ok("run", "--tooth", tooth or self.tooth, "--bur", "round-4", "--out", self.folder / out,
                       *arguments, **options)
        text = (self.folder / out / "trace.csv").read_text()
        self.assertTrue(text.startswith(FIRST_COLUMNS + ","), text.splitlines()[0])
        return rows_of(text), done

    def check_forces(self, trace):
        for row in trace:
            self.assertLessEqual(math.hypot(*number(row, "fx_n", "fy_n", "fz_n")), DEVICE_LIMIT_N + 1e-6)
            self.assertTrue(all(math.isfinite(float(v)) for k, v in row.items() if k != "tissue"))

    def test_a_drop_is_felt_and_repeats(self):
        first, done = self.go("first", "--motion", "drop")
        second, _ = self.go("second", "--motion", "drop", "--no-cache", "--threads", "1")
        self.assertEqual(without_times(first), without_times(second))
        self.check_forces(first)
        self.assertEqual(sorted(p.name for p in (self.folder / "first").iterdir()),
                         ["depth.svg", "force.svg", "speed.svg", "summary.json", "trace.csv"])
        for plot in ("depth", "speed", "force"):
            svg = (self.folder / "first" / f"{plot}.svg").read_text()
            self.assertTrue(svg.lstrip().startswith("<") and "</svg>" in svg)
        self.assertIn("scheduling", done.stdout)

        times = [float(row["t_s"]) for row in first]
        self.assertTrue(all(abs(b - a - 1e-3) < 1e-9 for a, b in zip(times, times[1:])), "a row every millisecond")
        apart = [row for row in first if float(row["depth_mm"]) < -0.1]
        self.assertTrue(apart)
        for row in apart:
            # Friction-free air: no force before the surface is near.
            self.assertEqual(number(row, "fx_n", "fy_n", "fz_n"), [0, 0, 0])
        last = first[-1]
        self.assertGreater(float(last["fz_n"]), 0.3, "the tooth pushes back up")
        self.assertLess(abs(float(last["fx_n"])), 0.2)
        # The proxy, which the eye sees, stays on the surface: the tip at the pole of the sphere.
        self.assertAlmostEqual(float(last["proxy_z_mm"]), 5.0, delta=0.05)
        self.assertGreaterEqual(float(last["depth_mm"]), 0.0)
        self.assertEqual(last["tissue"], "enamel")

        summary = json.loads((self.folder / "first" / "summary.json").read_text())
        self.assertEqual(summary["ticks"], len(first))
        self.assertAlmostEqual(summary["peak_force_n"],
                               max(math.hypot(*number(r, "fx_n", "fy_n", "fz_n")) for r in first), delta=1e-6)
        self.assertAlmostEqual(summary["deepest_mm"], max(float(r["depth_mm"]) for r in first), delta=1e-6)
        self.assertEqual((summary["fault_ticks"], summary["queue_overflow"]), (0, 0))

    def test_every_motion_rate_and_method(self):
        for out, arguments in (("press", ["--motion", "press", "--rate", "4000", "--load", "3"]),
                               ("slide", ["--motion", "slide"]), ("drag", ["--motion", "drag", "--rate", "2000"]),
                               ("loop", ["--motion", "loop"]),
                               ("stiff", ["--hand", "stiff", "--delay", "1", "--friction", "0.05"]),
                               ("hull", ["--method", "hull", "--force", "penalty"])):
            with self.subTest(run=out):
                trace, done = self.go(out, "--json", *arguments)
                self.check_forces(trace)
                summary = json.loads(done.stdout)
                self.assertEqual(summary["ticks"], len(trace))
                self.assertGreater(max(float(r["depth_mm"]) for r in trace), 0, "touched")
                self.assertGreater(summary["peak_force_n"], 0.05)
                self.assertEqual(summary["fault_ticks"], 0)

    def test_holding_above_is_nothing(self):
        trace, done = self.go("hold", "--motion", "hold", "--duration", "0.2")
        self.assertEqual(len(trace), 201)
        for row in trace:
            self.assertEqual(number(row, "fx_n", "fy_n", "fz_n", "area_mm2"), [0, 0, 0, 0])
            self.assertAlmostEqual(float(row["depth_mm"]), -1.0, delta=0.06)
        self.assertIn("none, nearest", done.stdout)

    def test_a_motion_from_a_file(self):
        path = self.folder / "motion.csv"
        path.write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,8,1,0,0,0\n0.5,0,0,6,1,0,0,0\n")
        trace, _ = self.go("file", "--motion", path, "--hand", "rigid")
        self.assertEqual(len(trace), 501, "both ends")
        self.check_forces(trace)
        # A rigid hand is on its path, to an encoder step and a tick's way.
        for row in trace:
            self.assertAlmostEqual(float(row["true_z_mm"]), 8 - 4 * float(row["t_s"]), delta=0.02)
            self.assertAlmostEqual(float(row["z_mm"]), float(row["true_z_mm"]), delta=0.08)
            self.assertAlmostEqual(float(row["depth_mm"]), 5 - float(row["z_mm"]), delta=1e-6)

    def test_the_whole_hand_is_pushed_by_its_limit_only(self):
        cube = write_stl(self.folder / "cube.stl", box((-4, -4, -8), (4, 4, 4)))
        trace, done = self.go("hard", "--motion", "press", "--hand", "rigid", "--depth", "8", "--speed", "60", "--json",
                              tooth=cube)
        self.check_forces(trace)
        self.assertAlmostEqual(json.loads(done.stdout)["peak_force_n"], DEVICE_LIMIT_N, delta=1e-3)
        self.assertGreater(json.loads(done.stdout)["force_limited_ticks"], 0)

    def test_real_time_says_what_it_got(self):
        trace, done = self.go("now", "--motion", "hold", "--duration", "0.2", "--real-time", "--json")
        summary = json.loads(done.stdout)
        self.assertTrue(summary["real_time"])
        self.assertTrue(summary["scheduling"])
        self.assertEqual(summary["ticks"], len(trace))
        # Every period up to the last tick was served or is counted as missed; a late last tick comes after the end.
        periods = summary["ticks"] + summary["missed_periods"]
        self.assertGreaterEqual(periods, 201)
        self.assertAlmostEqual(float(trace[-1]["t_s"]), (periods - 1) / 1000)

    def test_the_examples_own_method(self):
        """examples/own_method.cpp: the tooth as a table at its highest point."""
        out = self.folder / "mine"
        arguments = ["run", "--method", "mine", "--tooth", self.tooth, "--bur", "round-4", "--motion", "press", "--at",
                     "3", "0", "--out", out]
        self.ok(*arguments, program=OWN_METHOD)
        trace = rows_of((out / "trace.csv").read_text())
        self.check_forces(trace)
        self.assertGreater(max(float(row["fz_n"]) for row in trace), 0.3)
        for row in trace:
            # 3 mm beside the middle the sphere lies 1 mm deeper, the table does not.
            self.assertAlmostEqual(float(row["depth_mm"]), 5 - float(row["z_mm"]), delta=1e-6)
        self.assertIn("mine", run("run", "--help", program=OWN_METHOD).stdout)
        self.assertEqual(run(*arguments).returncode, 1, "the plain program does not know it")

    def test_the_examples_own_law_of_force(self):
        """examples/own_force_law.cpp: stiffness grows from none to all of the tissue's over the first millimetre."""
        out = self.folder / "cushion"
        arguments = ["run", "--force", "cushion", "--tooth", self.tooth, "--bur", "round-4", "--motion", "press",
                     "--slide-friction", "0", "--out", out]
        self.ok(*arguments, program=OWN_LAW)
        trace = rows_of((out / "trace.csv").read_text())
        self.check_forces(trace)
        touching = [row for row in trace if float(row["depth_mm"]) > 0.1]
        self.assertGreater(len(touching), 100)
        for row in touching:
            depth = float(row["depth_mm"])
            self.assertAlmostEqual(float(row["fz_n"]), 0.5 * min(depth, 1.0) * depth, delta=0.01)
        refused = run(*arguments)
        self.assertEqual(refused.returncode, 1, "the plain program does not know it")
        self.assertIn("there are proxy and penalty", refused.stderr)


if __name__ == "__main__":
    unittest.main()
