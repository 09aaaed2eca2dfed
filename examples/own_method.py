#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A contact method of one's own beside the two that come along: how deep, how far off, how long it takes.

    python3 own_method.py

The method: the corners of the bur's mesh are looked up in the tooth's distance field, and the deepest decides. It is some
twenty lines, and right as far as the mesh is fine and the field reaches.
"""
import argparse
import time

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

import handpiece as hp

matplotlib.use("Agg")  # into a file: no display is needed


class Corners(hp.Method):
    """The deepest of the bur's corners in the tooth's field."""

    name = "corners"

    def __init__(self, tooth, bur):
        self.field, self.corners = tooth.field, np.array(bur.mesh.vertices)

    def depth(self, pose):
        places = self.corners @ hp.rotation(pose).T + pose[:3]
        distances = self.field.distance(places)
        deepest = distances.argmin()
        normal = self.field.normal(places[deepest])[0]
        if not normal.any():  # out of the field's fine part: a bound, and no direction
            return -distances[deepest]
        return -distances[deepest], normal, places[deepest] - distances[deepest] * normal


def poses_about(tooth, count, seed):
    """Poses with the shank leaning, the tip within a millimetre of the crown's surface."""
    random = np.random.default_rng(seed)
    vertices = tooth.outer.vertices
    crown = vertices[vertices[:, 2] > vertices[:, 2].max() - 3.0]
    poses = np.zeros((count, 7))
    poses[:, :3] = crown[random.integers(len(crown), size=count)]
    poses[:, 2] += random.uniform(-0.5, 0.6, count)
    poses[:, 3:] = random.normal(0, 0.15, (count, 4)) + [1, 0, 0, 0]
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
    return poses


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--bur", default="330")
    options.add_argument("--count", type=int, default=1500, help="poses")
    options.add_argument("--seed", type=int, default=1, help="of the poses")
    options.add_argument("--out", default="own_method.png", help="picture to write (.png, .svg, .pdf; %(default)s)")
    given = options.parse_args()

    tooth, bur = hp.prepare(hp.make_tooth(faces=20000), voxel_mm=0.1), hp.Bur(given.bur)
    poses = poses_about(tooth, given.count, given.seed)
    depths, micros = {}, {}
    for method in ("field", "hull", Corners(tooth, bur)):
        contact = hp.Contact(tooth, bur, method)
        took = []
        for _ in range(3):
            begun = time.perf_counter()
            depths[contact.method] = contact.probe(poses, patches=False).depth_mm
            took.append(1e6 * (time.perf_counter() - begun) / len(poses))
        micros[contact.method] = min(took)  # the machine may do other things too

    # Beyond the field's fine part the corners know a bound alone.
    near = np.abs(depths["field"]) < 0.5
    exact = depths["field"][near]
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
    span = [exact.min(), exact.max()]
    left.plot(span, span, color="black", linewidth=0.8, label=f"field, {micros['field']:.0f} µs a pose")
    for name, colour in (("hull", "tab:red"), ("corners", "tab:blue")):
        off = depths[name][near] - exact
        left.plot(exact, depths[name][near], ".", color=colour, markersize=3, alpha=0.5, label=f"{name}, {micros[name]:.0f} µs a pose")
        right.hist(np.clip(off, -0.3, 1.0), bins=np.linspace(-0.3, 1.0, 66), color=colour, alpha=0.6,
                   label=f"{name}: median {np.median(off):+.3f} mm, 95 % within {np.percentile(np.abs(off), 95):.3f} mm")
    left.set(xlabel="depth by field, exact [mm]", ylabel="depth by the method [mm]", title="The same poses (positive: inside the tooth)")
    left.legend(frameon=False, markerscale=4)
    right.set(xlabel="depth beyond the exact one [mm] (ends: and more)", ylabel="poses", title="How far each is off", yscale="log")
    right.set_ylim(0.7, 20 * len(exact))
    right.legend(frameon=False, loc="upper right")
    figure.savefig(given.out, dpi=110)
    print("drawn:", given.out)
    for name, depth in depths.items():
        off = np.abs(depth[near] - exact)
        print(f"{name:8} {micros[name]:7.1f} us a pose, off by {off.mean():.4f} mm on average, {off.max():.4f} at most")


if __name__ == "__main__":
    main()
