# SPDX-License-Identifier: Apache-2.0
"""Does the steps of a way in the real window. What a step finds not there it leaves out, so that a way goes on to mean
something when steps before it were taken away."""
import re
import subprocess
import time

from . import patience, spots
from .finds import Find
from .live import Doing

RESTS_S, OPENS_S = 20.0, 600.0
STANDARD_EYE = {"1", "2", "3", "4", "5", "6", "Home"}


def number_of(text):
    """What a field says, whatever it writes between thousands; None without a number."""
    plain = re.sub(r"(?<=\d)[,\u202f\u00a0 ](?=\d{3})", "", text).replace("\u2212", "-")
    found = re.search(r"-?\d+(?:[.,]\d+)?", plain)
    return float(found[0].replace(",", ".")) if found else None


class Player:
    """`find(Find)` is told what breaks here; `watch` sees the maps; `log` is what recorded.py judges by."""

    def __init__(self, desk, watch, find, way, arguments):
        self.desk, self.watch, self.find, self.arguments = desk, watch, find, arguments
        self.doing = watch.doing = Doing()
        self.log, self.recordings = [], set()
        self.language = way["start"]["language"]

    # What the window says.

    def hand(self):
        return self.watch.latest().get("hand", {})

    def windows(self):
        return self.watch.latest().get("windows", [])

    def others(self):
        """Windows but the main one and what only tells."""
        return [name for name in self.windows() if name not in ("mainWindow", "qtooltip_label")]

    def wait(self, happens, seconds):
        end = time.monotonic() + seconds * patience.times()
        while time.monotonic() < end:
            if happens():
                return True
            if self.desk.app.poll() is not None:
                return False
            time.sleep(0.1)
        return bool(happens())

    def fresh(self):
        """A map that was written after now."""
        now = time.monotonic()
        self.wait(lambda: self.hand().get("clockS", 0.0) > now, 5.0)
        return self.hand()

    def is_open(self):
        hand = self.hand()
        return hand.get("mode") == "live" and not hand.get("busy") and "camera" in hand and hand.get("tick", 0) > 0

    def at_rest(self, seconds=RESTS_S):
        """Until nothing changes in the tooth; False where that does not come, in a replay at once."""
        now = time.monotonic()
        self.wait(lambda: self.hand().get("clockS", 0.0) > now and ("stateHash" in self.hand() or self.hand()["mode"] != "live"), seconds)
        return "stateHash" in self.hand()

    def opened(self):
        return self.wait(self.is_open, OPENS_S)

    def begin(self):
        self.watch.renew()
        if not self.opened():
            self.find(Find("opens", f"no tooth that can be cut within {OPENS_S:.0f} s"))
            return False
        if "welcomeClose" in self.desk.widgets():
            self.desk.click("welcomeClose")
        self.look()
        return True

    def moment(self, hand):
        """Of its recording, for a find's `moments`."""
        return [self.watch.sitting(hand["recording"]), hand["timeS"]]

    # The steps.

    def do(self, number, step):
        self.doing.step, self.doing.expects_problem = number, False
        try:
            getattr(self, "do_" + step["do"])(step)
        except (KeyError, subprocess.CalledProcessError, subprocess.TimeoutExpired):
            pass  # what was to be clicked has gone
        self.doing.pixels = []
        recording = self.hand().get("recording")
        if recording:
            self.recordings.add(recording)

    def do_key(self, step):
        for key in step["keys"]:
            if key in STANDARD_EYE:
                self.doing.eye_is_walkers = False
        self.desk.key(*step["keys"])

    def over_view(self):
        """Keys are the picture's as soon as the pointer is over it."""
        self.desk.move("view", 0.5, 0.08)
        time.sleep(0.1)

    def do_view(self, step):
        self.over_view()
        self.desk.key(step["key"])
        time.sleep(0.3)
        self.doing.eye_is_walkers = False
        self.look()

    def look(self):
        """That something is drawn where the tooth is to be."""
        if not self.is_open() or self.others():
            return
        width, height = self.hand()["viewport"]

        def colours():
            pixels = self.desk.pixels("view")
            return len(set(pixels[i:i + 3] for i in range(0, len(pixels) - 2, 3 * 97)))
        if width < 100 or height < 100 or self.wait(lambda: colours() > 40, 10.0):
            return
        if self.is_open():
            self.find(Find("tooth-in-frame", "the picture is empty", {"colours": colours()}))

    def screen(self, pixels):
        x, y, _, _ = self.desk.widgets()["view"]
        return [(round(x + px), round(y + py)) for px, py in pixels]

    def run_path(self, pixels, seconds, press=None, held=0.0, keys=()):
        """One xdotool for the whole way: pointer, button, pauses."""
        words, at = [], self.screen(pixels)
        pause = max(0.004, seconds / max(1, len(at) - 1))
        for key in keys:
            words += ["keydown", key]
        words += ["mousemove", *at[0]]
        if press:
            words += ["sleep", 0.25, "mousedown", press]
        if held:
            words += ["sleep", held]
        for x, y in at[1:]:
            words += ["mousemove", x, y, "sleep", round(pause, 4)]
        if press:
            words += ["sleep", 0.1, "mouseup", press]
        for key in keys:
            words += ["keyup", key]
        self.desk.xdo(*words)

    def do_hover(self, step):
        self.run_path(spots.path(self.hand(), step["spots"]), step["seconds"])

    def do_orbit(self, step):
        self.doing.eye_is_walkers = True
        self.run_path(spots.path(self.hand(), step["spots"], 25.0), step["seconds"], press=step.get("button", 3))

    def do_wheel(self, step):
        if not step.get("keys"):
            self.doing.eye_is_walkers = True
        self.run_path(spots.path(self.hand(), [step["spot"]]), 0.0)
        self.desk.wheel(step["notches"], *step.get("keys", []))

    def do_drag(self, step):
        """The press that all this is about."""
        hand = self.fresh()
        if not self.is_open() or "pressed" not in hand:
            return
        pixels = spots.path(hand, step["spots"])
        if step.get("back"):
            pixels += pixels[::-1][1:]
        began = time.monotonic()
        # Slowly (Shift) the hand goes a part of the pointer's way, from where it is.
        under = [] if "shift" in step.get("keys", []) else pixels
        self.doing.pixels, self.doing.since_s = [(float(x), float(y)) for x, y in under], began
        self.run_path(pixels, step["seconds"], press=1, held=step.get("held", 0.3), keys=step.get("keys", []))
        ended = time.monotonic()
        self.doing.pixels = []
        after = self.fresh()
        if not self.at_rest() and self.desk.app.poll() is None:
            self.find(Find("comes-to-rest", f"{RESTS_S:.0f} s after the button was let go the stroke has not ended"))
        self.note_press(hand, after, pixels, began, ended, step)

    def note_press(self, hand, after, pixels, began, ended, step):
        """For the recording's judges; where the eye moved meanwhile, or a tool was in the hand, they cannot know."""
        seen = [h for h in self.watch.hands_since(began - 0.5) if h.get("recording") == hand.get("recording")]
        # The freshest: a poll is old by up to 33 ms.
        shifts = [h["clockS"] - h["timeS"] for h in seen if h.get("clockS", 0) <= ended + 1.5 and h.get("timeS")]
        if (not shifts or "viewport" not in after or spots.eye.eye_moved(hand, after) or not hand.get("isDrill")
                or hand.get("compare") or hand["camera"].get("mirrored") or "shift" in step.get("keys", [])):
            return
        shift = min(shifts)
        self.log.append({"step": self.doing.step, "sitting": self.watch.sitting(hand["recording"]), "recording": hand["recording"],
                         "hand": {k: hand[k] for k in ("camera", "viewport")},
                         "pixels": pixels, "from_s": began + 0.25 - shift, "to_s": ended - 0.1 - shift, "load_n": hand["loadN"],
                         "latched": hand.get("latched", False), "stop_mm": hand.get("stopMm"), "bur": hand["bur"], "tooth_mm": hand["toothMm"]})

    def do_undo(self, step):
        self.at_rest()
        for _ in range(step.get("times", 1)):
            self.desk.key("ctrl+shift+z" if step.get("redo") else "ctrl+z")
            self.at_rest()

    def do_reset(self, step):
        self.at_rest()
        self.desk.key("ctrl+BackSpace")
        self.at_rest()

    def do_click(self, step):
        if step["name"] in self.desk.widgets():
            self.desk.click(step["name"], *step.get("at", [0.5, 0.5]))

    def do_stop_on(self, step):
        if "depthStopOn" in self.desk.widgets() and "depthStopOn" not in self.desk.map()["on"]:
            self.desk.click("depthStopOn", 0.1)
            self.fresh()

    def do_typed(self, step):
        """A number into a field, as fast or slowly as people type; it is then what the field says."""
        if step["name"] not in self.desk.widgets() or step["name"] in self.desk.map()["off"]:
            return
        self.desk.click(step["name"], 0.25)
        self.desk.key("ctrl+a")
        self.desk.xdo("type", "--delay", step["delay_ms"], step["text"])
        time.sleep(0.3)
        self.desk.key(step.get("end", "Tab"))
        self.fresh()
        if step["name"] not in self.desk.widgets():
            return
        if not self.wait(lambda: number_of(self.desk.text(step["name"])) == float(step["text"]), 3.0):
            self.find(Find("typed-number", f"\"{step['text']}\" typed into {step['name']} at {step['delay_ms']} ms a key became "
                           f"\"{self.desk.text(step['name'])}\"", {"delay_ms": step["delay_ms"]}, self.doing.step))
        self.over_view()

    def do_dialog(self, step):
        """Opened by its key, looked at, closed by Escape."""
        self.over_view()
        self.desk.key(step["key"])
        time.sleep(step.get("seconds", 0.6))
        self.close_windows()

    def do_menu(self, step):
        if step["name"] in self.desk.widgets():
            self.desk.click(step["name"])
            time.sleep(0.4)
        self.close_windows()

    def close_windows(self):
        """Whatever is open but the main window answers to Escape."""
        for _ in range(6):
            self.fresh()
            if not self.others():
                return
            self.desk.key("Escape")
            self.wait(lambda: not self.others(), 1.0)
        left = self.others()
        if left and self.desk.app.poll() is None:
            self.find(Find("dialog-answers", f"{', '.join(left)} does not close at Escape", {}, self.doing.step))

    def do_resize(self, step):
        found = self.desk.windows("handpiece")
        if found:
            self.desk.xdo("windowsize", found[0], *step["size"])
            time.sleep(0.5)

    def do_wait(self, step):
        time.sleep(step["seconds"])
