# SPDX-License-Identifier: Apache-2.0
"""The shortest way that still fails. Walking one costs minutes, so the likeliest come first: what was done last."""
import time


def shrink(steps, fails, at=None, tries=40, minutes=60.0, tell=lambda _: None):
    """`fails(steps)` walks them and says whether the same invariant breaks. `at`: the step at which it broke; what comes
    after it is not needed. Ends at a list of which no step can be left out, or when tries or minutes are used up; what it
    gives back always failed (or is all of `steps`, when nothing shorter did)."""
    deadline = time.monotonic() + 60.0 * minutes
    seen = {}

    def holds(candidate):
        key = repr(candidate)
        if key not in seen:
            if len(seen) >= tries or time.monotonic() > deadline:
                return False
            seen[key] = fails(candidate)
            tell(f"{len(candidate)} steps: {'fails' if seen[key] else 'holds'}")
        return seen[key]

    best = list(steps)
    if at is not None and 0 <= at < len(best) - 1 and holds(best[:at + 1]):
        best = best[:at + 1]
    # The end alone, then twice as much of it.
    length = 1
    while length < len(best):
        if holds(best[-length:]):
            best = best[-length:]
            break
        length *= 2
    return _without(best, holds)


def _without(best, holds):
    """Zeller's delta debugging: leaves out a part at a time, in ever smaller parts."""
    parts = 2
    while len(best) >= 2:
        size = -(-len(best) // parts)
        for start in range(0, len(best), size):
            rest = best[:start] + best[start + size:]
            if rest and holds(rest):
                best, parts = rest, max(parts - 1, 2)
                break
        else:
            if size == 1:
                return best
            parts = min(2 * parts, len(best))
    return best
