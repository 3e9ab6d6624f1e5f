#!/usr/bin/env python3
"""Every command of the guide's table beside its twin in Python: the same document to the bit, the same text, the same
file. The table is docs/guide/python.md; each command that can be called has a row in it."""

import json
import os
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/end_to_end"))
import journal_file  # noqa: E402
import mbk  # noqa: E402
import movement_test  # noqa: E402
import sensor_delay_test  # noqa: E402
import sensor_test  # noqa: E402
import springs_test  # noqa: E402

MBK = os.environ["MBK"]
TABLE = re.search(r"## Commands and their Python equivalents\n(.*?)\n\n", (ROOT / "docs/guide/python.md").read_text(encoding="utf-8"),
                  re.DOTALL)[1]
TWINS = [(line.replace("\\|", "|"), python) for line, python in re.findall(r"^\| `(mbk .*)` \| `(.*)` \|$", TABLE, re.M)]
COMMANDS = {" ".join(one["path"]): one for one in json.loads(mbk._mbk.describe())["commands"]}
WITH_DOCUMENT = {name for name, one in COMMANDS.items() if "--json" in [option["names"][-1] for option in one["options"]]}


def command_of(words):
    """The name of the command that a line begins with."""
    return next(name for name in (" ".join(words[:2]), words[0]) if name in COMMANDS)


def command(*words, folder):
    process = subprocess.run([MBK, *map(str, words)], cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    if process.returncode in (2, 3):
        raise AssertionError(f"{words}: exit {process.returncode}\n{process.stderr}")
    return process.stdout


def make_files(folder):
    """What the table's commands read."""
    command("simulate", "relaxed_sinusoidal", "--quiet", "--out", "log.mat", folder=folder)
    command("simulate", "relaxed_sinusoidal", "--seed", 2, "--quiet", "--out", "other.mat", folder=folder)
    shutil.copy(folder / "other.mat", folder / "p08_s1_relaxed.mat")
    command("simulate", "free_motion", "--quiet", "--out", "free.h5", folder=folder)
    (folder / "mass.toml").write_text(sensor_delay_test.MASS)
    command("simulate", "mass.toml", "--quiet", "--out", "mass.h5", folder=folder)
    (folder / "trial.h5.journal").write_bytes(b"".join(journal_file.pieces(8)))
    (folder / "result.json").write_text(command("measure", "log.mat", "--json", "--quiet", folder=folder))
    (folder / "other.json").write_text(command("measure", "other.mat", "--json", "--quiet", folder=folder))
    (folder / "robot.json").write_text(command("robot", "identify", "free.h5", "--json", "--quiet", folder=folder))
    (folder / "spring.csv").write_text(springs_test.stretch(150))
    rows = [f"{fx},{fy},{vx!r},{vy!r}" for cell in [sensor_test.Cell()] for fx, fy in sensor_test.loads()
            for vx, vy in [cell.voltages(fx, fy)]]
    (folder / "loads.csv").write_text("Fx,Fy,Vx,Vy\n" + "\n".join(rows) + "\n")
    movement_test.write_reaches(folder / "reach.csv")
    shutil.copy(ROOT / "examples/robots/double_pendulum.toml", folder / "planar.toml")
    shutil.copy(ROOT / "examples/robots/double_pendulum.urdf", folder)
    shutil.copy(ROOT / "examples/robots/thesis.toml", folder)
    shutil.copy(ROOT / "examples/teleop/telerehabilitation.toml", folder)
    noise = random.Random(1)
    lines, angle, speed = ["time,position_rad,torque_Nm"], 0.0, 0.0
    for k in range(20000):  # a joint of 0.01 kg·m², 0.1 N·m·s/rad, 5 N·m/rad, moved by a filtered noise
        acceleration = noise.gauss(0, 4.0) - 30.0 * angle - 8.0 * speed
        speed += 1e-3 * acceleration
        angle += 1e-3 * speed
        lines.append(f"{k / 1000},{angle!r},{-(0.01 * acceleration + 0.1 * speed + 5.0 * angle)!r}")
    (folder / "wrist.csv").write_text("\n".join(lines) + "\n")


def without_time(text):
    """The log of a study says when each line was written, and what follows from that."""
    text = re.sub(r'"(time|hash|head|digest)": "[^"]*"', r'"\1": ""', text)
    text = re.sub(r"head [0-9a-f]{64}", "head", text)
    return re.sub(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d\S*", "", text)


class Twins(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        made = tempfile.TemporaryDirectory(prefix="mbk-twins-")
        cls.addClassCleanup(made.cleanup)
        cls.shell, cls.python = pathlib.Path(made.name, "shell"), pathlib.Path(made.name, "python")
        cls.shell.mkdir()
        make_files(cls.shell)
        shutil.copytree(cls.shell, cls.python)  # each has a folder of its own, with the same files under the same names

    def test_every_command_that_can_be_called_has_one(self):
        have = {command_of(shlex.split(line)[1:]) for line, _ in TWINS}
        self.assertEqual(have, {name for name, one in COMMANDS.items() if one["callable"]})

    def test_python_knows_every_command_of_the_programs_help(self):
        listed = re.findall(r"^  ([a-z]+) {2,}", command("--help", folder=self.shell), re.MULTILINE)
        self.assertEqual({name.split()[0] for name in COMMANDS}, set(listed))

    def test_the_guides_own_lines_run(self):
        text = (ROOT / "docs/guide/python.md").read_text(encoding="utf-8")
        reference = text[text.index("## Install"):]  # above it: tests/documents/tutorials_test.py
        blocks = [block for block in re.findall(r"^```python\n(.*?)^```", reference, re.DOTALL | re.MULTILINE)
                  if "mbk.live" not in block]
        self.assertEqual(len(blocks), 3)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.python)
        names = {"mbk": mbk}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for block in blocks:
                with self.subTest(block):
                    exec(block, names)  # noqa: S102 - the guide's own lines
        self.assertTrue(names["result"].usable)
        self.assertAlmostEqual(names["result"].model.K[0, 0], 120, delta=1)

    def test_both_say_the_same_to_the_bit(self):
        self.assertGreater(len(TWINS), 30)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        for line, python in TWINS:
            with self.subTest(line):
                words = shlex.split(line)[1:]
                shown = command(*words, *(["--json"] if command_of(words) in WITH_DOCUMENT else []), folder=self.shell)
                os.chdir(self.python)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    got = eval(python, {"mbk": mbk})  # noqa: S307 - the guide's own lines
                if isinstance(got, mbk.Document):
                    self.assertEqual(without_time(got.json), without_time(shown))
                    self.assertEqual(got.to_dict(), json.loads(got.json))
                elif isinstance(got, pathlib.Path):
                    self.assertEqual((self.python / got).read_bytes(), (self.shell / got).read_bytes())
                else:
                    self.assertEqual(without_time(str(got)), without_time(shown))


if __name__ == "__main__":
    unittest.main()
