#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds every relative link of the Markdown to a file and, with an anchor, to a heading of it, and every page to a place in the site; with a folder, every link of the site built there, which
must load nothing from elsewhere. Links to elsewhere are counted, or listed with --external; none is fetched.

    tools/check_links.py [SITE] [--external]"""
import argparse
import collections
import html.parser
import os
import pathlib
import re
import sys
import unicodedata
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "packaging/site"))
sys.dont_write_bytecode = True
import reading_order  # noqa: E402

LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\)")
BARE = re.compile(r"https?://[^\s<>()`\"'|]+[\w/]")


def without_code(text):
    """Fenced blocks and code in a line are no links; the lines stay."""
    kept, fence = [], None
    for line in text.split("\n"):
        mark = re.match(r"^ *(`{3,}|~{3,})", line)
        if fence:
            if mark and mark.group(1).startswith(fence):
                fence = None
            line = ""
        elif mark:
            fence, line = mark.group(1), ""
        kept.append(re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", "", line))
    return "\n".join(kept)


def anchors(path, known={}):
    """What a forge makes of the headings: small letters, spaces to hyphens, marks dropped, what comes again numbered."""
    if path not in known:
        found, seen, fenced = set(), collections.Counter(), False
        for line in path.read_text().split("\n"):
            if re.match(r"^ *```", line):
                fenced = not fenced
            heading = None if fenced else re.match(r"^#{1,6} +(.+?)(?: +#+)? *$", line)
            if heading:
                words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
                slug = "".join(c for c in words if c in "-_ " or unicodedata.category(c)[0] in "LNM").replace(" ", "-")
                found.add(slug if not seen[slug] else f"{slug}-{seen[slug]}")
                seen[slug] += 1
        known[path] = found
    return known[path]


def markdown(breaches, external):
    pages = [*sorted(ROOT.glob("*.md")), *(p for folder in ("docs", "packaging", "examples", "tests") for p in sorted((ROOT / folder).rglob("*.md")))]
    count = 0
    for page in pages:
        if "node_modules" in page.parts:
            continue
        name = page.relative_to(ROOT).as_posix()
        for number, line in enumerate(without_code(page.read_text()).split("\n"), 1):
            for address in BARE.findall(line):
                external[address].append(f"{name}:{number}")
            for target in LINK.findall(line):
                if re.match(r"[a-z][a-z+.-]*:", target):
                    continue
                count += 1
                place, _, anchor = urllib.parse.unquote(target).partition("#")
                file = (page.parent / place).resolve() if place else page
                if not file.is_relative_to(ROOT) or not file.exists():
                    breaches.append(f"{name}:{number}: {target}: there is no such file")
                elif anchor and (file.suffix != ".md" or anchor not in anchors(file)):
                    breaches.append(f"{name}:{number}: {target}: there is no such heading")
    breaches += reading_order.order(ROOT, reading_order.pages(ROOT))[1]
    # What sources say of a page; those of wrong_links.py are made up.
    for folder in ("src", "apps", "tests", "bench", "examples", "tools", "data"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp", ".py", ".js", ".ts", ".toml", ".txt", "") or not path.is_file() or "node_modules" in path.parts or path.name == "wrong_links.py":
                continue
            for number, line in enumerate(path.read_text(errors="replace").split("\n"), 1):
                for place, anchor in re.findall(r"(?<![\w/.])(docs/[\w./-]+\.md)(?:#([\w-]+))?", line):
                    count += 1
                    name = f"{path.relative_to(ROOT).as_posix()}:{number}"
                    if not (ROOT / place).exists():
                        breaches.append(f"{name}: {place}: there is no such page")
                    elif anchor and anchor not in anchors(ROOT / place):
                        breaches.append(f"{name}: {place}#{anchor}: there is no such heading")
    return len(pages), count


class Page(html.parser.HTMLParser):
    """Names, links, and what a browser loads by itself."""

    def __init__(self):
        super().__init__()
        self.names, self.links, self.loads = set(), [], []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.names.update(filter(None, (attributes.get("id"), attributes.get("name") if tag == "a" else None)))
        if tag == "a" and attributes.get("href"):
            self.links.append(attributes["href"])
        if tag == "link" and attributes.get("href") and attributes.get("rel") not in ("canonical",):
            self.loads.append(attributes["href"])
        if tag in ("script", "img", "iframe", "source", "video", "audio", "embed") and attributes.get("src"):
            self.loads.append(attributes["src"])
        if tag == "form" and attributes.get("action"):
            self.links.append(attributes["action"])


def site(folder, breaches, external):
    pages = {}
    for path in sorted(folder.rglob("*.html")):
        pages[path] = Page()
        pages[path].feed(path.read_text())
    count = 0
    for path, page in pages.items():
        name = path.relative_to(folder).as_posix()
        for target, loaded in [(t, False) for t in page.links] + [(t, True) for t in page.loads]:
            if target.startswith("data:") or target.startswith("blob:"):
                continue
            if re.match(r"([a-z][a-z+.-]*:|//)", target):
                if loaded:
                    breaches.append(f"{name}: loads {target} from elsewhere")
                else:
                    external[target].append(name)
                continue
            count += 1
            place, _, anchor = target.partition("#")
            place, anchor = urllib.parse.unquote(place.partition("?")[0]), urllib.parse.unquote(anchor)
            file = pathlib.Path(os.path.normpath(path.parent / place)) if place else path
            if not file.is_file():
                breaches.append(f"{name}: {target}: there is no such file")
            elif anchor and file in pages and anchor not in pages[file].names:
                breaches.append(f"{name}: {target}: there is no such place")
    for path in sorted(folder.rglob("*.css")):
        for address in re.findall(r"(?:url\(\s*|@import\s+)[\"']?((?:https?:/)?/[^\"')\s]+)", path.read_text()):
            breaches.append(f"{path.relative_to(folder).as_posix()}: loads {address} from elsewhere")
    if not pages:
        breaches.append(f"{folder}: there is no page")
    return len(pages), count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site", nargs="?", type=pathlib.Path)
    parser.add_argument("--external", action="store_true")
    given = parser.parse_args()
    breaches, external = [], collections.defaultdict(list)
    pages, count = site(given.site.resolve(), breaches, external) if given.site else markdown(breaches, external)
    if given.external:
        for address, places in sorted(external.items()):
            print(f"{address}  ({', '.join(sorted(set(places))[:3])})")
    for line in breaches:
        print(line)
    print(f"links: {count} within {pages} pages, {len(breaches)} broken; {len(external)} addresses elsewhere")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
