#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What a hand feels while a bur cuts: force, feed and what is taken, tissue by tissue.

    python3 cut_force.py
    python3 cut_force.py --session session.h5
"""
import argparse

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

import handpiece as hp

matplotlib.use("Agg")  # into a file: no display is needed


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--session", help="a recorded session (.h5); without it a hand plunges into a molar that is made")
    options.add_argument("--bur", default="330")
    options.add_argument("--depth-mm", type=float, default=3.0, help="of the plunge")
    options.add_argument("--seed", type=int, default=1, help="of the hand's tremor")
    options.add_argument("--out", default="cut_force.png", help="picture to write (.png, .svg, .pdf; %(default)s)")
    given = options.parse_args()

    if given.session:
        with hp.Session(given.session) as session:
            samples = session.samples()
    else:
        run = hp.run(hp.make_tooth(fdi=46, faces=20000), "plunge", given.seed, bur=given.bur, voxel_mm=0.1,
                     depth_mm=given.depth_mm, dwell_s=5, tremor_um=15)
        samples = run.samples

    # From just before the first touch on.
    touching = np.flatnonzero(samples["tissue"])
    first = max(touching[0] - len(samples["tick"]) // 20, 0) if touching.size else 0
    samples = {name: values[first:] for name, values in samples.items()}
    time = samples["time_s"]
    force = np.linalg.norm(samples["force_n"], axis=1)
    removed = samples["removed_mm3"]
    figure, (top, middle, bottom) = plt.subplots(3, 1, figsize=(9, 7.5), sharex=True, layout="constrained")
    top.plot(time, force, color="tab:red", linewidth=0.9)
    top.set(ylabel="force on the hand [N]", title=f"Bur {given.bur} cuts its way in" if not given.session else given.session,
            ylim=(0, 1.25 * max(force.max(), 0.01)))
    # What it bears on, as bands behind the curve.
    colours = {"enamel": "#dfe8ef", "dentine": "#f3e3b3", "pulp": "#f2c0c0"}
    tissue = samples["tissue"]
    edges = np.flatnonzero(np.diff(tissue)) + 1
    labelled = set()
    for begin, end in zip(np.r_[0, edges], np.r_[edges, len(tissue)]):
        name = hp.TISSUES[tissue[begin]]
        if name == "none":
            continue
        colour = colours.get(name, "#cfb08a")
        top.axvspan(time[begin], time[end - 1], color=colour, linewidth=0, label=None if name in labelled else f"bears on {name}")
        labelled.add(name)
    if labelled:
        top.legend(loc="upper left", frameon=False, ncols=len(labelled))
    middle.plot(time, samples["feed_mm_s"], color="tab:purple", linewidth=0.9)
    middle.set(ylabel="feed [mm/s]", ylim=(0, None))
    speed = middle.twinx()
    speed.plot(time, samples["speed_rpm"] / 1000, color="tab:gray", linewidth=0.9)
    speed.set_ylabel("rotor [1000 rpm]", color="tab:gray")
    speed.set_ylim(0, None)
    for index in np.flatnonzero(removed[-1] > 1e-4):
        bottom.plot(time, removed[:, index], label=f"{hp.TISSUES[index]}, {removed[-1, index]:.2f} mm³")
    bottom.set(xlabel="time [s]", ylabel="removed [mm³]", ylim=(0, None))
    if bottom.lines:
        bottom.legend(loc="upper left", frameon=False)
    bottom.margins(x=0)
    figure.savefig(given.out, dpi=110)
    print("drawn:", given.out)
    print(f"{time[-1]:.1f} s, peak {force.max():.2f} N, {removed[-1].sum():.3f} mm3 taken")


if __name__ == "__main__":
    main()
