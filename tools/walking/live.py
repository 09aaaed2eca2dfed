# SPDX-License-Identifier: Apache-2.0
"""Invariants held on every widget map while the window is walked. Each has a name and see(map, way), where `way` says
what the walker is doing; it gives a Find, or None. Plain data in, so tests plant faults."""
import dataclasses
import math

from . import eye, patience
from .finds import Find

# How far the hand may be from the pointer's path: what it is lifted by over a cusp.
HAND_OFF_PATH_MM = 2.5
# On its way, the pedal up, it may be anywhere (docs/pointer.md, 8); for longer than this the picture says why.
AWAY_UNTOLD_S = 5.0
FORCE_OVER_LOAD, FORCE_SLACK_N = 1.1, 0.05
# What is over for no longer than a few milliseconds nobody feels; so much is too much at any time.
FORCE_PEAK = 2.0
SECONDS_BETWEEN_NOTICES = 60.0
# Answers to what the person just asked for, each time anew.
ANSWERS = {"nothing-to-undo", "nothing-to-redo", "nothing-to-reset", "not-while-cutting", "saved", "refused", "bur-locked",
           "help-locked", "handed-in", "hull-only-touches"}


@dataclasses.dataclass
class Doing:
    """What the walker does now, for those who judge what they see."""
    step: int = -1
    pixels: list = dataclasses.field(default_factory=list)  # of the press under way, in the picture
    since_s: float = 0.0             # when that began
    eye_is_walkers: bool = False     # it turned, shifted or zoomed the view since the last standard one
    expects_problem: bool = False    # an error dialog is what the step is to bring


def live(hand):
    return hand.get("mode") == "live" and not hand.get("busy") and "camera" in hand


def works(hand):
    """It cuts, or bears on something: a pedal that was latched is down on the way, too."""
    return (hand.get("pedal", 0.0) > 0.0 and not hand.get("latched")) or any(hand["forceN"])


class HandNearPointer:
    """While the button is down a hand that works is near a line of sight through where the pointer was; one that is
    not comes there, or the picture says why it does not."""
    name = "hand-near-pointer"

    def __init__(self):
        self.far, self.away_since = 0, None

    def see(self, told, doing):
        hand = told.get("hand", {})
        if not (live(hand) and hand.get("pressed") and doing.pixels) or hand["clockS"] < doing.since_s + 1.0:
            self.far, self.away_since = 0, None
            return None
        off = eye.off_path_mm(hand["handMm"], hand, doing.pixels)
        is_far = off > HAND_OFF_PATH_MM
        self.far = self.far + 1 if is_far and works(hand) else 0
        if self.far == 2:
            return Find(self.name, f"the hand is {off:.1f} mm from where the pointer was, {HAND_OFF_PATH_MM} at most are allowed",
                        {"off_mm": round(off, 2)})
        if not is_far or works(hand) or hand.get("hint"):
            self.away_since = None
        elif self.away_since is None:
            self.away_since = hand["clockS"]
        elif hand["clockS"] - self.away_since > AWAY_UNTOLD_S * patience.times():
            self.away_since = float("inf")  # told once
            return Find(self.name, f"the hand stays {off:.1f} mm from where the pointer was, and nothing says why",
                        {"off_mm": round(off, 2)})
        return None


class ForceWithinLoad:
    """The mouse's hand presses with no more than what is set; a map may meet a peak of a millisecond, two do not."""
    name = "force-within-load"

    def __init__(self):
        self.over, self.is_told = 0, False

    def see(self, told, doing):
        hand = told.get("hand", {})
        if not (live(hand) and hand.get("pressed") and "loadN" in hand):
            self.over, self.is_told = 0, False
            return None
        force = math.sqrt(sum(n * n for n in hand["forceN"]))
        if force <= FORCE_OVER_LOAD * hand["loadN"] + FORCE_SLACK_N:
            self.over, self.is_told = 0, False
            return None
        self.over += 1
        if self.is_told or (self.over < 2 and force <= FORCE_PEAK * hand["loadN"] + FORCE_SLACK_N):
            return None
        self.is_told = True
        return Find(self.name, f"{force:.2f} N on the instrument where {hand['loadN']:.1f} N is set",
                    {"force_n": round(force, 3), "over": round(force / hand["loadN"], 3)})


class NoticeOnce:
    """No notice comes twice within a minute, but for one that a graver one had covered, or that answers a request."""
    name = "notice-once"

    def __init__(self):
        self.shown, self.began, self.now = {}, None, ""

    def see(self, told, doing):
        hand = told.get("hand", {})
        notice, clock = hand.get("notice", ""), hand.get("clockS", 0.0)
        before, self.now = self.now, notice
        if not notice or notice == before:
            return None
        last = self.shown.get(notice)
        self.shown[notice] = clock
        # It stood behind the one before.
        if last is None or before or notice in ANSWERS or clock - last >= SECONDS_BETWEEN_NOTICES:
            return None
        return Find(self.name, f"\"{notice}\" came twice within {clock - last:.0f} s", {"apart_s": round(clock - last, 1)})


class ToothInFrame:
    """The tooth is in the picture unless the walker turned or zoomed it away."""
    name = "tooth-in-frame"

    def __init__(self):
        self.lost = 0

    def see(self, told, doing):
        hand = told.get("hand", {})
        if not live(hand) or doing.eye_is_walkers:
            self.lost = 0
            return None
        box = eye.crown_seen(hand)
        width, height = hand["viewport"]
        share = 0.0
        if box:
            left, top, right, bottom = box
            inside = max(0.0, min(right, width) - max(left, 0.0)) * max(0.0, min(bottom, height) - max(top, 0.0))
            share = inside / max(1.0, (right - left) * (bottom - top))
        self.lost = self.lost + 1 if share < 0.5 else 0
        if self.lost != 2:
            return None
        return Find(self.name, f"only {100 * share:.0f} % of the crown's place is in the picture, and nobody turned it away",
                    {"share": round(share, 3)})


class NoProblem:
    """Nothing goes wrong that the walker did not bring about."""
    name = "no-problem"

    def __init__(self):
        self.told = set()

    def see(self, told, doing):
        hand = told.get("hand", {})
        what = []
        if "errorDialog" in told.get("windows", []) and not doing.expects_problem:
            what.append("an error is shown: " + told["texts"].get("errorWhat", ""))
        if hand.get("fault"):
            what.append("the work has ended: " + hand["fault"])
        if live(hand) and hand.get("message"):
            what.append("instead of the picture: " + hand["message"])
        new = [one for one in what if one not in self.told]
        self.told.update(new)
        return Find(self.name, new[0]) if new else None


def all_of_them():
    return [HandNearPointer(), ForceWithinLoad(), NoticeOnce(), ToothInFrame(), NoProblem()]
