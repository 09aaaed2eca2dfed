# SPDX-License-Identifier: Apache-2.0
"""The walk of a school's pages finds the two faults of a school that has them."""
import json
import pathlib
import shutil
import subprocess
import unittest

from support import ROOT

HERE = pathlib.Path(__file__).resolve().parent


class School(unittest.TestCase):
    def test_planted_faults(self):
        if not shutil.which("node"):
            self.skipTest("needs nodejs")
        done = subprocess.run(["node", str(ROOT / "tests/school/browser/wander.mjs"), str(HERE / "bad_school.mjs"), "3", "0.4"],
                              capture_output=True, text=True, check=False, timeout=280)
        if done.returncode == 77:
            self.skipTest(done.stdout.strip())
        finds = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        told = {find["invariant"]: find["told"] for find in finds}
        self.assertIn("a planted fault", " ".join(f["told"] for f in finds), done.stdout + done.stderr)
        self.assertIn("500", " ".join(f["told"] for f in finds if f["invariant"] == "school-answers"))
        self.assertEqual(set(told), {"school-console", "school-answers"})


if __name__ == "__main__":
    unittest.main()
