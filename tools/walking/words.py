# SPDX-License-Identifier: Apache-2.0
"""Whether a window in Japanese still speaks English somewhere: words of Latin letters that are no known names."""
import re

from .finds import Find

WORD = re.compile(r"[A-Za-z][a-z]+(?:'[a-z]+)?")
# What stands in <code> is typed as it is.
TAG = re.compile(r"<code>.*?</code>|<[^>]*>")
# A path, an address, a file's name or an identifier is no word.
PATH = re.compile(r"\S*[/\\_]\S*|\S+\.(?:h5|stl|handpiece|toml|png|html|csv|json|svg)\b|&[a-z]+;", re.IGNORECASE)


def read_names(path):
    """A name a line; what stands behind # is a remark."""
    return {line.split("#")[0].strip().casefold() for line in path.read_text().splitlines()} - {""}


def foreign(text, names):
    """The words of a text that need a translation; two letters are a unit or a sign."""
    plain = PATH.sub(" ", TAG.sub(" ", text))
    return [word for word in WORD.findall(plain) if len(word) > 2 and word.casefold() not in names]


class Translated:
    """All texts of the map, each once."""
    name = "translated"
    # What a person or a file wrote.
    OWN = {"statusRecording", "codeEdit"}

    def __init__(self, names):
        self.names, self.seen = names, set()

    def see(self, told, doing):
        if "QFileDialog" in told.get("windows", []):
            return None  # Qt's own, in the desktop's language; with the names of files
        texts = dict(told.get("texts", {}))
        for place in told.get("places", {}):
            # A button's place tells what it is for, not what it says.
            if "/" in place and not place.startswith("button/"):
                texts[place] = place.split("/", 1)[1]
        for widget, text in texts.items():
            if (widget, text) in self.seen or widget in self.OWN:
                continue
            self.seen.add((widget, text))
            words = foreign(text, self.names)
            if words:
                return Find(self.name, f"{widget} says \"{text[:80]}\"", {"words": len(words)})
        return None
