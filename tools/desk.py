# SPDX-License-Identifier: Apache-2.0
"""Works handpiece-desktop as a person would: real mouse and keys on a screen of its own (Xvfb, xdotool), pictures of
what is seen (ImageMagick). For tools/screenshots and tools/measure_window. Widgets are found by their object names
(docs/desktop-objects.md), which the program writes into a file when HANDPIECE_WIDGET_MAP names one, with what they
say. Waiting looks at what the window says; what does not come about ends the script with a sentence."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
NEEDED = {"Xvfb": "xvfb", "xdotool": "xdotool", "import": "imagemagick"}


def missing():
    """The Debian packages that are not there and that a Desk needs."""
    return [package for program, package in NEEDED.items() if not shutil.which(program)]


class Desk:
    """`build`: a folder under build/, or the program itself. `home`: settings, recordings and what goes with them; its
    own by default. The teeth are taken from (and left in) the caller's cache. `errors`: a file for what it says on
    stderr."""

    def __init__(self, arguments=(), size="1440x900", display=None, build="release", home=None, environment=(), errors=None):
        self.folder = pathlib.Path(home or tempfile.mkdtemp(prefix="handpiece-desk-"))
        self.map_file = self.folder / "widgets.json"
        # Xvfb takes a free number by itself and tells it.
        told, tell = os.pipe()
        number = [] if display is None else [f":{display}"]
        self.screen = subprocess.Popen(["Xvfb", *number, "-displayfd", str(tell), "-screen", "0", f"{size}x24",
                                        "-nolisten", "tcp"], pass_fds=[tell], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        os.close(tell)
        with os.fdopen(told) as pipe:
            self.number = pipe.readline().strip()
        if not self.number:
            raise SystemExit("the screen did not come up: is Xvfb installed?")
        self.size = [int(part) for part in size.split("x")]
        self.environment = dict(os.environ, DISPLAY=f":{self.number}", HANDPIECE_WIDGET_MAP=str(self.map_file),
                                XDG_CONFIG_HOME=str(self.folder / "config"), XDG_DATA_HOME=str(self.folder / "data"),
                                XDG_RUNTIME_DIR=str(self.folder), QT_QPA_PLATFORM="xcb", LANG="en_GB.UTF-8")
        self.environment.update(environment)
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.folder.chmod(0o700)
        self.program = pathlib.Path(build)
        if not self.program.is_file():
            self.program = ROOT / "build" / build / "bin" / "handpiece-desktop"
        if not self.program.is_file():
            raise SystemExit(f"{self.program} is not built")
        self.app, self.errors = None, errors
        self.start(arguments)

    def start(self, arguments=()):
        """The program, its window over the whole screen."""
        self.map_file.unlink(missing_ok=True)
        self.begun = time.monotonic()
        with open(self.errors or os.devnull, "ab") as told:
            self.app = subprocess.Popen([str(self.program), *map(str, arguments)], env=self.environment,
                                        stderr=told if self.errors else None)
        self.wait_for("mainWindow")
        for window in self.windows("handpiece"):
            subprocess.run(["xdotool", "windowmove", window, "0", "0", "windowsize", window, *map(str, self.size)],
                           env=self.environment, capture_output=True, check=False)
        self.until(lambda: self.place("mainWindow", 0, 0) == (0, 0), "the window in the corner of the screen")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def crash(self):
        """As a power cut ends it."""
        self.app.kill()
        self.app.wait()

    def close(self):
        if self.app and self.app.poll() is None:
            self.app.send_signal(signal.SIGTERM)
            try:
                self.app.wait(20)
            except subprocess.TimeoutExpired:
                self.app.kill()
        self.screen.terminate()
        self.screen.wait()

    # Finding.

    def map(self):
        try:
            return json.loads(self.map_file.read_text())
        except (FileNotFoundError, json.JSONDecodeError):
            return {"places": {}, "texts": {}, "on": [], "off": []}

    def widgets(self):
        """Name -> [x, y, width, height] on the screen, of what is visible now; nothing before the program is ready."""
        return self.map()["places"]

    def text(self, name):
        """What a widget says; empty when it is not there."""
        return self.map()["texts"].get(name, "")

    def number_in(self, name):
        """The first number a widget says; none without one."""
        found = re.search(r"-?\d+(?:[.,]\d+)?", self.text(name).replace("\u202f", ""))
        return float(found[0].replace(",", ".")) if found else None

    def windows(self, name):
        out = subprocess.run(["xdotool", "search", "--onlyvisible", "--class", name], env=self.environment,
                             capture_output=True, text=True, check=False).stdout
        return out.split()

    def focus(self):
        """Keys go to the newest window, a dialog for one: there is no window manager that would see to it."""
        windows = sorted(map(int, self.windows("handpiece")))
        now = subprocess.run(["xdotool", "getwindowfocus"], env=self.environment, capture_output=True, text=True,
                             check=False).stdout.strip()
        if windows and now != str(windows[-1]):
            subprocess.run(["xdotool", "windowfocus", "--sync", str(windows[-1])], env=self.environment,
                           capture_output=True, check=False, timeout=10)
            time.sleep(0.1)

    def until(self, happens, what, seconds=120):
        """What `happens` gave, as soon as that is something."""
        deadline = time.monotonic() + seconds
        while True:
            result = happens()
            if result:
                return result
            if self.app.poll() is not None:
                raise SystemExit(f"handpiece-desktop ended with {self.app.returncode} while waiting for {what}")
            if time.monotonic() > deadline:
                self.shot(self.folder / "failed.png")
                raise SystemExit(f"no {what} after {seconds} s; what was seen is in {self.folder / 'failed.png'}")
            time.sleep(0.1)

    @staticmethod
    def comes_true(happens, seconds):
        """Whether it happens in time."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            if happens():
                return True
            time.sleep(0.1)
        return bool(happens())

    def wait_for(self, name, seconds=60, gone=False):
        self.until(lambda: (name in self.widgets()) != gone, f"{'end of ' if gone else ''}{name}", seconds)

    def wait_off(self, name, off=True, seconds=60):
        """Until a command cannot be used; off=False: until it can."""
        self.until(lambda: name in self.widgets() and (name in self.map()["off"]) == off,
                   f"{name} {'off' if off else 'ready'}", seconds)

    def place(self, name, across=0.5, down=0.5):
        if name not in self.widgets():
            self.wait_for(name)
        x, y, width, height = self.widgets()[name]
        return x + across * width, y + down * height

    # Acting.

    def xdo(self, *words):
        # A locale that is there everywhere, for letters beyond ASCII.
        subprocess.run(["xdotool", *map(str, words)], env=dict(self.environment, LC_ALL="C.UTF-8"), check=True,
                       stdout=subprocess.DEVNULL)

    def move(self, name, across=0.5, down=0.5, steps=1, seconds=0.0):
        """The pointer to a place in a widget; in steps, as a hand moves."""
        x, y = self.place(name, across, down)
        if steps > 1:
            out = subprocess.run(["xdotool", "getmouselocation", "--shell"], env=self.environment, capture_output=True,
                                 text=True, check=True).stdout
            now = dict(line.split("=") for line in out.split())
            x0, y0 = float(now["X"]), float(now["Y"])
            for i in range(1, steps):
                self.xdo("mousemove", round(x0 + (x - x0) * i / steps), round(y0 + (y - y0) * i / steps))
                time.sleep(seconds / steps)
        self.xdo("mousemove", round(x), round(y))

    def click(self, name, across=0.5, down=0.5, button=1):
        self.move(name, across, down)
        time.sleep(0.05)
        self.xdo("click", button)
        time.sleep(0.25)

    def press(self, button=1):
        self.xdo("mousedown", button)

    def release(self, button=1):
        self.xdo("mouseup", button)

    def drag(self, name, start, end, button=1, steps=20, seconds=1.0):
        """Press at `start` = (across, down) of a widget, along to `end`, and let go."""
        self.move(name, *start)
        time.sleep(0.1)
        self.press(button)
        self.move(name, *end, steps=steps, seconds=seconds)
        self.release(button)

    def wheel(self, steps, *held):
        """Positive: away from the hand. `held`: names of keys."""
        for key in held:
            self.xdo("keydown", key)
        for _ in range(abs(steps)):
            self.xdo("click", 4 if steps > 0 else 5)
            time.sleep(0.03)
        for key in held:
            self.xdo("keyup", key)

    def key(self, *names):
        self.focus()
        self.xdo("key", *names)
        time.sleep(0.2)

    def type(self, text):
        # What is on no key gets one for the moment, which the program must have heard of.
        self.xdo("type", "--delay", 30 if text.isascii() else 300, text)
        time.sleep(0.2)

    def menu(self, *names):
        """Clicks through menus: ("menuFile", "actionSaveAs")."""
        for name in names:
            self.click(name)

    # Seeing.

    def pixels(self, name="view"):
        x, y, width, height = map(round, self.widgets()[name])
        return subprocess.run(["import", "-window", "root", "-crop", f"{width}x{height}+{x}+{y}", "-depth", "8", "rgb:-"],
                              env=self.environment, check=True, capture_output=True).stdout

    def changed(self, since, name="view"):
        """Waits until a widget's picture is another than it was."""
        self.until(lambda: self.pixels(name) != since, f"another picture in {name}")

    def still(self, name="view", seconds=20):
        """Waits until a widget's picture stays as it is: refined at rest."""
        before, deadline = None, time.monotonic() + seconds
        while time.monotonic() < deadline:
            seen = self.pixels(name)
            if seen == before:
                return
            before = seen
            time.sleep(0.5)

    def shot(self, path, crop=None, colours=None):
        """The screen as a PNG; `crop` a widget's name, `colours` a small palette for a small file."""
        path = pathlib.Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        area = []
        if crop:
            x, y, width, height = self.widgets()[crop]
            area = ["-crop", f"{round(width)}x{round(height)}+{round(x)}+{round(y)}", "+repage"]
        few = ["-dither", "None", "-colors", str(colours)] if colours else []
        subprocess.run(["import", "-window", "root", *area, *few, f"{'PNG8:' if colours else ''}{path}"],
                       env=self.environment, check=True)
        return path
