# SPDX-License-Identifier: Apache-2.0
"""What the tests of the module share: one small tooth, made once a program, and the command line beside it."""
import atexit
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

FOLDER = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-python-"))
atexit.register(shutil.rmtree, FOLDER, ignore_errors=True)
os.environ["XDG_CACHE_HOME"] = str(FOLDER / "cache")

import numpy as np  # noqa: E402

import handpiece as hp  # noqa: E402

HANDPIECE = os.environ["HANDPIECE"]


def command(*arguments, stdin=None):
    """Output of the command line, which must succeed."""
    # What is preloaded for a module under a sanitizer is none of the program's.
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    done = subprocess.run([HANDPIECE, *map(str, arguments)], input=stdin, capture_output=True, text=True, timeout=1200,
                          check=False, env=environment)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def box(low, high):
    """A closed box as a Mesh."""
    vertices = [[(high if i >> axis & 1 else low)[axis] for axis in range(3)] for i in range(8)]
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
             (1, 3, 7), (1, 7, 5)]
    return hp.Mesh(vertices, faces)


_made = {}


def once(make):
    """What `make` gives, made at the first call."""
    def get():
        if make not in _made:
            _made[make] = make()
        return _made[make]
    return get


@once
def molar():
    """Path of a small molar."""
    path = FOLDER / "molar"
    hp.make_tooth(faces=6000).write(path)
    return path


@once
def tooth():
    return hp.prepare(molar(), 0.1)


@once
def block():
    """Path of a block whose top is z = 0."""
    path = FOLDER / "block.stl"
    box((-2, -2, -2), (2, 2, 0)).write(path)
    return path


@once
def plunge():
    """A short cut into the block."""
    return hp.run(block(), "plunge", voxel_mm=0.1, depth_mm=0.6, dwell_s=0.3, tremor_um=20, seed=7, out=FOLDER / "plunge")


def poses(count=400, seed=1, lie=True):
    """Of a bur about the crown, some in it and some beyond reach, the shank mostly up."""
    random = np.random.default_rng(seed)
    low, high = tooth().outer.vertices.min(axis=0), tooth().outer.vertices.max(axis=0)
    place = random.uniform(low - 1, high + 1, (count, 3))
    place[:, 2] = random.uniform(high[2] - 3, high[2] + 2, count)
    turn = random.normal(0, 0.3 if lie else 0, (count, 4))
    turn[:, 0] += 1
    return np.hstack([place, turn / np.linalg.norm(turn, axis=1, keepdims=True)])


class Test(unittest.TestCase):
    """With what is asked of the package's own errors."""

    def assertError(self, what, call, *arguments, **options):
        """Raises handpiece.Error that says so; returns it."""
        with self.assertRaises(hp.Error) as caught:
            call(*arguments, **options)
        self.assertIn(what, str(caught.exception))
        return caught.exception
