#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The same bits on every machine: in what a hash, a mesh, a table, a force or a score rests on, nothing asks the C
library for a sine or its kin (base/core/portable_math.h has them), nothing asks Eigen for what asks it
(base/core/rotation.h), nothing takes random numbers or sums whose order is the library's own affair, and no option of
the compiler loosens the arithmetic. What is only seen or heard may. Exit 1 with one line a breach."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HELD = ("src/handpiece", "apps/studies", "apps/cli")
SEEN_OR_HEARD = re.compile(r"src/handpiece/(senses/(view|sound)|app/report)/|src/handpiece/base/core/portable_math\.(h|cpp)")
KIN = "(sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|hypot|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|erf|erfc|tgamma|lgamma)[fl]?"
BREACHES = [
    (re.compile(rf"\bstd::{KIN}\b|(?<![\w:.>]){KIN}\("), "of the C library: take base/core/portable_math.h"),
    (re.compile(r"\bAngleAxis|\.(slerp|angularDistance|eulerAngles|canonicalEulerAngles|computeDirect)\(|\bRotation2D|\bUnitRandom\("),
     "of Eigen asks the C library: take base/core/rotation.h"),
    (re.compile(r"\.(array\(\)\.)?(sin|cos|tan|acos|asin|atan|exp|log|log10|pow)\(\)"), "of Eigen asks the C library"),
    (re.compile(r"\bstd::(\w+_distribution|shuffle|reduce|transform_reduce|execution)\b|\bparallel_(deterministic_)?reduce\b|\blong double\b"), "is another in every library"),
]
FLAGS = re.compile(r"-ffast-math|-Ofast|-funsafe-math|-fassociative-math|-ffp-contract=(on|fast)|-mfma\b|-march=native")


def code(text):
    """Without comments and texts, line by line."""
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), text, flags=re.DOTALL)
    return [re.sub(r'//.*|"(?:\\.|[^"\\])*"', "", line) for line in text.split("\n")]


def breaches_in(lines):
    return [(n, m.group().strip(), why) for n, line in enumerate(lines, 1) for pattern, why in BREACHES if (m := pattern.search(line))]


def self_test():
    """What must be found, and what must not: a check that finds nothing looks like one that passes."""
    wrong = ["x = std::sin(a);", "y = exp(2);", "std::powf(a, b)", "Eigen::AngleAxisd(a, b)", "q.slerp(t, p)", "std::normal_distribution<> d;", "v.array().exp()", "tbb::parallel_reduce(r)"]
    right = ["x = core::sin(a);", "// std::sin(x)", "std::sqrt(x) + std::floor(y)", "a.exp(3)", "expect(1)", 'fmt::print("sin(x)")', "std::mt19937_64 g(1);", "parallelFor(1)"]
    return [f"self-test: not found: {line}" for line in wrong if not breaches_in(code(line))] + [f"self-test: found in {line}" for line in right if breaches_in(code(line))]


def main():
    out = self_test()
    files = [p for folder in HELD for p in (ROOT / folder).rglob("*") if p.suffix in (".h", ".cpp")]
    for path in sorted(files):
        rel = path.relative_to(ROOT).as_posix()
        if not SEEN_OR_HEARD.match(rel):
            out += [f"{rel}:{n}: {what} {why}" for n, what, why in breaches_in(code(path.read_text(errors="replace")))]
    builds = [ROOT / "CMakeLists.txt", ROOT / "CMakePresets.json", *(ROOT / "cmake").glob("*.cmake"), *(ROOT / "src").rglob("CMakeLists.txt"), *(ROOT / "apps").rglob("CMakeLists.txt")]
    for path in builds:
        out += [f"{path.relative_to(ROOT)}: {m.group()} gives other bits" for m in FLAGS.finditer(path.read_text())]
    if "-ffp-contract=off" not in (ROOT / "cmake" / "handpiece.cmake").read_text():
        out.append("cmake/handpiece.cmake: -ffp-contract=off is missing")
    print("\n".join(out + [f"math check: {len(files)} files, {len(out)} breaches"]))
    return 1 if out else 0


if __name__ == "__main__":
    sys.exit(main())
