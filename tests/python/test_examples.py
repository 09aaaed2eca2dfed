# SPDX-License-Identifier: Apache-2.0
"""Each example draws a picture without a display, small; and shows what it says."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
try:
    import matplotlib  # noqa: F401
except ImportError:
    matplotlib = None


@unittest.skipUnless(matplotlib, "matplotlib is not installed")
class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory(prefix="handpiece-examples-")
        cls.environment = dict(os.environ, XDG_CACHE_HOME=cls.home.name, MPLCONFIGDIR=cls.home.name)
        cls.environment.pop("DISPLAY", None)

    @classmethod
    def tearDownClass(cls):
        cls.home.cleanup()

    def draw(self, name, *arguments):
        picture = pathlib.Path(self.home.name) / f"{name}.png"
        done = subprocess.run([sys.executable, str(EXAMPLES / f"{name}.py"), *arguments], capture_output=True, text=True,
                              env=self.environment, timeout=1200, check=False, cwd=self.home.name)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(done.stderr, "")
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(picture.stat().st_size, 10000)
        return done.stdout

    def test_depth_map(self):
        told = self.draw("depth_map", "--grid", "40")
        self.assertGreater(float(re.search(r"up to ([\d.]+) mm", told).group(1)), 0.2)  # air that the hull feels

    def test_cut_force(self):
        told = self.draw("cut_force", "--depth-mm", "1.0")
        self.assertGreater(float(re.search(r"peak ([\d.]+) N", told).group(1)), 0.1)
        self.assertGreater(float(re.search(r"([\d.]+) mm3 taken", told).group(1)), 0.05)

    def test_own_method(self):
        told = self.draw("own_method", "--count", "200")
        off = dict(re.findall(r"^(\w+) .*off by ([\d.]+) mm on average", told, re.M))
        self.assertLess(float(off["corners"]), float(off["hull"]))

    def test_learning_curve(self):
        told = self.draw("learning_curve", "--students", "1", "--attempts", "2")
        first, second = map(float, re.search(r"^S1 (\d+) (\d+)$", told, re.M).groups())
        self.assertGreater(second, first)


class Page(unittest.TestCase):
    def test_what_the_page_says_runs(self):
        """The blocks of docs/python.md, one after the other as a reader types them."""
        text = (EXAMPLES.parent / "docs" / "python.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S)
        self.assertGreater(len(blocks), 2)
        done = subprocess.run([sys.executable, "-c", "\n".join(blocks)], capture_output=True, text=True, check=False, timeout=1200)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("True", done.stdout.splitlines())


class Files(unittest.TestCase):
    def test_every_example_is_tested(self):
        tested = {name[len("test_"):] for name in dir(Examples) if name.startswith("test_")}
        self.assertEqual({path.stem for path in EXAMPLES.glob("*.py")}, tested)


if __name__ == "__main__":
    unittest.main()
