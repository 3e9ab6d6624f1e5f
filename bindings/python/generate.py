#!/usr/bin/env python3
"""Writes the functions of the Python package from the option table of the command line: `mbk manual --json`.

usage: generate.py COMMANDS.json FOLDER

Writes to FOLDER, which contains the module _mbk and its library: _functions.py (measure, identify, …) and a module for each command
with subcommands: robot.py, springs.py, sensor.py, study.py. Names, fixed values, help and needs of options are those of
--help; texts name options and commands as in Python. Options that only a command line needs (--json, --out for text,
--quiet, --help) have another form in Python.
"""

import json
import keyword
import pathlib
import re
import sys
import textwrap

WIDTH = 100
ONLY_COMMAND_LINE = {"--help", "--help-all", "--version", "--json", "--quiet"}
NAMES = {"tf": "transfer_function", "import": "import_"}
RESULTS = {  # class of a command's result; Document if it has no class of its own
    ("measure",): "Results | Result", ("identify",): "Results | Result", ("passivity",): "Passivity",
    ("explore",): "Exploration", ("tf",): "TransferFunction", ("teleop",): "Teleoperation", ("compare",): "Comparison",
    ("ellipse",): "Ellipses", ("validate",): "Validation", ("info",): "Information", ("movement",): "Movement",
    ("springs", "field"): "Springs", ("springs", "find"): "Springs", ("springs", "calibrate"): "Springs",
    ("robot", "identify"): "RobotDynamics", ("robot", "force"): "VirtualForce",
    ("study", "list"): "StudyList", ("study", "export"): "Document | str",
    ("study", "summary"): "StudySummary",
}
NUMBERS = {"HZ": "float", "S": "float", "KG": "float", "MM": "float", "MS": "float", "DEG": "float", "V": "float",
           "X": "float", "FLOAT": "float", "N": "int", "W": "int"}
SPECIAL = {  # function that calls it, type and description of its result
    ("convert",): ("convert", "Path", "Path of the file written."),
    ("simulate",): ("simulate", "Recording | list[Recording] | Path | str",
                    "A recording, or a list for several trials or seeds. With `out`, the path of the file written. With `list`, "
                    "`facts` or `show`, the text that the command prints."),
    ("read",): ("read", "Recording | list[Recording]", "A recording, or a list if there are several."),
}


def python_name(option):
    name = option.removeprefix("--").replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def type_of(option):
    """Type annotation of an option."""
    if not option["value"]:
        return "bool"
    kinds = []
    words = [word for word in option["words"] if word in option["value"].split("|")]
    parts = [part for part in option["value"].split("|") if part not in words]
    if words:
        kinds.append("Literal[" + ", ".join(json.dumps(word) for word in words) + "]")
    for part in parts:
        if part == "MAP":
            kinds.append("Mapping[str, object] | str")
        elif part in NUMBERS:
            kinds.append(NUMBERS[part])
        elif option["files"] or option["folders"]:
            kinds.append("str | PathLike[str]" + (" | Document | Recording" if is_read(option) else ""))
        elif re.search(r"[,:\[]", part):
            kinds.append("str" if option["repeats"] else "str | Sequence[float]")
        else:
            kinds.append("str")
    kinds = list(dict.fromkeys(kind for one in kinds for kind in one.split(" | ")))
    one = " | ".join(kinds)
    return f"{one} | Sequence[{one}]" if option["repeats"] else one


def is_read(option):
    """Whether the option names a file to read, which an object in memory may replace."""
    return option["value"] in ("FILE", "FILE.json", "RESULT.json") and option["names"][-1] not in ("--out", "--report", "--summary")


def is_for_text(option):
    """Whether the option redirects the text of standard output to a file."""
    return option["names"][-1] == "--out" and "instead of standard output" in option["description"]


def separator_of(option):
    """Separator between numbers of one value; empty if the option is repeated for each value."""
    if option["repeats"]:
        return ""
    return ":" if ":" in option["value"] and "," not in option["value"] and option["value"] != "MAP" else ","


def sentence(text, literals=()):
    """The text with a capital and a full stop; a literal value or a unit at its beginning stays as it is typed."""
    text = re.sub(r"\s+", " ", text).strip()
    made = _mbk.in_python(text)
    first = re.split(r"[\s,:;]", text)[0]
    if text[:1].isalpha() and first not in literals and "/" not in first:
        made = made[:1].upper() + made[1:]
    return made + ("" if made.endswith(".") else ".")


def quoted(text):
    return text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')


def paragraph(text, indent):
    return textwrap.indent("\n".join(textwrap.wrap(text, WIDTH - indent, break_long_words=False,
                                                   break_on_hyphens=False)), " " * indent)


class Command:
    """One function: its name, its module, its parameters."""

    def __init__(self, json_command):
        self.path = json_command["path"]
        self.module = self.path[0] if len(self.path) > 1 else "_functions"
        self.name = NAMES.get(self.path[-1], self.path[-1].replace("-", "_"))
        self.summary = json_command["summary"]
        self.footer = json_command["footer"]
        names = [option["names"][-1] for option in json_command["options"]]
        self.json = "--json" in names
        self.all_options = json_command["options"]
        self.options = [option for option in self.all_options if self.is_kept(option)]
        self.arguments = json_command["arguments"]

    def is_kept(self, option):
        name = option["names"][-1]
        if name in ONLY_COMMAND_LINE:
            return False
        if not self.json:
            return True
        # Document.save writes the document; --overwrite then applies to other files.
        if name == "--out":
            return not is_for_text(option)
        others = [one for one in self.all_options if one["names"][-1] in ("--report", "--summary", "--charts", "--out")]
        return name != "--overwrite" or not all(map(is_for_text, others))

    @property
    def result(self):
        if tuple(self.path) in SPECIAL:
            return SPECIAL[tuple(self.path)][1]
        if tuple(self.path) in RESULTS:
            return RESULTS[tuple(self.path)]
        return "Document" if self.json else "str"

    def positional(self):
        """Positional parameters: (name, type, description)."""
        rows = []
        for argument in self.arguments:
            placeholder = re.split(r"[.( ]", argument["value"])[0]
            if argument["repeats"] and placeholder == "FILE":
                rows.append(("*sources", "Source", argument["description"]))
            elif argument["repeats"]:
                rows.append((f"*{placeholder.lower()}", "str", argument["description"]))
            else:
                kind = "Source" if placeholder == "FILE" else "int | str" if placeholder == "N" else \
                    "str | PathLike[str]" if argument["files"] or argument["folders"] else "str"
                default = "" if argument["required"] else " | None = None"
                rows.append((placeholder.lower(), kind + default, argument["description"]))
        return rows

    def signature(self):
        positional = [f"{name}: {kind}" for name, kind, _ in self.positional()]
        if self.options and not any(one.startswith("*") for one in positional):
            positional.append("*")
        options = [f"{python_name(option['names'][-1])}: "
                   + ("bool = False" if not option["value"] else f"{type_of(option)} | None = None")
                   for option in self.options]
        lines = "".join(f"    {one},\n" for one in positional + options)
        return f"def {self.name}(\n{lines}) -> {self.result}:\n" if lines else f"def {self.name}() -> {self.result}:\n"

    def docstring(self):
        out = [f'    """{sentence(quoted(self.summary))}', ""]
        if self.positional() or self.options:
            out += ["    Parameters", "    ----------"]
        for name, kind, description in self.positional():
            out.append(f"    {quoted(name).replace('*', chr(92) * 2 + '*')} : {kind.replace(' = None', '').replace(' | None', ', optional')}")
            out.append(paragraph(quoted(sentence(description)), 8))
            if kind.startswith("Source"):
                out.append(paragraph("File names, or recordings in memory: `Recording`, a mapping of arrays, a pandas DataFrame, "
                                     "an xarray Dataset.", 8))
        for option in self.options:
            kind = type_of(option)
            more = "default: False" if not option["value"] else "optional"
            out.append(f"    {python_name(option['names'][-1])} : {kind}, {more}")
            text = sentence(option["description"], option["words"])
            if option["needs"]:
                text += " Needs " + ", ".join(f"`{self.parameter(one)}`" for one in option["needs"]) + "."
            if option["excludes"]:
                text += " Not with " + ", ".join(f"`{self.parameter(one)}`" for one in option["excludes"]) + "."
            unit = {"HZ": "Hz", "S": "s", "KG": "kg", "MM": "mm", "MS": "ms", "DEG": "°"}.get(option["value"].split("|")[0])
            if unit:
                text += f" [{unit}]"
            out.append(paragraph(quoted(text), 8))
        out += ["", "    Returns", "    -------", f"    {self.result}"]
        if tuple(self.path) in SPECIAL:
            out.append(paragraph(SPECIAL[tuple(self.path)][2], 8))
        elif self.json:
            out.append(paragraph("`.to_dict()` returns the JSON document.", 8))
        else:
            out.append(paragraph("The text that the command prints.", 8))
        out += ["", "    Raises", "    ------", "    UsageError", "        An option or argument is wrong.",
                "    DataError", "        A file or recording cannot be read or used."]
        footer = self.footer.strip()
        if footer:
            out += ["", "    Notes", "    -----", "    On the command line::", ""]
            out += [textwrap.indent(quoted(line.rstrip()), " " * 8) if line.strip() else "" for line in footer.splitlines()]
        out.append('    """')
        return "\n".join(line.rstrip() for line in out) + "\n"

    def parameter(self, option):
        """Name in Python of an option "--name" or of the placeholder of an argument."""
        return python_name(option) if option.startswith("--") else re.split(r"[.( ]", option)[0].lower()

    def body(self):
        sources = ", ".join(f"str({name})" if kind == "int | str" else name for name, kind, _ in self.positional())
        options = "".join(f"            {json.dumps(option['names'][-1][2:])}: {python_name(option['names'][-1])},\n"
                          for option in self.options)
        options = f"{{\n{options}        }}" if options else "{}"
        several = {option["names"][-1][2:]: separator_of(option) for option in self.options}
        several = {name: separator for name, separator in several.items() if separator != ","}
        call = SPECIAL.get(tuple(self.path), ("run",))[0]
        return (f"    return _calling.{call}(  # type: ignore[no-any-return]\n        {json.dumps(' '.join(self.path))},\n"
                f"        [{sources}],\n        {options},\n        {json.dumps(several)},\n    )\n")

    def text(self):
        return self.signature() + self.docstring() + self.body()


HEADER = '''"""{title}

Generated from the option table of the command line; see `mbk {command} --help`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Literal

from mbk import _calling
from mbk._calling import Source
from mbk._documents import {classes}
from mbk._recording import Recording

__all__ = {names}

'''


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    table = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    folder = pathlib.Path(sys.argv[2])
    sys.path.insert(0, str(folder))
    global _mbk
    import _mbk
    groups = {one["path"][0]: one["summary"] for one in table["commands"]}
    modules = {}
    info = next(one for one in table["commands"] if one["path"] == ["info"])
    reading = {**info, "path": ["read"], "summary": "read recordings into memory", "footer": ""}
    for one in [reading, *table["commands"]]:
        if not one["callable"]:
            continue
        command = Command(one)
        modules.setdefault(command.module, []).append(command)
    for module, commands in modules.items():
        classes = sorted({part for command in commands for part in command.result.split(" | ")} - {"str", "Path", "Recording", "list[Recording]"})
        text = HEADER.format(
            title="The commands of mbk as functions." if module == "_functions" else sentence(groups[module]),
            command="" if module == "_functions" else module, classes=", ".join(sorted({*classes, "Document"})),
            names=[command.name for command in commands])
        text = text.replace("mbk  --help", "mbk --help")
        text += "\n\n".join(command.text() for command in commands)
        target = folder / f"{module}.py"
        target.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
