# SPDX-License-Identifier: Apache-2.0
"""The page that `handpiece report` writes: whole, of this session, with nothing loaded from elsewhere."""

import html.parser
import json
import re
import unittest

from support import SystemTest, box, run, write_stl


class Page(html.parser.HTMLParser):
    """Its text, its pictures, and whether every tag is closed."""

    EMPTY = {"meta", "img"}

    def __init__(self, text):
        super().__init__()
        self.open, self.pictures, self.text, self.addresses = [], [], "", []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag not in self.EMPTY:
            self.open.append(tag)
        for name, value in attrs:
            if name in ("src", "href"):
                self.addresses.append(value)
            if tag == "img" and name == "src":
                self.pictures.append(value)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in self.EMPTY:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if self.open[-1:] != ["script"]:
            self.text += data


class Report(SystemTest):
    def cut(self):
        block = write_stl(self.folder / "block <1>.stl", box((-2, -2, -2), (2, 2, 0)))
        out = self.folder / "out"
        self.ok("run", "--tooth", block, "--bur", "330", "--voxel", "100", "--motion", "plunge", "--depth", "0.8",
                "--code", "student-7", "--out", out)
        return out

    def test_a_session_as_one_page(self):
        out = self.cut()
        done = self.ok("report", out / "session.h5", "--out", self.folder / "report.html")
        self.assertIn("report.html", done.stdout)
        text = (self.folder / "report.html").read_text()
        page = Page(text)
        self.assertEqual(page.open, [])
        self.assertTrue(all(a.startswith("data:image/png;base64,") for a in page.addresses))
        self.assertTrue(page.pictures or "No pictures" in page.text)
        for word in ("student-7", "block <1>", "Times", "Force and speed", "Cavity", "stroke begin", "bit for bit", "330"):
            self.assertIn(word, page.text)
        self.assertIn("@media print", text)
        self.assertNotIn(str(self.folder), text)
        self.assertNotIn("nan", page.text)
        self.assertEqual(text.count("<svg"), 3)
        self.assertEqual(text.count("<style>"), 1)
        self.ok("report", out / "session.h5", "--no-pictures", "--language", "ja", "--out", self.folder / "ja.html")
        japanese = (self.folder / "ja.html").read_text()
        self.assertIn('<html lang="ja">', japanese)
        for word in ("実習の記録", "除去の合計", "エナメル質", "時間 [s]"):
            self.assertIn(word, japanese)
        self.assertEqual(run("--language", "xx", "report", out / "session.h5", "--out", self.folder / "x.html").returncode, 2)
        summary = json.loads((out / "summary.json").read_text())
        replay = json.loads(self.ok("replay", out / "session.h5", "--json").stdout)
        self.assertIn(replay["state_hash"], page.text)
        told = float(re.search(r"removed in all\s*([0-9.]+) mm", page.text).group(1))
        self.assertGreater(told, 0.05)
        self.assertTrue(summary)
        depth = float(re.search(r"deepest below the uncut surface\s*([0-9.]+) mm", page.text).group(1))
        self.assertTrue(0.2 < depth < 1.5, depth)

    def test_bad_input_is_one_line(self):
        out = self.cut()
        self.refused("report", self.folder / "none.h5", "--out", self.folder / "x.html", mentions=["no such file"])
        self.refused("report", out / "trace.csv", "--out", self.folder / "x.html", mentions=["no session"])
        self.refused("report", out / "session.h5", "--no-pictures", "--out", "/nowhere/x.html", mentions=["/nowhere"])


if __name__ == "__main__":
    unittest.main()
