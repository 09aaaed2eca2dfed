# SPDX-License-Identifier: Apache-2.0
"""A way: how the program is started, and steps in which nothing is left to chance, so that it can be walked again."""
import json

FORMAT = 1
START = {"language": "en", "size": "1366x768", "layout": "practice"}


def new(seed, start):
    return {"format": FORMAT, "seed": seed, "start": {**START, **start}, "steps": []}


def write(path, way):
    """A step a line: short, and to be read."""
    head = {name: value for name, value in way.items() if name != "steps"}
    lines = ",\n  ".join(json.dumps(step, ensure_ascii=False) for step in way["steps"])
    text = json.dumps(head, indent=1, ensure_ascii=False)[:-2] + f',\n "steps": [\n  {lines}\n ]\n}}\n'
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def read(path, kinds):
    """`kinds`: what a step may do. Ends with one clear sentence on anything else."""
    try:
        way = json.loads(path.read_text())
    except (OSError, ValueError) as problem:
        raise SystemExit(f"{path}: no way can be read: {problem}") from None
    if not isinstance(way, dict) or way.get("format") != FORMAT:
        raise SystemExit(f"{path}: this is no way of format {FORMAT}: write it with tools/walk")
    for number, step in enumerate(way.get("steps", []), 1):
        if not isinstance(step, dict) or step.get("do") not in kinds:
            raise SystemExit(f"{path}: step {number} does something unknown: {step}; there are: {', '.join(sorted(kinds))}")
    if not way.get("steps"):
        raise SystemExit(f"{path}: it has no steps")
    way["start"] = {**START, **way.get("start", {})}
    return way


def with_steps(way, steps):
    return {**way, "steps": list(steps)}
