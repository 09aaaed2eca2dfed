# SPDX-License-Identifier: Apache-2.0
"""Ways: the same from the same seed, read and written, shrunk; what is known hides nothing new."""
import itertools
import pathlib
import tempfile
import unittest

from support import ROOT, hand
from walking import errands, glance, people, player, shrink, spots, way
from walking.finds import Find, KnownList


def some(seed, count=400):
    return list(itertools.islice(people.Person(seed).steps(), count))


class People(unittest.TestCase):
    def test_a_seed_is_a_way(self):
        self.assertEqual(some(5), some(5))
        self.assertNotEqual(some(5), some(6))

    def test_every_step_can_be_done(self):
        done = {step["do"] for seed in range(20) for step in some(seed)}
        self.assertEqual(done - errands.KINDS, set())
        self.assertEqual(errands.KINDS - done, {"wait"})  # for ways written by hand

    def test_only_what_was_asked(self):
        steps = list(itertools.islice(people.Person(1, {"take_back": 1}).steps(), 50))
        self.assertLessEqual({step["do"] for step in steps[6:]}, {"undo", "reset"})


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.file = pathlib.Path(self.folder.name) / "way.json"

    def test_round(self):
        one = way.with_steps(way.new(7, {"language": "ja"}), some(7, 30))
        way.write(self.file, one)
        self.assertEqual(way.read(self.file, errands.KINDS), one)

    def test_what_is_no_way(self):
        for text, word in (("{", "no way can be read"), ("[]", "format 1"), ('{"format": 2}', "format 1"),
                           ('{"format": 1}', "no steps"), ('{"format": 1, "steps": [{"do": "fly"}]}', "step 1 does something unknown")):
            self.file.write_text(text)
            with self.assertRaises(SystemExit) as problem:
                way.read(self.file, errands.KINDS)
            self.assertIn(word, str(problem.exception))

    def test_those_that_are_kept(self):
        for file in sorted((ROOT / "tests" / "walk" / "ways").glob("*.json")):
            with self.subTest(file.name):
                kept = way.read(file, errands.KINDS)
                self.assertIn("invariant", kept)
                self.assertIn("told", kept)


class Shrink(unittest.TestCase):
    STEPS = [{"do": "view", "key": str(i)} for i in range(40)]

    def shrink(self, needed, at=None, **limits):
        walked = []

        def fails(steps):
            walked.append(len(steps))
            keys = [step["key"] for step in steps]
            places = [keys.index(key) for key in needed if key in keys]
            return len(places) == len(needed) and places == sorted(places)
        found = shrink.shrink(self.STEPS, fails, at, **limits)
        return [step["key"] for step in found], walked

    def test_to_the_one(self):
        found, walked = self.shrink(["23"], at=23)
        self.assertEqual(found, ["23"])
        self.assertLessEqual(len(walked), 3)

    def test_to_those_that_belong_together(self):
        found, _ = self.shrink(["4", "17", "30"], at=30, tries=200)
        self.assertEqual(found, ["4", "17", "30"])

    def test_what_comes_after_is_not_needed(self):
        found, walked = self.shrink(["0"], at=0)
        self.assertEqual(found, ["0"])
        self.assertEqual(walked, [1])

    def test_stops_when_tries_are_used_up(self):
        found, walked = self.shrink(["4", "17", "30"], at=30, tries=5)
        self.assertEqual(len(walked), 5)
        self.assertLessEqual({"4", "17", "30"}, set(found))

    def test_a_way_that_never_fails_again_stays(self):
        self.assertEqual(shrink.shrink(self.STEPS, lambda _: False, 39), self.STEPS)


class Known(unittest.TestCase):
    ENTRY = {"invariant": "hand-near-pointer", "told": "the hand is", "reason": "issue 37", "at_most": {"off_mm": 20.0}}

    def test_known(self):
        self.assertEqual(KnownList([self.ENTRY]).reason_of(Find("hand-near-pointer", "the hand is 11 mm away", {"off_mm": 11.0})), "issue 37")

    def test_news(self):
        known = KnownList([self.ENTRY])
        for find in (Find("force-within-load", "the hand is strong", {"off_mm": 1.0}), Find("hand-near-pointer", "it went", {"off_mm": 1.0}),
                     Find("hand-near-pointer", "the hand is 90 mm away", {"off_mm": 90.0}), Find("hand-near-pointer", "the hand is away")):
            self.assertIsNone(known.reason_of(find))
        self.assertEqual(known.never_met(), [self.ENTRY])

    def test_a_reason_is_needed(self):
        for entry in ({"invariant": "a", "told": "b"}, {**self.ENTRY, "reason": " "}, {**self.ENTRY, "always": True}):
            with self.assertRaises(SystemExit):
                KnownList([entry])

    def test_the_list_that_is_kept(self):
        known = KnownList.read(ROOT / "tests" / "walk" / "known.toml")
        text = (ROOT / "docs" / "walk.md").read_text()
        for entry in known.entries:
            self.assertIn(f"`{entry['invariant']}`", text)


class Places(unittest.TestCase):
    def test_the_middle_of_the_crown(self):
        x, y = spots.pixel(hand(), ["tooth", 0.5, 0.5])
        self.assertAlmostEqual(x, 400.0, 3)
        self.assertAlmostEqual(y, 300.0, 3)

    def test_held_to_the_picture(self):
        self.assertEqual(spots.pixel(hand(), ["tooth", 99.0, -99.0]), (796.0, 3.0))

    def test_a_path_has_its_ends(self):
        path = spots.path(hand(), [["view", 0.25, 0.5], ["view", 0.75, 0.5]])
        self.assertEqual((path[0], path[-1]), ((200, 300), (600, 300)))


class Fields(unittest.TestCase):
    def test_numbers_as_they_are_written(self):
        for text, number in (("1.7 mm", 1.7), ("1,7 mm", 1.7), ("-2.3 mm", -2.3), ("\u22122.3 mm", -2.3), ("400,000 rpm", 400000.0),
                             ("400\u202f000 rpm", 400000.0), ("off", None)):
            self.assertEqual(player.number_of(text), number)


class Glance(unittest.TestCase):
    def test_share(self):
        h = hand(viewport=[80, 60])
        white, half = bytes([255]) * (3 * 80 * 60), bytearray([255]) * (3 * 80 * 60)
        self.assertEqual(glance.hidden_share(white, white, h), 0.0)
        for y in range(60):
            half[3 * 80 * y:3 * 80 * y + 120] = bytes(120)
        self.assertAlmostEqual(glance.hidden_share(bytes(half), white, h), 0.5, delta=0.1)
        glass = bytes([200]) * (3 * 80 * 60)
        self.assertEqual(glance.hidden_share(glass, white, h), 0.0)


if __name__ == "__main__":
    unittest.main()
