# SPDX-License-Identifier: Apache-2.0
"""The invariants that are held on every map: each is silent on sound ones and speaks of a planted fault."""
import unittest

from support import hand, told
from walking import eye, live, memory, undo, words


def doing(**changes):
    return live.Doing(step=3, pixels=[(400.0, 300.0), (440.0, 300.0)], since_s=90.0, **changes)


class Eye(unittest.TestCase):
    def test_a_ray_goes_through_its_pixel(self):
        h = hand()
        for pixel in ((400.0, 300.0), (10.0, 590.0), (733.0, 51.0)):
            origin, direction = eye.ray(h, *pixel)
            at = eye.pixel_of(h, eye.along(origin, direction, 37.0))
            self.assertAlmostEqual(at[0], pixel[0], 6)
            self.assertAlmostEqual(at[1], pixel[1], 6)

    def test_right_is_right_and_up_is_up(self):
        x, y = eye.pixel_of(hand(), [1.0, 2.0, 0.0])
        self.assertGreater(x, 400.0)
        self.assertLess(y, 300.0)

    def test_the_crown_is_the_upper_part(self):
        _, _, low = min(eye.crown_corners(hand()), key=lambda corner: corner[2])
        self.assertAlmostEqual(low, 5.0 - 0.42 * 20.0)

    def test_nothing_behind_the_eye(self):
        self.assertIsNone(eye.pixel_of(hand(), [0.0, 0.0, 61.0]))


class HandNearPointer(unittest.TestCase):
    def far(self, place, maps=3, **changes):
        invariant = live.HandNearPointer()
        finds = [invariant.see(told(handMm=place, clockS=100.0 + i, **changes), doing()) for i in range(maps)]
        return [find for find in finds if find]

    def test_on_the_path(self):
        self.assertEqual(self.far([0.0, 0.0, 5.0]), [])
        self.assertEqual(self.far([0.5, 0.5, -3.0]), [])

    def test_runs_away(self):
        finds = self.far([0.0, 11.0, 5.0])
        self.assertEqual(len(finds), 1)  # once, not at every map
        self.assertAlmostEqual(finds[0].numbers["off_mm"], 11.0, 1)

    def test_comes_down_first(self):
        self.assertEqual(self.far([0.0, 11.0, 5.0], maps=3, pressed=False), [])
        early = live.HandNearPointer()
        self.assertIsNone(early.see(told(handMm=[0, 11, 5], clockS=90.5), doing()))

    def test_on_its_way_it_is_free(self):
        self.assertEqual(self.far([0.0, 11.0, 5.0], pedal=0.0, forceN=[0.0, 0.0, 0.0]), [])

    def test_stays_away(self):
        away = {"place": [0.0, 11.0, 5.0], "maps": 3000, "pedal": 0.0, "forceN": [0.0, 0.0, 0.0]}
        self.assertEqual(len(self.far(**away)), 1)
        self.assertEqual(self.far(**away, hint="The handpiece cannot get there"), [])

    def test_one_map_is_no_find(self):
        self.assertEqual(self.far([0.0, 11.0, 5.0], maps=1), [])


class ForceWithinLoad(unittest.TestCase):
    def test_within(self):
        invariant = live.ForceWithinLoad()
        self.assertIsNone(invariant.see(told(forceN=[0.0, 0.6, 0.9]), doing()))

    def test_over(self):
        invariant = live.ForceWithinLoad()
        find = invariant.see(told(forceN=[0.0, 0.0, 3.3]), doing())
        self.assertAlmostEqual(find.numbers["over"], 3.3)
        self.assertIsNone(invariant.see(told(forceN=[0.0, 0.0, 3.3]), doing()))

    def test_over_a_little_is_a_find_when_it_lasts(self):
        invariant = live.ForceWithinLoad()
        seen = [invariant.see(told(forceN=[0.0, 0.0, 1.3]), doing()) for _ in range(3)]
        self.assertEqual([find is not None for find in seen], [False, True, False])

    def test_follows_the_load(self):
        self.assertIsNone(live.ForceWithinLoad().see(told(forceN=[0.0, 0.0, 2.1], loadN=2.0), doing()))

    def test_a_hand_that_does_not_press_is_another_matter(self):
        self.assertIsNone(live.ForceWithinLoad().see(told(forceN=[0.0, 0.0, 2.0], pressed=False), doing()))


class NoticeOnce(unittest.TestCase):
    def told(self, *notices):
        invariant = live.NoticeOnce()
        return [find for at, notice in notices if (find := invariant.see(told(clockS=at, notice=notice), doing()))]

    def test_once(self):
        self.assertEqual(self.told((0, "stalled"), (1, "stalled"), (7, "")), [])

    def test_twice(self):
        finds = self.told((0, "stalled"), (7, ""), (20, "stalled"))
        self.assertEqual(len(finds), 1)
        self.assertEqual(finds[0].numbers["apart_s"], 20)

    def test_a_minute_later(self):
        self.assertEqual(self.told((0, "stalled"), (7, ""), (61, "stalled")), [])

    def test_covered_by_a_graver_one(self):
        self.assertEqual(self.told((0, "stalled"), (2, "pulp-exposed"), (4, "stalled")), [])

    def test_an_answer(self):
        self.assertEqual(self.told((0, "nothing-to-undo"), (7, ""), (20, "nothing-to-undo")), [])


class ToothInFrame(unittest.TestCase):
    AWAY = {"eyeMm": [0, 0, 60], "targetMm": [60, 0, 0], "up": [0, 1, 0], "fieldOfViewRad": 0.42, "mirrored": False}

    def see(self, camera, **changes):
        invariant = live.ToothInFrame()
        return [find for _ in range(3) if (find := invariant.see(told(camera=camera), doing(**changes)))]

    def test_in_frame(self):
        self.assertEqual(self.see(hand()["camera"]), [])

    def test_out_of_frame(self):
        self.assertEqual(len(self.see(self.AWAY)), 1)

    def test_turned_away_by_the_walker(self):
        self.assertEqual(self.see(self.AWAY, eye_is_walkers=True), [])


class NoProblem(unittest.TestCase):
    def test_sound(self):
        self.assertIsNone(live.NoProblem().see(told(), doing()))

    def test_error(self):
        seen = told()
        seen["windows"].append("errorDialog")
        seen["texts"]["errorWhat"] = "The disk is full"
        invariant = live.NoProblem()
        self.assertIn("The disk is full", invariant.see(seen, doing()).told)
        self.assertIsNone(invariant.see(seen, doing()))
        self.assertIsNone(live.NoProblem().see(seen, doing(expects_problem=True)))

    def test_fault_and_no_picture(self):
        self.assertIn("ended", live.NoProblem().see(told(fault="bad_alloc"), doing()).told)
        self.assertIn("picture", live.NoProblem().see(told(message="No tooth is open"), doing()).told)


class Translated(unittest.TestCase):
    NAMES = {"handpiece", "ctrl"}

    def test_japanese(self):
        self.assertEqual(words.foreign("ハンドピース <b>330</b> 1.5 mm, Ctrl+Z, Handpiece", self.NAMES), [])

    def test_english(self):
        self.assertEqual(words.foreign("Undo the last stroke", self.NAMES), ["Undo", "the", "last", "stroke"])

    def test_paths_and_markup_are_no_words(self):
        self.assertEqual(words.foreign("<span style='color:red'>0.3</span>&nbsp;/tmp/molar/cut.h5 molar.handpiece "
                                       "<code>handpiece scan case</code>", self.NAMES), [])

    def test_each_text_once(self):
        invariant = words.Translated(self.NAMES)
        seen = told()
        seen["texts"]["actionUndo"] = "Undo"
        self.assertIn("actionUndo", invariant.see(seen, doing()).told)
        self.assertIsNone(invariant.see(seen, doing()))

    def test_a_button_is_named_by_what_it_is_for(self):
        seen = told()
        seen["places"]["button/Discard"] = [0, 0, 1, 1]
        self.assertIsNone(words.Translated(self.NAMES).see(seen, doing()))

    def test_cells_of_lists(self):
        seen = told()
        seen["places"]["burList/330, Pear"] = [0, 0, 1, 1]
        self.assertIn("Pear", words.Translated(self.NAMES).see(seen, doing()).told)


class Undo(unittest.TestCase):
    def run_states(self, *states):
        invariant = undo.UndoGivesBack()
        names = ("undoSteps", "redoSteps", "strokes", "stateHash")
        return [find for state in states if (find := invariant.see(told(**dict(zip(names, state))), doing()))]

    def test_gives_back(self):
        self.assertEqual(self.run_states((0, 0, 0, "a"), (1, 0, 1, "b"), (2, 0, 2, "c"), (1, 1, 2, "b"), (0, 2, 2, "a"), (1, 1, 2, "b"),
                                         (2, 0, 2, "c")), [])

    def test_undo_gives_another_tooth(self):
        self.assertEqual(len(self.run_states((0, 0, 0, "a"), (1, 0, 1, "b"), (0, 1, 1, "x"))), 1)

    def test_tells_the_two_moments(self):
        invariant = undo.UndoGivesBack()
        invariant.see(told(stateHash="a", timeS=3.0), doing())
        invariant.see(told(stateHash="b", timeS=4.0, undoSteps=1, strokes=1), doing())
        find = invariant.see(told(stateHash="x", timeS=5.0, redoSteps=1, strokes=1), doing())
        self.assertEqual(find.moments, ["a.h5", 3.0, 5.0])

    def test_redo_gives_another_tooth(self):
        self.assertEqual(len(self.run_states((0, 0, 0, "a"), (1, 0, 1, "b"), (0, 1, 1, "a"), (1, 0, 1, "x"))), 1)

    def test_another_stroke_after_undo(self):
        self.assertEqual(self.run_states((0, 0, 0, "a"), (1, 0, 1, "b"), (0, 1, 1, "a"), (1, 0, 2, "c"), (0, 1, 2, "a"), (1, 0, 2, "c")), [])

    def test_a_list_that_is_full_moves_down(self):
        self.assertEqual(self.run_states((2, 0, 7, "b"), (2, 0, 8, "c"), (1, 1, 8, "b"), (2, 0, 8, "c")), [])

    def test_changed_with_nothing_done(self):
        self.assertEqual(len(self.run_states((1, 0, 1, "b"), (1, 0, 1, "x"))), 1)


class Memory(unittest.TestCase):
    def test_steady(self):
        self.assertIsNone(memory.judge([(s, 500.0 + 20.0 * (s % 7)) for s in range(0, 1200, 5)]))

    def test_grows(self):
        self.assertIn("went from", memory.judge([(s, 300.0 + s) for s in range(0, 1200, 5)]).told)

    def test_short_walks_say_little(self):
        self.assertIsNone(memory.judge([(s, 300.0 + s) for s in range(0, 100, 5)]))

    def test_beyond_all_measure(self):
        self.assertIsNotNone(memory.judge([(0, 500.0), (2, 4100.0)]))


if __name__ == "__main__":
    unittest.main()
