# SPDX-License-Identifier: Apache-2.0
"""Feel and cut teeth from Python: distance fields, contact, haptic runs, sessions, scores.

Lengths are millimetres, forces newtons, times seconds, and say so in their names; poses are the bur in the tooth's frame,
x, y, z, qw, qx, qy, qz, tip at the origin of the bur, shank along its +z. Arrays that come out are read-only views where
C++ holds the numbers, and keep alive what they look at. docs/python.md begins at the beginning.
"""
from ._core import (BURS, EXERCISES, MOTIONS, STATUS, TISSUES, Bur, Case, Contact, Exercise, Field, KeyFrame, Mesh, Part, Probe,
                    Session, StandingTooth, Tooth, __version__, make_mouth, make_tooth, open_exercise, prepare, read_case,
                    read_mesh, replay, score, set_threads, threads)
from ._error import Error
from ._method import Method, rotation
from ._run import Run, run

__all__ = ["BURS", "EXERCISES", "MOTIONS", "STATUS", "TISSUES", "Bur", "Case", "Contact", "Error", "Exercise", "Field",
           "KeyFrame", "Mesh", "Method", "Part", "Probe", "Run", "Session", "StandingTooth", "Tooth", "__version__",
           "make_mouth", "make_tooth", "open_exercise", "prepare", "read_case", "read_mesh", "replay", "rotation", "run",
           "score", "set_threads", "threads"]

# As one reads and imports them.
for _name in __all__:
    if getattr(globals()[_name], "__module__", "").startswith("handpiece."):
        globals()[_name].__module__ = "handpiece"
del _name
