#!/usr/bin/env python3
"""The documentation site builds without a network and without a warning, asks for nothing outside, and its links hold.

The build runs in a network namespace of its own that has not even a loopback; where the kernel refuses that, the test is
skipped rather than run without the proof.
"""

import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

import lxml.html

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TOOLS = ("doxygen", "sphinx-build", "unshare")
ALONE = ("unshare", "--map-root-user", "--net")
SKIPPED = 77
OUTSIDE = re.compile(r"^(?:[a-z][a-z0-9+.-]*:)?//", re.IGNORECASE)
LOADED = {"script": ("src",), "img": ("src", "srcset"), "iframe": ("src",), "source": ("src", "srcset"),
          "embed": ("src",), "object": ("data",), "video": ("src",), "audio": ("src",), "link": ("href",)}


@functools.lru_cache(maxsize=None)
def standing_at(folder, path):
    """The file that a path leads to from a folder; None where there is none. Links within a site come thousands of times."""
    found = pathlib.Path(os.path.normpath(folder / path))
    return found if found.is_file() else None


class Page:
    """What a page loads, where it leads, the places in it, and its text."""

    def __init__(self, file):
        tree = lxml.html.parse(str(file), lxml.html.HTMLParser(encoding="utf-8"))
        loaded = [found for one in tree.iter(*LOADED) for found in map(one.get, LOADED[one.tag])]
        self.loads = [found for found in loaded if found]
        self.leads = [found for found in (one.get("href") for one in tree.iter("a")) if found]
        self.places = set(tree.xpath("//@id | //@name"))
        self.text = tree.xpath("string()")


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-site-")
        cls.addClassCleanup(folder.cleanup)
        process = subprocess.run([*ALONE, SOURCE / "tools/docs", "--mbk", os.environ["MBK"], "--to", folder.name],
                                 capture_output=True, text=True, timeout=280, check=False)
        if process.returncode != 0:
            raise AssertionError(f"tools/docs: exit {process.returncode}\n{process.stdout}\n{process.stderr}")
        cls.html = pathlib.Path(folder.name) / "html"
        cls.pages = {file: Page(file) for file in cls.html.rglob("*.html")}

    @functools.lru_cache(maxsize=None)
    def name(self, file):
        """Asked for at every link, for what would be said of it."""
        return file.relative_to(self.html).as_posix()

    def test_there_was_no_network(self):
        """The proof itself: in such a namespace nothing can be reached, this machine included."""
        reached = subprocess.run([*ALONE, sys.executable, "-c", "import socket; socket.create_connection(('127.0.0.1', 1))"],
                                 capture_output=True, text=True, check=False)
        self.assertIn("Network is unreachable", reached.stderr)

    def test_every_kind_of_page_is_there(self):
        for name in ("index", "guide/first_measurement", "theory/equations", "house", "decisions", "examples/01_measure",
                     "commands/mbk-measure", "commands/mbk-robot-force", "library", "changelog", "api/files", "search"):
            self.assertTrue((self.html / f"{name}.html").is_file(), name)
        self.assertEqual(len(list((self.html / "guide").glob("*.html"))),
                         len(list((SOURCE / "docs/guide").glob("*.md"))))

    def test_commands_say_what_the_program_says(self):
        help_text = subprocess.run([os.environ["MBK"], "measure", "--help"], capture_output=True, text=True, check=True).stdout
        shown = self.pages[self.html / "commands/mbk-measure.html"].text
        options = set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", help_text, re.MULTILINE))
        self.assertGreater(len(options), 30)
        for option in options:
            self.assertIn(option, shown)

    def test_the_recording_shows_the_first_commands_as_text_and_to_play(self):
        tree = lxml.html.parse(str(self.html / "index.html"), lxml.html.HTMLParser(encoding="utf-8"))
        (shown,) = tree.xpath("//details[@class='recorded']//pre")
        for part in ("$ mbk simulate relaxed_sinusoidal --out trial.h5\n", "$ mbk measure trial.h5\n", "\n  stiffness K  46.0 ± 5.0 ",
                     "\n               yy\n"):  # which a terminal of 80 columns has no room for beside the others
            self.assertIn(part, shown.text_content())
        casts = tree.xpath("//script[@type='application/x-asciicast']")
        has_player = (self.html / "_static/asciinema-player.min.js").is_file()
        self.assertEqual(len(casts), has_player)
        if not casts:
            return
        header, *events = map(json.loads, casts[0].text.strip().splitlines())
        self.assertEqual((header["version"], header["width"]), (2, 80))
        times = [time for time, _, _ in events]
        self.assertEqual(times, sorted(times))
        played = "".join(output for _, _, output in events).replace("\r\n", "\n")
        self.assertEqual(played.removesuffix("$ ").strip(), shown.text_content().strip())
        self.assertTrue((self.html / "_static/asciinema-player.LICENSE.txt").is_file())

    def test_navigation_has_the_order_of_the_readmes(self):
        tree = lxml.html.parse(str(self.html / "theory/index.html"))
        shown = [one.get("href") for one in tree.xpath("//*[@class='sidebar-tree']//a")]
        captions = tree.xpath("//*[@class='sidebar-tree']//p[contains(@class, 'caption')]/span/text()")
        guide = (SOURCE / "docs/guide/README.md").read_text()
        groups = re.findall(r"^\*\*(.+)\*\*$", guide, re.MULTILINE)
        self.assertEqual(captions[:len(groups)], groups)
        for folder, before in (("guide", "../guide/"), ("theory", "")):
            text = (SOURCE / "docs" / folder / "README.md").read_text()
            order = list(dict.fromkeys(re.findall(r"\]\(([\w-]+)\.md\)", text)))
            self.assertEqual([one for one in shown if one in {f"{before}{name}.html" for name in order}],
                             [f"{before}{name}.html" for name in order])

    def test_formulas_are_set_apart(self):
        theory = (self.html / "theory/robot.html").read_text()
        self.assertGreater(theory.count('class="formula"'), 3)
        self.assertIn("F<sub>h</sub>", theory)

    def test_functions_of_the_theory_lead_to_their_reference(self):
        leads = self.pages[self.html / "theory/equations.html"].leads
        self.assertGreater(sum("../api/" in one and "#" in one for one in leads), 40)

    def test_nothing_is_loaded_from_outside(self):
        for file, page in self.pages.items():
            for one in page.loads:
                self.assertNotRegex(one, OUTSIDE, self.name(file))
        for file in [*self.html.rglob("*.css"), *self.html.rglob("*.html")]:
            styles = file.read_text() if file.suffix == ".css" else "".join(re.findall(r"<style.*?</style>", file.read_text(), re.DOTALL))
            for one in re.findall(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)", styles):
                self.assertNotRegex("".join(one), OUTSIDE, self.name(file))

    def test_what_is_loaded_is_there(self):
        for file, page in self.pages.items():
            for one in page.loads:
                self.assert_loaded(file, one)
        for file in self.html.rglob("*.css"):
            for one in re.findall(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)", file.read_text()):
                self.assert_loaded(file, "".join(one))

    def assert_loaded(self, file, one):
        """From the site itself, wherever it stands: not from the root of a server either."""
        target = urllib.parse.unquote(one.split("?")[0].split("#")[0])
        if target and not re.match(r"data:|javascript:", target):
            self.assertFalse(target.startswith("/"), f"{self.name(file)} loads {one}")
            self.assertIsNotNone(standing_at(file.parent, target), f"{self.name(file)} loads {one}")

    def test_links_within_the_site_hold(self):
        checked = 0
        for file, page in self.pages.items():
            for one in page.leads:
                if OUTSIDE.match(one) or re.match(r"(mailto|javascript):", one):
                    continue
                target, _, place = urllib.parse.unquote(one).partition("#")
                found = standing_at(file.parent, target.split("?")[0]) if target else file
                self.assertIsNotNone(found, f"{self.name(file)} leads to {one}")
                # Doxygen lists nested types under a heading to which it gives no name.
                if place and found in self.pages and place != "nested-classes":
                    self.assertIn(place, self.pages[found].places, f"{self.name(file)} leads to {one}")
                checked += 1
        self.assertGreater(checked, 10000)


if __name__ == "__main__":
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if not missing and subprocess.run([*ALONE, "true"], capture_output=True, check=False).returncode != 0:
        missing.append("the right to a network namespace")
    if missing:
        print("not here:", *missing)
        sys.exit(SKIPPED)
    unittest.main()
