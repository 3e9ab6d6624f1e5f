#!/usr/bin/env python3
"""Modules use only what they declare, and only lower layers.   usage: layering.py [ROOT]

Reads wings and layers from mbk/CMakeLists.txt (mbk_wing), what each module declares from its CMakeLists.txt
(mbk_module ... DEPENDS) and every #include in the tree, and holds the map in docs/house.md to the folders. Each line that it prints says where, what and how to mend it;
exit 1 where there is one.
"""

import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
KEYWORDS = {"DEPENDS", "SOURCES", "PRIVATE_HEADERS", "LIBRARIES", "PUBLIC_LIBRARIES", "TEST_LIBRARIES"}
MOST_WINGS = 11
FOLDERS = ("mbk", "apps", "bindings", "tests", "bench", "fuzz", "examples")


def calls(path, function):
    """Each call of a CMake function in a file, as a list of (line number, argument)."""
    text = re.sub(r"#[^\n]*", "", path.read_text())
    for match in re.finditer(rf"^\s*{function}\s*\(([^)]*)\)", text, re.MULTILINE):
        first_line = text.count("\n", 0, match.start(1)) + 1
        yield [(first_line + offset, word)
               for offset, line in enumerate(match.group(1).split("\n")) for word in line.split()]


class Tree:
    def __init__(self, root):
        self.root = pathlib.Path(root).resolve()
        self.problems = []
        self.layer = {}  # module → number of its layer, counted through all wings
        self.folder = {}  # module → where it stands
        self.declared = {}  # module → {module that it declares: line}
        self.used = {}  # module → modules whose headers it includes

    def report(self, path, line, problem):
        self.problems.append(f"{path.relative_to(self.root)}:{line}: {problem}")

    def check(self):
        self.read_wings()
        for folder in self.module_folders():
            self.read_module(folder)
        for module in self.declared:
            self.check_declarations(module)
        for top in FOLDERS:
            for path in sorted((self.root / top).rglob("*")):
                if path.suffix in (".h", ".cpp"):
                    self.check_includes(path)
        for module, declared in self.declared.items():
            for other, line in declared.items():
                if other not in self.used[module]:
                    self.report(self.lists(module), line,
                                f"'{module}' declares '{other}' but includes none of its headers; "
                                f"take '{other}' out of DEPENDS")
        self.check_names()
        self.check_map()
        return self.problems

    def check_map(self):
        """docs/house.md has one row for each module."""
        path = self.root / "docs/house.md"
        rows = [(number, match[1]) for number, line in enumerate(path.read_text().splitlines(), start=1)
                if (match := re.match(r"\| [^|]*\| `(\w+)` \|", line))]
        shown = [module for _, module in rows]
        for number, module in rows:
            if module not in self.declared:
                self.report(path, number, f"there is no module '{module}'; take its row out")
            elif shown.count(module) > 1:
                self.report(path, number, f"'{module}' has {shown.count(module)} rows; keep one")
        for module in sorted(self.declared.keys() - set(shown)):
            self.report(path, 1, f"'{module}' has no row in the map of modules; say what it holds")

    def module_folders(self):
        """Every folder of a wing that has something in it, and each wing that is a module itself."""
        for wing in sorted(path for path in (self.root / "mbk").iterdir() if path.is_dir()):
            if self.folder.get(wing.name) == wing:
                yield wing
            else:
                yield from sorted(path for path in wing.iterdir() if path.is_dir() and any(path.iterdir()))

    def check_names(self):
        """A header's name says which it is."""
        first = {}
        for path in sorted((self.root / "mbk").rglob("*.h")):
            if path.name in first:
                self.report(path, 1, f"{first[path.name].relative_to(self.root)} has the same name; "
                                     "let each name say what is different")
            first.setdefault(path.name, path)

    def lists(self, module):
        return self.folder[module] / "CMakeLists.txt"

    def read_wings(self):
        path = self.root / "mbk" / "CMakeLists.txt"
        number, wings = 0, 0
        for (line, wing), *words in calls(path, "mbk_wing"):
            number, wings = number + 1, wings + 1
            if wings > MOST_WINGS:
                self.report(path, line, f"'{wing}' is wing {wings} of at most {MOST_WINGS}; "
                                        "let it be a module of another")
            layers = [(line, word, self.root / "mbk" / wing / word) for line, word in words]
            for line, module, folder in layers or [(line, wing, self.root / "mbk" / wing)]:
                if module == "LAYER":
                    number += 1
                    continue
                if module in self.layer:
                    self.report(path, line, f"'{module}' stands in two layers; keep one")
                else:
                    self.layer[module], self.folder[module] = number, folder

    def read_module(self, folder):
        module, path = folder.name, folder / "CMakeLists.txt"
        self.declared[module], self.used[module] = {}, set()
        if self.folder.setdefault(module, folder) != folder or module not in self.layer:
            self.report(self.root / "mbk" / "CMakeLists.txt", 1,
                        f"'{folder.relative_to(self.root)}' stands in no layer; add it to its mbk_wing, above "
                        "everything that it uses")
        found = list(calls(path, "mbk_module")) if path.exists() else []
        if len(found) != 1 or found[0][0][1] != module:
            self.report(path, 1, f"should hold one mbk_module({module} ...); write it")
            return
        keyword = None
        for line, word in found[0][1:]:
            if word in KEYWORDS:
                keyword = word
            elif keyword == "DEPENDS":
                self.declared[module][word] = line

    def runs_upward(self, module, other):
        """Whether `module` may not use `other` because of their layers; one without a layer is reported elsewhere."""
        return module in self.layer and other in self.layer and self.layer[other] >= self.layer[module]

    def upward(self, module, other):
        return (f"'{module}' (layer {self.layer[module]}) may not use '{other}' (layer {self.layer[other]}); "
                "move what both need to a lower layer, or hand the value in from above")

    def check_declarations(self, module):
        for other, line in self.declared[module].items():
            if other not in self.declared:
                self.report(self.lists(module), line, f"there is no module '{other}'; correct DEPENDS")
            elif self.runs_upward(module, other):
                self.report(self.lists(module), line, self.upward(module, other))

    def check_includes(self, path):
        module = self.module_of(path)
        for line, text in enumerate(path.read_text(errors="replace").splitlines(), start=1):
            match = INCLUDE.match(text)
            if match:
                self.check_include(path, line, module, *match.groups())

    def module_of(self, path):
        """The module whose folder holds a file; None outside mbk/."""
        return next((name for name, folder in self.folder.items() if path.parent == folder), None)

    def check_include(self, path, line, module, quote, name):
        if not name.startswith("mbk/"):
            if module and quote == '"' and (path.parent / name).exists():
                self.report(path, line, f"'{name}' is named from this folder; name it from the root: \"mbk/...\"")
            return
        if not (self.root / name).is_file():
            self.report(path, line, f"there is no {name}; correct the path")
            return
        other = self.module_of(self.root / name)
        if module is None or other is None or other == module:
            return
        self.used[module].add(other)
        if self.runs_upward(module, other):
            self.report(path, line, self.upward(module, other))
        elif other not in self.declared[module]:
            self.report(path, line, f"'{module}' does not declare '{other}'; "
                                    f"add '{other}' to DEPENDS in {self.lists(module).relative_to(self.root)}")


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    problems = Tree(root).check()
    print("\n".join(problems) or "every include is declared and runs downward")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
