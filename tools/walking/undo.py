# SPDX-License-Identifier: Apache-2.0
"""That undo and redo give back the tooth bit for bit: the state's hash at each depth of the undo list, as the maps tell
it at rest. Each find tells the two moments, for recorded.py, which knows better."""
from .finds import Find


class UndoGivesBack:
    name = "undo-gives-back"

    def __init__(self):
        self.forget()

    def forget(self):
        """Another tooth, or another program."""
        self.hashes, self.strokes, self.depth, self.recording = {}, None, None, None

    def see(self, told, doing):
        hand = told.get("hand", {})
        if hand.get("mode") != "live" or "stateHash" not in hand or hand.get("inStroke"):
            return None
        depth, strokes, undone = hand["undoSteps"], hand["strokes"], hand["redoSteps"]
        # Another recording is another tooth.
        if hand.get("recording") != self.recording or (self.strokes is not None and strokes < self.strokes):
            self.forget()
        was, self.strokes, self.recording = self.strokes, strokes, hand.get("recording")
        before, self.depth = self.depth, depth
        if was is not None and strokes > was:
            # What lay above is gone; and a list that is full has moved down.
            if depth - (before or 0) != strokes - was and not undone:
                self.hashes.clear()
            self.hashes = {d: h for d, h in self.hashes.items() if d < depth}
        elif before is not None and depth > before and not hand["removedMm3"] and not hand["removedOthersMm3"]:
            self.hashes.clear()  # a reset, which is a step like a stroke, or its redo
        known = self.hashes.get(depth)
        if known is not None and known[0] == hand["stateHash"]:
            return None
        self.hashes[depth] = hand["stateHash"], hand.get("timeS", 0.0)
        if known is None:
            return None
        return Find(self.name, f"with {depth} steps to undo and {undone} to redo the tooth is another than before",
                    {"depth": depth}, moments=[hand.get("recording"), known[1], hand.get("timeS", 0.0)])
