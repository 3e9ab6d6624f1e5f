#!/usr/bin/env python3
"""mbk completion: each script is sound, knows every option that --help shows, and completes what a person types."""

import os
import pty
import re
import select
import shutil
import subprocess
import time
import unittest

from command import WRONG_USAGE, Case, main
from help_tree import every_command

SHELLS = ("bash", "zsh", "fish")
READY = ["relaxed_odd_multisine", "relaxed_ramp_and_hold", "relaxed_sinusoidal", "relaxed_space", "relaxed_underdamped", "relaxed_virtual_sensor"]
TYPED = {  # what has been typed → what is offered
    ("me",): ["measure"],
    ("measure", "--mo"): ["--mode"],
    ("measure", "--mode", ""): ["default", "reference"],
    ("measure", "--json", "--mode", "r"): ["reference"],
    ("measure", "--cutoff", ""): ["none"],
    ("measure", "--domain", ""): ["hand", "joint"],
    ("comp",): ["compare", "completion"],
    ("compare", "--meth"): ["--method"],
    ("run", "--no-c"): ["--no-console"],
    ("springs", ""): ["calibrate", "field", "find"],
    ("springs", "field", "--sp"): ["--spring"],
    ("teleop", "--op"): ["--operator"],
    ("teleop", "--ex"): ["--excess"],
    ("teleop", "--sim"): ["--simulate"],
    ("validate", "springs", "--ru"): ["--runs"],  # springs is a study here, not the command
    ("validate", ""): ["after-onset", "all", "change", "closed-loop", "coverage", "emg", "faults", "frequency-response", "live-estimate",
                       "misspecification", "one-dimensional", "participant", "passivity", "ramp-and-hold",
                       "recorded-reliability", "recovery", "reflex", "reliability", "robot", "servo-displacement", "spatial",
                       "springs", "stretch", "teleoperation", "transfer-function", "virtual-sensor"],
    ("rep",): ["reproduce"],
    ("reproduce", "--wi"): ["--without-printed"],
    ("reproduce", "--on"): ["--only"],
    ("completion", ""): ["bash", "fish", "zsh"],
}


def needs(shell):
    return unittest.skipUnless(shutil.which(shell), f"there is no {shell}")


class Shell(Case):
    """A test that runs a shell."""

    def script(self, shell):
        return self.file(f"completion.{shell}", self.fine("completion", shell).out)

    def ran(self, *command):
        return subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=60, check=True).stdout

    def recordings(self):
        for name in ("one.mat", "two.csv", "notes.txt", "with space.mat"):
            self.file(name, "")
        (self.folder / "older").mkdir(exist_ok=True)


class Scripts(Shell):
    def test_the_shell_accepts_its_script(self):
        for shell in filter(shutil.which, SHELLS):
            with self.subTest(shell):
                self.ran(shell, "-n", self.script(shell))

    def test_every_option_and_command_stands_in_each_script(self):
        for shell in SHELLS:
            script = self.fine("completion", shell).out
            for command in every_command():
                path = " ".join(("mbk", *command.path))
                if shell == "bash":
                    part = re.search(rf"(?ms)^    '{path}'\)$(.*?);;", script).group(1)
                elif shell == "zsh":
                    part = re.search(rf"(?ms)^_{path.replace(' ', '_')}\(\) {{$(.*?)^}}", script).group(1)
                else:
                    part = "\n".join(re.findall(rf"(?m)^complete -c mbk -n '__mbk_at {path}' (.*)$", script))
                for word in (*command.options, *command.commands):
                    if shell == "fish":
                        word = re.sub("^-(?=[^-])", "-s ", word).replace("--", "-l ", 1)
                    with self.subTest(shell=shell, command=path, word=word):
                        self.assertRegex(part, rf"(?<![\w-]){re.escape(word)}(?![\w-])")

    def test_another_shell_is_refused(self):
        self.refused(WRONG_USAGE, "completion", "tcsh", says=["'tcsh'", "bash|zsh|fish"])


class Bash(Shell):
    def offered(self, *words):
        """What bash offers for the last of these words, which stand as bash splits them."""
        script = self.script("bash")
        self.recordings()
        source = ('source "$1"; shift; COMP_WORDS=(mbk "$@"); COMP_CWORD=$#; '
                  'eval "$(complete -p mbk | sed "s/.*-F \\([^ ]*\\) .*/\\1/")"; printf "%s\\n" "${COMPREPLY[@]}"')
        return sorted(self.ran("bash", "--norc", "-c", source, "bash", script, *words).splitlines())

    def test_what_is_typed_is_completed(self):
        for typed, expected in {**TYPED, ("simulate", "rel"): READY, ("simulate", "--show", "rel"): READY}.items():
            with self.subTest(typed):
                self.assertEqual(self.offered(*typed), expected)

    def test_a_value_after_an_equals_sign(self):
        self.assertEqual(self.offered("measure", "--mode", "=", "ref"), ["reference"])
        self.assertEqual(self.offered("measure", "--mode", "="), ["default", "reference"])

    def test_files_by_what_the_command_reads(self):
        self.assertEqual(self.offered("measure", ""), ["older", "one.mat", "two.csv", "with space.mat"])
        self.assertEqual(self.offered("measure", "--json", "o"), ["older", "one.mat"])
        self.assertIn("notes.txt", self.offered("measure", "--out", ""))
        self.assertEqual(self.offered("validate", "--charts", ""), ["older"])
        self.assertEqual(self.offered("reproduce", "--out", ""), ["older"])

    def test_no_file_where_a_number_is_meant(self):
        self.assertEqual(self.offered("measure", "--rate", ""), [""])


@needs("fish")
class Fish(Shell):
    def offered(self, *words):
        line = " ".join(("mbk", *words))
        lines = self.ran("fish", "--no-config", "-c", f"source {self.script('fish')}; complete -C '{line}'")
        return sorted(line.split("\t")[0] for line in lines.splitlines())

    def test_what_is_typed_is_completed(self):
        for typed, expected in {**TYPED, ("simulate", "rel"): READY}.items():
            with self.subTest(typed):
                self.assertEqual(self.offered(*typed), expected)


@needs("zsh")
class Zsh(Shell):
    LONGEST_WAIT_S = 60

    def line_after(self, typed):
        """The command line in an interactive zsh after `typed` and the tabulator key."""
        # The widget stands for the key that a person hits next: it hands out the line as it is by then.
        self.file("rc", "PS1='' PS2='' ; unsetopt beep list_beep; fpath=($PWD $fpath); autoload -Uz compinit; "
                        "compinit -u -D; shown() { print -r -- \"$BUFFER\" > line.part; mv line.part line; exit }; "
                        "zle -N shown; bindkey '^T' shown; print ready\n")
        self.file("_mbk", self.fine("completion", "zsh").out)
        line = self.folder / "line"
        line.unlink(missing_ok=True)
        child, terminal = pty.fork()
        if child == 0:
            os.chdir(self.folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb", "LC_ALL": "C.UTF-8"})
        end = time.monotonic() + self.LONGEST_WAIT_S
        try:
            os.write(terminal, b"source ./rc\n")
            shown = b""
            while b"\nready" not in shown and time.monotonic() < end:
                if select.select([terminal], [], [], 1)[0]:
                    shown += os.read(terminal, 4096)
            os.write(terminal, typed.encode() + b"\t\x14")
            while not line.exists() and time.monotonic() < end:
                if select.select([terminal], [], [], 0.05)[0]:
                    try:
                        shown += os.read(terminal, 4096)
                    except OSError:  # the shell has gone
                        break
        finally:
            os.close(terminal)
            os.waitpid(child, 0)
        self.assertTrue(line.exists(), shown)
        return line.read_text().rstrip("\n")

    def test_what_is_typed_is_completed(self):
        self.file("one.mat", "")
        self.file("other.txt", "")
        for typed, expected in (("mbk me", "mbk measure "), ("mbk measure --mo", "mbk measure --mode "),
                              ("mbk measure --mode r", "mbk measure --mode reference "),
                              ("mbk springs fie", "mbk springs field "),
                              ("mbk springs field --sp", "mbk springs field --spring "),
                              ("mbk validate springs --ru", "mbk validate springs --runs "),
                              ("mbk simulate relaxed_u", "mbk simulate relaxed_underdamped "),
                              ("mbk measure o", "mbk measure one.mat ")):
            with self.subTest(typed):
                self.assertEqual(self.line_after(typed).rstrip(), expected.rstrip())


if __name__ == "__main__":
    main()
