# SPDX-License-Identifier: Apache-2.0
"""Pictures without a display, through the real program."""

import os
import pathlib
import struct
import unittest
import zlib

from support import SystemTest, ball, box, write_coloured_ply, write_stl


def read_png(path):
    """Width, height and the rows as bytes of red, green, blue, alpha; filters undone by the book."""
    data = pathlib.Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, header = 8, b"", None
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(name + body)
        if name == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif name == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour = header[:4]
    assert (depth, colour) == (8, 6)
    raw, rows, before = zlib.decompress(packed), [], bytes(4 * width)
    for y in range(height):
        kind, row = raw[y * (4 * width + 1)], bytearray(raw[y * (4 * width + 1) + 1:(y + 1) * (4 * width + 1)])
        for i in range(4 * width):
            left, up, corner = (row[i - 4] if i >= 4 else 0), before[i], (before[i - 4] if i >= 4 else 0)
            if kind == 4:
                p = left + up - corner
                nearest = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
            else:
                nearest = (0, left, up, (left + up) // 2)[kind]
            row[i] = (row[i] + nearest) & 255
        rows.append(bytes(row))
        before = row
    return width, height, rows


class Picture(SystemTest):
    def setUp(self):
        super().setUp()
        self.cube = write_stl(self.folder / "cube.stl", box((-4, -4, -8), (4, 4, 4)))

    def picture(self, what, *more, name="a.png", size="160x100"):
        out = self.folder / name
        done = self.ok("picture", what, "--size", size, "--out", out, *more)
        self.assertIn(str(out), done.stdout)
        return read_png(out)

    def test_a_mesh_from_each_side_without_a_display(self):
        os.environ.pop("DISPLAY", None)
        seen = set()
        for view in ("occlusal", "buccal", "oblique"):
            width, height, rows = self.picture(self.cube, "--view", view)
            self.assertEqual((width, height), (160, 100))
            colours = {row[4 * x:4 * x + 3] for row in rows for x in range(width)}
            self.assertGreater(len(colours), 20, "one colour is no picture")
            self.assertTrue(all(row[4 * x + 3] == 255 for row in rows for x in range(width)))
            seen.add(b"".join(rows))
        self.assertEqual(len(seen), 3)

    def test_the_same_bits_each_time(self):
        self.picture(self.cube, name="a.png")
        self.picture(self.cube, name="b.png")
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    def test_the_face_towards_the_eye_fills_what_the_camera_says(self):
        # 8 x 8 mm seen from above in 100 x 100: a square in the middle, tooth by its brightness against the dark ground.
        width, height, rows = self.picture(self.cube, "--view", "occlusal", size="100x100")
        middle, corner = rows[50][200:203], rows[2][8:11]
        self.assertGreater(sum(middle), sum(corner) + 120)
        bright = [x for x in range(width) if sum(rows[50][4 * x:4 * x + 3]) > (sum(middle) + sum(corner)) // 2]
        self.assertGreater(len(bright), 80)
        self.assertAlmostEqual((bright[0] + bright[-1] + 1) / 2, 50, delta=1.5)

    def test_what_is_put_into_the_picture_changes_it(self):
        tooth = write_stl(self.folder / "ball.stl", ball(4, 24))
        common = ("--voxel", "200", "--quality", "fine")
        seen = {b"".join(self.picture(tooth, *common, *more)[2])
                for more in ((), ("--mirror",), ("--scale-bar",), ("--bur", "330"), ("--section", "y"),
                             ("--section", "y", "--grid"), ("--section", "0,0,1,1.5"), ("--stereo", "anaglyph"),
                             ("--stereo", "side-by-side"), ("--palette", "textbook"),
                             ("--eye", "0,-40,10", "--target", "0,0,0"))}
        self.assertEqual(len(seen), 11)

    def test_a_scan_in_colour_is_seen_so(self):
        def halves(place):
            return (190, 30, 30) if place[0] < 0 else (30, 170, 40)

        def seen(what, *more):
            _, _, rows = self.picture(what, "--view", "occlusal", "--voxel", "100", *more, size="100x100")
            return rows[42][4 * 30:4 * 30 + 3], rows[42][4 * 70:4 * 70 + 3]

        scan = write_coloured_ply(self.folder / "scan.ply", ball(4, 40), halves)
        self.ok("case", "new", "--out", self.folder / "case", "--outer", scan, "--part", f"enamel={scan}")
        # The mesh alone, the mesh as a tooth with a bur, and the case made of it.
        for what, more in ((scan, ()), (scan, ("--bur", "330")), (self.folder / "case", ())):
            with self.subTest(what=what.name, more=more):
                sides = seen(what, *more)
                # Mesial is +x and lies on one side or the other as charts have it.
                self.assertEqual(sum(1 for r, g, b in sides if r > 2 * g and r > 2 * b), 1, sides)
                self.assertEqual(sum(1 for r, g, b in sides if 2 * g > 3 * r and 2 * g > 3 * b), 1, sides)
                for r, g, b in seen(what, *more, "--no-scan-colours"):
                    self.assertLess(abs(r - g), 40)

    def test_where_a_scan_is_cut_its_colours_end(self):
        scan = write_coloured_ply(self.folder / "scan.ply", ball(4, 24),
                                  lambda place: (190, 30, 30) if place[2] < 0 else (30, 40, 190))
        self.ok("case", "new", "--out", self.folder / "case", "--outer", scan, "--part", f"enamel={scan}")
        self.ok("run", "--case", self.folder / "case", "--bur", "cylinder-round:1.6x4.0", "--motion", "plunge", "--voxel",
                "100", "--out", self.folder / "cut")
        blue = {}
        for look in ("now", "before"):
            _, _, rows = self.picture(self.folder / "cut" / "attempt", "--view", "occlusal", "--look", look, size="100x100")
            blue[look] = {(x, y) for y, row in enumerate(rows) for x in range(100)
                          if row[4 * x + 2] > 3 * row[4 * x] // 2 and row[4 * x + 2] > 70}
        # Uncut it is blue to its rim; then the bur's 1.6 of 8 mm are not, and all else still is.
        self.assertGreater(len(blue["before"]), 2500)
        gone = blue["before"] - blue["now"]
        self.assertGreater(len(gone), 60)
        self.assertTrue(all(abs(x - 50) < 22 and abs(y - 50) < 22 for x, y in gone), sorted(gone)[:5])

    def test_words_are_read_before_files(self):
        # A tooth may take a minute to prepare: a typing error must not wait for it. Here there is not even a file.
        for option, value in (("--section", "1,2"), ("--section", "y "), ("--section", "0,0,0,1"), ("--eye", "0,0"),
                              ("--size", "10x10"), ("--view", "above"), ("--bur", "none-such"), ("--hide", "hair"),
                              ("--target", "0,0,0"), ("--at", "3")):
            with self.subTest(option=option, value=value):
                told = self.refused("picture", self.folder / "none.stl", "--out", self.folder / "x.png", option, value,
                                    mentions=(value if option in ("--view", "--bur", "--hide") else option,))
                self.assertNotIn("none.stl", told)
        self.refused("picture", self.folder / "none.stl", "--out", self.folder / "x.png", "--section", "1,2",
                     mentions=("--section", "1,2", "NX,NY,NZ,OFFSET"))

    def test_bad_words_are_told(self):
        for more, mentions in (
                (("--view", "above"), ("above", "occlusal, buccal, lingual, mesial, distal, oblique")),
                (("--size", "10x10"), ("--size", "16 to 8192")), (("--size", "9000x10"), ("8192",)),
                (("--size", "big"), ("big", "1280x800")), (("--size", "100x"), ("100x",)),
                (("--palette", "gaudy"), ("gaudy", "natural, textbook, colour-safe")),
                (("--quality", "best"), ("best", "fast, fine, rich")), (("--look", "then"), ("then", "ghost")),
                (("--look", "ghost"), ("--look", "mesh")), (("--stereo", "3d"), ("3d", "anaglyph")),
                (("--section", "1,2"), ("--section", "1,2")), (("--section", "0,0,0,1"), ("--section", "direction")),
                (("--eye", "0,0"), ("--eye",)), (("--target", "0,0,0"), ("--eye",)),
                (("--eye", "1,1,1", "--target", "1,1,1"), ("--eye",)), (("--at", "3"), ("--at", "session")),
                (("--hide", "hair"), ("hair", "enamel")), (("--bur", "none-such"), ("none-such",))):
            with self.subTest(more=more):
                self.refused("picture", self.cube, "--voxel", "400", "--out", self.folder / "x.png", *more,
                             mentions=mentions)
        self.refused("picture", self.cube, "--out", self.folder / "x.jpg", mentions=(".png",))
        self.refused("picture", self.cube, "--out", self.folder / "no" / "x.png", mentions=("folder",))
        self.refused("picture", self.folder / "none.stl", "--out", self.folder / "x.png", mentions=("none.stl",))
        self.refused("picture", self.folder / "none.h5", "--out", self.folder / "x.png", mentions=("none.h5",))


class SessionPicture(SystemTest):
    def test_moments_of_a_session_and_its_attempt(self):
        case = self.folder / "tooth"
        self.ok("make", "tooth", "--faces", "4000", "--out", case)
        out = self.folder / "out"
        self.ok("run", "--tooth", case, "--bur", "330", "--motion", "plunge", "--depth", "1.5", "--voxel",
                "150", "--out", out)
        session, attempt = out / "session.h5", out / "attempt"
        pictures = {}
        for name, what, more in (("first", session, ("--at", "0")), ("last", session, ()),
                                 ("attempt", attempt, ()), ("before", attempt, ("--look", "before")),
                                 ("ghost", attempt, ("--look", "ghost")),
                                 ("depth", attempt, ("--look", "removed-depth"))):
            png = self.folder / f"{name}.png"
            self.ok("picture", what, "--size", "160x120", "--view", "occlusal", "--no-bur", "--out", png, *more)
            pictures[name] = b"".join(read_png(png)[2])
        self.assertEqual(len(set(pictures.values())), 4)
        self.assertEqual(pictures["first"], pictures["before"], "nothing is cut at the beginning")
        self.assertEqual(pictures["last"], pictures["attempt"], "what is cut again is what was kept")
        self.refused("picture", session, "--at", "1e6", "--out", self.folder / "x.png", mentions=("--at", "s long"))


if __name__ == "__main__":
    unittest.main()
