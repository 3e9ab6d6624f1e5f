#!/usr/bin/env python3
"""What stands below a command in README.md and the guides is what the command prints, to the last printed digit.

A block between ``` that begins with `$ ` is run, page by page, from top to bottom in one folder. A line of only an
ellipsis stands for any number of lines, an ellipsis in a line for anything in it. Commands whose files a page does not
make, that take minutes, or that move a robot are not run: SKIPPED says which, and why.
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
MBK = pathlib.Path(os.environ["MBK"]).resolve()
MAKE_LOG = pathlib.Path(os.environ["MAKE_LOG"]).resolve()

#: Before a page begins: what its text, and not a block with `$ `, tells the reader to do.
BEFORE = {
    "README.md": "mbk simulate relaxed_sinusoidal --quiet --out trial.csv",
    "docs/guide/first_measurement.md": "mkdir -p build/demonstration && mbk simulate relaxed_sinusoidal --quiet "
                                       "--out build/demonstration/demonstration.mat",
    "docs/guide/reading_a_result.md": "mbk simulate relaxed_sinusoidal --quiet --out relaxed.h5 && "
                                      "mbk simulate rigid_sinusoidal_6N --quiet --out rigid.h5",
    "docs/guide/simulate.md": "mkdir -p build/trials",
}

#: (part of the command, why it is not run)
SKIPPED = [
    ("mbk validate", "takes minutes; each study has a test of its own"),
]


def blocks(page):
    """(line, command, shown output) of every command of a page."""
    text = (ROOT / page).read_text(encoding="utf-8")
    for block in re.finditer(r"^```\w*\n(\$ .*?)^```", text, re.S | re.M):
        line = text.count("\n", 0, block.start(1)) + 1
        for command, shown in commands_of(block[1]):
            yield line + block[1][:block[1].index(f"$ {command}")].count("\n"), command, shown


def commands_of(block):
    """(command, shown output) of a block that begins with `$ `."""
    for example in re.split(r"^\$ ", block, flags=re.M)[1:]:
        lines, command = example.splitlines(), ""
        while not command or command.endswith("\\\n") or command.count("'") % 2:
            command += lines.pop(0) + "\n"
        yield command.strip(), "\n".join(lines).rstrip()


def pattern(shown):
    lines = []
    for line in shown.split("\n"):
        if line.strip() == "…":
            lines.append(r"(?:.*\n)*?")
        else:
            lines.append(re.escape(line.rstrip()).replace("…", ".*") + r" *\n")
    return re.compile("".join(lines) + r"\Z")


class Shown(unittest.TestCase):
    maxDiff = None

    def check(self, page):
        with tempfile.TemporaryDirectory(prefix="mbk-page-") as name:
            folder = pathlib.Path(name)
            tools = folder / "build/release/bin"
            tools.mkdir(parents=True)
            for program in (MBK, MAKE_LOG):
                (tools / program.name).symlink_to(program)
            shutil.copytree(ROOT / "examples", folder / "examples")
            environment = {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "100"}

            def ran(command):
                return subprocess.run(["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True,
                                      timeout=280, check=False)

            if page in BEFORE:
                made = ran(BEFORE[page])
                self.assertEqual(made.returncode, 0, made.stderr)
            count = 0
            for line, command, shown in blocks(page):
                if any(part in command for part, _ in SKIPPED):
                    continue
                count += 1
                with self.subTest(f"{page}:{line}: {command}"):
                    process = ran(command)
                    self.assertIn(process.returncode, (0, 4), process.stderr)
                    printed = process.stdout.rstrip() + "\n"
                    if not pattern(shown).match(printed) and shown:
                        self.fail(f"{page}:{line} shows\n{shown}\n\nbut the command prints\n{printed}")
            self.assertGreater(count, 0, f"{page} shows no command that is run")


def add(page):
    name = "test_" + re.sub(r"\W", "_", page)
    setattr(Shown, name, lambda self: self.check(page))


for a_page in BEFORE:
    add(a_page)


class Pattern(unittest.TestCase):
    """The comparison itself can fail."""

    def test_another_digit_is_another_output(self):
        self.assertTrue(pattern("a 1.25\n…\nb").match("a 1.25\nx\ny\nb\n"))
        self.assertFalse(pattern("a 1.25\n…\nb").match("a 1.26\nx\nb\n"))
        self.assertFalse(pattern("a 1.25").match("a 1.25\nb\n"))

    def test_every_reason_to_skip_is_used(self):
        commands = [command for page in BEFORE for _, command, _ in blocks(page)]
        for part, why in SKIPPED:
            self.assertTrue(any(part in command for command in commands), f"nothing is skipped for '{part}': {why}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
