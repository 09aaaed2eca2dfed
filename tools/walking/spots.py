# SPDX-License-Identifier: Apache-2.0
"""Places that a way names by what is there, as pixels of the picture now."""
from . import eye


def pixel(hand, spot):
    """`spot`: ["tooth", u, v]: shares of the crown's box on the picture, beyond 0 and 1 what lies beside it;
    ["view", u, v]: of the picture. Held to the picture."""
    what, u, v = spot
    width, height = hand["viewport"]
    box = eye.crown_seen(hand) if what == "tooth" else None
    left, top, right, bottom = box or (0.0, 0.0, width, height)
    x, y = left + u * (right - left), top + v * (bottom - top)
    return min(max(x, 3.0), width - 4.0), min(max(y, 3.0), height - 4.0)


def path(hand, spots, every=12.0):
    """Pixels along the straight lines between spots, as a hand moves."""
    corners = [pixel(hand, spot) for spot in spots]
    out = corners[:1]
    for (x0, y0), (x1, y1) in zip(corners, corners[1:]):
        count = max(1, round(((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5 / every))
        out += [(x0 + i / count * (x1 - x0), y0 + i / count * (y1 - y0)) for i in range(1, count + 1)]
    return [(round(x), round(y)) for x, y in out]
