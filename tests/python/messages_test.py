#!/usr/bin/env python3
"""Errors and warnings name options and commands as Python writes them: rate=1000 for --rate 1000, mbk.info() for
'mbk info'."""

import json
import os
import pathlib
import re
import tempfile
import unittest
import warnings

import mbk
import numpy as np
from mbk import _mbk

TERMINAL = re.compile(r"'mbk [^']*' in a terminal")
SHELL = re.compile(r"(?<![\w./-])--[a-z]|'mbk ")
TIME = np.arange(5000) / 1000
SINE = 0.01 * np.sin(6 * TIME)

ERRORS = (  # a call, and what its error must contain
    (lambda: mbk.measure("log.mat", mode="fast"), ("mode: ", "help(mbk.measure)")),
    (lambda: mbk.measure("log.mat", sg_window=4), ("sg_window: ", "help(mbk.measure)")),
    (lambda: mbk.measure("log.mat", trial=7), ("trial=7",)),
    (lambda: mbk.measure("log.mat", side="left"), ('side="left"',)),
    (lambda: mbk.measure("log.mat", from_=500), ("from_=500 s", "from_=…")),
    (lambda: mbk.measure("log.mat", split=500), ("split=500",)),
    (lambda: mbk.measure("log.mat", cutoff=900), ("cutoff=…",)),
    (lambda: mbk.measure("log.mat", procedure="chapter3"), ('mode="reference"', "procedure=…")),
    (lambda: mbk.measure("log.mat", arm=(0.3, -0.57, 0.31, 0.34)), ('domain="joint"', "report=…")),
    (lambda: mbk.measure("log.mat", channels="x"), ('channels="x=',)),
    (lambda: mbk.measure("names.csv"), ('channels="time=',)),
    (lambda: mbk.measure({"x": SINE, "F": SINE}), ("rate=1000", 'channels="time=1,…"')),
    (lambda: mbk.measure({"time": TIME, "u": SINE, "v": SINE}), ('channels="time=',)),
    (lambda: mbk.measure({"time": TIME, "x": SINE, "F": SINE}, parts=True), ("parts=True",)),
    (lambda: mbk.measure({"time": TIME, "x": SINE, "F": np.cos(6 * TIME)}, method="iv"), ('method="ls"',)),
    (lambda: mbk.measure(), ("help(mbk.measure)",)),
    (lambda: mbk.ellipse("names.csv"), ("mbk.measure().save(",)),
    (lambda: mbk.tf("log.mat", input="Fx", output="x"), ("poles=4, zeros=3", 'orders="1:4"')),
    (lambda: mbk.simulate("relaxed_sinusoidal", out="log.mat"), ("overwrite=True",)),
    (lambda: mbk.simulate("no_such_scenario"), ("mbk.simulate(list=True)",)),
    (lambda: mbk.study.list(study="nowhere"), ("mbk.study.init(FOLDER)",)),
    (lambda: mbk.robot.workspace(at=(1, 2, 3)), ('at="1,2,3"', 'at="300,50"')),
)
TEXTS = (  # a message for the command line, and for Python
    ("pass --rate HZ, or --rate 1000 if it is right", "pass rate=HZ, or rate=1000 if it is right"),
    ("name them with --channels x=2,y=3.", 'name them with channels="x=2,y=3".'),
    ("choose --from and --to inside it", "choose from_=… and to=… inside it"),
    ("as in --condition relaxed", 'as in condition="relaxed"'),
    ("say which, as in --clock '/force'; the others", 'say which, as in clock="/force"; the others'),
    ("add --input=-Fx --output hand_x --pool", 'add input="-Fx", output="hand_x", pool=True'),
    ("--force-source sensor", 'force_source="sensor"'),
    ("unknown option '--rates'; did you mean '--rate'?", "unknown option '--rates'; did you mean 'rate'?"),
    ("a--from.csv --no-such-option", "a--from.csv --no-such-option"),
    ("'mbk info' lists them", "mbk.info() lists them"),
    ("give a file that 'mbk measure --json' wrote", "give a file that mbk.measure().save(…) wrote"),
    ("write 'mbk measure FILE --json --out a.json'", 'write mbk.measure(FILE).save("a.json")'),
    ("'mbk study import' with --sheet", "mbk.study.import_() with sheet=…"),
    ("see 'mbk study add --help'", "see help(mbk.study.add)"),
    ("'mbk new channels FILE' asks", "'mbk new channels FILE' in a terminal asks"),
    ("it is called 'mbk log.mat'", "it is called 'mbk log.mat'"),
)


class Messages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="mbk-messages-")
        cls.addClassCleanup(temporary.cleanup)
        cls.addClassCleanup(os.chdir, os.getcwd())
        os.chdir(temporary.name)
        mbk.simulate("relaxed_sinusoidal", out="log.mat")
        rows = "".join(f"{k / 1000},{np.sin(k / 50)},{np.cos(k / 50)}\n" for k in range(3000))
        pathlib.Path("names.csv").write_text("u,v,w\n" + rows, encoding="utf-8")

    def assert_python(self, text):
        self.assertNotRegex(TERMINAL.sub("", text), SHELL)

    def test_errors_name_arguments_of_functions(self):
        for call, fragments in ERRORS:
            with self.subTest(fragments), self.assertRaises(mbk.Error) as caught:
                call()
            error = caught.exception
            for text in (str(error), error.file, error.what, error.hint):
                self.assert_python(text)
            for fragment in fragments:
                self.assertIn(fragment, str(error))

    def test_texts_are_translated_word_by_word(self):
        for text, expected in TEXTS:
            with self.subTest(text):
                self.assertEqual(_mbk.in_python(text), expected)

    def test_every_option_and_every_command_is_translated(self):
        for command in json.loads(_mbk.describe())["commands"]:
            typed = "mbk " + " ".join(command["path"])
            with self.subTest(typed):
                made = _mbk.in_python(f"run '{typed}' first")
                self.assert_python(made)
                self.assertEqual("in a terminal" in made, command["path"][0] in ("run", "new", "work", "completion", "manual"))
            for option in command["options"]:
                with self.subTest(option["names"][-1]):
                    self.assert_python(_mbk.in_python(f"choose {option['names'][-1]}, or omit it"))

    def test_warnings_give_advice_as_python_writes_it(self):
        noise = np.random.default_rng(1).normal(size=TIME.size)
        seen = 0
        for sources, options in (({"time": TIME, "x": SINE, "F": noise}, {}), ("log.mat", {"to": 8.0}),
                                 ({"time": TIME, "x": SINE, "F": SINE, "xr": SINE}, {})):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                found = mbk.measure(sources, **options)
            shown = {one.message.code: one.message.text for one in caught if isinstance(one.message, mbk.MbkWarning)}
            page = found._repr_html_()
            self.assert_python(re.sub("&#x27;", "'", page))
            for one in found.to_dict()["warnings"]:
                with self.subTest(one["code"]):
                    self.assert_python(shown[one["code"]])
                    self.assertTrue(shown[one["code"]].endswith(_mbk.in_python(one["try"])))
                    seen += bool(SHELL.search(one["try"]))
        self.assertGreater(seen, 0, "no advice that names an option")


if __name__ == "__main__":
    unittest.main()
