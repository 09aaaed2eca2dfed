#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How scores rise from attempt to attempt, out of many sessions.

    python3 learning_curve.py
    python3 learning_curve.py --exercise dexterity-line a1.h5 a2.h5 b1.h5 b2.h5

Sessions are grouped by the code that they carry, in the order in which they are named. Without any, simulated hands make
them: each cuts a groove into a block, and trembles less each time, as people do who practise. That is a made-up course of
practice; what is real is the cutting, the sessions and the scores.
"""
import argparse
import collections
import pathlib
import tempfile

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

import handpiece as hp

matplotlib.use("Agg")  # into a file: no display is needed

GROOVE_MM = {"length": 8.0, "width": 1.2, "depth": 1.5}  # of the exercise dexterity-line
FEED_MM_S, BUR_RADIUS_MM = 4.0, 0.4


def groove():
    """What a hand does that knows the figure: layer by layer, along one side and back along the other; (n, 8)."""
    half, side = GROOVE_MM["length"] / 2, GROOVE_MM["width"] / 2 - BUR_RADIUS_MM
    corners = [(-half, -side, 1.0)]
    for depth in np.linspace(0, GROOVE_MM["depth"], 4)[1:]:
        corners += [(-half, -side, -depth), (half, -side, -depth), (half, side, -depth), (-half, side, -depth), (-half, -side, -depth)]
    corners.append((-half, -side, 1.0))
    places = np.array(corners)
    ways = np.linalg.norm(np.diff(places, axis=0), axis=1)
    motion = np.zeros((len(places), 8))
    motion[:, 0] = np.r_[0, np.cumsum(np.maximum(ways, 0.1) / FEED_MM_S)]
    motion[:, 1:4], motion[:, 4] = places, 1.0
    return motion


def practise(exercise, folder, students, attempts):
    """Paths of sessions by student."""
    sessions = collections.defaultdict(list)
    for student in range(students):
        for attempt in range(attempts):
            tremor = (230 + 60 * student) * (attempt + 1) ** -0.75  # a power law of practice
            out = folder / f"S{student + 1}-{attempt + 1}"
            hp.run(exercise.case.path, groove(), seed=100 * student + attempt, out=out, surfaces=False, bur="330", pedal=1.0,
                   voxel_mm=exercise.voxel_mm, tremor_um=tremor, code=f"S{student + 1}", full_removal=True)
            sessions[f"S{student + 1}"].append(out / "session.h5")
            print(f"S{student + 1}, attempt {attempt + 1}: cut", flush=True)
    return sessions


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("sessions", nargs="*", help="recorded sessions (.h5), each student's in their order")
    options.add_argument("--exercise", default="dexterity-line", help="folder, file, or id of one that comes along")
    options.add_argument("--students", type=int, default=3, help="to simulate, where there are no sessions")
    options.add_argument("--attempts", type=int, default=6)
    options.add_argument("--prove", action="store_true", help="cut every session again: slower, and proven")
    options.add_argument("--out", default="learning_curve.png", help="picture to write (.png, .svg, .pdf; %(default)s)")
    given = options.parse_args()

    exercise = hp.open_exercise(given.exercise)
    with tempfile.TemporaryDirectory() as folder:
        if given.sessions:
            sessions = collections.defaultdict(list)
            for path in given.sessions:
                with hp.Session(path) as session:
                    sessions[session.code or "without a code"].append(path)
        else:
            sessions = practise(exercise, pathlib.Path(folder), given.students, given.attempts)
        results = {code: [hp.score(path, exercise, prove=given.prove) for path in paths] for code, paths in sessions.items()}

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    colours = plt.get_cmap("tab10")
    percent = {code: np.array([100 * r["score"] / r["max_score"] for r in all]) for code, all in results.items()}
    for i, (code, scores) in enumerate(percent.items()):
        left.plot(np.arange(1, len(scores) + 1), scores, "o-", color=colours(i), linewidth=1, markersize=4, alpha=0.7, label=code)
    longest = max(map(len, percent.values()))
    mean = [np.mean([s[n] for s in percent.values() if len(s) > n]) for n in range(longest)]
    left.plot(np.arange(1, longest + 1), mean, color="black", linewidth=2.2, label="mean")
    left.set(xlabel="attempt", ylabel="score [% of what can be had]", title=exercise.id, ylim=(0, 102), xticks=np.arange(1, longest + 1))
    left.legend(frameon=False, loc="lower right", ncols=2)
    # Which criteria the points were lost by, on average.
    lost = collections.defaultdict(lambda: np.zeros(longest))
    for n in range(longest):
        these = [all[n] for all in results.values() if len(all) > n]
        for result in these:
            for criterion in result["criteria"]:
                if criterion["points"] is not None:
                    lost[criterion["id"]][n] += (criterion["max_points"] - criterion["points"]) / len(these)
    shown = sorted((item for item in lost.items() if item[1].max() > 0.5), key=lambda item: -item[1].sum())
    base = np.zeros(longest)
    for i, (name, points) in enumerate(shown):
        right.bar(np.arange(1, longest + 1), points, bottom=base, label=name, color=plt.get_cmap("Set2")(i), width=0.7)
        base += points
    right.set(xlabel="attempt", ylabel="points lost, mean", title="What the points were lost by", xticks=np.arange(1, longest + 1))
    if shown:
        right.legend(frameon=False)
    figure.savefig(given.out, dpi=110)
    print("drawn:", given.out)
    for code, scores in percent.items():
        print(code, " ".join(f"{score:.0f}" for score in scores))


if __name__ == "__main__":
    main()
