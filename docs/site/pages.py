#!/usr/bin/env python3
"""What Sphinx builds the site from: the documents as they stand, with what only a site needs added to them.

usage: pages.py headers FILE              the public headers, for Doxygen
       pages.py pages MBK API.tag FOLDER  every page, into FOLDER
A page keeps its text. Links to other pages lead to pages of the site, links to public headers and names of functions to
the API reference, links to any other file to a page that shows it. Formulas on lines of their own are typeset. The
reference of commands is made of the manual pages that the program writes.
"""

import html
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import document_pages
import pygments
import pygments.formatters
import pygments.lexers
import python_pages

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIXED = {"README.md": "index", "CHANGELOG.md": "changelog", "CONTRIBUTING.md": "contributing",
         "CODE_OF_CONDUCT.md": "conduct", "SECURITY.md": "security",
         "THIRD_PARTY_NOTICES.md": "notices", "bench/README.md": "bench", "fuzz/README.md": "fuzz",
         "bridge/README.md": "bridge"}
LANGUAGES = {".cpp": "cpp", ".h": "cpp", ".c": "c", ".py": "python", ".toml": "toml", ".urdf": "xml", ".sh": "bash",
             ".json": "json", ".ipynb": "json", ".yml": "yaml", ".ts": "typescript", ".cmake": "cmake", ".txt": "cmake"}
SUBSCRIPT = re.compile(r"(?<![\w./@])([A-Za-zΑ-ω][\u0300-\u036f]*|∂[a-z])_([A-Za-z]{1,4}|\d)(?![\w/])")
LINK = re.compile(r"(?P<code>(?<!\[)`+[^`]+`+(?!\]))|(?P<image>!?)\[(?P<label>(?:[^\[\]`]|`[^`]*`)*)\]\((?P<target>[^)\s]+)\)")


def public_headers():
    """Every header that is installed: not those of tests, not those that a module keeps to itself."""
    for lists in sorted(ROOT.glob("mbk/*/**/CMakeLists.txt")):
        text = re.sub(r"#[^\n]*", "", lists.read_text())
        private = set()
        for words in re.findall(r"PRIVATE_HEADERS((?:\s+\w+\.h)+)", text):
            private |= set(words.split())
        for header in sorted(lists.parent.glob("*.h")):
            if header.name not in private and not header.name.startswith("test_"):
                yield header.relative_to(ROOT)


class Reference:
    """Where Doxygen put headers, folders and the names in them, from its tag file."""

    def __init__(self, tag_file, html_folder):
        self.page, self.names, kinds = {}, {}, {}
        for file in html_folder.glob("dir_*.html"):  # which the tag file leaves out
            name = re.search(r"<title>[^:]*: (\S+) Directory Reference", file.read_text())
            self.page[name.group(1)] = file.name
        for compound in ElementTree.parse(tag_file).getroot():
            kind, name = compound.get("kind"), compound.findtext("name")
            file = compound.findtext("filename")
            if not file.endswith(".html"):
                file += ".html"
            if kind in ("class", "struct"):
                members = {member.findtext("name"): f"{member.findtext('anchorfile')}#{member.findtext('anchor')}"
                           for member in compound.findall("member")}
                kinds[name] = file, members
        for compound in ElementTree.parse(tag_file).getroot():
            kind, name = compound.get("kind"), compound.findtext("name")
            if kind != "file":
                continue
            path = os.path.relpath(compound.findtext("path") + name, ROOT)
            self.page[path] = compound.findtext("filename") + ("" if compound.findtext("filename").endswith(".html") else ".html")
            names = {}
            for one in compound.findall("class"):
                if one.text in kinds:
                    file, members = kinds[one.text]
                    simple = one.text.split("::")[-1]
                    for member, place in members.items():
                        names.setdefault(member, place)
                        names[f"{simple}::{member}"] = place
                    names[simple] = file
            for member in compound.findall("member"):
                names[member.findtext("name")] = f"{member.findtext('anchorfile')}#{member.findtext('anchor')}"
            self.names[path] = names


class Site:
    def __init__(self, reference, out):
        self.reference, self.out = reference, out
        self.pages = {}  # name of a page without ending → its text
        self.shown = []  # files and folders that need a page of their own

    # Where things are

    def page_of(self, path):
        """The page of a document of the repository, or None."""
        name = path.as_posix()
        if name in FIXED:
            return FIXED[name]
        if path.suffix != ".md":
            return None
        if name.startswith("docs/"):
            name = name[len("docs/"):]
        if name == "examples/README.md":
            return "examples/index"
        name = re.sub(r"^(examples/.*)/README\.md$", r"\1.md", name)
        return re.sub(r"README\.md$", "index.md", name)[:-len(".md")]

    def leading_to(self, page, target):
        """A relative path from a page to anything else of the site."""
        return os.path.relpath(target, os.path.dirname(page) or ".")

    def link(self, page, path, anchor, label):
        """`label`, leading from a page to a file or folder of the repository."""
        other = self.page_of(path)
        if other:
            if label.endswith(".md") and (ROOT / path).is_file():  # a page is called by its title, not by its file
                label = re.search(r"^# (.*)$", (ROOT / path).read_text(), re.MULTILINE).group(1)
            return f"[{label}]({self.leading_to(page, other + '.md')}{anchor})"
        if path.as_posix() in self.reference.page:
            return self.outward(page, "api/" + self.reference.page[path.as_posix()], label)
        return self.outward(page, self.page_that_shows(path), label)

    def page_that_shows(self, path):
        """The page, made here and not by Sphinx, of a file or folder that is no document."""
        if path not in self.shown:
            self.shown.append(path)
        return f"source/{path.as_posix()}{'/index' if (ROOT / path).is_dir() else ''}.html"

    def outward(self, page, target, label):
        """To what Sphinx does not know: the API reference."""
        text = re.sub(r"`([^`]*)`", lambda code: f"<code>{html.escape(code.group(1))}</code>", label)
        text = re.sub(r"(?<=[\w>][/_])(?=\w)(?![^<]*>)", "<wbr>", text)  # where a long name may be broken
        return f'<a class="reference api" href="{self.leading_to(page, target)}">{text}</a>'

    # Documents

    def add(self, path, more=""):
        page = self.page_of(path)
        self.pages[page] = self.rewritten((ROOT / path).read_text(), path, page) + more

    def rewritten(self, text, path, page):
        """A document with its links led into the site."""
        out, fence, quoted = [], None, []
        for line in [*text.splitlines(), None]:
            if quoted and (line is None or not line.startswith(">")):
                out.append(formula(quoted))
                quoted = []
            if line is None:
                break
            opened = re.match(r"\s*(```+)", line)
            if opened and fence is None:
                fence = opened.group(1)
            elif opened and line.strip() == fence:
                fence = None
            elif fence is None:
                if path.as_posix().startswith("docs/theory/") and line.startswith("> "):
                    quoted.append(line[2:])
                    continue
                line = self.with_links(line, path, page)
            out.append(line)
        return "\n".join(out) + "\n"

    def with_links(self, line, path, page):
        headers = [resolved.as_posix() for match in LINK.finditer(line) if match.group("target")
                   for resolved in [self.resolved(path, match.group("target").split("#")[0])] if resolved]

        def replaced(match):
            if match.group("code"):
                name = match.group("code").strip("`")
                for header in headers:
                    place = self.reference.names.get(header, {}).get(name)
                    if place:
                        return self.outward(page, f"api/{place}", match.group("code"))
                return breakable(match.group("code")) if line.startswith("|") else match.group("code")
            target, _, anchor = match.group("target").partition("#")
            resolved = self.resolved(path, target)
            if match.group("image") or resolved is None:
                return match.group()
            return self.link(page, resolved, f"#{anchor}" if anchor else "", match.group("label"))

        out, at = [], 0
        for match in LINK.finditer(line):
            out += [with_subscripts(line[at:match.start()]), replaced(match)]
            at = match.end()
        text = "".join([*out, with_subscripts(line[at:])])
        return LINK.sub(replaced, line) if line.startswith("#") else text

    def resolved(self, path, target):
        """The file or folder of the repository that a link means, or None where it leads outside or stays on its page."""
        if not target or re.match(r"[a-z][a-z+.-]*:|//", target):
            return None
        found = ((ROOT / path).parent / target).resolve()
        if not found.exists():
            raise SystemExit(f"{path}: '{target}' leads to nothing")
        return found.relative_to(ROOT)

    # Folders of documents: their README is the index, in whose order the pages stand

    def add_theory(self):
        order = linked_pages((ROOT / "docs/theory/README.md").read_text())
        for name in order:
            self.add(pathlib.Path("docs/theory", f"{name}.md"))
        self.add(pathlib.Path("docs/theory/README.md"), toctree(order))

    def add_guide(self):
        """The guide's pages, which the navigation shows at once under the headings of its README."""
        self.add(pathlib.Path("docs/guide/README.md"))
        groups = re.split(r"^\*\*(.+)\*\*$", (ROOT / "docs/guide/README.md").read_text(), flags=re.MULTILINE)[1:]
        trees = toctree(["guide/index"])
        for caption, links in zip(groups[::2], groups[1::2]):
            order = linked_pages(links)
            for name in order:
                self.add(pathlib.Path("docs/guide", f"{name}.md"))
            trees += toctree([f"guide/{name}" for name in order], caption)
        self.pages["index"] = self.pages["index"].replace("<!-- the guide -->\n", trees)

    def add_examples(self):
        index = (ROOT / "examples/README.md").read_text()
        order = re.findall(r"\]\((\w+)/README\.md\)", index)
        for name in order:
            script = ROOT / "examples" / name / "run.sh"
            more = f"\n## run.sh\n{fenced(script.read_text(), 'bash')}" if script.exists() else ""
            self.add(pathlib.Path("examples", name, "README.md"), more)
        self.add(pathlib.Path("examples/README.md"), toctree(order))

    # Commands

    def add_commands(self, mbk):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([mbk, "manual", "--pages", pathlib.Path(folder, "man")], check=True)
            pages = {file.name[:-2]: file.read_text() for file in pathlib.Path(folder, "man").iterdir()}
        main = "mbk"
        names = sorted(name for name in pages if name != main)
        titles = {name: title_of(text) for name, text in pages.items()}
        rows = "".join(f"| [`{titles[name][0]}`]({name}.md) | {escaped(titles[name][1])} |\n" for name in names)
        for name in names:
            self.pages[f"commands/{name}"] = manual_page(pages[name], titles)
        self.pages["commands/index"] = (
            "# Commands\nWhat `mbk COMMAND --help` and the manual pages say, written by the program itself.\n\n"
            f"| Command | What it does |\n|---|---|\n{rows}\n" + toctree(names))

    # The library

    def add_library(self):
        text = (ROOT / "docs/house.md").read_text()
        holds = dict(re.findall(r"^\| [^|]*\| `(\w+)` \| (.*?) \|$", text, re.MULTILINE))
        rows = []
        lists = re.sub(r"#[^\n]*", "", (ROOT / "mbk/CMakeLists.txt").read_text())
        for wing, words in re.findall(r"^mbk_wing\((\w+)((?:\s+\w+)*)\)", lists, re.MULTILINE):
            for module in [word for word in words.split() if word != "LAYER"] or [wing]:
                place = self.reference.page.get(f"mbk/{wing}" if module == wing else f"mbk/{wing}/{module}")
                if place:
                    where = self.outward("library", f"api/{place}", f"`{module}`")
                    rows.append(f"| {wing} | {where} | {holds.get(module, '')} |")
        self.pages["library"] = (
            "# C++ library\n"
            + self.rewritten(
                "What an application may use: the public headers, with their equations, units, signs and the ways in which "
                "they fail. A module uses only modules of lower layers ([why](docs/decisions.md#modules-layers-and-groups)); how to link them "
                "is in [install.md](docs/guide/install.md), programs to begin with in "
                "[use_the_library](examples/use_the_library/README.md).\n", pathlib.Path("CONTRIBUTING.md"), "library")
            + "\n" + " · ".join(self.outward("library", f"api/{file}", label) for file, label in (
                ("files.html", "by header"), ("annotated.html", "by type"), ("namespaces.html", "by namespace"),
                ("globals_func.html" if (self.out.parent / "html/api/globals_func.html").exists() else "namespacemembers_func.html",
                 "by function"))) + "\n\n| Group | Module | Holds |\n|---|---|---|\n" + "\n".join(rows) + "\n")

    # Files that are linked and are no documents

    def write_shown(self, html_folder):
        formatter = pygments.formatters.HtmlFormatter(linenos="inline", style="default")
        dark = pygments.formatters.HtmlFormatter(style="github-dark")
        (html_folder / "source").mkdir(parents=True, exist_ok=True)
        (html_folder / "source/source.css").write_text(SOURCE_STYLE + formatter.get_style_defs(".highlight"))
        (html_folder / "source/dark.css").write_text(SOURCE_DARK + dark.get_style_defs(".highlight"))
        for path in self.shown:  # grows while folders list what is in them
            name, file = self.page_that_shows(path), ROOT / path
            if file.is_dir():
                inside = sorted(one.relative_to(ROOT) for one in file.rglob("*") if one.is_file())
                body = "<ul>" + "".join(f"<li>{self.from_source(name, one, path)}</li>" for one in inside) + "</ul>"
            else:
                language = LANGUAGES.get(file.suffix, "bash" if path.parts[0] == "tools" else "text")
                body = pygments.highlight(file.read_text(), pygments.lexers.get_lexer_by_name(language), formatter)
            page = html_folder / name
            page.parent.mkdir(parents=True, exist_ok=True)
            page.write_text(SOURCE_PAGE.format(title=html.escape(path.as_posix()), body=body,
                                               style=self.leading_to(name, "source/source.css"),
                                               dark=self.leading_to(name, "source/dark.css"),
                                               home=self.leading_to(name, "index.html")))

    def from_source(self, name, path, folder):
        """A link from the page of a folder to a file in it."""
        document = self.page_of(path)
        target = f"{document}.html" if document in self.pages else self.page_that_shows(path)
        return f'<a href="{self.leading_to(name, target)}">{html.escape(path.relative_to(folder).as_posix())}</a>'

    # All of it

    def write(self):
        kept = set()
        for name, text in self.pages.items():
            file = self.out / f"{name}.md"
            kept.add(file)
            if not file.exists() or file.read_text() != text:  # Sphinx reads again what is newer
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
        for file in self.out.rglob("*.md"):
            if file not in kept:
                file.unlink()
        pictures = self.out / "guide/pictures"
        shutil.copytree(ROOT / "docs/guide/pictures", pictures, dirs_exist_ok=True)


def formula(lines):
    """Formulas as the documents write them, in Unicode, one below the other; what stands behind _ and ^ is moved."""
    text = html.escape("\n".join(lines).replace("**", ""))
    for sign, tag in (("_", "sub"), ("\\^", "sup")):
        text = re.sub(sign + r"(?:\{([^}]*)\}|([A-Za-z0-9α-ω]+))", lambda found: f"<{tag}>{found[1] or found[2]}</{tag}>", text)
    return f'\n<div class="formula">{text}</div>\n'


def with_subscripts(text):
    """F_h as text has it, with its subscript lowered."""
    return SUBSCRIPT.sub(r"\1<sub>\2</sub>", text)


def breakable(code):
    """The long name of a test, which a narrow column may break before a word."""
    name = code.strip("`")
    if len(name) < 20 or not re.fullmatch(r"[\w/.:]+", name):
        return code
    text = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[/.])", "<wbr>", html.escape(name))
    return f'<code class="docutils literal">{text}</code>'


def linked_pages(text):
    """Names of the pages of the same folder, in the order of a README."""
    return list(dict.fromkeys(re.findall(r"\]\(([\w-]+)\.md\)", text)))


def toctree(names, caption=""):
    caption = f":caption: {caption}\n" if caption else ""
    return f"\n```{{toctree}}\n:hidden:\n{caption}\n" + "\n".join(names) + "\n```\n"


def fenced(text, language):
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{fence}{language}\n{text.rstrip()}\n{fence}\n"


def escaped(text):
    return re.sub(r"([\\`*_{}\[\]<>|$#~])", r"\\\1", text)


SOURCE_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - mbk</title><link rel="stylesheet" href="{style}">
<link id="dark" rel="stylesheet" media="screen and (prefers-color-scheme: dark)" href="{dark}">
<script>
const theme = localStorage.getItem("theme"); // the choice made with the button of the other pages
if (theme === "dark" || theme === "light") document.getElementById("dark").media = theme === "dark" ? "screen" : "not all";
</script></head>
<body><nav><a href="{home}">mbk</a></nav>
<main><h1>{title}</h1>
{body}</main></body></html>
"""
SOURCE_STYLE = """body { margin: 1.5rem auto; max-width: 76rem; padding: 0 1rem; font-family: system-ui, "DejaVu Sans", sans-serif; }
pre { font: 13.5px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; overflow-x: auto; }
a { color: #0f5c8c; }
h1 { font-size: 1rem; overflow-wrap: anywhere; }
.highlight .linenos { color: inherit; padding-right: 1rem; user-select: none; }
"""
SOURCE_DARK = """:root { color-scheme: dark; background: #131416; color: #d0d0d0; }
a { color: #7cc4ee; }
"""


# Manual pages: the few requests that the program writes

ROFF = {r"\-": "-", r"\(aq": "'", r"\(ti": "~", r"\(ha": "^", r"\(ga": "`", r"\e": "\\", r"\&": "", r"\ ": " ", r"\(dq": '"'}
ESCAPE = re.compile(r"\\(?:\(..|f.|.)")


def plain(roff):
    """Without fonts."""
    return ESCAPE.sub(lambda one: "" if one.group().startswith(r"\f") else ROFF[one.group()], roff)


def marked(roff):
    """Bold as code, italics as emphasis."""
    out, font, run = [], "R", []

    def close():
        text = "".join(run)
        run.clear()
        if text:
            out.append(f"`{text}`" if font == "B" else f"*{escaped(text)}*" if font == "I" and text.strip() else escaped(text))

    at = 0
    for match in ESCAPE.finditer(roff):
        run.append(roff[at:match.start()])
        at = match.end()
        if match.group().startswith(r"\f"):
            close()
            font = match.group()[2]
        else:
            run.append(ROFF[match.group()])
    run.append(roff[at:])
    close()
    return "".join(out)


def title_of(text):
    """mbk-robot-force as one types it, and its one line."""
    name = plain(re.search(r"^\.SH NAME\n(.*)$", text, re.MULTILINE).group(1))
    command, _, line = name.partition(" - ")
    synopsis = plain(re.search(r"^\.SH SYNOPSIS\n(.*)$", text, re.MULTILINE).group(1))
    words = command.replace("-", " ")
    return (words if synopsis.startswith(words) else command), line


def manual_page(text, titles):
    (command, line), out = title_of(text), []
    section, waiting, in_code, described = None, None, False, False
    out.append(f"# {command}\n{escaped(line[:1].upper() + line[1:])}.\n")
    for request in text.splitlines():
        if request.startswith(".TH") or request.startswith('.\\"'):
            continue
        if request.startswith(".SH"):
            section, described = request[4:].strip().strip('"'), False
            if section not in ("NAME", "DESCRIPTION"):
                out.append(f"\n## {section.capitalize()}\n")
        elif request.startswith(".SS"):
            out.append(f"\n### {escaped(plain(request[4:].strip()))}\n")
        elif request == ".TP":
            waiting, described = "term", False
        elif request == ".EX":
            in_code = True
            out.append("\n```text")
        elif request == ".EE":
            in_code = False
            out.append("```\n")
        elif request in (".PP", ".RE") or request.startswith(".RS"):
            out.append("")
        elif request.startswith(".") and not in_code:
            raise SystemExit(f"the manual page of {command} has a request that is not known here: {request}")
        elif section == "NAME" or section == "DESCRIPTION" and plain(request).rstrip(".").lower() == line.lower():
            continue
        elif in_code:
            out.append(plain(request))
        elif section == "SYNOPSIS":
            out.append(f"```text\n{plain(request)}\n```\n")
        elif section == "SEE ALSO":
            def leading(match, titles=titles):
                name = plain(match.group(1))
                return f"[`{titles[name][0]}`]({'index' if name == 'mbk' else name}.md)" if name in titles else match.group()
            out.append(re.sub(r"\\fB(.*?)\\fR\(1\)", leading, request))
        elif waiting == "term":
            out.append(f"\n{marked(request)}")
            waiting = "description"
        elif waiting == "description":
            out.append(f"{': ' if not described else '  '}{marked(request)}{'  ' if described else ''}")
            described = True
        else:
            out.append(marked(request))
    return "\n".join(out) + "\n"


def main():
    if sys.argv[1:2] == ["headers"] and len(sys.argv) == 3:
        pathlib.Path(sys.argv[2]).write_text("".join(f"INPUT += {header}\n" for header in public_headers()))
        return
    if sys.argv[1:2] != ["pages"] or len(sys.argv) != 5:
        sys.exit(__doc__)
    mbk, tag_file, out = sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])
    site = Site(Reference(tag_file, out.parent / "html/api"), out)
    landing = ROOT / "docs/site/index.md"
    site.pages["index"] = site.rewritten(landing.read_text(), pathlib.Path("docs/theory/landing.md"), "index")
    site.add_guide()
    site.add_theory()
    for name in ("docs/house.md", "docs/decisions.md"):
        site.add(pathlib.Path(name))
    site.add_examples()
    site.add_commands(mbk)
    build = pathlib.Path(mbk).resolve().parents[1]
    site.pages.update(python_pages.pages(build / "python/mbk"))
    site.pages.update(document_pages.pages(build / "schemas"))
    site.add_library()
    for name in ("CHANGELOG.md", "CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "SECURITY.md", "THIRD_PARTY_NOTICES.md", "bench/README.md", "fuzz/README.md",
                 "bridge/README.md"):
        site.add(pathlib.Path(name))
    site.write()
    site.write_shown(out.parent / "html")


if __name__ == "__main__":
    main()
