#!/usr/bin/env python3
"""mbk manual: every command has a page that man reads, and the page says what --help says."""

import functools
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from command import FINE, WRONG_USAGE, Case, main, run
from help_tree import every_command

SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "SEE ALSO"]


def needs(tool):
    return unittest.skipUnless(shutil.which(tool), f"there is no {tool}")


def plain(page):
    """What is printed, without fonts and escapes."""
    text = re.sub(r"\\f[BIR]", "", page)
    for escape, sign in ((r"\-", "-"), (r"\&", ""), (r"\(aq", "'"), (r"\(ti", "~"), (r"\(ha", "^"), (r"\(ga", "`"),
                         (r"\e", "\\")):
        text = text.replace(escape, sign)
    return text


def squeezed(text):
    return re.sub(r"\s+", " ", text)


@functools.lru_cache(maxsize=None)
def pages():
    """Each command's page as a file, as a package installs them."""
    folder = tempfile.TemporaryDirectory(prefix="mbk-manual-")
    unittest.addModuleCleanup(folder.cleanup)
    if run("manual", "--pages", folder.name).code != FINE:
        raise AssertionError("the pages cannot be written")
    return {command: pathlib.Path(folder.name) / f"{command.name}.1" for command in every_command()}


class Manual(Case):
    def ran(self, *command):
        process = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        return process.stdout + process.stderr

    def test_there_is_one_page_for_each_command_and_no_other(self):
        self.assertEqual(sorted(path.name for path in pages()[every_command()[0]].parent.iterdir()),
                         sorted(path.name for path in pages().values()))
        for command, path in pages().items():
            self.assertEqual(self.fine("manual", *command.path).out, path.read_text())

    def test_as_json_it_has_every_command_and_option(self):
        table = self.fine("manual", "--json").json  # which fits its schema: run() sees to that
        known = {tuple(one["path"]): {name for option in one["options"] for name in option["names"]}
                 for one in table["commands"]}
        for command in every_command():
            if command.path:
                with self.subTest(command=command.name):
                    self.assertLessEqual(set(command.options), known[tuple(command.path)])
        self.assertEqual(len(known), len([one for one in every_command() if one.path]))
        measure = next(one for one in table["commands"] if one["path"] == ["measure"])
        mode = next(option for option in measure["options"] if option["names"] == ["--mode"])
        self.assertEqual(mode["words"], ["default", "reference"])
        self.refused(WRONG_USAGE, "manual", "--json", "measure")

    def test_every_option_stands_in_its_page(self):
        for command, path in pages().items():
            page = plain(path.read_text())
            for name, value in command.options.items():
                with self.subTest(command=command.name, option=name):
                    self.assertRegex(page, rf"(?m)^(-\w, )?{re.escape(name)}(, --[-\w]+)?"
                                           rf"{' ' + re.escape(value) if value else ''}(\.\.\.)?$")
            for name in command.positionals:
                self.assertRegex(page, rf"(?m)^{re.escape(name)}(\.\.\.)?$")

    def test_the_words_of_the_help_are_those_of_the_page(self):
        page = squeezed(plain(self.fine("manual", "measure").out))
        lines = re.findall(r"(?m)^ {6,}(\S.*)$", self.fine("measure", "--help").out)
        self.assertGreater(len(lines), 50)
        for line in lines:
            self.assertIn(squeezed(line), page)

    def test_sections_stand_in_their_order(self):
        for command, path in pages().items():
            with self.subTest(command.name):
                found = re.findall(r"(?m)^\.SH (.*)$", path.read_text())
                self.assertEqual([one for one in found if one in SECTIONS], SECTIONS)
                if "Example" in command.text:
                    self.assertIn("EXAMPLES", found)

    def test_groups_and_lists_are_kept(self):
        measure = self.fine("manual", "measure").out
        self.assertEqual(re.findall(r"(?m)^\.SS (.*)$", measure),
                         ["Reading the file", "Force sensor", "Analysed interval", "Filters", "Model", "Plausibility"])
        self.assertRegex(self.fine("manual", "validate").out, r"\.SH EXAMPLES\n\.EX\n  mbk validate coverage ")

    def test_exit_codes_are_those_of_the_command(self):
        self.assertRegex(self.fine("manual", "validate").out, r"\.SH EXIT STATUS\n.*\b1 \w.*\b6 \w")
        self.assertRegex(self.fine("manual", "measure").out, r"\.SH EXIT STATUS\n.*\b4 \w")

    def test_a_line_of_text_is_never_taken_for_a_request(self):
        for path in pages().values():
            for line in path.read_text().splitlines():
                if line.startswith((".", "'")):
                    self.assertRegex(line, r"^\.(TH|SH|SS|TP|PP|EX|EE|RS|RE)\b")

    def test_every_page_that_is_referred_to_exists(self):
        names = {path.name for path in pages().values()}
        for command, path in pages().items():
            for name in re.findall(r"([-a-z]+)\(1\)", plain(path.read_text())):
                self.assertIn(f"{name}.1", names, command.name)

    @needs("mandoc")
    def test_mandoc_finds_nothing_wrong(self):
        complaints = self.ran("mandoc", "-T", "lint", "-W", "warning", *pages().values()).splitlines()
        # A page belongs to a version and not to a day: the same sources give the same bytes.
        self.assertEqual([one for one in complaints if "missing date" not in one], [])

    @needs("lexgrog")
    def test_lexgrog_finds_name_and_summary(self):
        for command, path in pages().items():
            said = self.ran("lexgrog", path)
            self.assertIn(f'"{command.name} - ', said)

    @needs("man")
    def test_man_prints_it_without_a_warning(self):
        for path in pages().values():
            process = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", path], timeout=60, check=True,
                                     capture_output=True, text=True, env={"LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"})
            self.assertEqual(process.stderr, "", path)
            self.assertIn("\nSEE ALSO\n", re.sub(".\x08", "", process.stdout))  # bold is a sign printed over itself

    def test_pages_that_are_there_are_kept(self):
        self.fine("manual", "--pages", self.folder / "man1")
        self.refused(WRONG_USAGE, "manual", "--pages", self.folder / "man1", says="--overwrite")
        self.fine("manual", "--pages", self.folder / "man1", "--overwrite")

    def test_what_is_no_command_is_refused(self):
        self.refused(WRONG_USAGE, "manual", "springs", "fly", says=["springs fly", "mbk --help"])
        self.refused(WRONG_USAGE, "manual", "measure", "--pages", self.folder / "pages", says="--pages")


if __name__ == "__main__":
    main()
