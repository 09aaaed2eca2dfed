# SPDX-License-Identifier: Apache-2.0
"""What an invariant says when it is broken, and the list of what is known to be broken."""
import dataclasses
import re
import tomllib


@dataclasses.dataclass
class Find:
    """`invariant`: its name (docs/walk.md); `told`: one sentence; `numbers`: what was measured, by names with units;
    `step`: the place in the way; `moments`: a recording and two of its times at which the tooth is to be the same, where
    only the window's word speaks against it."""
    invariant: str
    told: str
    numbers: dict = dataclasses.field(default_factory=dict)
    step: int = -1
    moments: list = dataclasses.field(default_factory=list)

    def as_json(self):
        return dataclasses.asdict(self)

    def __str__(self):
        return f"step {self.step}: {self.invariant}: {self.told}"


class KnownList:
    """Each entry names an invariant, a pattern that the sentence must hold, a reason, and where it matters the most
    that a number may be: more than that is news."""
    KEYS = {"invariant", "told", "reason", "at_most"}

    def __init__(self, entries):
        self.entries = entries
        self.met = [0] * len(entries)
        for number, entry in enumerate(entries, 1):
            missing = {"invariant", "told", "reason"} - entry.keys()
            strange = entry.keys() - self.KEYS
            if missing or strange:
                raise SystemExit(f"known find {number}: {'lacks ' + ', '.join(sorted(missing)) if missing else ''}"
                                 f"{'has unknown ' + ', '.join(sorted(strange)) if strange else ''}: it needs an "
                                 "invariant, a pattern of what is told, and a reason")
            if not str(entry["reason"]).strip():
                raise SystemExit(f"known find {number}: a reason is needed")
            re.compile(entry["told"])

    @classmethod
    def read(cls, path):
        return cls(tomllib.loads(path.read_text()).get("known", []) if path.is_file() else [])

    def reason_of(self, find):
        """Why it is known; None for what is new."""
        for place, entry in enumerate(self.entries):
            if entry["invariant"] != find.invariant or not re.search(entry["told"], find.told):
                continue
            if any(find.numbers.get(name, float("inf")) > most for name, most in entry.get("at_most", {}).items()):
                continue
            self.met[place] += 1
            return entry["reason"]
        return None

    def never_met(self):
        return [entry for entry, met in zip(self.entries, self.met) if not met]
