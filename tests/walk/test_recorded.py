# SPDX-License-Identifier: Apache-2.0
"""The invariants that are held on a recording, on recordings made by hand: a hand that runs away, a force over the load,
a groove beside the pointer's path, one below the depth stop."""
import unittest

import support  # noqa: F401
import numpy as np
from walking import recorded, swept

PRESS = {"from_s": 1.0, "to_s": 5.0, "load_n": 1.0}
TIMES = np.arange(0.0, 6.0, 0.001)
# Straight down, along x from 0 to 4 mm.
ORIGINS = np.array([[x, 0.0, 20.0] for x in np.arange(0.0, 4.01, 0.1)])
DIRECTIONS = np.tile([0.0, 0.0, -1.0], (len(ORIGINS), 1))
UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0]])
RADIUS = 0.5


def tooth(points):
    """All below z = 0."""
    return points[:, 2].copy()


def bur(points):
    """A cylinder with a round end, the tip at the origin, 8 mm long."""
    along = np.clip(points[:, 2], RADIUS, 8.0)
    return np.linalg.norm(points - np.stack([np.zeros(len(points)), np.zeros(len(points)), along], 1), axis=1) - RADIUS


def groove(from_x, to_x, y, depth, tilt=0.0):
    """The tooth with what a bur swept out of it; `tilt` [rad] about x."""
    def cut(points):
        closest = np.stack([np.clip(points[:, 0], from_x, to_x), np.full(len(points), y), np.full(len(points), -depth)], 1)
        local = points - closest
        c, s = np.cos(tilt), np.sin(tilt)
        local = np.stack([local[:, 0], c * local[:, 1] - s * local[:, 2], s * local[:, 1] + c * local[:, 2]], 1)
        return np.maximum(tooth(points), -bur(local))
    return cut


def stroke(**changes):
    return {"low": np.array([-2.0, -2.0, -4.0]), "high": np.array([6.0, 2.0, 0.0]), "tilts": UPRIGHT, "origins": ORIGINS,
            "directions": DIRECTIONS, "stop_mm": None, **changes}


class Hand(unittest.TestCase):
    def path(self):
        return np.stack([np.clip(TIMES - 1.0, 0.0, 4.0), np.zeros_like(TIMES), np.full_like(TIMES, 1.0)], 1)

    def judge(self, places, working=None):
        working = np.ones(len(TIMES), bool) if working is None else working
        return recorded.judge_hand(TIMES, places, working, PRESS, ORIGINS, DIRECTIONS)

    def test_on_its_path(self):
        self.assertEqual(self.judge(self.path()), [])

    def test_on_its_way_it_is_free(self):
        places = self.path()
        places[(TIMES > 3.0) & (TIMES < 3.5), 1] += 19.6
        self.assertEqual(self.judge(places, (TIMES <= 3.0) | (TIMES >= 3.5)), [])

    def test_what_works(self):
        samples = {"force_n": np.array([[0, 0, 0], [0, 0, 0], [0, 0, 0.4]]), "pedal": np.array([0.0, 1.0, 0.0])}
        self.assertEqual(recorded.works(samples, {}).tolist(), [False, True, True])
        self.assertEqual(recorded.works(samples, {"latched": True}).tolist(), [False, False, True])

    def test_runs_away(self):
        places = self.path()
        places[(TIMES > 3.0) & (TIMES < 3.5), 1] += 19.6
        [find] = self.judge(places)
        self.assertAlmostEqual(find.numbers["off_mm"], 19.6, 1)
        self.assertAlmostEqual(find.numbers["seconds"], 0.5, 1)

    def test_before_and_after_the_press_is_free(self):
        places = self.path()
        places[(TIMES < 1.5) | (TIMES > 5.01), 1] += 19.6
        self.assertEqual(self.judge(places), [])


class Force(unittest.TestCase):
    def test_within(self):
        self.assertEqual(recorded.judge_force(TIMES, np.tile([0.0, 0.0, 1.09], (len(TIMES), 1)), PRESS), [])

    def test_over(self):
        forces = np.tile([0.0, 0.0, 1.0], (len(TIMES), 1))
        forces[2000:2500, 0] = 3.0
        [find] = recorded.judge_force(TIMES, forces, PRESS)
        self.assertAlmostEqual(find.numbers["force_n"], 3.16, 2)
        self.assertAlmostEqual(find.numbers["seconds"], 0.5, 2)

    def test_a_moment_over(self):
        forces = np.tile([0.0, 0.0, 1.0], (len(TIMES), 1))
        forces[2000:2010, 0] = 0.8
        self.assertEqual(recorded.judge_force(TIMES, forces, PRESS), [])
        forces[2500:2515, 0] = 0.8
        self.assertEqual(recorded.judge_force(TIMES, forces, PRESS), [])
        forces[2000:2010, 0] = 2.8
        self.assertEqual(len(recorded.judge_force(TIMES, forces, PRESS)), 1)


class Removed(unittest.TestCase):
    def judge(self, after, **changes):
        return swept.judge(tooth, after, tooth, swept.Revolved(bur, RADIUS, 8.0), stroke(**changes), 0.1)

    def test_the_table_is_the_bur(self):
        places = np.random.default_rng(1).uniform([-1.0, -1.0, -0.8], [1.0, 1.0, 8.5], (2000, 3))
        self.assertLess(np.abs(swept.Revolved(bur, RADIUS, 8.0)(places) - bur(places)).max(), 0.03)

    def test_a_groove_under_the_pointer(self):
        self.assertEqual(self.judge(groove(0.0, 4.0, 0.0, 1.5), stop_mm=1.5), [])

    def test_nothing_removed(self):
        self.assertEqual(self.judge(tooth), [])

    def test_a_groove_beside_it(self):
        [find] = self.judge(groove(0.0, 4.0, 0.8, 1.0))
        self.assertEqual(find.invariant, "removed-in-sweep")
        self.assertAlmostEqual(find.numbers["mm"], 0.8, delta=0.12)

    def test_a_groove_beyond_its_end(self):
        [find] = self.judge(groove(0.0, 5.5, 0.0, 1.0))
        self.assertAlmostEqual(find.numbers["mm"], 1.5, delta=0.12)

    def test_another_tilt_than_recorded(self):
        self.assertEqual([f.invariant for f in self.judge(groove(0.0, 4.0, 0.0, 2.5, tilt=0.6))], ["removed-in-sweep"])

    def test_its_own_tilt(self):
        half = 0.5 * 0.6
        turned = np.array([[np.cos(half), -np.sin(half), 0.0, 0.0]])
        self.assertEqual(self.judge(groove(0.0, 4.0, 0.0, 2.5, tilt=0.6), tilts=turned), [])

    def test_below_the_stop(self):
        [find] = self.judge(groove(0.0, 4.0, 0.0, 2.2), stop_mm=1.5)
        self.assertEqual(find.invariant, "removed-to-stop")
        self.assertAlmostEqual(find.numbers["mm"], 2.2, 0)


class Session:
    """Of a module for Python: two sittings, the second from 10 s on, and the tooth's hash at each second."""

    def __init__(self, _):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def events(self):
        return [{"name": "resume", "time_s": 10.0}]

    def tooth_at(self, seconds):
        tooth = Session(None)
        tooth.state_hash = {3.0: "a", 5.0: "b", 13.0: "a"}[seconds]
        return tooth


class SameTooth(unittest.TestCase):
    def same(self, then, now):
        return recorded.same_tooth("a.h5", then, now, type("Module", (), {"Session": Session}))

    def test_as_recorded(self):
        self.assertTrue(self.same([0, 3.0], [1, 3.0]))
        self.assertFalse(self.same([0, 3.0], [0, 5.0]))

    def test_a_sitting_that_was_not_recorded(self):
        self.assertFalse(self.same([0, 3.0], [2, 3.0]))


if __name__ == "__main__":
    unittest.main()
