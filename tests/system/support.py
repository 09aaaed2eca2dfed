# SPDX-License-Identifier: Apache-2.0
"""What the tests of the real program share: running it, small meshes, looking at what it left."""

import csv
import math
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

HANDPIECE = os.environ["HANDPIECE"]
OWN_METHOD = os.environ["HANDPIECE_OWN_METHOD"]
OWN_LAW = os.environ["HANDPIECE_OWN_LAW"]
REAL_DATA = pathlib.Path(os.environ["HANDPIECE_REAL_DATA"])


# Options of run() for somebody whom permissions stop: nobody where these tests are run by root, else who runs them.
ORDINARY = {"user": 65534, "group": 65534} if os.geteuid() == 0 else {}


def run(*arguments, program=HANDPIECE, stdin=None, cwd=None, **who):
    """The finished process, with its output as text."""
    if who:
        who["extra_groups"] = []
    return subprocess.run([program, *map(str, arguments)], input=stdin, capture_output=True, text=True, timeout=1200,
                          cwd=cwd, check=False, **who)


def write_stl(path, facets):
    """Binary STL of triangles ((x, y, z), (x, y, z), (x, y, z))."""
    with open(path, "wb") as out:
        out.write(bytes(80) + struct.pack("<I", len(facets)))
        for facet in facets:
            out.write(struct.pack("<12fH", 0, 0, 0, *facet[0], *facet[1], *facet[2], 0))
    return path


def write_coloured_ply(path, facets, colour_of):
    """Binary PLY as intraoral scanners write it: facets as for write_stl(), red, green and blue of a place in bytes."""
    places = sorted({corner for facet in facets for corner in facet})
    number = {place: i for i, place in enumerate(places)}
    with open(path, "wb") as out:
        out.write(f"ply\nformat binary_little_endian 1.0\ncomment a scan\nelement vertex {len(places)}\n"
                  "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
                  f"property uchar blue\nproperty uchar alpha\nelement face {len(facets)}\n"
                  "property list uchar int vertex_indices\nend_header\n".encode())
        for place in places:
            out.write(struct.pack("<3f4B", *place, *colour_of(place), 255))
        for facet in facets:
            out.write(struct.pack("<B3i", 3, *(number[corner] for corner in facet)))
    return path


def vertex_colours(path):
    """Place to red, green and blue of the binary PLY that handpiece writes; empty where it holds none."""
    head, body = pathlib.Path(path).read_bytes().split(b"end_header\n", 1)
    if b"property uchar red" not in head:
        return {}
    count = int(head.split(b"element vertex ")[1].split()[0])
    rows = (struct.unpack_from("<3d3B", body, 27 * i) for i in range(count))
    return {row[:3]: row[3:] for row in rows}


def box(low, high):
    """A closed box, counter-clockwise from outside."""
    v = [tuple((high if i >> axis & 1 else low)[axis] for axis in range(3)) for i in range(8)]
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6),
             (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return [tuple(v[i] for i in face) for face in faces]


def ball(radius, n=12, centre=(0, 0, 0)):
    """An octahedron whose sides are cut in n, on a sphere; its poles are vertices."""
    facets = []
    for octant in range(8):
        sx, sy, sz = (-1 if octant >> axis & 1 else 1 for axis in range(3))

        def at(i, j):
            p = (sx * i, sy * j, sz * (n - i - j))
            length = math.sqrt(sum(c * c for c in p))
            return tuple(centre[axis] + radius * p[axis] / length for axis in range(3))

        for i in range(n):
            for j in range(n - i):
                cut = [(at(i, j), at(i + 1, j), at(i, j + 1))]
                if i + j + 1 < n:
                    cut.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
                facets += cut if sx * sy * sz > 0 else [(a, c, b) for a, b, c in cut]
    return facets


def open_arch(rng, along=40, across=10, ragged=0.6):
    """An open intraoral scan: a U-shaped tube of teeth, cut open below, with a ragged border in one loop."""
    rows = []
    for i in range(along):
        t = math.pi * i / (along - 1)
        out = (math.cos(t) / 25, math.sin(t) / 30)
        length = math.hypot(*out)
        height, low = 6 + 2.5 * abs(math.sin(7 * t)), -ragged * rng.random()
        row = []
        for j in range(across):
            a = math.pi * j / (across - 1)
            r = -5 * math.cos(a)
            row.append((25 * math.cos(t) + out[0] / length * r, 30 * math.sin(t) + out[1] / length * r,
                        low if j in (0, across - 1) else height * math.sin(a) ** 0.6))
        rows.append(row)
    facets = []
    for i in range(along - 1):
        for j in range(across - 1):
            a, b, c, d = rows[i][j], rows[i][j + 1], rows[i + 1][j + 1], rows[i + 1][j]
            facets += [(a, b, c), (a, c, d)]
    return facets


def rows_of(text):
    """CSV text as a list of dictionaries."""
    return list(csv.DictReader(text.splitlines()))


def poses(*lines):
    """CSV of x, y, z with the shank up, or of all seven numbers."""
    text = "x,y,z,qw,qx,qy,qz\n"
    for line in lines:
        full = tuple(line) + (1, 0, 0, 0) if len(line) == 3 else tuple(line)
        text += ",".join(repr(float(value)) for value in full) + "\n"
    return text


class SystemTest(unittest.TestCase):
    """A folder of its own for each test; caches stay in it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-system-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        os.environ["XDG_CACHE_HOME"] = str(self.folder / "cache")

    def ok(self, *arguments, **options):
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, 0, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def listing(self):
        """Every file but the caches, with its bytes."""
        return {str(path.relative_to(self.folder)): path.read_bytes() if path.is_file() else None
                for path in sorted(self.folder.rglob("*"))
                if "cache" not in str(path.relative_to(self.folder))}

    def refused(self, *arguments, mentions=(), **options):
        """Exit code 1, one line on stderr that mentions each word, nothing written."""
        before = self.listing()
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, 1, f"{arguments}\n{done.stdout}\n{done.stderr}")
        lines = done.stderr.splitlines()
        # Beside it what was seen in a file on the way.
        lines = [line for line in lines if not line.startswith("handpiece: note: ")]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("handpiece: "), lines[0])
        for word in mentions:
            self.assertIn(word, lines[0])
        self.assertEqual(self.listing(), before, "left something behind")
        return lines[0]
