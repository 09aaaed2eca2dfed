# SPDX-License-Identifier: Apache-2.0
"""Maps and recordings as the window gives them, made by hand."""
import pathlib
import sys

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))


def hand(**changes):
    """A tooth of 10 mm in the middle of a picture of 800 by 600, seen from above; the hand where the pointer is."""
    told = {"clockS": 100.0, "timeS": 50.0, "mode": "live", "busy": False, "tick": 50000, "recording": "a.h5", "fault": "",
            "camera": {"eyeMm": [0, 0, 60], "targetMm": [0, 0, 0], "up": [0, 1, 0], "fieldOfViewRad": 0.42, "mirrored": False},
            "viewport": [800, 600], "toothMm": [[-5, -5, -15], [5, 5, 5]], "pressed": True, "latched": False, "pedal": 1.0,
            "hint": "", "loadN": 1.0,
            "forceN": [0.0, 0.0, 1.0], "handMm": [0.0, 0.0, 5.0], "undoSteps": 0, "redoSteps": 0, "strokes": 0,
            "inStroke": False, "removedMm3": 1.0, "removedOthersMm3": 0.0, "stateHash": "aa", "message": "", "notice": ""}
    told.update(changes)
    return told


def told(**changes):
    return {"places": {}, "texts": {}, "on": [], "off": [], "windows": ["mainWindow"], "hand": hand(**changes)}
