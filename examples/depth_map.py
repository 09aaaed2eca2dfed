#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Where a bur that comes straight down touches a tooth: felt by the paper's convex hull, and on the concave tooth.

    python3 depth_map.py
    python3 depth_map.py --tooth molar.stl --bur round-4 --grid 120

Over a fissure the hull stops the bur in the air: the open problem of the paper that Handpiece began with.
"""
import argparse

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

import handpiece as hp

matplotlib.use("Agg")  # into a file: no display is needed

NEAR_MM = 1e-4  # what counts as touching
STEPS = 60


def touch_heights(contact, x, y, top_mm, bottom_mm):
    """Height of the tip [mm] where a bur with its shank up first touches at each x, y; NaN where it passes by."""
    poses = np.zeros((x.size, 7))
    poses[:, 0], poses[:, 1], poses[:, 2], poses[:, 3] = x.ravel(), y.ravel(), top_mm, 1.0
    falling = np.arange(x.size)
    for _ in range(STEPS):
        # Apart, the depth is minus the distance: that far it can surely go down.
        clear = -contact.probe(poses[falling], patches=False).depth_mm
        poses[falling, 2] -= np.maximum(clear, 0.0)
        falling = falling[(clear > NEAR_MM) & (poses[falling, 2] > bottom_mm)]
        if falling.size == 0:
            break
    heights = poses[:, 2]
    heights[heights <= bottom_mm] = np.nan
    return heights.reshape(x.shape)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--tooth", help="case or mesh file (mm); a molar is made without it")
    options.add_argument("--bur", default="round-1/2" if "round-1/2" in hp.BURS else "330")
    options.add_argument("--grid", type=int, default=90, help="places along the longer side")
    options.add_argument("--out", default="depth_map.png", help="picture to write (.png, .svg, .pdf; %(default)s)")
    given = options.parse_args()

    case = hp.read_case(given.tooth) if given.tooth else hp.make_tooth(faces=30000)
    tooth = hp.prepare(case, voxel_mm=0.1)
    vertices = tooth.outer.vertices
    top = vertices[:, 2].max()
    crown = vertices[vertices[:, 2] > top - 5.0]
    low, high = crown.min(axis=0), crown.max(axis=0)
    step = max(high[:2] - low[:2]) / given.grid
    x, y = np.meshgrid(np.arange(low[0], high[0], step), np.arange(low[1], high[1], step))
    heights = {name: touch_heights(hp.Contact(tooth, given.bur, name), x, y, top + 0.5, top - 5.0) for name in ("hull", "field")}
    over = heights["hull"] - heights["field"]
    column = int(np.nanargmax(np.nanmax(over, axis=0)))
    at = x[0, column]

    figure = plt.figure(figsize=(11, 7.6), layout="constrained")
    grid = figure.add_gridspec(2, 3, height_ratios=[4, 3])
    below = {name: all_mm - top for name, all_mm in heights.items()}
    maps = [("by the convex hull", below["hull"], "viridis", (np.nanmin(below["field"]), 0), "tip touches, below the highest cusp [mm]"),
            ("on the concave tooth (field)", below["field"], "viridis", (np.nanmin(below["field"]), 0),
             "tip touches, below the highest cusp [mm]"),
            ("the hull stops it too early by", over, "magma_r", (0, np.nanmax(over)), "air felt as tooth [mm]")]
    for i, (title, shown, colours, (least, most), label) in enumerate(maps):
        axes = figure.add_subplot(grid[0, i])
        mesh = axes.pcolormesh(x, y, shown, cmap=colours, shading="nearest", vmin=least, vmax=most)
        axes.axvline(at, color="black", linewidth=0.9, linestyle="--")
        axes.set(title=title, aspect="equal", xlabel="x, to mesial [mm]", ylabel="y [mm]" if i == 0 else "")
        figure.colorbar(mesh, ax=axes, label=label, orientation="horizontal", shrink=0.9)
    axes = figure.add_subplot(grid[1, :])
    along, hull, field = y[:, column], below["hull"][:, column], below["field"][:, column]
    axes.fill_between(along, field, hull, color="tab:red", alpha=0.12, label="felt by the hull where there is air")
    axes.plot(along, hull, label="tip, by the hull", color="tab:red")
    axes.plot(along, field, label="tip, on the concave tooth", color="tab:blue")
    axes.set(xlabel=f"y along the dashed line, x = {at:.2f} mm [mm]", ylabel="below the highest cusp [mm]",
             title=f"Across the fissure: bur {given.bur}, up to {np.nanmax(over):.2f} mm of air felt as tooth")
    axes.set_ylim(np.nanmin(field) - 0.9, 0.15)
    axes.legend(loc="lower center", ncols=3, frameon=False)
    axes.margins(x=0)
    figure.savefig(given.out, dpi=110)
    print("drawn:", given.out)
    print(f"{x.size} places: the hull stops the bur up to {np.nanmax(over):.3f} mm above the tooth, {np.nanmean(over):.3f} mm on average")


if __name__ == "__main__":
    main()
