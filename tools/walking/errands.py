# SPDX-License-Identifier: Apache-2.0
"""The longer things that a person does: an exercise, a program that is killed or left, a replay, a look at how much the
handpiece hides. Each a step of player.py's kind."""
import time

from . import patience, spots
from .finds import Find
from .glance import hidden_share
from .player import OPENS_S, Player

JUDGED_S, CLOSES_S = 400.0, 30.0
MOST_HIDDEN = 1.0 / 3.0


class Errands(Player):
    def give_up_work(self):
        """Answers the question about unsaved work, where it comes."""
        if self.wait(lambda: "unsavedDialog" in self.windows(), 1.5):
            self.desk.click("button/Discard")

    def do_exercise(self, step):
        """The row of the list, begun."""
        self.over_view()
        self.desk.key("ctrl+shift+l")
        if not self.wait(lambda: "exercisesDialog" in self.windows(), 20.0):
            return
        rows = [name for name in self.desk.widgets() if name.startswith("exercisesList/")]
        if rows:
            self.desk.click(rows[step["row"] % len(rows)])
        # The ideal may be made first; who does not wait for it begins.
        self.wait(lambda: "exercisesBegin" in self.desk.widgets() and "exercisesBegin" not in self.desk.map()["off"], 120.0)
        before = self.hand().get("recording")
        self.desk.click("exercisesBegin")
        self.give_up_work()
        if not self.wait(lambda: self.is_open() and self.hand().get("recording") != before, OPENS_S):
            self.close_windows()
        self.doing.eye_is_walkers = False
        self.close_windows()

    def do_finish(self, step):
        """To the result, and back to the tooth."""
        if not self.hand().get("exercise"):
            return
        self.at_rest()
        self.over_view()
        self.desk.key("ctrl+shift+w")
        if self.wait(lambda: {"judgeShow", "resultTable", "exerciseGoOn"} & self.desk.widgets().keys(), JUDGED_S):
            for name in ("exerciseFinish", "judgeShow"):
                if "resultTable" not in self.desk.widgets() and name in self.desk.widgets():
                    self.desk.click(name)
            self.wait(lambda: "resultTable" in self.desk.widgets(), JUDGED_S)
            if step.get("show") and "resultShow_1" in self.desk.widgets():
                self.desk.click("resultShow_1")
                self.doing.eye_is_walkers = True  # the program showed a place
                time.sleep(2.0)
        self.close_windows()

    def do_first(self, step):
        """Gives up what is open for another tooth of the chart: the one it stands at."""
        self.over_view()
        self.desk.key("ctrl+t")
        if not self.wait(lambda: "toothDialog" in self.windows(), 10.0):
            return
        before = self.hand().get("recording")
        self.desk.key("Return")
        self.give_up_work()
        # Where the chart stands at no tooth (a block, a replay) nothing is opened.
        if self.wait(lambda: self.hand().get("busy"), 3.0):
            self.wait(lambda: self.is_open() and self.hand().get("recording") != before, 60.0)
        self.doing.eye_is_walkers = False
        self.close_windows()

    def do_crash(self, step):
        """Killed in the middle of it all; what was done comes back bit for bit."""
        was = self.hand() if self.at_rest() and self.is_open() else {}
        then = self.moment(was) if was else None
        time.sleep(2.0)  # what is recorded is on the disk within a second
        self.watch.pause()
        self.desk.crash()
        self.restart()
        cut = "stateHash" in was and was.get("unsaved") and was.get("removedMm3", 0.0) + was.get("removedOthersMm3", 0.0) > 0.0
        if not cut:
            return
        if not self.wait(lambda: "noticeRemedy" in self.desk.widgets() and self.hand().get("notice") == "crashed", 20.0):
            self.find(Find("recovers", "after a kill no work is offered to be brought back"))
            return
        self.desk.click("noticeRemedy")
        if not self.wait(lambda: self.is_open() and self.hand().get("recording") == was["recording"], OPENS_S):
            self.find(Find("recovers", "after a kill the work does not come back"))
        elif not self.is_again(was):
            self.find(Find("recovers", f"{was['removedMm3']:.3f} mm³ were gone before a kill, {self.hand().get('removedMm3', 0.0):.3f} "
                           "mm³ are after the recovery, and the tooth is another",
                           moments=[was["recording"], then, self.moment(self.hand())]))

    def do_quit(self, step):
        """By its key, with what was cut given up; then started again."""
        self.leave()
        self.restart()

    def leave(self):
        self.close_windows()
        self.over_view()
        self.watch.pause()
        self.desk.key("ctrl+q")
        end = time.monotonic() + CLOSES_S * patience.times()
        while self.desk.app.poll() is None and time.monotonic() < end:
            if "unsavedDialog" in self.desk.map().get("windows", []):
                self.desk.click("button/Discard")
            time.sleep(0.2)
        if self.desk.app.poll() is None:
            # What a job that hears nothing keeps alive has no window any more.
            what = "the window does not close" if self.desk.windows("handpiece") else "the window is gone, the program does not end"
            self.find(Find("dialog-answers", f"{what} at Ctrl+Q"))
            self.desk.crash()
        elif self.desk.app.returncode != 0:
            self.find(Find("alive", f"the program ended with {self.desk.app.returncode} when it was closed"))

    def restart(self):
        self.desk.start(self.arguments)
        self.doing.eye_is_walkers = False
        self.begin()

    def do_replay(self, step):
        """What was done so far is watched; the tooth comes back as it was."""
        was = self.hand() if self.at_rest() and self.is_open() else {}
        then = self.moment(was) if was else None
        self.over_view()
        self.desk.key("ctrl+y")
        if not self.wait(lambda: self.hand().get("mode") == "replay", 120.0):
            return
        time.sleep(step.get("seconds", 1.0))
        self.desk.click("replayClose")
        if not self.wait(lambda: self.is_open(), OPENS_S):
            self.find(Find("opens", "the tooth does not come back from its replay"))
        elif was.get("stateHash") and not self.is_again(was):
            self.find(Find("replay-gives-back", "after its replay the tooth is another than before",
                           moments=[was["recording"], then, self.moment(self.hand())]))

    def is_again(self, was):
        """At rest, and the tooth that it was."""
        return self.wait(lambda: self.at_rest() and self.hand().get("stateHash") == was["stateHash"], 3.0)

    def do_glance(self, step):
        """How much of the tooth the handpiece hides: the picture with it and without, the bur where it is."""
        if not self.is_open():
            return
        self.run_glance_path(step)
        with_it, without = self.two_pictures()
        if with_it is None:
            return
        share = hidden_share(with_it, without, self.hand())
        if share > MOST_HIDDEN:
            self.find(Find("handpiece-hides", f"the handpiece hides {100 * share:.0f} % of the crown's picture, a third at most "
                           "is allowed", {"share": round(share, 3)}))

    def run_glance_path(self, step):
        self.run_path(spots.path(self.hand(), step["spots"]), 0.3)
        time.sleep(1.0)

    def two_pictures(self):
        """With and without the handpiece, switched where the look's panel shows it; None where it does not."""
        if "showTurbine" not in self.desk.widgets():
            return None, None
        pictures = []
        for _ in range(2):
            self.desk.still("view", 4)
            pictures.append((("showTurbine" in self.desk.map()["on"]), self.desk.pixels("view")))
            self.desk.click("showTurbine", 0.1)
        shown = dict(pictures)
        return (shown.get(True), shown.get(False)) if len(shown) == 2 else (None, None)


KINDS = {name[3:] for name in dir(Errands) if name.startswith("do_")}
