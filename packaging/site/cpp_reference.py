# SPDX-License-Identifier: Apache-2.0
"""The C++ reference as pages for Sphinx: Doxygen reads the public headers, one page is written for each room of the house.
By itself it ends with what Doxygen finds fault with."""
import collections
import html
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

DOXYFILE = """
PROJECT_NAME = Handpiece
INPUT = {inputs}
OUTPUT_DIRECTORY = {out}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
HAVE_DOT = NO
JAVADOC_AUTOBRIEF = YES
WARN_IF_UNDOCUMENTED = NO
# A parameter is told of where its name does not say all.
WARN_IF_INCOMPLETE_DOC = NO
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = HANDPIECE_REALTIME=
STRIP_FROM_PATH = {src}
STRIP_FROM_INC_PATH = {src}
# A place in a page of docs/ is no name in the code.
FILTER_PATTERNS = *.h="sed s/\\.md#/.md\\\\\\\\#/g"
QUIET = YES
WARN_FORMAT = "$file:$line: $text"
"""


def rooms(root):
    """Room -> its public headers, from the handpiece_room() calls, lowest first as the build has them."""
    found = {}
    for room in re.findall(r"\b[a-z]+/[a-z_]+\b", (root / "CMakeLists.txt").read_text()):
        path = root / "src/handpiece" / room / "CMakeLists.txt"
        if not path.exists():
            continue
        call = re.search(r"handpiece_room\((\S+)\s+HEADERS\s+(.*?)\s+(?:SOURCES|USES|THIRD_PARTY|\))", path.read_text() + " )", re.S)
        if call:
            found[call.group(1)] = call.group(2).rstrip(")").split()
    return found


def doxygen(root, headers, work):
    """XML of the headers, and what Doxygen says of them."""
    work.mkdir(parents=True, exist_ok=True)
    (work / "Doxyfile").write_text(DOXYFILE.format(inputs=" ".join(f'"{root / "src/handpiece" / h}"' for h in headers), out=work, src=root / "src"))
    done = subprocess.run(["doxygen", str(work / "Doxyfile")], capture_output=True, text=True, check=True)
    return [line for line in done.stderr.splitlines() if line.strip()]


class Reference:
    """All that was found, and where each thing is told of."""

    def __init__(self, xml, room_of):
        self.files, self.things, self.place = {}, collections.defaultdict(list), {}
        self.taken = collections.Counter()
        compounds = [c for path in sorted(xml.glob("*.xml")) for c in ElementTree.parse(path).getroot().findall("compounddef")]
        compounds.sort(key=lambda c: c.get("id"))
        for compound in compounds:
            kind = compound.get("kind")
            if kind == "file":
                self.files[compound.find("location").get("file").removeprefix("handpiece/")] = compound
            elif kind in ("class", "struct", "union"):
                if compound.get("prot") in (None, "public"):
                    self.add(compound, compound.find("compoundname").text, room_of)
            elif kind == "namespace":
                for member in compound.iter("memberdef"):
                    self.add(member, member.find("qualifiedname").text, room_of)

    def add(self, thing, name, room_of):
        where = thing.find("location")
        header = where.get("file", "").removeprefix("handpiece/")
        if header not in room_of or "@" in name:
            return
        page = page_of(room_of[header])
        self.things[header].append((int(where.get("line")), name, thing))
        self.note(thing, name, page)
        if thing.tag == "compounddef":
            for member in public_members(thing):
                self.note(member, f"{name}::{member.find('name').text}", page)

    def note(self, thing, name, page):
        anchor = re.sub(r"[^\w.~=<>+*/!\[\]()-]", "", short(name).replace("::", "."))
        self.taken[anchor.lower()] += 1
        if self.taken[anchor.lower()] > 1:
            anchor += f"-{self.taken[anchor.lower()]}"
        self.place[thing.get("id")] = (page, anchor)

    # Doxygen's mark-up as HTML.
    TAGS = {"para": "p", "computeroutput": "code", "itemizedlist": "ul", "orderedlist": "ol", "listitem": "li", "verbatim": "pre", "bold": "b", "emphasis": "em",
            "programlisting": "pre", "parameterlist": "ul", "superscript": "sup", "subscript": "sub"}

    def inside(self, node):
        text = html.escape(node.text or "", quote=False)
        for child in node:
            text += self.text(child) + html.escape(child.tail or "", quote=False)
        return text

    def text(self, node):
        if node.tag == "ref":
            return self.link(node.get("refid"), self.inside(node))
        if node.tag == "sp":
            return " "
        if node.tag == "parameteritem":
            names = ", ".join(f"<code>{html.escape(name.text or '')}</code>" for name in node.iter("parametername"))
            return f"<li>{names}: {self.inside(node.find('parameterdescription'))}</li>"
        if node.tag == "simplesect":
            return f"<p>{node.get('kind').capitalize()}: {self.inside(node)}</p>"
        tag = self.TAGS.get(node.tag)
        return f"<{tag}>{self.inside(node)}</{tag}>" if tag else self.inside(node)

    def link(self, refid, text):
        if refid not in self.place:
            return text
        page, anchor = self.place[refid]
        return f'<a href="{page}.html#{html.escape(anchor)}">{text}</a>'

    def says(self, thing):
        """What the comment says, without the paragraph's tags where it is one."""
        text = "".join(self.inside(part).strip() for part in (thing.find("briefdescription"), thing.find("detaileddescription")) if part is not None)
        # Lists and notes within a paragraph end it.
        text = re.sub(r"<p>\s*</p>", "", text)
        return re.sub(r"\n\s*\n", "\n", text)

    def declaration(self, member):
        """As a person would write it, names linked."""
        kind, name = member.get("kind"), html.escape(member.find("name").text)
        page_anchor = self.place[member.get("id")][1]
        named = f'<b id="{html.escape(page_anchor)}">{name}</b>'
        kept = self.inside(member.find("type")) if member.find("type") is not None else ""
        template = member.find("templateparamlist")
        before = ""
        if template is not None:
            before = "template &lt;" + ", ".join(self.inside(p.find("type")) + (" " + p.find("declname").text if p.find("declname") is not None else "")
                                                 for p in template) + "&gt; "
        if kind == "function":
            parameters = []
            for p in member.findall("param"):
                one = self.inside(p.find("type"))
                if p.find("declname") is not None:
                    one += " " + html.escape(p.find("declname").text)
                if p.find("defval") is not None:
                    one += " = " + self.inside(p.find("defval"))
                parameters.append(one)
            after = re.sub(r"^.*\)(?=[^)]*$)", "", member.find("argsstring").text or "")
            virtual = "virtual " if member.get("virt") in ("virtual", "pure-virtual") else ""
            static = "static " if member.get("static") == "yes" else ""
            return f"{before}{static}{virtual}{kept} {named}({', '.join(parameters)}){html.escape(after)}".replace("  ", " ").strip()
        if kind == "variable":
            start = member.find("initializer")
            value = " " + self.inside(start) if start is not None and len("".join(start.itertext())) < 60 else ""
            array = html.escape(member.find("argsstring").text or "") if member.find("argsstring") is not None else ""
            static = "static " if member.get("static") == "yes" and "constexpr" not in kept else ""
            return f"{static}{kept} {named}{array}{value}"
        if kind == "typedef":
            return f"{before}using {named} = {kept}"
        if kind == "enum":
            return f"enum {'class ' if member.get('strong') == 'yes' else ''}{named}"
        return f"{kept} {named}"

    def member(self, member):
        text = f"<dt>{self.declaration(member)}</dt><dd>{self.says(member)}"
        values = member.findall("enumvalue")
        if values:
            text += '<dl class="cpp">' + "".join(f"<dt>{html.escape(v.find('name').text)}</dt><dd>{self.says(v)}</dd>" for v in values) + "</dl>"
        return text + "</dd>"

    def members(self, members):
        # Blank lines would end the block of HTML.
        return re.sub(r"\n\s*\n", "\n", '<dl class="cpp">\n' + "\n".join(map(self.member, members)) + "\n</dl>\n") if members else ""


def short(name):
    return name.removeprefix("handpiece::")


def page_of(room):
    return room.replace("/", "-")


def public_members(compound):
    return [m for m in compound.iter("memberdef") if m.get("prot") == "public" and m.get("kind") != "friend" and "@" not in m.find("name").text]


def write(root, out, work):
    """Pages into `out`; gives back what Doxygen complains of."""
    house = rooms(root)
    room_of = {f"{room}/{header}": room for room, headers in house.items() for header in headers}
    complaints = doxygen(root, sorted(room_of), work)
    reference = Reference(work / "xml", room_of)
    out.mkdir(parents=True, exist_ok=True)
    wings = collections.defaultdict(list)
    for room, headers in house.items():
        wing, name = room.split("/")
        page = [f"# {name} ({wing})\n"]
        namespaces = set()
        for header in headers:
            key = f"{room}/{header}"
            compound = reference.files.get(key)
            page.append(f"## {header}\n\n<p class=\"header-file\"><code>#include \"handpiece/{key}\"</code></p>\n")
            if compound is not None and reference.says(compound):
                page.append(f"<div>{reference.says(compound)}</div>\n")
            loose = []
            for _, full, thing in sorted(reference.things[key], key=lambda t: t[:2]):
                namespaces.add(full.split("::")[1] if "::" in full else "")
                if thing.tag == "memberdef":
                    loose.append(thing)
                    continue
                page.append(reference.members(loose))
                loose = []
                bases = [html.unescape(b.text or "") for b in thing.findall("basecompoundref") if b.get("prot") == "public"]
                words = f"{thing.get('kind')} {short(full)}" + (" : " + ", ".join(bases) if bases else "")
                anchor = html.escape(reference.place[thing.get("id")][1])
                page.append(f'<span id="{anchor}"></span>\n\n### `{words}`\n')
                if reference.says(thing):
                    page.append(f"<div>{reference.says(thing)}</div>\n")
                page.append(reference.members([m for m in public_members(thing)]))
            page.append(reference.members(loose))
        (out / f"{page_of(room)}.md").write_text("\n".join(part for part in page if part))
        wings[wing].append((page_of(room), name, ", ".join(header.removesuffix(".h") for header in headers)))
    index = ["# C++ reference\n", "The public headers of the library, room by room ([who may use whom](../ARCHITECTURE.md#who-may-include-whom)); namespaces are within `handpiece`. "
             "A program links what it uses: `find_package(handpiece)`, then `handpiece::contact` and so on "
             "([a whole program](../tests/consumer/main.cpp)).\n"]
    for wing, pages in wings.items():
        index.append(f"## {wing}\n\n" + "\n".join(f'<p><a href="{page}.html"><b>{name}</b></a>: {held}</p>' for page, name, held in pages)
                     + "\n\n```{toctree}\n:hidden:\n\n" + "\n".join(page for page, _, _ in pages) + "\n```\n")
    (out / "index.md").write_text("\n".join(index))
    return complaints


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        sys.exit("\n".join(write(pathlib.Path(__file__).resolve().parents[2], pathlib.Path(folder, "pages"), pathlib.Path(folder, "doxygen"))) or None)
