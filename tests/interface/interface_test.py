#!/usr/bin/env python3
"""The interface of mbk is the recorded one: nothing is missing, nothing has changed, and what is new is recorded.

usage: interface_test.py            compares recorded.txt with the build
       interface_test.py --update   writes recorded.txt anew

The environment names the program (MBK) and the folder of the build (BUILD); default: build/release. Each line of
recorded.txt is "KIND NAME: ITEM ITEM …". What the build lacks (the Python package, libmbk.so) is not compared, and
--update keeps its lines. docs/guide/stability.md says what is promised.
"""

import importlib
import inspect
import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORDED = pathlib.Path(__file__).with_name("recorded.txt")
BUILD = pathlib.Path(os.environ.get("BUILD", ROOT / "build/release"))
MBK = os.environ.get("MBK", BUILD / "bin/mbk")
HEADERS = ["bindings/c/mbk.h", "mbk/experiment/drivers/device_plugin.h"]
#: Documents of pages, of the console, and of a program for tests, which are not promised.
NOT_PROMISED = re.compile(r"^(Data|Content) of the page|console of `mbk run`|`mbk_misbehaving_robot`")

HOW_TO_WITHDRAW = """
This breaks scripts and programs of users. If it happened by accident, restore it. To withdraw or rename something,
announce it in CHANGELOG.md, keep the old name working for two minor versions with a warning that names the new one,
and only then remove it (docs/guide/stability.md). A JSON field is renamed with a new number of its schema. To record
such a step: python3 tests/interface/interface_test.py --update"""
HOW_TO_RECORD = """
If mbk should have the new names for years, record them: python3 tests/interface/interface_test.py --update"""


def output_of(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout


# Commands and options

def items_of(one):
    """What is fixed about an option or argument: flag or value, the words that it takes."""
    words = [word for word in one["words"] if word in one["value"].split("|")]
    items = words if len(words) == len(one["value"].split("|")) else [*words, "value"] if one["value"] else ["flag"]
    return [*items, *(word for word in ("required", "repeats") if one[word])]


def commands():
    for names in re.findall(r"^  (-[-\w,]+)", output_of(MBK, "--help"), re.M):
        yield f"option mbk {names.split(',')[-1]}", ["flag"]
    for command in json.loads(output_of(MBK, "manual", "--json"))["commands"]:
        path = " ".join(command["path"])
        yield f"command {path}", ["callable"] if command["callable"] else []
        for number, argument in enumerate(command["arguments"], start=1):
            yield f"argument {path} {number}", items_of(argument)
        for option in command["options"]:
            if "--help" not in option["names"]:
                yield f"option {path} {option['names'][-1]}", [*items_of(option), *option["names"][:-1]]


# JSON documents

def underlined(word):
    return str(word).replace(" ", "_")


def type_of(schema):
    """A schema as one word: "number|null", "[Value]", "Ellipse", "{a:number,b?:string}"."""
    if "$ref" in schema:
        return schema["$ref"].rsplit("/", 1)[-1]
    for either in ("anyOf", "oneOf"):
        if either in schema:
            return "|".join(map(type_of, schema[either]))
    if "enum" in schema:
        return "word"
    kind = schema.get("type", "any")
    if kind == "array":
        return f"[{type_of(schema.get('items', {}))}]"
    if kind == "object":
        inside = [f"{name}:{word}" for name, word in fields_of(schema)]
        if isinstance(schema.get("additionalProperties"), dict):
            inside.append(f"*:{type_of(schema['additionalProperties'])}")
        return "{" + ",".join(inside) + "}"
    return "|".join(kind) if isinstance(kind, list) else kind


def fields_of(schema):
    for name, value in sorted(schema.get("properties", {}).items()):
        yield underlined(name) + ("" if name in schema.get("required", []) else "?"), type_of(value)


def type_items(schema):
    """The fields of a type, each as "name:type", and each fixed word as "name=word"."""
    if "properties" not in schema:
        return [f"={underlined(word)}" for word in schema["enum"]] if "enum" in schema else [type_of(schema)]
    items = [f"{name}:{word}" for name, word in fields_of(schema)]
    if isinstance(schema.get("additionalProperties"), dict):
        items.append(f"*:{type_of(schema['additionalProperties'])}")
    for name, value in sorted(schema["properties"].items()):
        items += [f"{underlined(name)}={underlined(word)}" for word in value.get("enum", [])]
    return items


def documents():
    files = sorted((BUILD / "schemas").glob("*.schema.json"))
    if not files:
        raise FileNotFoundError(f"there are no schemas in {BUILD / 'schemas'}")
    for file in files:
        schema = json.loads(file.read_text(encoding="utf-8"))
        if NOT_PROMISED.search(schema.get("description", "")):
            continue
        yield f"json {file.name.split('.')[0]}", type_items(schema)
        for name, definition in schema["definitions"].items():
            yield f"json {name}", type_items(definition)


# C

def declarations():
    for header in HEADERS:
        text = (ROOT / header).read_text(encoding="utf-8")
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        for name in re.findall(r"^#define (MBK_\w*VERSION) \w+$", text, re.M):
            yield f"c {name}", ["grows"]  # with each addition
        text = re.sub(r"\s+", " ", re.sub(r"^#.*$", "", text, flags=re.M))
        for body in re.findall(r"enum \w*\s*\{(.*?)\}", text):
            for name, value in re.findall(r"(MBK_\w+) = (\w+)", body):
                yield f"c {name}", [value]
        for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\} \w+;", text):
            for member in filter(None, map(str.strip, body.split(";"))):
                field = re.search(r"\(\*(\w+)\)|(\w+)(?:\[\d+\])?$", member)
                yield f"c {name}.{field[1] or field[2]}", [member]
        for function in re.findall(r"MBK_API ([^;{}]*\));", text):
            yield f"c {re.search(r'(mbk_[a-z_]+)[(]', function)[1]}", [function]


def exported_symbols():
    lines = output_of("nm", "-D", "--defined-only", BUILD / "lib/libmbk.so").splitlines()
    return {line.split()[-1].split("@")[0] for line in lines if line.split()[-2] == "T"}


# Python

def members_of(kind):
    """Public attributes that classes of mbk define."""
    return sorted({name for one in kind.__mro__ if one.__module__.split(".")[0] == "mbk" for name in vars(one)
                   if not name.startswith("_")})


def python_names():
    sys.path.insert(0, str(BUILD / "python"))
    package = importlib.import_module("mbk")
    for name in sorted(package.__all__):
        yield from python_object(f"mbk.{name}", getattr(package, name))


def python_object(name, value):
    if inspect.ismodule(value):
        for inside in sorted(value.__all__):
            yield from python_object(f"{name}.{inside}", getattr(value, inside))
    elif inspect.isclass(value):
        yield f"python {name}", ["class", *members_of(value)]
    else:
        yield f"python {name}", ["function", *(str(one).split(":")[0].split("=")[0].strip()
                                               for one in inspect.signature(value).parameters.values())]


# MATLAB and Octave

def matlab_names():
    for file in sorted((ROOT / "bindings/matlab/+mbk").glob("*.m")):
        yield f"matlab mbk.{file.stem}", ["function"]


#: Each kind of line, what makes it, and whether the build has it.
KINDS = {
    ("argument", "command", "option"): (commands, lambda: pathlib.Path(MBK).is_file()),
    ("json",): (documents, lambda: (BUILD / "schemas").is_dir()),
    ("c",): (declarations, lambda: True),
    ("python",): (python_names, lambda: (BUILD / "python/mbk/__init__.py").is_file()),
    ("matlab",): (matlab_names, lambda: True),
}


def built(kinds):
    """Name and items of each line that the build gives; nothing if it lacks this part."""
    make, there = KINDS[kinds]
    return dict(make()) if there() else None


def recorded():
    lines = {}
    for line in RECORDED.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            name, _, items = line.removesuffix(":").partition(": ")
            lines[name] = [items] if name.startswith("c ") else items.split()
    return lines


def differences(before, now):
    """(missing, added): each name, or name and item, that only one of both has."""
    def flat(lines):
        return {name for name in lines} | {f"{name}: {item}" for name, items in lines.items() for item in items}
    only_before, only_now = flat(before) - flat(now), flat(now) - flat(before)

    def short(names):  # a whole line is named once
        return sorted(name for name in names if ": " not in name or name.split(": ")[0] not in names)
    return short(only_before), short(only_now)


def of_kinds(lines, kinds):
    return {name: items for name, items in lines.items() if name.split()[0] in kinds}


def update():
    lines = recorded() if RECORDED.exists() else {}
    for kinds in KINDS:
        now = built(kinds)
        if now is None:
            print(f"{'/'.join(kinds)}: not in this build, kept as recorded", file=sys.stderr)
            continue
        missing, added = differences(of_kinds(lines, kinds), now)
        for sign, names in (("-", missing), ("+", added)):
            print(*(f"{sign} {name}" for name in names), sep="\n", end="\n" if names else "")
        lines = {name: items for name, items in lines.items() if name.split()[0] not in kinds} | now
    text = "# The interface of mbk, written by: python3 tests/interface/interface_test.py --update\n"
    text += "".join(sorted(f"{name}: {' '.join(items)}".rstrip() + "\n" for name, items in lines.items()))
    RECORDED.write_text(text, encoding="utf-8")


class Interface(unittest.TestCase):
    def compare(self, *kinds):
        now = built(kinds)
        if now is None:
            self.skipTest("not in this build")
        self.assertGreater(len(now), 10)
        missing, added = differences(of_kinds(recorded(), kinds), now)
        if missing:
            self.fail("missing or changed:\n  " + "\n  ".join(missing)
                      + ("\nnew:\n  " + "\n  ".join(added) if added else "") + HOW_TO_WITHDRAW)
        if added:
            self.fail("new:\n  " + "\n  ".join(added) + HOW_TO_RECORD)

    def test_commands_and_options(self):
        self.compare("argument", "command", "option")

    def test_fields_of_json_documents(self):
        self.compare("json")

    def test_declarations_in_c(self):
        self.compare("c")

    @unittest.skipUnless((BUILD / "lib/libmbk.so").exists(), "libmbk.so is not in this build")
    def test_the_library_exports_the_recorded_functions(self):
        functions = {name.split()[1] for name in recorded() if re.match(r"c mbk_[a-z_]+$", name)}
        self.assertGreater(len(functions), 20)
        self.assertEqual(exported_symbols(), functions, HOW_TO_WITHDRAW)

    def test_names_in_python(self):
        self.compare("python")

    def test_functions_in_matlab(self):
        self.compare("matlab")

    def test_the_list_is_sorted_and_complete(self):
        lines = [line for line in RECORDED.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        self.assertEqual(lines, sorted(lines))
        self.assertEqual({line.split()[0] for line in lines}, {kind for kinds in KINDS for kind in kinds})

    def test_the_check_can_fail(self):
        before = {"option measure --cutoff": ["value"], "json Fit": ["VAF:[Value]", "held?:word"]}
        self.assertEqual(differences(before, before), ([], []))
        self.assertEqual(differences(before, {"json Fit": ["VAF:Value", "held?:word"]}),
                         (["json Fit: VAF:[Value]", "option measure --cutoff"], ["json Fit: VAF:Value"]))
        self.assertEqual(differences(before, {**before, "json Fit": [*before["json Fit"], "RMSE:[Value]"]}),
                         ([], ["json Fit: RMSE:[Value]"]))


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        update()
    else:
        unittest.main()
