#!/usr/bin/env python3
"""Headers get what they name of the standard library from what they include.   usage: headers.py [ROOT]

Precompiled headers and batches of sources hide from the compiler what a header lacks; whoever uses the installed library
finds it. Each line that it prints says where, what and how to mend it; exit 1 where there is one.
"""

import functools
import pathlib
import re
import sys

HEADERS = {  # each with the names in std:: that it alone is sure to bring
    "array": "array to_array",
    "atomic": "atomic",
    "chrono": "chrono",
    "complex": "complex",
    "condition_variable": "condition_variable",
    "deque": "deque",
    "filesystem": "filesystem",
    "functional": "function",
    "list": "list",
    "map": "map multimap",
    "memory": "make_shared make_unique shared_ptr unique_ptr weak_ptr",
    "mutex": "lock_guard mutex once_flag scoped_lock unique_lock",
    "numbers": "numbers",
    "optional": "nullopt optional",
    "random": "mt19937 mt19937_64",
    "set": "set",
    "span": "span",
    "stop_token": "stop_source stop_token",
    "string": "string to_string",
    "string_view": "string_view",
    "thread": "jthread thread",
    "unordered_map": "unordered_map",
    "unordered_set": "unordered_set",
    "variant": "holds_alternative monostate variant visit",
    "vector": "vector",
}
NEEDED = {name: header for header, names in HEADERS.items() for name in names.split()}
NAME = re.compile(r"\bstd::(\w+)")
INCLUDE = re.compile(r'^#include ([<"])([^>"]+)[>"]', re.MULTILINE)
NO_CODE = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"')


class Tree:
    def __init__(self, root):
        self.root = pathlib.Path(root)

    @functools.cache
    def brought(self, name):
        """The standard headers that a header of ours includes, itself or through another of ours."""
        found = set()
        path = self.root / name
        for mark, other in INCLUDE.findall(path.read_text(encoding="utf-8")) if path.exists() else ():
            found |= {other} if mark == "<" else self.brought(other)
        return found

    @functools.cache
    def included(self, name):
        """The headers of ours that a file includes itself, in order."""
        text = (self.root / name).read_text(encoding="utf-8")
        return [other for mark, other in INCLUDE.findall(text) if mark == '"' and (self.root / other).exists()]

    @functools.cache
    def reached(self, name):
        """A file and the headers of ours that it includes, itself or through another."""
        return frozenset({name}.union(*map(self.reached, self.included(name))))

    def compiled_by_themselves(self, batches):
        """The headers before which, in one of the batches of sources that are compiled together, stand none of ours but
        those that they include themselves."""
        found = set()

        def read(name, before):
            for header in self.included(name):
                if header not in before:
                    if before <= self.reached(header):
                        found.add(header)
                    before = read(header, before) | {header}
            return before

        for batch in batches:
            before = frozenset()
            for source in batch:
                before = read(source, before)
        return found

    def missing(self, name):
        """What a header names and does not get: header of it → (line, name)."""
        found = {}
        for number, line in enumerate((self.root / name).read_text(encoding="utf-8").split("\n"), 1):
            for used in () if line.startswith("#") else NAME.findall(NO_CODE.sub("", line)):
                if used in NEEDED and NEEDED[used] not in self.brought(name):
                    found.setdefault(NEEDED[used], (number, used))
        return found

    def check(self):
        for path in sorted((self.root / "mbk").rglob("*.h")):
            name = str(path.relative_to(self.root))
            for header, (line, used) in self.missing(name).items():
                yield f"{name}:{line}: names std::{used}; add #include <{header}>"


if __name__ == "__main__":
    said = list(Tree(sys.argv[1] if len(sys.argv) > 1 else ".").check())
    print("\n".join(said) or "headers include what they name")
    sys.exit(1 if said else 0)
