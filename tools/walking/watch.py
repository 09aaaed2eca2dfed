# SPDX-License-Identifier: Apache-2.0
"""Looks at the window's map all the time, on a thread of its own, and holds the live invariants."""
import json
import threading
import time

from . import memory, patience
from .finds import Find

EVERY_S = 0.08
# A map comes five times a second; so long may a long job on the window's thread keep it, on a machine of one's own.
ANSWERS_WITHIN_S = 15.0
REMEMBERED = 3000


class Watch:
    """`desk.app` may be another after a crash: renew() forgets what was of the one before."""

    def __init__(self, desk, invariants, when_found):
        self.desk, self.invariants, self.when_found = desk, invariants, when_found
        self.doing = None
        self.maps, self.memory = [], {}
        self.sittings = {}  # of each recording: the newest tick of its loop, and how often that has begun anew
        self.paused, self.ended = True, False
        self.lock = threading.Lock()
        self.stamp, self.heard = None, time.monotonic()
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def renew(self):
        with self.lock:
            self.paused, self.stamp, self.heard = False, None, time.monotonic()
            self.maps.clear()

    def pause(self):
        with self.lock:
            self.paused = True

    def stop(self):
        self.ended = True
        self.thread.join(5)

    def latest(self):
        with self.lock:
            return self.maps[-1] if self.maps else {}

    def hands_since(self, clock_s):
        with self.lock:
            return [told["hand"] for told in self.maps if told["hand"].get("clockS", 0.0) >= clock_s]

    def _run(self):
        while not self.ended:
            time.sleep(EVERY_S)
            with self.lock:
                if not self.paused and self.doing is not None:
                    finds = self._look()
                else:
                    finds = []
            for find in finds:
                self.when_found(find)

    def _look(self):
        finds, now = [], time.monotonic()
        if self.desk.app.poll() is not None:
            self.paused = True
            return [self._at(Find("alive", f"the program ended by itself with {self.desk.app.returncode}"))]
        try:
            stamp = self.desk.map_file.stat().st_mtime_ns
            told = json.loads(self.desk.map_file.read_text()) if stamp != self.stamp else None
        except (OSError, ValueError):
            told = None
        if told is None:
            if now - self.heard > ANSWERS_WITHIN_S * patience.times():
                finds.append(self._at(Find("answers", f"the window has not answered for {now - self.heard:.0f} s")))
                self.heard = now + 3600.0  # told once
            return finds
        self.stamp, self.heard = stamp, now
        told.setdefault("hand", {})
        self._count(told["hand"])
        self.maps.append(told)
        del self.maps[:-REMEMBERED]
        series = self.memory.setdefault(self.desk.app.pid, [])
        if not series or now - series[-1][0] > 2.0:
            series.append((now, memory.resident_mb(self.desk.app.pid)))
        for invariant in self.invariants:
            find = invariant.see(told, self.doing)
            if find:
                finds.append(self._at(find))
        return finds

    def sitting(self, recording):
        return self.sittings.get(recording, (0, 0))[1]

    def _count(self, hand):
        """A recording that goes on (after a replay, a crash) has a loop that counts from nought again."""
        if hand.get("mode") == "live" and hand.get("recording"):
            tick, times = self.sittings.get(hand["recording"], (0, 0))
            self.sittings[hand["recording"]] = hand["tick"], times + (hand["tick"] < tick)

    def _at(self, find):
        find.step = self.doing.step
        if find.moments:
            recording, then, now = find.moments
            find.moments = [recording, *([self.sitting(recording), at] for at in (then, now))]
        return find
