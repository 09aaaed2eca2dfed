#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What standard_test.cpp expects of borderline regression, by numpy alone: its least squares, its random numbers.
Exit 1 where the test beside has another number, 77 (skipped) without numpy."""
import pathlib
import sys

try:
    import numpy
except ImportError:
    print("python3-numpy is not installed: the expected numbers are not computed again")
    sys.exit(77)

WORKS = [(1, 31), (2, 48), (2, 55), (3, 61), (3, 66), (3, 58), (4, 74), (4, 81), (5, 88), (5, 93), (1, 40), (2, 44.5)]
BORDERLINE = 2.0

x, y = numpy.array(WORKS, dtype=float).T
design = numpy.column_stack([numpy.ones_like(x), x])
(intercept, slope), *_ = numpy.linalg.lstsq(design, y, rcond=None)
residual = y - design @ [intercept, slope]
spread = numpy.sqrt(residual @ residual / (len(x) - 2))
at = numpy.array([1.0, BORDERLINE])
error = spread * numpy.sqrt(at @ numpy.linalg.inv(design.T @ design) @ at)
random = numpy.random.default_rng(1)
cuts = []
for _ in range(200_000):
    drawn = random.integers(0, len(x), len(x))
    if x[drawn].std() > 0:
        b = numpy.cov(x[drawn], y[drawn], bias=True)[0, 1] / x[drawn].var()
        cuts.append(y[drawn].mean() + b * (BORDERLINE - x[drawn].mean()))
low, high = numpy.percentile(numpy.clip(cuts, 0, 100), [2.5, 97.5])
expected = {"slope": slope, "intercept": intercept, "cut": intercept + slope * BORDERLINE, "r2": 1 - residual @ residual / ((y - y.mean()) ** 2).sum(),
            "residual": spread, "error": error, "low": low, "high": high}
text = pathlib.Path(__file__).with_name("standard_test.cpp").read_text()
missing = [f"{name} {value!r}" for name, value in expected.items() if repr(float(value))[:11] not in text]
print("\n".join(f"{name} {float(value)!r}" for name, value in expected.items()))
sys.exit(f"standard_test.cpp has another: {missing}" if missing else 0)
