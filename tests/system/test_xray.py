# SPDX-License-Identifier: Apache-2.0
"""Radiographs of a case: the files, read by nothing of ours, and what is refused."""

import json
import struct
import unittest
import zlib

from support import SystemTest, ball, write_stl


def png(path):
    """Width, height, bits and the first byte row by row."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, bits, colour = struct.unpack(">IIBB", data[16:26])
    assert colour == 0, "grey"
    body, at = b"", 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IDAT":
            body += data[at + 8:at + 8 + length]
        at += 12 + length
    assert len(zlib.decompress(body)) == height * (1 + width * bits // 8)
    return width, height, bits


class Xray(SystemTest):
    def setUp(self):
        super().setUp()
        self.tooth = write_stl(self.folder / "ball.stl", ball(4.0, n=40))

    def take(self, name, *arguments):
        self.ok("xray", self.tooth, "--out", self.folder / name, *arguments)
        return (self.folder / name).read_bytes()

    def test_pictures_of_both_views(self):
        for view in ("bitewing", "periapical"):
            self.take("p.png", "--view", view, "--size", "300x200")
            self.assertEqual(png(self.folder / "p.png"), (300, 200, 16))
        self.take("p8.png", "--bits", 8, "--pixel", 100)
        self.assertEqual(png(self.folder / "p8.png"), (360, 260, 8))

    def test_same_seed_same_bytes_at_any_thread_count(self):
        small = ("--size", "120x90", "--pixel", 100)
        first = self.take("a.png", *small, "--seed", 5, "--threads", 1)
        self.assertEqual(first, self.take("b.png", *small, "--seed", 5, "--threads", 2))
        self.assertNotEqual(first, self.take("c.png", *small, "--seed", 6))
        self.assertEqual(self.take("d.png", *small, "--noise", "off"),
                         self.take("e.png", *small, "--noise", "off", "--seed", 9))

    def test_dicom_is_marked(self):
        data = self.take("r.dcm", "--size", "64x48")
        self.assertEqual(data[128:132], b"DICM")
        for text in (b"SIMULATED bitewing", b"DERIVED\\SECONDARY", b"1.2.840.10008.5.1.4.1.1.1.3", b"FOR PRESENTATION"):
            self.assertIn(text, data)
        self.assertIn("IO", self.ok("scan", "info", self.folder / "r.dcm").stdout)

    def test_told_as_json(self):
        told = json.loads(self.ok("xray", self.tooth, "--out", self.folder / "j.png", "--size", "64x48", "--json").stdout)
        self.assertEqual((told["width"], told["height"], told["simulated"]), (64, 48, True))

    def test_bad_input_one_sentence(self):
        out = ("--out", self.folder / "x.png")
        for arguments, said in ((("--view", "panoramic"), "bitewing or periapical"), (("--size", "1200"), "1200x866"),
                                (("--size", "99999x99999"), "--size"), (("--kv", "120"), "--kv"), (("--fdi", "46"), "no tooth 46"),
                                (("--out", self.folder / "x.jpg"), ".png or .dcm"), (("--filling", "gold"), "amalgam")):
            given = arguments if arguments[0] == "--out" else (*out, *arguments)
            self.refused("xray", self.tooth, *given, mentions=[said])


if __name__ == "__main__":
    unittest.main()
