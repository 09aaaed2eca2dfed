# SPDX-License-Identifier: Apache-2.0
"""Seeded ways of a person: an endless run of steps with nothing left to chance but the seed. Scenes follow one another
as people do them: look, cut, take back, change the bur, measure, open and close things, type numbers, begin exercises,
leave."""
import random

DIALOGS = ["ctrl+t", "ctrl+shift+k", "F1", "ctrl+i", "ctrl+shift+r", "ctrl+shift+l", "ctrl+shift+h", "ctrl+shift+p",
           "F8", "shift+F1", "ctrl+shift+n", "ctrl+n", "ctrl+shift+t"]
MENUS = ["menuFile", "menuEdit", "menuView", "menuTools", "menuSound", "menuHelp", "viewsButton"]
# Fields and what they hold.
FIELDS = [("depthStop", 0.1, 5.0, 1), ("sectionOffset", -3.0, 3.0, 1), ("springSpin", 0.2, 2.5, 1), ("speedSpin", 300000, 390000, 0)]
SIZES = [(1366, 768), (1280, 720), (1100, 700), (1366, 700)]


class Person:
    def __init__(self, seed, weights=None):
        self.rng = random.Random(seed)
        self.last = None  # spots of the last press
        scenes = {"look": 3, "cut": 8, "take_back": 3, "change": 3, "measure": 2, "open_and_close": 2, "type_numbers": 1,
                  "panels": 1, "exercise": 1, "leave": 1}
        if weights:
            scenes = {name: weights.get(name, 0) for name in scenes}
        self.names, self.weights = list(scenes), list(scenes.values())

    def steps(self):
        """Ends never."""
        yield from self.look()
        while True:
            yield from getattr(self, self.rng.choices(self.names, self.weights)[0])()

    # Places.

    def between(self, low, high):
        return round(self.rng.uniform(low, high), 3)

    def spot(self):
        """On the tooth mostly; on its neighbours, the gingiva below it, the gaps beside it."""
        where = self.rng.choices(["tooth", "neighbour", "gingiva", "gap", "anywhere"], [12, 2, 2, 2, 1])[0]
        if where == "tooth":
            return ["tooth", self.between(0.15, 0.85), self.between(0.15, 0.85)]
        if where == "neighbour":
            return ["tooth", self.rng.choice([self.between(-0.5, -0.1), self.between(1.1, 1.5)]), self.between(0.3, 0.7)]
        if where == "gingiva":
            return ["tooth", self.between(0.2, 0.8), self.between(0.95, 1.15)]
        if where == "gap":
            return ["tooth", self.rng.choice([0.0, 1.0]) + self.between(-0.05, 0.05), self.between(0.3, 0.7)]
        return ["view", self.between(0.1, 0.9), self.between(0.15, 0.9)]

    def line_from(self, spot, most=0.35):
        what, u, v = spot
        spots = [spot]
        for _ in range(self.rng.choices([0, 1, 2, 4], [2, 6, 2, 1])[0]):
            _, u, v = spots[-1]
            spots.append([what, round(u + self.rng.uniform(-most, most), 3), round(v + self.rng.uniform(-most, most), 3)])
        return spots

    # Scenes.

    def look(self):
        yield {"do": "view", "key": self.rng.choice("123456")}
        for _ in range(self.rng.randrange(3)):
            how = self.rng.randrange(4)
            if how == 0:
                start = [0.5, 0.5]
                end = [0.5 + self.between(-0.2, 0.2), 0.5 + self.between(-0.2, 0.2)]
                yield {"do": "orbit", "spots": [["view", *start], ["view", *map(lambda x: round(x, 3), end)]],
                       "seconds": self.between(0.2, 0.8), "button": self.rng.choice([3, 3, 2])}
            elif how == 1:
                yield {"do": "wheel", "spot": self.spot(), "notches": self.rng.choice([-2, -1, 1, 2, 3])}
            elif how == 2:
                yield {"do": "hover", "spots": [self.spot(), self.spot(), self.spot()], "seconds": self.between(0.5, 2.0)}
            else:
                yield {"do": "view", "key": self.rng.choice(["Home", "1", "6"])}
        if self.rng.random() < 0.15:
            yield {"do": "glance", "spots": [["tooth", self.between(0.3, 0.7), self.between(0.3, 0.7)]]}

    def cut(self):
        if self.rng.random() < 0.3:
            yield {"do": "view", "key": self.rng.choice("111234566")}
        if self.rng.random() < 0.1:
            yield {"do": "key", "keys": [self.rng.choice(["n", "r"])]}
        for _ in range(self.rng.randint(1, 3)):
            again = self.last is not None and self.rng.random() < 0.35
            spots = self.last if again else self.line_from(self.spot())
            self.last = spots
            step = {"do": "drag", "spots": spots, "seconds": self.between(0.3, 4.0), "held": self.between(0.0, 1.0)}
            if self.rng.random() < 0.3:
                step["back"] = True
            if self.rng.random() < 0.08:
                step["keys"] = [self.rng.choice(["shift", "ctrl"])]
            yield step

    def take_back(self):
        yield {"do": "undo", "times": self.rng.randint(1, 3)}
        if self.rng.random() < 0.6:
            yield {"do": "undo", "redo": True, "times": self.rng.randint(1, 2)}
        if self.rng.random() < 0.1:
            yield {"do": "reset"}

    def change(self):
        how = self.rng.randrange(5)
        if how == 0:
            yield {"do": "key", "keys": [self.rng.choice(["period", "comma"])] * self.rng.randint(1, 3)}
        elif how == 1:
            yield {"do": "wheel", "spot": ["view", 0.5, 0.1], "notches": self.rng.choice([-4, -2, 2, 5]), "keys": ["shift"]}
        elif how == 2:
            yield {"do": "wheel", "spot": ["view", 0.5, 0.1], "notches": self.rng.choice([-3, -1, 1, 3]), "keys": ["ctrl"]}
        elif how == 3:
            yield {"do": "click", "name": "depthStopOn", "at": [0.1, 0.5]}
        else:
            yield {"do": "key", "keys": [self.rng.choice(["plus", "minus", "t", "Escape"])]}

    def measure(self):
        tool = self.rng.choice([["d"], ["d", "d"], ["d", "d", "d"], ["x"], ["m"], ["c"], ["ctrl+shift+y"]])
        yield {"do": "key", "keys": tool}
        yield {"do": "hover", "spots": [self.spot(), self.spot()], "seconds": 0.6}
        if tool[0] == "d":
            yield {"do": "drag", "spots": [self.spot()], "seconds": 0.0, "held": 0.1}
        if tool[0] in "xm":
            yield {"do": "orbit", "spots": [["view", 0.5, 0.5], ["view", self.between(0.4, 0.6), self.between(0.4, 0.6)]],
                   "seconds": 0.4, "button": 1}
        yield {"do": "key", "keys": tool[:1] if tool[0] in ("x", "m", "c", "ctrl+shift+y") else ["Escape"]}
        yield {"do": "key", "keys": ["Escape"]}

    def open_and_close(self):
        if self.rng.random() < 0.6:
            yield {"do": "dialog", "key": self.rng.choice(DIALOGS), "seconds": self.between(0.2, 1.5)}
        else:
            yield {"do": "menu", "name": self.rng.choice(MENUS)}

    def type_numbers(self):
        name, low, high, digits = self.rng.choice(FIELDS)
        number = f"{self.rng.uniform(low, high):.{digits}f}"
        if name == "depthStop":
            yield {"do": "stop_on"}
        if name == "sectionOffset":
            yield {"do": "key", "keys": ["x"]}
        yield {"do": "typed", "name": name, "text": number, "delay_ms": self.rng.choice([5, 30, 300]),
               "end": self.rng.choice(["Tab", "Return"])}
        if name == "sectionOffset":
            yield {"do": "key", "keys": ["x", "Escape"]}

    def panels(self):
        how = self.rng.randrange(4)
        if how == 0:
            yield {"do": "key", "keys": [self.rng.choice(["F5", "F6", "F7"])]}
        elif how == 1:
            yield {"do": "key", "keys": [self.rng.choice(["shift+F9", "ctrl+F9"])]}
        elif how == 2:
            yield {"do": "resize", "size": list(self.rng.choice(SIZES))}
        else:
            yield {"do": "key", "keys": ["F6"]}
            yield {"do": "click", "name": "tab/View"}
            yield {"do": "glance", "spots": [["tooth", self.between(0.3, 0.7), self.between(0.3, 0.7)]]}
            yield {"do": "key", "keys": ["F5"]}

    def exercise(self):
        yield {"do": "exercise", "row": self.rng.randrange(10)}
        for _ in range(self.rng.randint(1, 3)):
            yield from self.cut()
        if self.rng.random() < 0.5:
            yield {"do": "finish", "show": self.rng.random() < 0.5}
        if self.rng.random() < 0.5:
            yield {"do": "first"}

    def leave(self):
        yield {"do": self.rng.choice(["crash", "crash", "quit", "replay"])}
