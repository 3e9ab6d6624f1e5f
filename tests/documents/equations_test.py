#!/usr/bin/env python3
"""docs/theory holds: every equation has its row, and every header, function and test that is named is there."""

import pathlib
import re
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
THEORY = SOURCE / "docs/theory"
MAP = THEORY / "equations.md"
NUMBERED = {"3": 27, "4": 3, "5": 5, "A": 6, "D": 3, "E": 4}  # equations of each chapter of the source
NAMED = ["definition 3.1", "definition 3.2", "theorem 3.1", "theorem 3.2", "theorem 4.1", "theorem 4.2", "lemma 4.1",
         "lemma 4.2"]
TEST = re.compile(r"^TEST(?:_P|_F)?\(\s*(\w+),\s*(\w+)\)", re.MULTILINE)
LINK = re.compile(r"\[[^\]]*\]\(([^)#]+)[^)]*\)")


def rows(page):
    """The cells of each row of each table of five columns, but for headings."""
    for line in page.read_text().splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 5 and cells[0] != "Source" and not cells[0].startswith("---"):
            yield cells


def code_of(header):
    """A header without its comments."""
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", header.read_text(), flags=re.DOTALL)


def tests_in(*files):
    return {f"{suite}.{name}" for file in files for suite, name in TEST.findall(file.read_text())}


def programs():
    """The tests of each GoogleTest program: a module has <module>_test, folders of tests/ what their lists say."""
    found = {f"{lists.parent.name}_test": tests_in(*lists.parent.glob("*_test.cpp"))
             for lists in [*(SOURCE / "mbk").glob("*/**/CMakeLists.txt"), SOURCE / "thesis/CMakeLists.txt"]}
    for lists in (SOURCE / "tests").glob("*/CMakeLists.txt"):
        for name in re.findall(r"mbk_test\((\w+)", lists.read_text()):
            found[name] = tests_in(*lists.parent.glob("*_test.cpp"))
    return found


class Equations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rows = list(rows(MAP))
        cls.programs = programs()

    def test_every_number_has_one_row(self):
        expected = [f"({chapter}.{i})" for chapter, last in NUMBERED.items() for i in range(1, last + 1)] + NAMED
        sources = [one for cells in self.rows for one in cells[0].split(", ")]
        for number in expected:
            self.assertEqual(sources.count(number), 1, f"{number} should stand in one row of {MAP.name}")

    def test_every_row_says_where_and_what_holds_it(self):
        self.assertGreater(len(self.rows), 50)
        for source, says, where, held, more in self.rows:
            with self.subTest(source):
                self.assertTrue(says)
                self.assertRegex(where, r"`\w[\w:]*`.*\.h\)")
                self.assertRegex(held, r"`\w+/\w+")
                self.assertIn("](", more)

    def test_functions_stand_in_the_headers_that_are_named(self):
        for source, _, where, _, _ in self.rows:
            waiting = []
            for name, header in re.findall(r"`([\w:]+)`|\]\(([^)]+\.h)\)", where):
                if name:
                    waiting.append(name)
                    continue
                file = (THEORY / header).resolve()
                self.assertTrue(file.is_file(), f"{source}: there is no {header}")
                for one in waiting:
                    for part in one.split("::"):
                        self.assertRegex(code_of(file), rf"\b{part}\b", f"{source}: {header} has no {one}")
                waiting = []
            self.assertEqual(waiting, [], f"{source}: which header?")

    def test_tests_are_there(self):
        for source, _, _, held, _ in self.rows:
            for program, name in re.findall(r"`(\w+)/([\w.]+)`", held):
                if program == "end_to_end":
                    self.assertTrue((SOURCE / "tests/end_to_end" / f"{name}_test.py").is_file(), f"{source}: {name}")
                else:
                    self.assertIn(program, self.programs, source)
                    self.assertIn(name, self.programs[program], f"{source}: {program} has no such test")

    def test_errata_have_both_ends(self):
        """Each section of the errata is named by a row."""
        headings = re.findall(r"^## (.*)$", (THEORY / "errata.md").read_text(), re.MULTILINE)
        anchors = {re.sub(r"[^\w\- ]", "", one.lower()).replace(" ", "-") for one in headings}
        linked = {anchor for cells in self.rows for anchor in re.findall(r"errata\.md#([^)]+)", cells[4])}
        self.assertEqual(linked - anchors, set(), "leads to no section")
        self.assertEqual(anchors - linked, set(), "no row leads there")


class Pages(unittest.TestCase):
    def test_tests_that_follow_the_link_to_their_file_are_in_it(self):
        checked = 0
        for page in sorted(THEORY.glob("*.md")):
            file = None
            for number, line in enumerate(page.read_text().splitlines(), start=1):
                after = False  # of a link to a test, or of "same file"
                for link, name, same in re.findall(r"\]\(([^)#]+)[^)]*\)|`([^`]+)`|([Ss]ame file:)", line):
                    if link:
                        after = link.endswith("_test.cpp")
                        file = (page.parent / link).resolve() if after else file
                    elif same:
                        after = file is not None
                    elif after and re.fullmatch(r"(\w+\.)?[A-Z][a-z]\w{6,}", name):
                        tests = tests_in(file)
                        names = tests | {part for one in tests for part in one.split(".")}
                        self.assertIn(name, names, f"{page.name}:{number}: {file.name} has no such test")
                        checked += 1
        self.assertGreater(checked, 130)

    def test_pages_stand_in_the_index(self):
        for folder in (THEORY, SOURCE / "docs/guide"):
            index = (folder / "README.md").read_text()
            for page in folder.glob("*.md"):
                if page.name != "README.md":
                    self.assertIn(f"]({page.name})", index, folder.name)


if __name__ == "__main__":
    unittest.main()
