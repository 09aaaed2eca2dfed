# SPDX-License-Identifier: Apache-2.0
"""tools/check_links.py finds each kind of broken link, in the Markdown and in a site, and passes those that are right."""
import collections
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tools"))
import check_links  # noqa: E402

# A line of docs/a.md, and what must be said of it; nothing: it is right.
LINES = [
    ("[b](b.md)", ""), ("[b](b.md#two-words)", ""), ("[here](#title-of-a)", ""), ("[up](../README.md)", ""), ("![p](p.png)", ""), ("[日本](b.md#窩洞の深さ)", ""),
    ("[again](b.md#twice-1)", ""), ("[web](https://example.org/x)", ""), ("`[not](a-link.md)`", ""), ("[c](c.md)", "c.md: there is no such file"),
    ("[b](b.md#three)", "b.md#three: there is no such heading"), ("[b](b.md#in-code)", "no such heading"), ("[here](#nowhere)", "no such heading"),
    ("![q](q.png)", "no such file"), ("[out](../../etc/passwd)", "no such file"), ("[nested ![p](p.png)](c.md)", "c.md: there is no such file"),
]
B = "# B\n\n## Two words\n\n## Twice\n\n## Twice\n\n## 窩洞の深さ\n\n```sh\n# in code\n```\n"
SITE = [
    ('<a href="two.html#here">x</a>', ""), ('<a href="two.html#there">x</a>', "no such place"), ('<a href="three.html">x</a>', "no such file"), ('<a href="https://example.org">x</a>', ""),
    ('<script src="https://example.org/x.js"></script>', "from elsewhere"), ('<link rel="stylesheet" href="//example.org/x.css">', "from elsewhere"), ('<img src="gone.png">', "no such file"),
]
STYLES = [("a { background: url(data:image/png;base64,x) }", ""), ("@import url(https://example.org/font.css);", "from elsewhere"), ("@import '/javascript/x.css';", "from elsewhere")]


def main():
    missed = []

    def judge(what, said, breaches):
        if (breaches and not said) or (said and not any(said in line for line in breaches)):
            missed.append(f"{what}: expected '{said or 'nothing'}', told: {breaches}")

    with tempfile.TemporaryDirectory(prefix="handpiece-links-") as name:
        root = pathlib.Path(name)
        check_links.ROOT = root
        for folder in ("docs", "packaging/site", "src"):
            (root / folder).mkdir(parents=True)
        order = root / "packaging/site/order.toml"
        (root / "README.md").write_text("# R\n")
        for page in ("CHANGELOG", "ARCHITECTURE"):
            (root / f"{page}.md").write_text("# P\n")
        (root / "docs/b.md").write_text(B)
        (root / "docs/p.png").touch()

        def markdown():
            breaches = []
            check_links.anchors.__defaults__[0].clear()
            check_links.markdown(breaches, collections.defaultdict(list))
            return breaches

        order.write_text('"All" = ["docs/*", "CHANGELOG", "ARCHITECTURE"]\n')
        for line, said in LINES:
            (root / "docs/a.md").write_text(f"# Title of A\n\n{line}\n")
            judge(line, said, markdown())
        (root / "docs/a.md").write_text("# A\n")
        for line, said in (("// docs/b.md#two-words", ""), ("// docs/b.md#gone", "no such heading"), ("// docs/gone.md", "no such page")):
            (root / "src/x.h").write_text(line + "\n")
            judge(line, said, markdown())
        (root / "src/x.h").unlink()
        order.write_text('"All" = ["docs/a", "CHANGELOG", "ARCHITECTURE"]\n')
        judge("a page nobody reads", "who reads docs/b", markdown())
        order.write_text('"All" = ["docs/*", "docs/c", "CHANGELOG", "ARCHITECTURE"]\n')
        judge("a page that is not there", "no such page", markdown())

        site = root / "site"
        site.mkdir()
        (site / "two.html").write_text('<p id="here">x</p>')
        for body, said in SITE:
            (site / "one.html").write_text(body)
            breaches = []
            check_links.site(site, breaches, collections.defaultdict(list))
            judge(body, said, breaches)
        (site / "one.html").write_text("")
        for style, said in STYLES:
            (site / "x.css").write_text(style)
            breaches = []
            check_links.site(site, breaches, collections.defaultdict(list))
            judge(style, said, breaches)
    print("\n".join(missed) if missed else f"{len(LINES) + len(SITE) + len(STYLES) + 5} links, each judged as it should be")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
