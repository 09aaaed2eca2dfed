# SPDX-License-Identifier: Apache-2.0
"""Whether the program's memory stays where it is while one works on."""
import os
import pathlib
import statistics

from .finds import Find

# Strokes that can be undone are kept, a tooth that is opened is another: this much is theirs.
GROWS_BY, MORE_MB, LONG_S = 1.25, 120.0, 600.0
MOST_MB = 4000.0


def resident_mb(pid):
    """0 of a process that has gone."""
    try:
        pages = int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, IndexError, ValueError):
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def judge(series):
    """`series`: (seconds, MB) of one process. In the last third not more than in the middle one; and never beyond all
    measure."""
    if not series:
        return None
    most = max(mb for _, mb in series)
    if most > MOST_MB:
        return Find("memory-steady", f"{most:.0f} MB are in use", {"mb": round(most)})
    begin, end = series[0][0], series[-1][0]
    if end - begin < LONG_S:
        return None
    third = (end - begin) / 3.0
    middle = statistics.median(mb for s, mb in series if begin + third <= s < end - third)
    last = statistics.median(mb for s, mb in series if s >= end - third)
    if last <= GROWS_BY * middle + MORE_MB:
        return None
    return Find("memory-steady", f"memory went from {middle:.0f} to {last:.0f} MB within {2 * third / 60:.0f} minutes",
                {"from_mb": round(middle), "to_mb": round(last)})
