# SPDX-License-Identifier: Apache-2.0
"""Invariants held on the recording of a walk, sample by sample: hand, force and what was taken away. Needs NumPy and
the program's module for Python (PYTHONPATH=build/dev/python)."""
import numpy as np

from . import eye, swept
from .finds import Find
from .live import FORCE_OVER_LOAD, FORCE_PEAK, FORCE_SLACK_N, HAND_OFF_PATH_MM

CUTTING = 32
SETTLES_S = 1.0  # from the press: the hand comes from where it hovered
FORCE_OVER_S = 0.02  # for so long at a time a force may be over the load


def rays_of(hand, pixels, every=3.0):
    origins, directions = [], []
    for (x0, y0), (x1, y1) in zip(pixels, pixels[1:] or pixels):
        count = max(1, int(np.ceil(np.hypot(x1 - x0, y1 - y0) / every)))
        for i in range(count + 1):
            origin, direction = eye.ray(hand, x0 + i / count * (x1 - x0), y0 + i / count * (y1 - y0))
            origins.append(origin)
            directions.append(direction)
    return np.array(origins), np.array(directions)


def off_path(positions, origins, directions):
    """Of each position the distance to the nearest line of sight."""
    best = np.full(len(positions), np.inf)
    for origin, direction in zip(origins, directions):
        off = positions - origin
        best = np.minimum(best, np.linalg.norm(off - np.outer(off @ direction, direction), axis=1))
    return best


def works(samples, press):
    """As live.py has it."""
    bears = np.linalg.norm(samples["force_n"], axis=1) > 0.0
    return bears if press.get("latched") else bears | (samples["pedal"] > 0.0)


def judge_hand(times, positions, working, press, origins, directions):
    inside = (times >= press["from_s"] + SETTLES_S) & (times <= press["to_s"]) & working
    if not inside.any():
        return []
    off = off_path(positions[inside], origins, directions)
    wrong = off > HAND_OFF_PATH_MM
    if not wrong.any():
        return []
    seconds = float(wrong.sum() * np.median(np.diff(times)))
    return [Find("hand-near-pointer", f"for {seconds:.2f} s the hand is up to {off.max():.1f} mm from the pointer's path, "
                 f"{HAND_OFF_PATH_MM} at most are allowed", {"off_mm": round(float(off.max()), 2), "seconds": round(seconds, 3)})]


def longest_run(flags):
    """Of samples one after the other."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def judge_force(times, forces, press):
    """Samples over 1.1 times the load set, while the button is down: for longer than a moment, or by far."""
    inside = (times >= press["from_s"]) & (times <= press["to_s"])
    if not inside.any() or not press.get("load_n"):
        return []
    size = np.linalg.norm(forces[inside], axis=1)
    wrong = size > FORCE_OVER_LOAD * press["load_n"] + FORCE_SLACK_N
    if not wrong.any():
        return []
    seconds = longest_run(wrong) * (float(np.median(np.diff(times[inside]))) if inside.sum() > 1 else 0.0)
    if seconds <= FORCE_OVER_S and size.max() <= FORCE_PEAK * press["load_n"] + FORCE_SLACK_N:
        return []
    return [Find("force-within-load", f"{size.max():.2f} N at most, for up to {seconds:.3f} s at a time over the {press['load_n']:.1f} N "
                 "that are set", {"force_n": round(float(size.max()), 3), "seconds": round(seconds, 3),
                             "over": round(float(size.max()) / press["load_n"], 3)})]


def judge_removed(session, module, whole, press, samples, times, origins, directions):
    """Cuts the session again up to before and after the press, seconds of one core each. `whole`: the tooth at its
    beginning."""
    span = (times >= press["from_s"] - 0.2) & (times <= press["to_s"] + 1.0)
    if not span.any() or not (samples["flags"][span] & CUTTING).any():
        return []
    cutting = span & ((samples["flags"] & CUTTING) != 0)
    # What comes out of a cavity after the button is up cuts its overhang.
    before = session.tooth_at(max(0.0, press["from_s"] - 0.1))
    after = session.tooth_at(min(float(times[-1]), press["to_s"] + 0.9))
    bur = module.Bur(press["bur"])
    revolved = swept.Revolved(bur.distance, bur.max_radius_mm, bur.length_mm)
    places = samples["position_mm"][cutting]
    reach = bur.max_radius_mm + bur.length_mm + 1.0
    uncut = whole.field.distance if whole.is_cut else whole.distance
    tilts = np.unique(np.round(samples["orientation"][cutting][:: max(1, cutting.sum() // 50)], 3), axis=0)
    stroke = {"low": places.min(0) - reach, "high": places.max(0) + reach, "tilts": tilts, "origins": origins,
              "directions": directions, "stop_mm": press.get("stop_mm")}
    box = np.array(press["tooth_mm"])
    stroke["low"], stroke["high"] = np.maximum(stroke["low"], box[0]), np.minimum(stroke["high"], box[1])
    spacing = 2.0 * before.field.voxel_mm
    return swept.judge(before.field.distance, after.field.distance, uncut, revolved, stroke, spacing)


def judge(path, presses, module, most_sweeps, tell):
    """`presses`: what the walker logged of each (player.py), of this recording. Gives finds, each with its step."""
    finds, whole = [], None
    with module.Session(path) as session:
        samples = session.samples()
        times = samples["time_s"]
        if not len(times):
            return finds
        began = [0.0] + [event["time_s"] for event in session.events() if event["name"] == "resume"]
        for press in presses:
            if press["sitting"] >= len(began):
                continue
            press = {**press, "from_s": press["from_s"] + began[press["sitting"]], "to_s": press["to_s"] + began[press["sitting"]]}
            origins, directions = rays_of(press["hand"], press["pixels"])
            now = judge_hand(times, samples["position_mm"], works(samples, press), press, origins, directions)
            now += judge_force(times, samples["force_n"], press)
            inside = (times >= press["from_s"]) & (times <= press["to_s"])
            cuts = bool((samples["flags"][inside] & CUTTING).any())
            if cuts and most_sweeps > 0 and press["bur"] in module.BURS:
                most_sweeps -= 1
                whole = whole or session.tooth_at(0.0)
                now += judge_removed(session, module, whole, press, samples, times, origins, directions)
            if inside.any():
                off = off_path(samples["position_mm"][inside], origins, directions).max()
                force = np.linalg.norm(samples["force_n"][inside], axis=1).max()
                tell(f"  press of step {press['step']}: hand at most {off:.2f} mm off its path, {force:.2f} N of "
                     f"{press['load_n']:.1f}, {'cuts' if cuts else 'cuts nothing'}", quiet=True)
            for find in now:
                find.step = press["step"]
            finds += now
    return finds


def same_tooth(path, then, now, module):
    """Whether the tooth was the same at two moments [sitting, seconds]: the window's map tells the hash of its own
    copy, which on a busy machine is a while behind the tooth."""
    with module.Session(path) as session:
        began = [0.0] + [event["time_s"] for event in session.events() if event["name"] == "resume"]
        if max(then[0], now[0]) >= len(began):
            return False
        hashes = [session.tooth_at(began[sitting] + seconds).state_hash for sitting, seconds in (then, now)]
    return hashes[0] == hashes[1]
