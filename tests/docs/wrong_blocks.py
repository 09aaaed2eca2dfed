# SPDX-License-Identifier: Apache-2.0
"""run_blocks.py finds a page that is wrong, each way in which one can be, and says where; and passes one that is right."""
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent

# What stands in the page, and what must be said of it; nothing: it is right.
PAGES = [
    ("```sh\nfalse\ntrue\n```\n", "page.md:1: ends with 1"),
    ("```sh\nhandpiece make plane --out p.stl\n```\n\n```sh\nhandpiece mesh info q.stl\n```\n", "page.md:5: ends with 1"),
    ("```sh\nhandpiece make plane --out p.stl\n```\n\n```sh\nhandpiece mesh info p.stl\n```\n", ""),
    ("```synopsis\nhandpiece mesh info FILE [--colour X]\n```\n", "'mesh info' has no option --colour"),
    ("```synopsis\nhandpiece mesh paint FILE\n```\n", "'mesh' has no command 'paint'"),
    ("```synopsis\nhandpiece paint FILE\n```\n", "there is no command 'paint'"),
    ("```synopsis\nhandpiece mesh info|paint FILE\n```\n", "there is no command 'mesh paint'"),
    ("```synopsis\nhandpiece mesh info FILE [--unit mm|cm]\n                   [--json]\n```\n", ""),
    ("```toml\na = \n```\n", "page.md:1:"),
    ("<!-- check: handpiece rubric check {} -->\n```toml\nformat = 1\n```\n", "page.md:2: ends with 1"),
    ("```json\n{\n```\n", "page.md:1:"),
    ("```csv\na,b\n1\n```\n", "rows of several lengths"),
    ("```cpp\nint x = \"a\";\n```\n", "invalid conversion"),
    ("<!-- preamble: #include \"handpiece/tick/contact/method.h\" -->\n```cpp\nhandpiece::contact::Depth depth;\n```\n", ""),
    ("```python\n1 / 0\n```\n", "ZeroDivisionError"),
    ("```python\nx = 1\n```\n\n```python\nassert x == 1\n```\n", ""),
    ("```python\nx = 1\n```\n\n```python\nassert x == 2\n```\n", "page.md:5:"),
    ("```python\nimport os\nos.abort()\n```\n", "ends Python"),
    ("```\nls\n```\n", "language ''"),
    ("```ruby\n1\n```\n", "language 'ruby'"),
    ("```sh\nls\n", "the block has no end"),
    ("<!-- not run: -->\n```sh\nls\n```\n", "without its text"),
    ("<!-- not run: needs an arm -->\nWords.\n", "no block after it"),
    ("<!-- with: x => y -->\n```sh\nls\n```\n", "is not in the block"),
]


def main():
    binaries, missed = sys.argv[1], []
    with tempfile.TemporaryDirectory(prefix="handpiece-docs-") as folder:
        page = pathlib.Path(folder) / "page.md"
        for text, said in PAGES:
            page.write_text(text)
            done = subprocess.run([sys.executable, "-B", HERE / "run_blocks.py", "--bin", binaries, page], capture_output=True, text=True, check=False)
            right = done.returncode == 0 if not said else done.returncode == 1 and said in done.stdout
            if not right:
                missed.append(f"{text}\nexpected: {said or 'right'}\n{done.stdout}{done.stderr}")
    print("\n".join(missed) if missed else f"{len(PAGES)} pages, each judged as it should be")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
