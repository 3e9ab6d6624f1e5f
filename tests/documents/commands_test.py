#!/usr/bin/env python3
"""Commands in README.md, the guide and the examples name commands and options that the program has."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/end_to_end"))

import help_tree  # noqa: E402

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs/guide").glob("*.md")), *sorted((ROOT / "examples").rglob("*.md"))]


def commands(text):
    """Each command of mbk in blocks and in `code`, continued lines joined."""
    joined = text.replace("\\\n", " ")
    for block in re.findall(r"^```(?:\w*)\n(.*?)^```", joined, re.S | re.M):
        for line in block.splitlines():
            if match := re.match(r"(?:\$ )?(mbk .*)", line):
                yield match[1]
    yield from re.findall(r"`(mbk [^`]+)`", re.sub(r"^```.*?^```", "", joined, flags=re.S | re.M))


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.known = {one.path: one for one in help_tree.every_command()}

    def problems(self, command):
        words = re.split(r"\s+", re.split(r"\s{3,}|\s[|>;]|#", command)[0].strip())[1:]
        path = ()
        while words and (*path, words[0]) in self.known:
            path = (*path, words.pop(0))
        here = self.known[path]
        if here.commands and words and re.fullmatch(r"[a-z][a-z-]+", words[0]):
            return f"mbk {' '.join(path)} has no command '{words[0]}'"
        for word in words:
            option = re.match(r"--[a-z][\w-]*", word)
            if option and option[0] not in here.options and option[0] not in self.known[()].options:
                return f"mbk {' '.join(path)} has no option '{option[0]}'"
        return None

    def test_every_command_and_option_is_there(self):
        count = 0
        for page in PAGES:
            for command in commands(page.read_text(encoding="utf-8")):
                count += 1
                with self.subTest(page=page.relative_to(ROOT).as_posix(), command=command):
                    self.assertIsNone(self.problems(command))
        self.assertGreater(count, 200)

    def test_the_check_can_fail(self):
        self.assertIsNone(self.problems("mbk study measure --study arms"))
        self.assertIn("--repot", self.problems("mbk measure log.mat --repot a.html"))
        self.assertIn("measur", self.problems("mbk study measur"))


if __name__ == "__main__":
    unittest.main()
