# SPDX-License-Identifier: Apache-2.0
"""One walk: a window in a home of its own, steps one after the other, all invariants; then its recordings."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from . import live, memory, undo, words
from .errands import Errands
from .finds import Find
from .watch import Watch

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from desk import ROOT, Desk  # noqa: E402

NAMES = ROOT / "tests" / "walk" / "names.txt"
# What libraries tell of a machine without a GPU, a sound card or a session bus is not the program's.
NOT_OURS = ("libEGL warning", "MESA", "[ALSOFT]", "ALSA lib", "XDG_RUNTIME_DIR", "dbus", "QStandardPaths: ")


class Walk:
    """`options`: program, display, cache, out (a folder for pictures), sweeps, replays, module (of Python, or None)."""

    def __init__(self, way, options, tell=print):
        self.way, self.options, self.tell = way, options, tell
        self.finds, self.done = [], []
        self.home = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-walk-"))
        (self.home / "Documents").mkdir()

    def found(self, find):
        """Of a thread or of the player: kept once an invariant and step, with a picture of the moment."""
        if find.step < 0:
            find.step = self.player.doing.step if self.player else -1
        if any(f.invariant == find.invariant and f.step == find.step for f in self.finds):
            return
        self.finds.append(find)
        self.tell(f"  FIND {find}")
        if self.options.out:
            place = self.options.out / f"{len(self.finds):02d}-{find.invariant}.png"
            try:
                self.desk.shot(place)
                find.numbers["picture"] = place.name
            except (OSError, subprocess.CalledProcessError):
                pass

    def walk(self, steps, until):
        """Does `steps` (an iterator) until `until` says it is enough."""
        self.player = None
        start = self.way["start"]
        arguments = ["--no-sound", "--language", start["language"], "--layout", start["layout"], *start.get("arguments", [])]
        environment = {"HOME": str(self.home), "HANDPIECE_SCHOOL_SETTINGS": str(self.home / "none.toml")}
        if self.options.cache:
            environment["XDG_CACHE_HOME"] = str(self.options.cache)
        else:
            environment["XDG_CACHE_HOME"] = os.environ.get("XDG_CACHE_HOME", str(pathlib.Path.home() / ".cache"))
        errors = self.home / "stderr.txt"
        with Desk(arguments, size=start["size"], display=self.options.display, build=self.options.program, home=self.home,
                  environment=environment, errors=errors) as self.desk:
            invariants = live.all_of_them() + [undo.UndoGivesBack()]
            if start["language"] == "ja":
                invariants.append(words.Translated(words.read_names(NAMES)))
            watch = Watch(self.desk, invariants, self.found)
            self.player = Errands(self.desk, watch, self.found, self.way, arguments)
            try:
                if self.player.begin():
                    until.begin()
                    self.go(steps, until)
                if self.desk.app.poll() is None:
                    self.player.at_rest()
                    self.player.leave()
            finally:
                watch.stop()
            for series in watch.memory.values():
                self.tell(f"  memory: {series[0][1]:.0f} MB at first, {max(mb for _, mb in series):.0f} at most, {series[-1][1]:.0f} at the "
                          f"end of {series[-1][0] - series[0][0]:.0f} s", quiet=True)
                find = memory.judge(series)
                if find:
                    self.found(find)
        self.read_errors(errors)
        self.read_recordings()
        return self.finds

    def go(self, steps, until):
        for number, step in enumerate(steps):
            if time.monotonic() > until.clock_s or self.desk.app.poll() is not None:
                return
            if until.invariant and any(f.invariant == until.invariant for f in self.finds):
                return
            self.done.append(step)
            self.tell(f"  {number:4d} {json.dumps(step, ensure_ascii=False)}", quiet=True)
            self.player.do(number, step)
            if number % 10 == 9:
                self.tell(f"  {memory.resident_mb(self.desk.app.pid):.0f} MB", quiet=True)

    def read_errors(self, file):
        lines = [line for line in file.read_text(errors="replace").splitlines() if line.strip() and not
                 any(word in line for word in NOT_OURS)] if file.is_file() else []
        if lines:
            self.finds.append(Find("stderr-empty", f"{len(lines)} lines on stderr, the first: {lines[0][:160]}"))

    def read_recordings(self):
        """What the disk holds once the window is closed."""
        tool = self.desk.program.with_name("handpiece")
        environment = dict(self.desk.environment)
        for recording in sorted(self.player.recordings)[:self.options.replays] if self.player else []:
            if not pathlib.Path(recording).is_file():
                continue
            done = subprocess.run([str(tool), "replay", recording, "--json"], capture_output=True, text=True, check=False,
                                  env=environment)
            try:
                matches = json.loads(done.stdout)["matches"]
            except (ValueError, KeyError):
                matches = False
            # Killed before its first key frame: there is nothing that it could be held to.
            if not matches and "before it told a state" not in done.stderr:
                self.finds.append(Find("replay-matches", "cut again, the recording is another tooth: "
                                       f"{(done.stderr or done.stdout).strip()[-200:]}"))
        if self.options.module is None:
            return
        from . import recorded
        self.finds = [find for find in self.finds if not self.is_belied(find, recorded)]
        for recording in sorted(self.player.recordings) if self.player else []:
            presses = [press for press in self.player.log if press["recording"] == recording]
            if not presses or not pathlib.Path(recording).is_file():
                continue
            for find in recorded.judge(recording, presses, self.options.module, self.options.sweeps, self.tell):
                same = [f for f in self.finds if f.invariant == find.invariant and f.step == find.step]
                # The recording knows more than the maps.
                if same:
                    same[0].told, picture = find.told, same[0].numbers.get("picture")
                    same[0].numbers = dict(find.numbers, **({"picture": picture} if picture else {}))
                else:
                    self.finds.append(find)

    def is_belied(self, find, recorded):
        """The window spoke of another tooth, and the recording has the same."""
        if not find.moments or not pathlib.Path(find.moments[0]).is_file():
            return False
        same = recorded.same_tooth(*find.moments, self.options.module)
        if same:
            self.tell(f"  not so by the recording: {find}")
        return same

    def keep(self, folder):
        """Recordings and the window's files, for who looks into it."""
        for recording in self.player.recordings if self.player else []:
            if pathlib.Path(recording).is_file():
                shutil.copy(recording, folder)

    def clean(self):
        shutil.rmtree(self.home, ignore_errors=True)


class Until:
    """Some minutes from when the tooth is there, or this find."""

    def __init__(self, minutes, invariant=None):
        self.minutes, self.invariant = minutes, invariant

    def begin(self):
        self.clock_s = time.monotonic() + 60.0 * self.minutes
