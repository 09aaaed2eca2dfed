# SPDX-License-Identifier: Apache-2.0
"""A school's pages in a real Chromium, every role, along seeded random ways: tests/school/browser/wander.mjs does it and
tells its finds, a line of JSON each."""
import json
import pathlib
import re
import shutil
import subprocess

from .finds import Find

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Chromium's word on letters that wander.mjs puts into a field for numbers or dates, where no keyboard would.
OWN_DOING = re.compile(r'The specified value ".*" (cannot be parsed|does not conform)')


def walk(program, seed, minutes, out, known, tell):
    folder = pathlib.Path(program)
    stage = folder.with_name("school_stage") if folder.is_file() else ROOT / "build" / program / "bin" / "school_stage"
    absent = [what for what, there in ((str(stage), stage.is_file()), ("nodejs", shutil.which("node"))) if not there]
    if absent:
        print(f"skipped: needs {', '.join(absent)}")
        return 77
    tell(f"walking a school's pages: seed {seed}")
    done = subprocess.Popen(["node", str(ROOT / "tests/school/browser/wander.mjs"), str(stage), str(seed), str(minutes)],
                            stdout=subprocess.PIPE, text=True)
    finds = []
    for line in done.stdout:
        try:
            told = json.loads(line)
        except ValueError:
            tell(line.rstrip())
            continue
        find = Find(told["invariant"], told["told"], step=told["step"])
        if OWN_DOING.search(find.told):
            continue
        reason = known.reason_of(find)
        tell(f"{'known' if reason else 'NEW'}  {find}{f'  ({reason})' if reason else ''}")
        finds.append((find, reason))
    code = done.wait()
    if code == 77:
        return 77
    if code:
        tell(f"the browser's walk ended with {code}")
        return 1
    new = [find for find, reason in finds if not reason]
    if finds:
        place = out / f"school-{seed}"
        place.mkdir(parents=True, exist_ok=True)
        (place / "finds.json").write_text(json.dumps([find.as_json() for find, _ in finds], indent=1))
    tell(f"{len(new)} new finds; the seed was {seed}")
    return 1 if new else 0
