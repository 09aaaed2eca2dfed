# SPDX-License-Identifier: Apache-2.0
"""How much the handpiece hides, on pictures made by hand: silent on a tooth that is seen, and it speaks of one that is
not."""
import unittest

from support import hand
from walking import errands, eye, glance

WIDTH, HEIGHT = hand()["viewport"]
TOOTH, STEEL = (210, 195, 160), (60, 62, 66)


def picture(*boxes, tooth=TOOTH):
    """RGB bytes: the tooth all over, and boxes (left, top, right, bottom, colour) on it."""
    rows = [bytearray(bytes(tooth) * WIDTH) for _ in range(HEIGHT)]
    for left, top, right, bottom, colour in boxes:
        for y in range(max(0, round(top)), min(HEIGHT, round(bottom))):
            rows[y][3 * round(left):3 * round(right)] = bytes(colour) * (round(right) - round(left))
    return b"".join(rows)


def over_the_crown(share, colour=STEEL):
    """A bar that covers so much of the crown's box, from its left."""
    left, top, right, bottom = eye.crown_seen(hand())
    return left, top, left + share * (right - left), bottom, colour


class Window:
    """What do_glance asks of a desk: the picture, with the handpiece or without, and the switch that shows it."""

    def __init__(self, with_it, without, shown=True, switch=True):
        self.with_it, self.without, self.shown, self.switch = with_it, without, shown, switch

    def widgets(self):
        return {"view": [0, 0, WIDTH, HEIGHT], **({"showTurbine": [0, 0, 9, 9]} if self.switch else {})}

    def map(self):
        return {"on": ["showTurbine"] if self.shown else []}

    def still(self, *_):
        pass

    def pixels(self, _):
        return self.with_it if self.shown else self.without

    def click(self, name, *_):
        assert name == "showTurbine"
        self.shown = not self.shown


class Glance(errands.Errands):
    """Of a window that stands still."""

    def __init__(self, window):
        self.desk, self.found = window, []
        self.find = self.found.append

    def hand(self):
        return hand()

    def is_open(self):
        return True

    def run_glance_path(self, step):
        pass


class HandpieceHides(unittest.TestCase):
    def share(self, with_it, without=None):
        return glance.hidden_share(with_it, without or picture(), hand())

    def finds(self, with_it, **changes):
        window = Window(with_it, picture(), **changes)
        person = Glance(window)
        was = window.shown
        person.do_glance({"do": "glance", "spots": [["tooth", 0.5, 0.5]]})
        self.assertEqual(window.shown, was)  # left as it was
        return person.found

    def test_the_share_is_that_of_the_crown(self):
        self.assertEqual(self.share(picture()), 0.0)
        for share in (0.1, 0.3, 0.5, 1.0):
            self.assertAlmostEqual(self.share(picture(over_the_crown(share))), share, delta=0.02)

    def test_what_lies_beside_the_crown_hides_nothing(self):
        _, _, right, _ = eye.crown_seen(hand())
        self.assertEqual(self.share(picture((right + 4, 0, WIDTH, HEIGHT, STEEL))), 0.0)

    def test_glass_and_a_shadow_hide_nothing(self):
        through = tuple(channel - 50 for channel in TOOTH)
        self.assertEqual(self.share(picture(over_the_crown(1.0, through))), 0.0)

    def test_a_quarter_is_allowed(self):
        self.assertEqual(self.finds(picture(over_the_crown(0.25))), [])

    def test_half_is_a_find(self):
        for shown in (True, False):
            [find] = self.finds(picture(over_the_crown(0.5)), shown=shown)
            self.assertEqual(find.invariant, "handpiece-hides")
            self.assertAlmostEqual(find.numbers["share"], 0.5, delta=0.02)

    def test_without_the_switch_nothing_is_said(self):
        self.assertEqual(self.finds(picture(over_the_crown(1.0)), switch=False), [])


if __name__ == "__main__":
    unittest.main()
