# SPDX-License-Identifier: Apache-2.0
"""The review in a page: its viewer's types, and the page worked in a real browser. Skips where there is none."""

import pathlib
import shutil
import subprocess
import unittest

from support import SystemTest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHROMIUM = [name for name in ("chromium", "chromium-browser", "google-chrome") if shutil.which(name)]


class Review(SystemTest):
    @unittest.skipUnless(shutil.which("tsc"), "no tsc (Debian: node-typescript)")
    def test_the_modules_are_of_one_piece(self):
        for folder in ("viewer", "live"):
            done = subprocess.run(["tsc", "-p", ROOT / "apps" / "web" / folder], capture_output=True, text=True,
                                  check=False)
            self.assertEqual(done.returncode, 0, done.stdout)

    def work(self, page, *options):
        done = subprocess.run(["node", ROOT / "tests" / "web" / "review_test.mjs", page, *options],
                              capture_output=True, text=True, timeout=1500, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @unittest.skipUnless(shutil.which("node"), "no node (Debian: nodejs)")
    @unittest.skipUnless(CHROMIUM, "no Chromium (Debian: chromium)")
    def test_a_page_worked_by_mouse_and_keys(self):
        block, out = self.folder / "block", self.folder / "out"
        self.ok("make", "block", "--kind", "line", "--rubric", ROOT / "data" / "rubrics" / "dexterity-line.toml",
                "--out", block)
        # Half as fine as it is made: a quarter of the time.
        asked = block / "exercise.toml"
        asked.write_text(asked.read_text().replace("voxel_um = 50", "voxel_um = 100"))
        cut = ("--voxel", "100", "--bur", "330", "--motion", "plunge")
        self.ok("run", "--case", block / "case", *cut, "--depth", "0.9", "--out", out)
        self.ok("report", out / "session.h5", "--out", self.folder / "plain.html")
        self.work(self.folder / "plain.html")
        # A second session goes on where the first has left the tooth; held against the exercise, both are played.
        second, work, result = self.folder / "second", self.folder / "work", self.folder / "result"
        self.ok("run", "--case", out / "attempt", *cut, "--depth", "1.4", "--out", second)
        work.mkdir()
        for name, session in (("a.h5", out), ("b.h5", second)):
            shutil.copy(session / "session.h5", work / name)
        self.ok("score", work, "--exercise", block, "--out", result)
        self.work(result / "report.html", "--exercise")
        text = (result / "report.html").read_text()
        self.assertIn("The next session: b.h5", text)
        for page in (self.folder / "plain.html", result / "report.html"):
            self.assertLess(page.stat().st_size, 3_000_000)


if __name__ == "__main__":
    unittest.main()
