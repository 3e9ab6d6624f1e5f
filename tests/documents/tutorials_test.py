#!/usr/bin/env python3
"""Every block of "First ten minutes" in the guide is run in an empty folder, and prints what the page shows.

`$ COMMAND` runs in a shell, with its output below it; a block `python` or `matlab` (in Octave) shows its output in the block
`text` that follows; on the page for clinicians, `text` shows lines of report.html as a browser shows them. Code of one language runs in one
process, up to the next block of another. The clone of the reader is ~/mbk.
"""

import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from shown_output_test import commands_of, pattern

try:
    import lxml.html
    import numpy
except ImportError:
    numpy = None

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["MBK"]).resolve().parents[1]
PAGES = ("clinician", "kinarm", "matlab", "python", "ros")
MARK = "--- the next block ---"
CHROMIUM = [found for name in ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
            if (found := shutil.which(name))]


class Missing(Exception):
    """What this machine or build lacks."""


def blocks(page):
    """(language, content) of each block of the tutorial of a page; an output belongs to the code above it."""
    text = (ROOT / f"docs/guide/{page}.md").read_text(encoding="utf-8")
    section = re.search(r"^## First ten minutes\n(.*?)(?=^## |\Z)", text, re.S | re.M)[1]
    return [(found[1], found[2]) for found in re.finditer(r"^```(\w*)\n(.*?)^```$", section, re.S | re.M)]


def processes(page):
    """(language, [(code, shown output or None)]), in order; what one process runs. Fails at a block that nothing runs."""
    runs = []
    for language, content in blocks(page):
        if language == "text" and page == "clinician":
            runs.append(("report", [("the report", content)]))
        elif language == "text":
            if not runs or runs[-1][0] not in ("python", "matlab") or runs[-1][1][-1][1] is not None:
                raise AssertionError(f"{page}: no code above this output:\n{content}")
            runs[-1][1][-1] = (runs[-1][1][-1][0], content.rstrip())
        elif language in ("python", "matlab"):
            if not runs or runs[-1][0] != language:
                runs.append((language, []))
            runs[-1][1].append((content, None))
        elif language == "" and content.startswith("$ "):
            runs.append((language, list(commands_of(content))))
        else:
            raise AssertionError(f"{page}: nothing runs this block:\n{content}")
    return runs


class Reader:
    """A home with a clone in mbk, and an empty folder to work in."""

    def __init__(self, home):
        self.folder = home / "work"
        release, python = home / "mbk/build/release", home / "bin/python3"
        for folder in (self.folder, release, python.parent):
            folder.mkdir(parents=True)
        python.write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n', encoding="utf-8")  # the one that has NumPy
        python.chmod(0o755)
        for one in ROOT.iterdir():
            if one.name not in ("build", ".git"):
                (home / "mbk" / one.name).symlink_to(one)
        for one in ("bin", "octave", "python"):
            if (BUILD / one).exists():
                (release / one).symlink_to(BUILD / one)
        self.environment = {**os.environ, "HOME": str(home), "COLUMNS": "100",
                            "PATH": os.pathsep.join([str(release / "bin"), str(python.parent), os.environ["PATH"]]),
                            "PYTHONPATH": str(release / "python"), "PYTHONDONTWRITEBYTECODE": "1",
                            "MPLBACKEND": "Agg", "OCTAVE_PATH": str(release / "octave")}

    def run(self, *command):
        process = subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=280,
                                 check=False)
        if process.returncode not in (0, 4):  # 4: not usable, which a page may show
            raise AssertionError(f"{command}: exit {process.returncode}\n{process.stdout}\n{process.stderr}")
        return process.stdout

    def outputs(self, language, codes):
        """What each piece of code prints."""
        if language == "":
            return [self.run("bash", "-c", code) for code in codes]
        if language == "report":
            return [self.report]
        if language == "matlab" and not (shutil.which("octave-cli") and (BUILD / "octave/mbk_mex.mex").exists()):
            raise Missing("Octave, or the package for it in this build")
        if language == "python" and not (BUILD / "python/mbk/__init__.py").exists():
            raise Missing("the Python package in this build")
        script = self.folder.parent / {"python": "code.py", "matlab": "code.m"}[language]
        mark = {"python": f"print('{MARK}')\n", "matlab": f"disp('{MARK}')\n"}[language]
        before = {"python": "", "matlab": "graphics_toolkit('gnuplot'); figure('visible', 'off');\n"}[language]
        script.write_text(before + mark.join(codes), encoding="utf-8")
        command = {"python": [sys.executable], "matlab": ["octave-cli", "--no-gui", "--quiet", "--no-init-file"]}[language]
        return self.run(*command, str(script)).split(f"{MARK}\n")

    @functools.cached_property
    def report(self):
        """The words of report.html, once it has been written."""
        if not CHROMIUM:
            raise Missing("Chromium")
        page = self.run(CHROMIUM[0], "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000", "--dump-dom",
                        (self.folder / "report.html").as_uri())
        tree = lxml.html.fromstring(page)
        for hidden in tree.xpath("//script|//style|//noscript"):
            hidden.drop_tree()
        return words(" ".join(tree.itertext()))


def words(text):
    """Without the breaks that elements of a page make, also before a full stop."""
    return re.sub(r" (?=[.,;])", "", " ".join(text.split()))


def differences(language, shown, printed):
    """None, or what is shown but not printed."""
    if language == "report":  # in this order, with anything between
        at = 0
        for line in filter(None, map(words, shown.splitlines())):
            at = printed.find(line, at)
            if at < 0:
                return line
        return None
    return None if pattern(shown).match(printed.rstrip() + "\n") else shown


class Tutorials(unittest.TestCase):
    maxDiff = None

    @unittest.skipIf(numpy is None, "NumPy or lxml is not there")
    def check(self, page):
        runs = processes(page)
        with tempfile.TemporaryDirectory(prefix="mbk-tutorial-") as home:
            reader = Reader(pathlib.Path(home))
            self.assertEqual(list(reader.folder.iterdir()), [])
            for language, steps in runs:
                try:
                    printed = reader.outputs(language, [code for code, _ in steps])
                except Missing as missing:
                    self.skipTest(f"not here: {missing}")
                self.assertEqual(len(printed), len(steps))
                for (code, shown), output in zip(steps, printed):
                    with self.subTest(code):
                        if shown:
                            missing = differences(language, shown, output)
                            self.assertIsNone(missing, f"{page} shows\n{missing}\n\nbut there is\n{output}")
                        elif language in ("python", "matlab"):
                            self.assertEqual(output.strip(), "", "the page does not show this output")

    def test_each_has_steps_outputs_and_where_to_go_next(self):
        for page in PAGES:
            with self.subTest(page):
                text = (ROOT / f"docs/guide/{page}.md").read_text(encoding="utf-8")
                section = re.search(r"^## First ten minutes\n(.*?)(?=^## |\Z)", text, re.S | re.M)[1]
                steps = [int(one) for one in re.findall(r"^\*\*(\d)\. ", section, re.M)]
                self.assertEqual(steps, list(range(1, len(steps) + 1)))
                self.assertIn(len(steps), range(5, 9))
                self.assertIn("\n**Next:** ", section)
                self.assertGreater(sum(bool(shown) for _, run in processes(page) for _, shown in run), 3)

    def test_the_comparison_can_fail(self):
        self.assertIsNone(differences("report", "Stiffness K\n137 N/m", "Stiffness K pushes back 137 N/m [130, 143]"))
        self.assertEqual(differences("report", "Stiffness K\n138 N/m", "Stiffness K pushes back 137 N/m"), "138 N/m")
        self.assertEqual(differences("report", "137 N/m\nStiffness K", "Stiffness K pushes back 137 N/m"), "Stiffness K")
        self.assertIsNotNone(differences("python", "1.25", "1.26\n"))


def add(page):
    setattr(Tutorials, f"test_{page}", lambda self: self.check(page))


for a_page in PAGES:
    add(a_page)


if __name__ == "__main__":
    unittest.main()
