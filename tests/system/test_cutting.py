# SPDX-License-Identifier: Apache-2.0
"""A tooth that is cut, from the command line: what is left, what is recorded, and that it can be cut again."""

import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import unittest

try:
    import h5py
    import numpy
except ImportError:  # another Python than Debian's, which has python3-h5py
    if sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
    print("skipped: there is no h5py (python3-h5py)")
    sys.exit(0)

from support import HANDPIECE, SystemTest, ball, box, rows_of, run, write_stl

REMOVED = ["removed_enamel_mm3", "removed_dentine_mm3", "removed_caries_mm3", "removed_pulp_mm3"]
OUTPUTS = ["attempt", "cut", "cut.stl", "depth.svg", "feed.svg", "force.svg", "removed.svg", "rotor.svg",
           "session.h5", "speed.svg", "summary.json", "trace.csv"]
TOP, DEPTH, RADIUS, LENGTH = 4.0, 0.8, 0.5, 2.0  # of the block and of the groove in it
DEVICE_LIMIT_N = 3.3


class Cutting(SystemTest):
    def setUp(self):
        super().setUp()
        self.block = write_stl(self.folder / "block.stl", box((-3, -2, 0), (3, 2, TOP)))
        # Down, along x, and out: the bur's tip.
        self.groove = self.folder / "groove.csv"
        z, x = TOP - DEPTH, LENGTH / 2
        self.groove.write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n"
                               f"0,{-x},0,{TOP + 0.4},1,0,0,0\n0.2,{-x},0,{z},1,0,0,0\n"
                               f"0.7,{x},0,{z},1,0,0,0\n0.9,{x},0,{TOP + 0.4},1,0,0,0\n")

    def case(self):
        """A block of enamel over dentine, with a core of decay."""
        parts = {"outer": ((-3, -2, 0), (3, 2, TOP)), "enamel": ((-3, -2, 3.4), (3, 2, TOP)),
                 "dentine": ((-3, -2, 0), (3, 2, 3.4)), "caries": ((-0.3, -0.3, 2.5), (0.3, 0.3, 3.2))}
        for name, corners in parts.items():
            write_stl(self.folder / f"{name}.stl", box(*corners))
        out = self.folder / "case"
        self.ok("case", "new", "--out", out, "--outer", self.folder / "outer.stl",
                *[word for t in ("enamel", "dentine", "caries") for word in ("--part", f"{t}={self.folder}/{t}.stl")])
        return out

    def cut(self, out, *arguments, tooth=None, bur="cylinder-round:1.0x4.0", voxel="100"):
        """The folder that a cut has left, and its summary."""
        done = self.ok("run", "--case", tooth or self.block, "--bur", bur, "--voxel", voxel, "--json", "--out",
                       self.folder / out, *arguments)
        return self.folder / out, json.loads(done.stdout)

    def grooved(self, out, *arguments, **options):
        return self.cut(out, "--full-removal", "--motion", self.groove, *arguments, **options)

    def test_a_plunge_through_enamel_into_dentine(self):
        case = self.case()
        before = self.listing()
        out, summary = self.cut("out", "--motion", "plunge", "--depth", "1.5", "--dwell", "2", "--code", "S-07",
                                tooth=case, bur="330", voxel="50")
        self.assertEqual({k: v for k, v in self.listing().items() if not (k + "/").startswith("out/")}, before,
                         "cutting never alters a case")
        self.assertEqual(sorted(p.name for p in out.iterdir()), OUTPUTS)
        rows = rows_of((out / "trace.csv").read_text())
        self.assertEqual(list(rows[0])[-5:], ["rpm", *REMOVED])
        for name in REMOVED:
            volumes = [float(row[name]) for row in rows]
            self.assertEqual(volumes, sorted(volumes), "what is gone stays gone")
        for name in ("enamel", "dentine", "caries"):
            self.assertGreater(summary["removed_mm3"][name], 0.01)
            self.assertAlmostEqual(float(rows[-1][f"removed_{name}_mm3"]), summary["removed_mm3"][name], delta=1e-8)
        # Enamel goes first, then dentine, then the decay in it.
        first = [next(i for i, row in enumerate(rows) if float(row[f"removed_{name}_mm3"]) > 1e-3)
                 for name in ("enamel", "dentine", "caries")]
        self.assertEqual(first, sorted(first))
        cutting = [row for row in rows if int(row["flags"]) & 32]
        self.assertEqual(len(cutting), summary["cutting_ticks"])
        self.assertLess(min(float(row["rpm"]) for row in cutting), 0.99 * max(float(row["rpm"]) for row in cutting),
                        "load slows the rotor")
        for row in rows:
            self.assertLessEqual(math.hypot(*(float(row[f]) for f in ("fx_n", "fy_n", "fz_n"))), DEVICE_LIMIT_N + 1e-6)

        mesh = json.loads(self.ok("mesh", "info", out / "cut.stl", "--json").stdout)
        self.assertTrue(mesh["closed"] and mesh["oriented"])
        removed = sum(summary["removed_mm3"].values())
        self.assertAlmostEqual(mesh["volume_mm3"] / (6 * 4 * TOP - removed), 1, delta=0.003)
        self.assertAlmostEqual(mesh["volume_mm3"], summary["cut_stl_mm3"], delta=1e-3)
        info = json.loads(self.ok("case", "info", out / "cut", "--json").stdout)
        self.assertEqual([part["tissue"] for part in info["parts"]], ["enamel", "dentine", "caries"])
        self.ok("case", "check", out / "cut")
        # What was left can be felt: the bur now goes deeper before it touches.
        depths = [rows_of(self.ok("probe", "--tooth", tooth, "--bur", "330", "--poses", "-",
                                  stdin=f"0,0,{TOP - 0.5},1,0,0,0\n").stdout)[0]["depth_mm"]
                  for tooth in (case, out / "cut.stl")]
        self.assertAlmostEqual(float(depths[0]), 0.5, delta=1e-6)
        self.assertLess(float(depths[1]), 0.05)

        with h5py.File(out / "session.h5", "r") as file:
            self.assertEqual(file.attrs["code"].decode(), "S-07")
            self.assertEqual(int(file["closed"][()]), 1)
            self.assertEqual(len(file["samples/tick"]), len(rows))
            self.assertAlmostEqual(float(file["samples/removed"][-1].sum()), removed, delta=4 * 2.0**-16)
            self.assertTrue((numpy.abs(file["samples/position"][:, 2] * 2.0**-20
                                       - [float(row["z_mm"]) for row in rows]) < 2e-6).all())
            names = list(file["events"]["name"])
            for name in (b"stroke begin", b"first dentine", b"stroke end", b"end"):
                self.assertIn(name, names)
            for private in (b"handpiece-system", os.path.expanduser("~").encode() + b"/"):
                self.assertNotIn(private, (out / "session.h5").read_bytes(), "no folder of this machine")

    def test_a_still_bur_cuts_nothing(self):
        _, summary = self.cut("still", "--motion", "plunge", "--depth", "0.5", "--dwell", "0.5", "--pedal", "0")
        self.assertEqual(sum(summary["removed_mm3"].values()), 0)
        self.assertGreater(summary["contact_s"], 0.3)
        self.assertGreater(summary["peak_force_n"], 0.1)
        self.assertEqual(summary["cutting_ticks"], 0)

    def test_the_groove_is_what_the_bur_sweeps(self):
        # A half disc under walls, swept along x; a round-ended plunge at its ends.
        section = math.pi * RADIUS**2 / 2 + 2 * RADIUS * (DEPTH - RADIUS)
        plunge = 2 / 3 * math.pi * RADIUS**3 + math.pi * RADIUS**2 * (DEPTH - RADIUS)
        swept = section * LENGTH + plunge
        for voxel in ("100", "50"):
            out, summary = self.grooved(f"groove{voxel}", voxel=voxel)
            self.assertAlmostEqual(summary["removed_mm3"]["enamel"] / swept, 1, delta=0.003)
            mesh = json.loads(self.ok("mesh", "info", out / "cut.stl", "--json").stdout)
            self.assertAlmostEqual(mesh["volume_mm3"] / (6 * 4 * TOP - swept), 1, delta=0.003)
            self.assertEqual((mesh["closed"], mesh["shells"]), (True, 1))
        # Felt in the groove that it has made, the bur just touches: nothing of what it swept is left.
        poses = "x,y,z,qw,qx,qy,qz\n" + "".join(f"{x},0,{TOP - DEPTH},1,0,0,0\n" for x in (-0.9, -0.33, 0, 0.512, 0.9))
        rows = rows_of(self.ok("probe", "--tooth", out / "cut.stl", "--bur", "cylinder-round:1.0x4.0", "--poses", "-",
                               stdin=poses).stdout)
        for row in rows:
            self.assertLess(abs(float(row["depth_mm"])), 0.005, row)

    def test_replay_cuts_the_same_tooth(self):
        hashes = {}
        for name, arguments in (("plain", []), ("undone", ["--undo-at", "0.95"]), ("reset", ["--reset-at", "0.95"]),
                                ("redone", ["--undo-at", "0.95", "--redo-at", "1.0"])):
            out, summary = self.grooved(name, *arguments)
            hashes[name] = summary["state_hash"]
            self.assertEqual(summary["undo_steps_taken"], len(arguments) // 2)
            replay = json.loads(self.ok("replay", out / "session.h5", "--json").stdout)
            self.assertEqual((replay["state_hash"], replay["matches"], replay["differing_ticks"]),
                             (summary["state_hash"], True, 0), name)
            self.assertTrue(replay["complete"])
        self.assertEqual(hashes["plain"], hashes["redone"])
        self.assertEqual(hashes["undone"], hashes["reset"])
        self.assertNotEqual(hashes["plain"], hashes["undone"])
        self.assertEqual(self.grooved("one", "--threads", "1", "--no-cache")[1]["state_hash"], hashes["plain"])
        self.assertEqual(self.grooved("two", "--threads", "2", "--no-cache")[1]["state_hash"], hashes["plain"])
        self.assertIn("matches true", self.ok("replay", self.folder / "plain" / "session.h5", "--no-cache").stdout)

        events = rows_of(self.ok("export", self.folder / "redone" / "session.h5", "--csv", "--events").stdout)
        self.assertEqual([e["name"] for e in events if e["name"] in ("undo", "redo")], ["undo", "redo"])

    def test_an_attempt_goes_on_where_it_was(self):
        first, before = self.cut("first", "--motion", "plunge", "--depth", "0.5", "--dwell", "0.5", "--code", "S-07")
        self.ok("case", "pack", first / "attempt", self.folder / "first.handpiece")
        for name, tooth in (("still", first / "attempt"), ("packed", self.folder / "first.handpiece")):
            _, still = self.cut(name, "--motion", "hold", "--duration", "0.1", "--pedal", "0", tooth=tooth)
            self.assertEqual(still["state_hash"], before["state_hash"])
            self.assertEqual(still["removed_mm3"], before["removed_mm3"])
        more, after = self.grooved("more", tooth=first / "attempt")
        self.assertGreater(after["removed_mm3"]["enamel"], before["removed_mm3"]["enamel"] + 1)
        replay = json.loads(self.ok("replay", more / "session.h5", "--json").stdout)
        self.assertEqual((replay["state_hash"], replay["matches"]), (after["state_hash"], True))
        self.refused("run", "--case", first / "attempt", "--motion", "plunge", "--voxel", "50", "--out",
                     self.folder / "other", mentions=["100 um", "--voxel 100"])
        write_stl(self.block, box((-3, -2, 0), (3, 2, TOP + 0.1)))
        self.refused("run", "--case", first / "attempt", "--motion", "plunge", "--voxel", "100", "--out",
                     self.folder / "other", mentions=["another"])

    def test_a_trembling_hand_repeats_by_its_seed(self):
        plunge = ["--motion", "plunge", "--depth", "0.4", "--dwell", "0.5"]
        _, still = self.cut("a", *plunge)
        _, first = self.cut("b", *plunge, "--tremor", "50", "--seed", "7")
        _, again = self.cut("c", *plunge, "--tremor", "50", "--seed", "7")
        _, other = self.cut("d", *plunge, "--tremor", "50", "--seed", "8")
        self.assertEqual(first["state_hash"], again["state_hash"])
        self.assertEqual(len({summary["state_hash"] for summary in (still, first, other)}), 3)

    def test_own_tissues_and_abilities(self):
        (self.folder / "tissues.toml").write_text("format = 1\n[enamel]\ncutting = 0.0\n")
        _, hard = self.cut("hard", "--motion", "plunge", "--depth", "0.4", "--dwell", "0.5", "--tissues",
                           self.folder / "tissues.toml")
        self.assertEqual(hard["removed_mm3"]["enamel"], 0)
        (self.folder / "burs.toml").write_text(
            'format = 1\n[ability.blunt]\ncutting = 0.05\n[[bur]]\nname = "worn"\nshape = "round"\ndiameter_mm = 1.2\n'
            'length_mm = 1.2\nability = "blunt"\n')
        options = ["--motion", "plunge", "--depth", "0.4", "--dwell", "0.5", "--abilities", self.folder / "burs.toml"]
        _, worn = self.cut("worn", *options, bur="worn")
        _, sharp = self.cut("sharp", *options, "--ability", "carbide", bur="worn")
        self.assertEqual(worn["ability"], "blunt")
        self.assertLess(worn["removed_mm3"]["enamel"], 0.7 * sharp["removed_mm3"]["enamel"])
        self.assertGreater(worn["removed_mm3"]["enamel"], 0)

    def test_export_and_pack(self):
        out, summary = self.grooved("out")
        rows = rows_of(self.ok("export", out / "session.h5", "--csv").stdout)
        self.assertEqual(len(rows), summary["ticks"])
        trace = rows_of((out / "trace.csv").read_text())
        for i in (0, 400, len(rows) - 1):
            for theirs, ours in (("x_mm", "x_mm"), ("z_mm", "z_mm"), ("fz_N", "fz_n"), ("depth_mm", "depth_mm"),
                                 ("removed_enamel_mm3", "removed_enamel_mm3")):
                self.assertAlmostEqual(float(rows[i][theirs]), float(trace[i][ours]), delta=1e-3, msg=theirs)
        path = self.folder / "events.csv"
        self.ok("export", out / "session.h5", "--csv", "--events", "--out", path)
        events = rows_of(path.read_text())
        self.assertEqual(events[-1]["name"], "end")
        self.assertEqual(json.loads(events[-1]["text"])["state_hash"], summary["state_hash"])
        self.ok("case", "pack", out / "cut", self.folder / "cut.handpiece")
        self.ok("case", "check", self.folder / "cut.handpiece")
        _, felt = self.cut("again", "--motion", "plunge", "--depth", "0.3", "--dwell", "0.2", "--at", "0", "1",
                           tooth=self.folder / "cut.handpiece")
        self.assertAlmostEqual(felt["outer_mm3"], summary["cut_stl_mm3"], delta=1e-6)

    def test_each_tissue_is_exported_as_the_session_leaves_it(self):
        out, summary = self.grooved("layers", tooth=self.case())
        self.assertGreater(summary["removed_mm3"]["enamel"], 0)
        left = {}
        # The attempt that was saved with the session is the same tooth.
        for source in (out / "session.h5", out / "attempt"):
            folder = self.folder / f"tissues-{source.name}"
            self.ok("export", source, "--stl", "--out", folder)
            for tissue, whole in (("enamel", 6 * 4 * (TOP - 3.4)), ("dentine", 6 * 4 * 3.4 - 0.6 * 0.6 * 0.7)):
                mesh = json.loads(self.ok("mesh", "info", folder / f"{tissue}.stl", "--json").stdout)
                self.assertTrue(mesh["closed"] and mesh["oriented"])
                rest = whole - summary["removed_mm3"].get(tissue, 0)
                self.assertAlmostEqual(mesh["volume_mm3"], rest, delta=0.03 * whole, msg=tissue)
            left[source.name] = [(folder / f"{tissue}.stl").read_bytes() for tissue in ("enamel", "dentine")]
        self.assertEqual(left["session.h5"], left["attempt"])
        self.refused("export", out / "session.h5", "--stl", mentions=["--out"])
        self.refused("export", out / "session.h5", "--stl", "--csv", "--out", self.folder / "both", mentions=["--stl"])

    def test_excavation_waits_for_the_bur_and_stops_over_the_pulp(self):
        parts = {"outer": box((-3, -3, 0), (3, 3, TOP)), "dentine": box((-3, -3, 0), (3, 3, TOP)),
                 "caries": ball(0.75, centre=(0, 0, TOP - 0.8)), "pulp": box((-1, -1, 1), (1, 1, 2.1))}
        for name, facets in parts.items():
            write_stl(self.folder / f"{name}.stl", facets)
        case = self.folder / "decayed"
        self.ok("case", "new", "--out", case, "--outer", self.folder / "outer.stl",
                *[word for t in ("dentine", "caries", "pulp") for word in ("--part", f"{t}={self.folder}/{t}.stl")])
        done = self.ok("run", "--case", case, "--bur", "round-4", "--drive", "low-speed", "--motion", "excavate",
                       "--voxel", "100", "--out", self.folder / "excavated")
        lesion = re.search(r"lesion .*: ([0-9.]+) of ([0-9.]+) mm3 .* ([0-9.]+) mm3 of sound tooth", done.stdout)
        self.assertTrue(lesion, done.stdout)
        self.assertIn("mm short of the pulp", done.stdout)
        over = float(re.search(r"pulp +([0-9.]+) mm of dentine remain over it", done.stdout).group(1))
        self.assertGreaterEqual(over, 0.45)
        summary = json.loads((self.folder / "excavated/summary.json").read_text())
        told, = summary["lesions"]
        may_go = told["decay_mm3"] - told["left_for_the_pulp_mm3"]
        self.assertGreater(told["taken_decay_mm3"], 0.89 * may_go)  # the rest are ridges between places
        self.assertNotIn("pulp", [t for t, mm3 in summary["removed_mm3"].items() if mm3 > 0])

    def test_bad_input_is_one_message(self):
        def bad(*arguments, tooth=None, motion="plunge", **options):
            return self.refused("run", "--case", tooth or self.block, "--no-cache", "--motion", motion, "--out",
                                self.folder / "result", *arguments, **options)

        case = self.case()
        os.remove(case / "dentine.stl")
        bad(tooth=case, mentions=["dentine.stl", "no such file"])
        toml = self.folder / "own.toml"
        toml.write_text("format = 1\n[cheese]\ncutting = 0.1\n")
        bad("--tissues", toml, mentions=["own.toml", "cheese", "line 2"])
        toml.write_text("format = 1\n[enamel]\ncutting = -1\n")
        bad("--tissues", toml, mentions=["own.toml", "cutting of enamel is -1"])
        toml.write_text('format = 1\n[[bur]]\nname = "none"\nshape = "round"\ndiameter_mm = 1\nlength_mm = 0\n')
        bad("--abilities", toml, "--bur", "none", mentions=["own.toml", "none", "0 mm"])
        toml.write_text("format = 1\n[ability.odd]\ncutting = -2\n")
        bad("--abilities", toml, "--ability", "odd", mentions=["own.toml", "cutting"])
        bad("--abilities", self.folder / "gone.toml", mentions=["gone.toml", "no such file"])
        bad("--drive", "steam", mentions=["steam", "turbine"])
        bad("--ability", "magic", mentions=["magic", "carbide"])
        bad("--method", "hull", mentions=["hull"])
        bad("--code", "Jane Doe", mentions=["code"])
        bad("--bur", "round-8", motion="class-one", mentions=["2.30 mm"])
        bad(motion="excavate", mentions=["no carious tissue"])
        self.assertEqual(run("run", "--case", self.block, "--motion", "plunge", "--pedal", "2", "--out",
                             self.folder / "result").returncode, 2)

    def test_bad_sessions_are_one_message(self):
        out, _ = self.grooved("out")
        whole = (out / "session.h5").read_bytes()
        cut_off = self.folder / "cut-off.h5"
        for share in (0.1, 0.5, 0.9):
            cut_off.write_bytes(whole[:int(share * len(whole))])
            self.refused("replay", cut_off, mentions=["cut-off.h5"])
            self.refused("export", cut_off, "--csv", mentions=["cut-off.h5"])
        newer = self.folder / "newer.h5"
        newer.write_bytes(whole)
        with h5py.File(newer, "r+") as file:
            file.attrs.modify("format_version", numpy.int32(99))
        self.refused("replay", newer, mentions=["newer", "format 99"])
        self.refused("replay", self.block, mentions=["block.stl", "no session"])
        other = self.folder / "other.h5"
        other.write_bytes(whole)
        with h5py.File(other, "r+") as file:  # another bur would have cut another groove
            settings = json.loads(file["settings"][()])
            settings["outline_mm"] = [[0.8 * x if abs(x) < 3 else x for x in piece] for piece in settings["outline_mm"]]
            text = json.dumps(settings)
            del file["settings"]
            file["settings"] = numpy.bytes_(text)
        done = run("replay", other)
        self.assertEqual(done.returncode, 1)
        self.assertIn("matches false", done.stdout)

    def test_a_full_disk_while_recording(self):
        """Files may grow to 400 kB only: one clear word, and what was recorded opens."""
        def limited():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000))

        out = self.folder / "full"
        done = subprocess.run([HANDPIECE, "run", "--case", self.block, "--bur", "cylinder-round:1.0x4.0", "--voxel",
                               "100", "--no-cache", "--full-removal", "--motion", self.groove, "--out", out],
                              text=True, preexec_fn=limited, capture_output=True, timeout=1200, check=False)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("cannot be written", done.stderr)
        self.assertEqual([p.name for p in out.iterdir()], ["session.h5"], "nothing half-written")
        rows = rows_of(self.ok("export", out / "session.h5", "--csv").stdout)
        self.assertGreater(len(rows), 300)
        self.assertGreater(float(rows[-1]["removed_enamel_mm3"]), 0.1)
        with h5py.File(out / "session.h5", "r") as file:
            self.assertEqual(len(file["samples/tick"]), len(rows))


if __name__ == "__main__":
    unittest.main()
