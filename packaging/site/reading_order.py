# SPDX-License-Identifier: Apache-2.0
"""Who reads what: packaging/site/order.toml against the pages that there are."""
import pathlib
import tomllib


def pages(root):
    """The pages of ours, by their path without the ending."""
    found = [root / "CHANGELOG.md", root / "ARCHITECTURE.md", *sorted((root / "docs").rglob("*.md"))]
    return {path.relative_to(root).with_suffix("").as_posix(): path for path in found}


def order(root, names):
    """Heading -> pages, and what is wrong. A star takes the pages of its folder that are not named elsewhere."""
    table = tomllib.loads((root / "packaging/site/order.toml").read_text())
    named = {entry for entries in table.values() for entry in entries if "*" not in entry}
    told, left, faults = {}, set(names), []
    for heading, entries in table.items():
        told[heading] = []
        for entry in entries:
            folder = entry.rpartition("/")[0]
            matching = [entry] if "*" not in entry else [n for n in sorted(left - named) if n.rpartition("/")[0] == folder and pathlib.PurePath(n).match(entry)]
            told[heading] += matching
            left -= set(matching)
            # The references are written when the site is built.
            faults += [f"packaging/site/order.toml names {name}, and there is no such page" for name in matching if name not in names and not name.endswith("/index")]
    if left:
        faults.append(f"packaging/site/order.toml does not say who reads {', '.join(sorted(left))}")
    return told, faults
