#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Probes from Python beside the same probes by the command line's own clock, back to back on one core.

    PYTHONPATH=build/dev/python HANDPIECE=build/dev/bin/handpiece python3 tests/python/bench_probe.py

`handpiece probe` tells the nanoseconds of each pose; their sum is what C++ takes. Python's is the wall time of
Contact.probe, arrays in and out. Median of the rounds; then the same on all cores, and depths alone. On a machine that does
other things too look at the last line: both in stretches of 64 poses, of each stretch the least time over all rounds, which
nothing came between; Python is called anew for each stretch there.
"""
import argparse
import csv
import io
import os
import statistics
import subprocess
import tempfile
import time

import numpy as np

import handpiece as hp


STRETCH = 64


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--count", type=int, default=10000)
    options.add_argument("--rounds", type=int, default=7)
    options.add_argument("--faces", type=int, default=68150)
    options.add_argument("--bur", default="330")
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        molar = os.path.join(folder, "molar")
        hp.make_tooth(faces=given.faces).write(molar)
        tooth = hp.prepare(molar)
        random = np.random.default_rng(1)
        vertices = tooth.outer.vertices
        crown = vertices[vertices[:, 2] > vertices[:, 2].max() - 4]
        poses = np.zeros((given.count, 7))
        poses[:, :3] = crown[random.integers(len(crown), size=given.count)] + random.uniform(-0.3, 0.7, (given.count, 3))
        poses[:, 3:] = random.normal(0, 0.2, (given.count, 4)) + [1, 0, 0, 0]
        poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
        text = "x,y,z,qw,qx,qy,qz\n" + "".join(",".join(map(repr, row)) + "\n" for row in poses.tolist())
        contact = hp.Contact(tooth, given.bur)
        times = {"C++, one core": [], "Python, one core": [], "Python, depth alone": [], "Python, all cores": []}

        def timed(name, threads, **more):
            hp.set_threads(threads)
            begun = time.perf_counter()
            probe = contact.probe(poses, **more)
            times[name].append(1e3 * (time.perf_counter() - begun))
            return probe

        stretches = np.array_split(poses, range(STRETCH, given.count, STRETCH))
        undisturbed = {name: np.full(len(stretches), np.inf) for name in ("C++", "Python")}

        def stretch_by_stretch():
            hp.set_threads(1)
            took = []
            for stretch in stretches:
                begun = time.perf_counter()
                contact.probe(stretch)
                took.append(1e3 * (time.perf_counter() - begun))
            return took


        for _ in range(given.rounds + 1):
            done = subprocess.run([os.environ["HANDPIECE"], "probe", "--tooth", molar, "--bur", given.bur, "--poses", "-"], input=text,
                                  capture_output=True, text=True, check=True)
            rows = list(csv.DictReader(io.StringIO(done.stdout)))
            each = np.array([1e-6 * int(row["time_ns"]) for row in rows])
            times["C++, one core"].append(each.sum())
            sums = [part.sum() for part in np.array_split(each, range(STRETCH, given.count, STRETCH))]
            undisturbed["C++"] = np.minimum(undisturbed["C++"], sums)
            probe = timed("Python, one core", 1)
            undisturbed["Python"] = np.minimum(undisturbed["Python"], stretch_by_stretch())
            timed("Python, depth alone", 1, patches=False)
            timed("Python, all cores", 0)
        assert [row["depth_mm"] for row in rows] == [f"{depth:.9f}" for depth in probe.depth_mm]
    print(f"{given.count} poses, {given.rounds} rounds, HANDPIECE_SIMD={os.environ.get('HANDPIECE_SIMD', '')}")
    base = statistics.median(times["C++, one core"][1:])
    for name, all_ms in times.items():
        of = all_ms[1:]  # the first one warms
        print(f"  {name:20} median {statistics.median(of):8.1f} ms, least {min(of):8.1f}, most {max(of):8.1f}, "
              f"{statistics.median(of) / base:5.3f} times C++")
    cpp, python = (undisturbed[name].sum() for name in ("C++", "Python"))
    print(f"  undisturbed, one core: C++ {cpp:.1f} ms, Python {python:.1f} ms, {python / cpp:.3f} times C++")


if __name__ == "__main__":
    main()
