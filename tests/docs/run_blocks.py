#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every fenced block of README and docs/ against what was built: what a page says shall be so.

    run_blocks.py --bin FOLDER [--all] [--python FOLDER] [PAGE ...]

A page has a folder of its own, in which its blocks run in their order, so that files made earlier are there. By language:
  sh         a script, every command of which must succeed; programs are those in FOLDER, as `handpiece` and as build/release/bin/handpiece
  synopsis   usage lines: each command is there, and its --help has each option
  toml json  read; by the product where a `check` says how
  python     run by Debian's Python, the blocks of a page one after the other in one session
  cpp        compiled against the headers
  csv        read: rows of one length; by the product where a `check` says how
  text       drawings and listings: nothing to run
Comments right before a block:
  <!-- not run: REASON -->       cannot run in a test; listed and counted
  <!-- nightly: REASON -->       too long for every change: with --all only (tools/nightly docs)
  <!-- first: COMMAND -->        runs before it: makes what the page takes for granted; `tooth FOLDER` makes a small one
  <!-- check: COMMAND -->        how the product reads it; {} is the file of the block
  <!-- with: A => B -->          B stands in the place of A while it runs: a folder of the test for one of the system
  <!-- small: A => B -->         likewise, a smaller one of the same; not with --all
  <!-- preamble: TEXT -->        what stands before a fragment of C++
"""
import argparse
import collections
import csv
import io
import itertools
import json
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FENCE = re.compile(r"^( *)(`{3,})\s*(\S*)\s*$")
COMMENT = re.compile(r"^ *<!-- (not run|nightly|first|check|with|small|preamble): (.+) -->$")
LANGUAGES = ("sh", "synopsis", "toml", "json", "python", "cpp", "csv", "text")

# The session that a page's blocks of Python share: the names of files come in, a mark goes out after each.
SESSION = """
import sys, traceback
names = {"__name__": "__main__"}
for file in map(str.strip, sys.stdin):
    try:
        exec(compile(open(file).read(), file, "exec"), names)
        print("\\n\\0done", flush=True)
    except BaseException:
        traceback.print_exc(file=sys.stdout)
        print("\\n\\0failed", flush=True)
"""


class Wrong(Exception):
    """A block that does not do what the page says."""


class Block:
    def __init__(self, page, line, language, text, comments):
        self.page, self.line, self.language, self.text = page, line, language, text
        self.told = collections.defaultdict(list)
        for key, value in comments:
            self.told[key].append(value.strip())

    def __str__(self):
        return f"{self.page}:{self.line}"


def blocks_of(path, name):
    lines, found, comments, at = path.read_text().split("\n"), [], [], 0
    while at < len(lines):
        fence, comment = FENCE.match(lines[at]), COMMENT.match(lines[at])
        if comment:
            comments.append(comment.groups())
        elif fence:
            start = at
            at += 1
            body = []
            while at < len(lines) and not re.match(rf"^ *{fence.group(2)}`* *$", lines[at]):
                body.append(lines[at].removeprefix(fence.group(1)))
                at += 1
            if at == len(lines):
                raise Wrong(f"{name}:{start + 1}: the block has no end")
            found.append(Block(name, start + 1, fence.group(3), "\n".join(body) + "\n", comments))
            comments = []
        else:
            if comments and lines[at].strip():
                raise Wrong(f"{name}:{at}: a comment for a block, and no block after it")
            if re.match(r"^ *<!-- *(not run|nightly|first|check|with|small|preamble)\b", lines[at]):
                raise Wrong(f"{name}:{at + 1}: a comment for a block without its text")
        at += 1
    return found


class Runner:
    def __init__(self, bin_folder, work, everything, python):
        self.bin, self.work, self.everything = bin_folder, work, everything
        self.helps, self.groups, self.session = {}, [], None
        self.environment = {key: value for key, value in os.environ.items() if not key.startswith("HANDPIECE")}
        self.environment.update(PATH=f"{bin_folder}:{os.environ['PATH']}", LC_ALL="C.UTF-8", PYTHONDONTWRITEBYTECODE="1")
        if python:
            self.environment["PYTHONPATH"] = str(python)

    def begin(self, page):
        """An own folder, home and caches: nothing of this machine's is seen or changed. Made teeth and fields are shared between pages."""
        self.folder = self.work / re.sub(r"\W", "-", page)
        (self.folder / "home").mkdir(parents=True)
        (self.folder / "run").mkdir(mode=0o700)
        (self.folder / "build/release").mkdir(parents=True)
        (self.folder / "build/release/bin").symlink_to(self.bin)
        if (self.bin.parent / "doubles").exists():
            (self.folder / "build/dev").mkdir()
            (self.folder / "build/dev/doubles").symlink_to(self.bin.parent / "doubles")
        for name in ("examples", "data", "tests"):
            (self.folder / name).symlink_to(ROOT / name)
        self.environment.update(HOME=str(self.folder / "home"), XDG_CACHE_HOME=str(self.work / "cache"), XDG_CONFIG_HOME=str(self.folder / "home/config"),
                                XDG_DATA_HOME=str(self.folder / "home/data"), XDG_RUNTIME_DIR=str(self.folder / "run"))
        (self.folder / "home/state").touch()

    def end(self):
        for group in self.groups:
            try:
                os.killpg(group, signal.SIGTERM)
            except ProcessLookupError:
                pass
        self.groups, self.session = [], None

    def shell(self, text):
        """Runs it as a page's reader would go on in one shell: variables stay, what was put behind goes on until the page's end."""
        state = self.folder / "home/state"
        tooth = shlex.quote(str(self.work / "tooth"))
        script = (f"tooth() {{ test -d {tooth} || handpiece make tooth --fdi 46 --seed 1 --faces 4000 --out {tooth}; test -d $1 || {{ mkdir -p $(dirname $1); cp -r {tooth} $1; }}; }}\n"
                  f"set -euo pipefail\nsource {shlex.quote(str(state))}\nset -a\n{text}\nset +a\nexport -p >{shlex.quote(str(state))}\n")
        with open(self.folder / "home/said", "w+", encoding="utf-8") as said:
            process = subprocess.Popen(["bash", "-c", script], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=said, stderr=said, start_new_session=True)
            self.groups.append(process.pid)
            code = process.wait(timeout=1800)
            said.seek(0)
            if code != 0:
                raise Wrong(f"ends with {code}:\n" + said.read()[-2000:])
            return said

    def run(self, block):
        if block.language not in LANGUAGES:
            raise Wrong(f"language '{block.language}': one of {', '.join(LANGUAGES)}")
        text = block.text
        for change in block.told["with"] + ([] if self.everything else block.told["small"]):
            old, _, new = change.partition(" => ")
            if old not in text:
                raise Wrong(f"'{old}' is to be another while it runs, and is not in the block")
            text = text.replace(old, new)
        for command in block.told["first"]:
            self.shell(command)
        getattr(self, block.language)(block, text)
        if block.told["check"]:
            file = self.folder / f"block-{block.line}.{block.language}"
            file.write_text(text)
            for command in block.told["check"]:
                self.shell(command.replace("{}", shlex.quote(str(file))))

    def sh(self, _block, text):
        self.shell(text)

    def text(self, block, _text):
        if block.told["check"]:
            raise Wrong("a drawing has nothing to check")

    def toml(self, _block, text):
        try:
            tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise Wrong(str(error)) from error

    def json(self, _block, text):
        try:
            json.loads(text)
        except json.JSONDecodeError as error:
            raise Wrong(str(error)) from error

    def csv(self, _block, text):
        rows = list(csv.reader(io.StringIO(text)))
        if len({len(row) for row in rows}) != 1:
            raise Wrong("rows of several lengths")

    def python(self, block, text):
        file = self.folder / f"block-{block.line}.py"
        file.write_text(text)
        if self.session is None:
            self.session = subprocess.Popen(["/usr/bin/python3", "-u", "-c", SESSION], cwd=self.folder, env=self.environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            stderr=subprocess.STDOUT, text=True, start_new_session=True)
            self.groups.append(self.session.pid)
        self.session.stdin.write(f"{file}\n")
        self.session.stdin.flush()
        said = ""
        for line in self.session.stdout:
            if line == "\0done\n":
                return
            if line == "\0failed\n":
                raise Wrong(said[-2000:])
            said += line
        self.session = None
        raise Wrong("ends Python:\n" + said[-2000:])

    def cpp(self, block, text):
        file = self.folder / f"block-{block.line}.cpp"
        file.write_text("\n".join(block.told["preamble"]) + "\n" + text)
        done = subprocess.run([os.environ.get("CXX", "g++"), "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I", ROOT / "src", "-isystem", "/usr/include/eigen3", file],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Wrong(done.stderr[-2000:])

    def help(self, words):
        """What --help of a command has, None where there is no such command."""
        key = tuple(words)
        if key not in self.helps:
            done = subprocess.run([self.bin / "handpiece", *words, "--help"], capture_output=True, text=True, env=self.environment, check=False)
            usage = re.search(r"^Usage: \S+ (.*)$", done.stdout, re.M)
            # The parent answers for a word that is no command of its own.
            self.helps[key] = done.stdout if done.returncode == 0 and usage and self.is_of(words, usage.group(1)) else None
        return self.helps[key]

    @staticmethod
    def is_of(words, usage):
        told = usage.split("[")[0].split()
        return told == list(words) or (words[0] in ("school", "serve") and told == [w for w in words if w != "school"]) or not words

    def synopsis(self, block, text):
        usages = []
        for line in text.splitlines():
            if line.startswith(" ") and usages:
                usages[-1] += " " + line.strip()
            elif line.strip():
                usages.append(line)
        for usage in usages:
            words = usage.split()
            if words[0] != "handpiece":
                raise Wrong(f"'{words[0]}' is no program of ours")
            commands = [()]
            for word in words[1:]:
                ways = [before + (way,) for before, way in itertools.product(commands, word.split("|")) if re.fullmatch(r"[a-z][a-z-]*", way)]
                found = [way for way in ways if self.help(way) is not None]
                if not found:
                    break
                if len(found) != len(ways) or len(ways) != len(commands) * len(word.split("|")):
                    raise Wrong(f"there is no command '{' '.join(next(w for w in ways if w not in found))}'")
                commands = found
            if commands == [()]:
                raise Wrong(f"there is no command '{words[1]}'")
            has_children = [c for c in commands if "\nSubcommands:" in self.help(c) and len(c) + 1 < len(words)]
            if has_children:
                raise Wrong(f"'{' '.join(has_children[0])}' has no command '{words[len(has_children[0]) + 1]}'")
            known = "\n".join(self.help(c) for c in commands)
            for option in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", usage):
                if not re.search(rf"(?<![\w-]){option}(?![\w-])", known):
                    raise Wrong(f"'{' '.join(commands[0])}' has no option {option}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*")
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--python", type=pathlib.Path)
    given = parser.parse_args()
    pages = [pathlib.Path(p).resolve() for p in given.pages] or [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    counted, wrong, spared, slow = collections.Counter(), [], [], []
    with tempfile.TemporaryDirectory(prefix="handpiece-docs-", ignore_cleanup_errors=True) as work:
        runner = Runner(given.bin.resolve(), pathlib.Path(work), given.all, given.python)
        for path in pages:
            name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name
            try:
                blocks = blocks_of(path, name)
            except Wrong as error:
                wrong.append(str(error))
                continue
            if not blocks:
                continue
            runner.begin(name)
            for block in blocks:
                reason = block.told["not run"] or ([] if given.all else block.told["nightly"])
                if reason:
                    spared.append(f"{block}: {'not run' if block.told['not run'] else 'nightly'}: {reason[0]}")
                    continue
                if block.language == "python" and not given.python and re.search(r"^\s*(import|from) handpiece\b", block.text, re.M):
                    spared.append(f"{block}: this build has no Python module")
                    continue
                start = time.monotonic()
                try:
                    runner.run(block)
                    counted[block.language] += 1
                except Wrong as error:
                    wrong.append(f"{block}: {error}")
                    counted["wrong"] += 1
                took = time.monotonic() - start
                if took > 2:
                    slow.append(f"{block}: {took:.0f} s")
            runner.end()
    for heading, lines in (("took longer", slow), ("not run here", spared), ("wrong", wrong)):
        if lines:
            print(f"{heading}:\n  " + "\n  ".join(lines))
    print("blocks: " + ", ".join(f"{count} {kind}" for kind, count in sorted(counted.items())) + f", {len(spared)} not run")
    return 1 if wrong or not counted else 0


if __name__ == "__main__":
    sys.exit(main())
