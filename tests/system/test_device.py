# SPDX-License-Identifier: Apache-2.0
"""Devices from the command line: the list, the fidelity report, the first steps, faults on purpose."""

import json
import os
import subprocess
import unittest

from support import HANDPIECE, SystemTest, ball, rows_of, write_stl

NAMES = ["openhaptics", "forcedimension", "falcon", "haply", "spacemouse", "gamepad", "simulated"]


class Device(SystemTest):
    def setUp(self):
        super().setUp()
        # Nobody's own profiles, no school, no library that this machine may have.
        self.environment = dict(os.environ, XDG_CONFIG_HOME=str(self.folder / "config"), HANDPIECE_SCHOOL_SETTINGS="",
                                HANDPIECE_HD_LIBRARY=str(self.folder / "no-such-libHD.so"))
        self.tooth = write_stl(self.folder / "tooth.stl", ball(5, 16))

    def go(self, *arguments, code=0, stdin=None):
        done = subprocess.run([HANDPIECE, *map(str, arguments)], capture_output=True, text=True, timeout=600,
                              env=self.environment, input=stdin, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        if code == 1:
            lines = done.stderr.strip().splitlines()
            self.assertTrue(lines[-1].startswith("handpiece: "), done.stderr)
        return done

    def cut(self, out, *arguments, **options):
        return self.go("run", "--tooth", self.tooth, "--bur", "round-4", "--voxel", 200, "--no-cache", "--out",
                       self.folder / out, "--json", *arguments, **options)

    def test_the_list_names_all_and_says_what_was_tried(self):
        found = json.loads(self.go("device", "list", "--json").stdout)
        self.assertEqual([d["driver"] for d in found], NAMES)
        simulated = found[-1]
        self.assertTrue(simulated["available"] and simulated["pushes"])
        openhaptics = found[0]
        self.assertFalse(openhaptics["available"])
        self.assertIn("no-such-libHD.so", openhaptics["why"])
        self.assertTrue(openhaptics["remedy"])
        self.assertFalse(any(d["tried_on_hardware"] for d in found))
        text = self.go("device", "list").stdout
        for name in NAMES:
            self.assertIn(name, text)
        self.assertIn("never tried on the hardware", text)

    def test_the_check_reports_on_the_simulated_arm(self):
        page = self.folder / "station.html"
        done = self.go("device", "check", "--device", "simulated", "--duration", 2.5, "--json", "--report", page)
        self.assertIn("pushes upwards with 0.8 N", done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(report["device"]["driver"], "simulated")
        findings = {f["id"]: f for f in report["findings"]}
        for name in ("servo-period", "servo-jitter", "servo-gaps", "tick-lateness", "reading-age", "force-slope",
                     "round-trip-delay", "encoder-step", "rest-noise", "limits", "temperature", "troubles",
                     "calibration", "scheduling", "memory-locked", "cpu-governor", "permission"):
            finding = findings[name]
            self.assertIn(finding["verdict"], ("pass", "warn", "fail", "not-measured"))
            self.assertTrue(finding["value"] and finding["against"], finding)
            if finding["verdict"] in ("warn", "fail"):
                self.assertTrue(finding["remedy"], finding)
        self.assertEqual(report["passed"], all(f["verdict"] != "fail" for f in report["findings"]))
        self.assertAlmostEqual(findings["limits"]["figures"]["max_force_n"], 3.3)
        # However slow this machine is: frames came, and none faster than the motors' clock on the mean.
        self.assertGreater(sum(count for _, count in report["period_histogram_us"]), 100)
        html = page.read_text()
        self.assertIn("<svg", html)
        self.assertIn("Round-trip delay", html)
        self.assertNotIn("http://", html.replace("http://www.w3.org/2000/svg", ""))

    def test_it_does_not_push_when_it_must_not(self):
        done = self.go("device", "check", "--device", "simulated", "--duration", 1, "--no-push", "--json")
        self.assertNotIn("pushes", done.stderr)
        findings = {f["id"]: f for f in json.loads(done.stdout)["findings"]}
        self.assertEqual(findings["round-trip-delay"]["verdict"], "not-measured")
        self.assertEqual(findings["force-slope"]["verdict"], "not-measured")

    def test_calibration_writes_a_profile_that_runs_use(self):
        profiles = self.folder / "profiles"
        done = self.go("device", "calibrate", "--device", "simulated", "--yes", "--at", 1, 2, 3, "--scale", 2,
                       "--left-handed", "--feel", 0.2, "--json", "--profiles", profiles)
        result = json.loads(done.stdout)
        self.assertEqual(result["device_mm"], [1.0, 2.0, 3.0])
        self.assertEqual(result["scale"], 2.0)
        self.assertTrue(result["left_handed"])
        self.assertGreater(result["stable"]["stiffness_n_per_mm"], 0.05)
        self.assertTrue(0.05 <= result["stable"]["share_of_record"] <= 1.0)
        profile = profiles / "simulated-simulated-arm.toml"
        self.assertEqual(result["profile"], str(profile))
        self.assertIn('hand = "left"', profile.read_text())
        summary = json.loads(self.cut("profiled", "--motion", "drop", "--profile", profile).stdout)
        self.assertEqual(summary["driver"]["scale"], 2.0)
        self.assertTrue(summary["driver"]["left_handed"])
        # The bur is where the motion has it all the same.
        self.assertGreater(summary["contact_s"], 0.1)
        # A profile of another device, and one with a word that there is not.
        text = profile.read_text()
        other = self.folder / "other.toml"
        other.write_text(text.replace('model = "simulated arm"', 'model = "Touch X"'))
        self.assertIn("another device", self.cut("r", "--profile", other, code=1).stderr)
        other.write_text(text.replace("scale =", "skale ="))
        self.assertIn("skale", self.cut("r", "--profile", other, code=1).stderr)
        self.assertFalse((self.folder / "r" / "trace.csv").exists())

    def test_calibration_asks_and_takes_enter(self):
        done = self.go("device", "calibrate", "--device", "simulated", "--feel", 0, "--profiles",
                       self.folder / "profiles", stdin="\n")
        self.assertIn("press its upper button", done.stderr)
        self.assertTrue((self.folder / "profiles" / "simulated-simulated-arm.toml").exists())
        # Nobody there to press it.
        done = self.go("device", "calibrate", "--device", "simulated", "--feel", 0, "--profiles",
                       self.folder / "nobody", code=1, stdin="")
        self.assertIn("--yes", done.stderr)
        self.assertFalse((self.folder / "nobody").exists())

    def test_faults_end_in_no_force_and_are_told(self):
        faults = "unplug@0.3:0.05, nan@0.5:0.02, stall@0.8:0.1, jump@1.0:0.05, error@1.2:0.05=0x0301"
        arguments = ("--motion", "press", "--inject", faults, "--duration", 1.6)
        summary = json.loads(self.cut("faults", *arguments).stdout)
        told = summary["faults"]
        self.assertEqual((told["planned"], told["happened"], told["not_in_time"]), (5, 5, 0))
        self.assertEqual([o["kind"] for o in told["outcomes"]], ["unplug", "nan", "stall", "jump", "error"])
        for outcome in told["outcomes"]:
            self.assertTrue(outcome["told"], outcome)
            self.assertLessEqual(outcome["to_zero_s"], 0.010)
            self.assertLessEqual(outcome["largest_n"], 3.3)
        self.assertGreater(max(o["force_before_n"] for o in told["outcomes"]), 0.05)
        self.assertGreater(told["gate"]["samples"], 1000)
        self.assertEqual(json.loads((self.folder / "faults" / "summary.json").read_text())["faults"], told)
        # In virtual time the same command gives the same run.
        again = json.loads(self.cut("again", *arguments).stdout)
        self.assertEqual(again["faults"], told)
        traces = [[[v for k, v in row.items() if k not in ("work_us", "late_us")]
                   for row in rows_of((self.folder / name / "trace.csv").read_text())] for name in ("faults", "again")]
        self.assertEqual(traces[0], traces[1])

    def test_faults_while_cutting_leave_a_session_that_replays(self):
        done = self.cut("cut", "--motion", "drop", "--pedal", 1, "--hand", "normal", "--inject",
                        "random:6:seed=3:every=0.15:from=0.3", "--duration", 1.5)
        summary = json.loads(done.stdout)
        self.assertEqual(summary["faults"]["not_in_time"], 0)
        self.assertGreater(summary["removed_mm3"]["enamel"], 0.0)
        self.go("replay", self.folder / "cut" / "session.h5", "--no-cache")

    def test_the_controller_keeps_the_plain_arm_plain_and_scale_reaches_the_bur(self):
        plain = json.loads(self.cut("plain", "--motion", "drop").stdout)
        self.assertNotIn("driver", plain)
        shaped = json.loads(self.cut("shaped", "--motion", "drop", "--controller", "on").stdout)
        self.assertNotIn("driver", shaped)
        self.assertGreater(shaped["peak_force_n"], 0.1)
        scaled = json.loads(self.cut("scaled", "--motion", "drop", "--scale", 3, "--controller", "off").stdout)
        self.assertEqual(scaled["driver"]["scale"], 3.0)
        self.assertFalse(scaled["driver"]["passivity_controller"])
        crisp = json.loads(self.cut("crisp", "--motion", "drop", "--crisp", "on").stdout)
        self.assertNotEqual(crisp["peak_force_n"], plain["peak_force_n"])

    def test_what_cannot_be_is_one_line(self):
        for arguments, word in (
                (("device", "check", "--device", "phantom"), "openhaptics"),
                (("device", "check", "--device", "openhaptics"), "no-such-libHD.so"),
                (("device", "check", "--device", "simulated", "--duration", 0), "duration"),
                (("device", "calibrate", "--device", "openhaptics", "--yes"), "no-such-libHD.so"),
                (("device", "calibrate", "--device", "simulated", "--yes", "--scale", 4), "scale"),
                (("device", "calibrate", "--device", "simulated", "--yes", "--feel", -1), "--feel")):
            self.assertIn(word, self.go(*arguments, code=1).stderr.splitlines()[-1])
        for arguments, word in (
                (("--device", "phantom"), "openhaptics"), (("--device", "openhaptics"), "no-such-libHD.so"),
                (("--device", "openhaptics", "--motion", "drop"), "--motion"), (("--scale", 1.5), "--scale"),
                (("--controller", "maybe"), "--controller"), (("--crisp", "maybe"), "--crisp"),
                (("--inject", "fire@2"), "fire"), (("--inject", "unplug@x"), "faults"),
                (("--profile", self.folder / "none.toml"), "none.toml")):
            self.assertIn(word, self.cut("r", *arguments, code=1).stderr.splitlines()[-1])
        self.go("device", code=2)

    def test_completion_knows_the_words(self):
        text = self.go("completion", "bash").stdout
        for word in ("device", "device calibrate", "--inject", "--no-push"):
            self.assertIn(word, text)


if __name__ == "__main__":
    unittest.main()
