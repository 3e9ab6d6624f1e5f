#!/usr/bin/env python3
"""What a person at a terminal sees: help and results in lines as wide as the window, colour, and in a pipe none of
it; few lines of progress."""

import collections
import fcntl
import os
import pty
import re
import struct
import subprocess
import termios

from command import WRONG_USAGE, Case, copy, main, make_log, program, run
from help_tree import every_command

ESCAPE = re.compile(r"\x1b\[[0-9;]*m")


def at_terminal(*arguments, columns=80, environment=None):
    """Exit code and what mbk shows at a terminal of so many columns."""
    ours, its = pty.openpty()
    fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    process = subprocess.Popen([program("MBK"), *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=its, stderr=its,
                               env={**os.environ, "TERM": "xterm", "NO_COLOR": "", **(environment or {})})
    os.close(its)
    text = b""
    while True:
        try:
            more = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not more:
            break
        text += more
    os.close(ours)
    return process.wait(timeout=60), text.decode("utf-8").replace("\r\n", "\n")


class Help(Case):
    def test_every_command_says_all_of_it_in_lines_that_fit(self):
        for command in every_command():
            text = run(*command.path, "--help").out
            with self.subTest(command=command.name):
                self.assert_lines_fit("\n".join(line for line in text.splitlines() if " " in line.strip()))

    def test_it_has_usage_arguments_options_and_examples(self):
        text = self.fine("measure", "--help").out
        for words in ("Usage: mbk measure", "FILE", "--json", "--summary", "mbk measure log.mat", "Model", "--hac-lag"):
            self.assertIn(words, text)

    def test_it_is_as_wide_as_the_terminal(self):
        for columns in (60, 72, 80, 120):
            for command in ("measure", "teleop", "validate"):
                for option in ("--help", "--help-all"):
                    code, text = at_terminal(command, option, columns=columns)
                    self.assertEqual(code, 0)
                    self.assert_lines_fit(ESCAPE.sub("", text), columns)
            self.assert_lines_fit(ESCAPE.sub("", at_terminal("--help", columns=columns)[1]), columns)


class Width(Case):
    def test_paragraphs_of_a_result_fit_and_lose_no_word(self):
        log = make_log().path
        plain = self.fine("measure", "--quiet", log).out
        for columns in (60, 80):
            _, text = at_terminal("measure", "--quiet", log, columns=columns)
            text = ESCAPE.sub("", text)
            self.assertEqual(collections.Counter(plain.split()) - collections.Counter(text.split()), {})
            self.assert_lines_fit(text, columns)

    def test_a_line_that_follows_a_broken_one_stays_a_line(self):
        _, text = at_terminal("measure", "--quiet", make_log().path)
        self.assertIn("  Neither statement guarantees that a robot coupled to this person is stable.",
                      ESCAPE.sub("", text).splitlines())

    def test_tables_come_in_parts_with_the_names_of_their_rows(self):
        log = make_log().path
        plain = self.fine("measure", "--quiet", log).out
        for columns in (60, 80):
            parts = ESCAPE.sub("", at_terminal("measure", "--quiet", log, columns=columns)[1]).splitlines()
            for name in ("inertia M", "damping B", "stiffness K"):
                whole = next(line for line in plain.splitlines() if line.strip().startswith(name))
                cells = re.split("  +", whole.strip())
                self.assertEqual(len(cells), 6, whole)  # name, four numbers, unit
                found = [re.split("  +", line.strip()) for line in parts if line.strip().startswith(name)]
                self.assertEqual([cell for part in found for cell in part[1:-1]], cells[1:-1], found)
                self.assertTrue(all(part[-1] == cells[-1] for part in found), found)  # the unit in each part

    def test_drawings_beside_one_another_are_put_below(self):
        _, text = at_terminal("measure", "--quiet", make_log().path, columns=60)
        captions = [line for line in ESCAPE.sub("", text).splitlines() if ", radius " in line]
        self.assertEqual([line.count(", radius ") for line in captions], [2, 1])
        wide = at_terminal("measure", "--quiet", make_log().path, columns=100)[1]
        self.assertEqual([line.count(", radius ") for line in wide.splitlines() if ", radius " in line], [3])

    def test_a_comparison_and_a_study_fit_too(self):
        for k, protocol in enumerate(("sinusoidal", "underdamped")):
            self.mbk("measure", "--quiet", make_log(protocol).path, "--json", "--out", self.folder / f"{k}.json")
        study = self.folder / "study"
        self.mbk("study", "init", study)
        self.mbk("study", "add", make_log().path, "--study", study, "--participant", "7", "--condition", "relaxed")
        self.mbk("study", "add", make_log("underdamped").path, "--study", study, "--participant", "8", "--condition",
                 "relaxed arm, hand on the table")
        self.mbk("study", "measure", "--study", study, "--quiet")
        self.mbk("study", "exclude", "2", "--study", study, "--why",
                 "the hand slipped off the handle in the middle of it")
        shown = (("compare", self.folder / "0.json", self.folder / "1.json"), ("study", "list", "--study", study),
                 ("study", "summary", "--study", study))
        for command in shown:
            plain = run(*command).out
            for columns in (60, 80):
                code, text = at_terminal(*command, columns=columns)
                text = ESCAPE.sub("", text)
                self.assertEqual(code, 0)
                self.assertEqual(collections.Counter(plain.split()) - collections.Counter(text.split()), {}, command)
                self.assert_lines_fit(text, columns)

    def test_a_document_stays_as_it_is(self):
        log = make_log().path
        self.assertEqual(at_terminal("info", log, "--json", columns=60)[1], self.fine("info", log, "--json").out)


class Colour(Case):
    def test_is_shown_at_a_terminal_alone(self):
        self.assertIn("\x1b[1mOptions:\x1b[0m", at_terminal("measure", "--help")[1])
        self.assertNotIn("\x1b", run("measure", "--help").out)
        self.assertIn("\x1b[", at_terminal("info", "none.mat")[1])
        self.assertNotIn("\x1b", run("info", "none.mat").err)

    def test_no_color_is_respected(self):
        for environment in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
            for arguments in (("measure", "--help"), ("info", "none.mat")):
                self.assertNotIn("\x1b", at_terminal(*arguments, environment=environment)[1])


class Progress(Case):
    def test_a_pipe_gets_a_line_for_each_tenth_at_most(self):
        ran = run("validate", "coverage", "--runs", 30, "--threads", 1)
        lines = re.findall(r"(?m)^coverage: (\d+) of 30", ran.err)
        self.assertTrue(1 <= len(lines) <= 10, ran.err)
        self.assertTrue(all(int(b) - int(a) >= 3 for a, b in zip(["0", *lines], lines)), ran.err)


class Studies(Case):
    def test_validate_alone_lists_them(self):
        text = self.fine("validate").out
        for study in ("coverage", "springs", "faults", "mbk validate all"):
            self.assertIn(study, text)
        self.assert_lines_fit(text)

    def test_all_of_them_have_no_common_document(self):
        self.refused(WRONG_USAGE, "validate", "all", "--json", says="mbk validate")


class NamesOfFiles(Case):
    """A file may be called what a terminal takes for a command: clear the screen, set the title, type an answer."""

    DRIVING = re.compile(r"\x1b(?!\[(?:0|1|1;31|33|36)m)|[\x00-\x08\x0b-\x1a\x1c-\x1f\x7f\x80-\x9f]")

    def test_drive_no_terminal(self):
        bad = "t\x1b]0;owned\x07\x1b[2J\x9b31m\r\b.mat"
        good = copy(make_log("sinusoidal").path, self.folder / bad)
        empty, text = self.file("\x1b[2Jempty.mat", b""), self.file("\x1b[2Jtext.csv", "time,\x1b[31mx\n0,1\n1,2\n2,3\n3,4\n")
        result = self.folder / "\x1b[2Jresult.json"
        self.mbk("measure", good, "--json", "--out", result)
        for words in (["info", good], ["info", text], ["info", empty], ["info", self.folder / "\x1b[2Jnone"], ["measure", good],
                      ["measure", good, good], ["measure", empty, good], ["explore", good, "--quiet"], ["explore", "--each", good, good],
                      ["ellipse", result], ["passivity", good], ["movement", good], ["convert", good, self.folder / "\x1b[2Ja.h5"],
                      ["compare", good, good], ["tf", good, "--input", "\x1b[2J", "--output", "x"], ["\x1b[2J"], ["measure", "--\x1b[2J"],
                      ["study", "list", "--study", self.folder / "\x1b[2J"], ["simulate", "\x1b[2J", "--out", "x.h5"],
                      ["robot", "describe", "\x1b[2J"], ["teleop", "\x1b[2J"], ["run", "\x1b[2J"], ["recover", "\x1b[2J"]):
            with self.subTest(command=words):
                _, shown = at_terminal(*words)
                self.assertIsNone(self.DRIVING.search(shown), repr(shown))
                ran = run(*words)
                self.assertNotIn("\x1b", ran.out + ran.err)


if __name__ == "__main__":
    main()
