#!/usr/bin/env python3
"""The figures of docs/guide/gallery.md are what the commands above them draw.

usage: gallery_test.py            runs the commands and compares
       gallery_test.py --update   runs the commands and replaces the figures
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/guide/gallery.md"
PICTURES = PAGE.parent / "pictures/gallery"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
TOLERANCE = 0.5  # in a drawing some 400 wide: rounding differs between processors


def drawn(folder):
    """Runs every command of the page in `folder`; the charts by their names."""
    for design in (ROOT / "examples/teleop").glob("*.toml"):
        shutil.copy(design, folder)
    text = PAGE.read_text(encoding="utf-8")
    for command in re.findall(r"^mbk (.*)$", "\n".join(re.findall(r"^```\n(.*?)^```", text, re.S | re.M)), re.M):
        subprocess.run([os.environ["MBK"], *command.split(), "--quiet"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return {file.name: file.read_text(encoding="utf-8") for file in pathlib.Path(folder).rglob("*.svg")}


def shown():
    return re.findall(r"\]\(pictures/gallery/([^)]+)\)", PAGE.read_text(encoding="utf-8"))


def same(one, other):
    """Whether two drawings have the same elements, words and, nearly, numbers."""
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other))
    return NUMBER.sub("#", one) == NUMBER.sub("#", other) and all(abs(float(a) - float(b)) <= TOLERANCE for a, b in pairs)


class Gallery(unittest.TestCase):
    def test_each_figure_is_what_the_commands_draw(self):
        with tempfile.TemporaryDirectory() as folder:
            charts = drawn(folder)
        self.assertGreater(len(shown()), 5)
        for name in shown():
            with self.subTest(name):
                self.assertIn(name, charts)
                self.assertTrue(same((PICTURES / name).read_text(encoding="utf-8"), charts[name]),
                                "the chart has changed; if that is intended, run gallery_test.py --update")

    def test_each_picture_is_shown(self):
        self.assertEqual(sorted(file.name for file in PICTURES.iterdir()), sorted(shown()))

    def test_the_check_can_fail(self):
        self.assertTrue(same('<text x="1.00">a</text>', '<text x="1.01">a</text>'))
        self.assertFalse(same('<text x="1.00">a</text>', '<text x="2.00">a</text>'))
        self.assertFalse(same('<text x="1.00">a</text>', '<text x="1.00">b</text>'))


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        with tempfile.TemporaryDirectory() as made:
            made_charts = drawn(made)
        shutil.rmtree(PICTURES, ignore_errors=True)
        PICTURES.mkdir(parents=True)
        for chart in shown():
            (PICTURES / chart).write_text(made_charts[chart], encoding="utf-8")
    else:
        unittest.main()
