# SPDX-License-Identifier: Apache-2.0
"""Whether what a stroke took away lies in the bur's own shape, at its recorded tilt, swept along the lines of sight
through the pointer's path, and no deeper than the stop shown. Needs NumPy and the program's module for Python."""
import numpy as np

from .finds import Find

GROWN_MM = 0.2
MOST_POINTS, MOST_RAYS, MOST_TILTS = 1500, 60, 4
STEP_MM = 0.1   # along a line of sight
REACH_MM = 12.0  # of the bur's tip beyond the first tooth that the line meets


def removed_points(before, after, low, high, spacing):
    """Places in a box that were tooth and are not: `before` and `after` give signed distances, negative inside."""
    axes = [np.arange(low[i], high[i] + spacing, spacing) for i in range(3)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    was = before(grid)
    near = grid[(was < -0.25 * spacing)]
    if not len(near):
        return near
    return near[after(near) > 0.25 * spacing]


def thin(rows, most):
    """Some of many, evenly."""
    if len(rows) <= most:
        return rows
    return rows[np.linspace(0, len(rows) - 1, most).astype(int)]


def turned(quaternion, vectors):
    """By the inverse of w x y z: from the tooth's frame into the bur's."""
    w, v = quaternion[0], -np.asarray(quaternion[1:])
    t = 2.0 * np.cross(v, vectors)
    return vectors + w * t + np.cross(v, t)


class Revolved:
    """A bur's signed distances from a table over its radius and axis: it is turned about +z. Beyond the table: its edge's,
    which is farther than anybody asks."""
    FINE_MM = 0.02

    def __init__(self, bur, radius_mm, length_mm, margin_mm=3.0):
        self.low = -margin_mm
        r = np.arange(0.0, radius_mm + margin_mm, self.FINE_MM)
        z = np.arange(self.low, length_mm + margin_mm, self.FINE_MM)
        places = np.stack(np.broadcast_arrays(r[:, None], 0.0, z[None, :]), -1).reshape(-1, 3)
        self.table = bur(places).reshape(len(r), len(z)).astype(np.float32)

    def __call__(self, points):
        r = np.rint(np.hypot(points[:, 0], points[:, 1]) / self.FINE_MM).astype(np.int64)
        z = np.rint((points[:, 2] - self.low) / self.FINE_MM).astype(np.int64)
        rows, columns = self.table.shape
        return self.table[np.clip(r, 0, rows - 1), np.clip(z, 0, columns - 1)]


def outside_mm(points, bur, tilts, origins, directions, first):
    """How far each point is from the nearest bur of all: the tip anywhere on a line of sight from a millimetre before
    `first` (where that line meets tissue) to REACH_MM beyond. `bur` gives signed distances in its own frame."""
    best = np.full(len(points), np.inf)
    ways = np.arange(-1.0, REACH_MM, STEP_MM)
    for tilt in tilts:
        local = turned(tilt, points)
        for origin, direction, begin in zip(origins, directions, first):
            open_ = best > 0.0
            if not open_.any():
                return best
            # In the bur's frame the tip goes along a line: the point goes the other way.
            tip = turned(tilt, origin + np.outer(begin + ways, direction))
            asked = (local[open_][:, None, :] - tip[None, :, :]).reshape(-1, 3)
            best[open_] = np.minimum(best[open_], bur(asked).reshape(-1, len(ways)).min(1))
    return best


def first_touch(field, origins, directions, far_mm=200.0):
    """Along each line of sight to the uncut tooth, by steps of its distance; where it passes by, the nearest place."""
    at = np.zeros(len(origins))
    nearest, where = np.full(len(origins), np.inf), np.zeros(len(origins))
    for _ in range(80):
        d = field(origins + at[:, None] * directions)
        closer = d < nearest
        nearest[closer], where[closer] = d[closer], at[closer]
        at = np.minimum(at + np.maximum(d, 0.02), far_mm)
    return where


def judge(before, after, uncut, bur, stroke, spacing):
    """`before`, `after`, `uncut`: signed distances of the tooth. `stroke`: low, high [mm], tilts (k, 4), origins,
    directions (n, 3), stop_mm or None."""
    points = removed_points(before, after, stroke["low"], stroke["high"], spacing)
    if not len(points):
        return []
    few = thin(points, MOST_POINTS)
    origins, directions = thin(stroke["origins"], MOST_RAYS), thin(stroke["directions"], MOST_RAYS)
    first = first_touch(uncut, origins, directions)
    beyond = outside_mm(few, bur, thin(stroke["tilts"], MOST_TILTS), origins, directions, first)
    finds, share = [], spacing ** 3 * len(points) / len(few)
    slack = GROWN_MM + spacing
    wrong = beyond > slack
    if wrong.any():
        mm3 = share * wrong.sum()
        finds.append(Find("removed-in-sweep", f"{mm3:.3f} mm³ are gone outside of the bur's way under the pointer, up to "
                          f"{beyond.max():.2f} mm from it", {"mm3": round(float(mm3), 4), "mm": round(float(beyond.max()), 3)}))
    if stroke.get("stop_mm"):
        deep = -uncut(few)
        wrong = deep > stroke["stop_mm"] + slack
        if wrong.any():
            finds.append(Find("removed-to-stop", f"{share * wrong.sum():.3f} mm³ are gone below the depth stop of "
                              f"{stroke['stop_mm']:.1f} mm, down to {deep.max():.2f} mm",
                              {"mm3": round(float(share * wrong.sum()), 4), "mm": round(float(deep.max()), 3)}))
    return finds
