#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the habits a compiler does not: licence line first, no file grown past reading, no absolute path of a machine,
no unfinished mark, formatted sources (when clang-format-14 is there). Exit 1 with one line a breach."""
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MAX_LINES = 1000
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
# JSON of somebody else's is counted before it is kept (config/outside_json.h); these read what the program itself wrote.
JSON_PARSE = re.compile(r"\b\w*[Jj]son::parse\(")
OWN_JSON = re.compile(r"src/handpiece/base/config/outside_json\.h|src/handpiece/app/(assessment/rescore|proving/conditions)\.cpp|"
                      r"apps/studies/.*|apps/school/(exam_line|live_commands|simulated_school|statements_push|station)\.cpp|apps/(cli|python)/.*|tests/.*|bench/.*")
MACHINE_PATH = re.compile(r"(?<![\w.])/(work|home|root|Users)/\w")


def own_namespace(path, text):
    """What a test's namespace has to end in, unless it does."""
    found = re.search(r"^namespace ([\w:]+) \{$", text, re.M)
    return path.stem if path.stem.endswith("_test") and found and not found.group(1).endswith("::" + path.stem) else None


def main():
    breaches = []
    sources = [p for folder in ("src", "apps", "tests", "bench", "examples") for p in sorted((ROOT / folder).rglob("*")) if p.suffix in (".h", ".cpp")]
    others = [p for folder in ("tools", "docs", "cmake") for p in sorted((ROOT / folder).rglob("*")) if p.is_file() and p.suffix in ("", ".py", ".md", ".cmake", ".txt")]
    others += sorted(ROOT.glob("*.md"))
    for path in sources + others:
        rel = path.relative_to(ROOT).as_posix()
        text = path.read_text(errors="replace")
        if path in sources:
            if not text.startswith("// SPDX-License-Identifier: Apache-2.0\n"):
                breaches.append(f"{rel}: the first line is not the licence's")
            if JSON_PARSE.search(text) and not OWN_JSON.fullmatch(rel):
                breaches.append(f"{rel}: reads JSON unbounded: use config::outsideJson()")
            if (own := own_namespace(path, text)):
                breaches.append(f"{rel}: is compiled together with others, so its namespace ends in ::{own}")
            if text.count("\n") > MAX_LINES:
                breaches.append(f"{rel}: {text.count(chr(10))} lines, more than {MAX_LINES}")
        if path.name != "check_tree.py":
            for number, line in enumerate(text.splitlines(), 1):
                if UNFINISHED.search(line):
                    breaches.append(f"{rel}:{number}: unfinished: {line.strip()[:80]}")
                if MACHINE_PATH.search(line):
                    breaches.append(f"{rel}:{number}: a path of one machine: {line.strip()[:80]}")
    formatter = shutil.which("clang-format-14")
    if formatter:
        result = subprocess.run([formatter, "--dry-run", "-Werror", *map(str, sources)], capture_output=True, text=True)
        files = sorted(set(re.findall(r"^(\S+?):\d+:\d+: error: code should be clang-formatted", result.stderr, re.M)))
        breaches += [f"{pathlib.Path(f).resolve().relative_to(ROOT)}: not formatted (clang-format-14 -i)" for f in files]
    for line in breaches:
        print(line)
    print(f"tree check: {len(sources)} sources, {len(breaches)} breaches" + ("" if formatter else ", format not checked: no clang-format-14"))
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
