# SPDX-License-Identifier: Apache-2.0
"""Pixels of the picture and millimetres of the tooth, as senses/view/camera.cpp has them. `hand` is the object of that
name in the widget map, or anything with its `camera`, `viewport` and `toothMm`."""
import math

CROWN_SHARE = 0.42  # of a tooth's height that is seen over the gum, as in view_state.cpp


def minus(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def along(origin, direction, by):
    return [origin[i] + by * direction[i] for i in range(3)]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def norm(a):
    return math.sqrt(dot(a, a))


def unit(a):
    length = norm(a)
    return [x / length for x in a]


def axes(hand, as_seen=False):
    """Forward, right, up; `as_seen`: in a mirror left and right have changed places."""
    camera = hand["camera"]
    forward = unit(minus(camera["targetMm"], camera["eyeMm"]))
    right = unit(cross(forward, camera["up"]))
    up = cross(right, forward)
    if as_seen and camera.get("mirrored"):
        right = [-x for x in right]
    return forward, right, up


def half_extent(hand):
    width, height = hand["viewport"]
    tall = math.tan(0.5 * hand["camera"]["fieldOfViewRad"])
    return tall * width / height, tall


def ray(hand, x, y):
    """Origin and unit direction of the hand's line of sight through a pixel."""
    forward, right, up = axes(hand)
    wide, tall = half_extent(hand)
    width, height = hand["viewport"]
    across, upward = (2.0 * x / width - 1.0) * wide, (1.0 - 2.0 * y / height) * tall
    return hand["camera"]["eyeMm"], unit([forward[i] + across * right[i] + upward * up[i] for i in range(3)])


def pixel_of(hand, point, as_seen=True):
    """Where a point is seen, outside of the picture too; None behind the eye."""
    forward, right, up = axes(hand, as_seen)
    p = minus(point, hand["camera"]["eyeMm"])
    depth = dot(p, forward)
    if depth <= 1e-9:
        return None
    wide, tall = half_extent(hand)
    width, height = hand["viewport"]
    return (0.5 * (1.0 + dot(p, right) / (depth * wide)) * width, 0.5 * (1.0 - dot(p, up) / (depth * tall)) * height)


def crown_corners(hand):
    low, high = hand["toothMm"]
    bottom = high[2] - CROWN_SHARE * (high[2] - low[2])
    return [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (bottom, high[2])]


def crown_seen(hand):
    """The crown's box on the picture: left, top, right, bottom; None with part of it behind the eye."""
    seen = [pixel_of(hand, corner) for corner in crown_corners(hand)]
    if not all(seen):
        return None
    across, down = [p[0] for p in seen], [p[1] for p in seen]
    return min(across), min(down), max(across), max(down)


def distance_to_ray(point, origin, direction):
    return norm(cross(minus(point, origin), direction))


def off_path_mm(point, hand, pixels, every=2.0):
    """From the nearest line of sight through a path of pixels."""
    best = float("inf")
    for (x0, y0), (x1, y1) in zip(pixels, pixels[1:] or pixels):
        count = max(1, math.ceil(math.hypot(x1 - x0, y1 - y0) / every))
        for i in range(count + 1):
            share = i / count
            best = min(best, distance_to_ray(point, *ray(hand, x0 + share * (x1 - x0), y0 + share * (y1 - y0))))
    return best


def eye_moved(before, after):
    """Between two hands: then pixels mean other lines of sight."""
    if before["viewport"] != after["viewport"]:
        return True
    return any(abs(a - b) > 1e-6 for name in ("eyeMm", "targetMm", "up")
               for a, b in zip(before["camera"][name], after["camera"][name]))
