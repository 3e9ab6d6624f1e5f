#!/usr/bin/env python3
"""Types and examples of the package: mypy --strict accepts it and a script that uses it, and refuses a wrong one; the
examples of the documentation (doctest) run as they stand."""

import doctest
import importlib
import importlib.util
import os
import pathlib
import pkgutil
import subprocess
import sys
import tempfile
import unittest

import mbk

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(mbk.__file__).parent
RIGHT = """
import mbk
import numpy as np

recording = mbk.Recording(time=np.arange(10.0), x=np.zeros(10), F=np.zeros(10))
first: float = float(recording["x"][0])
found = mbk.measure(recording, mode="reference", sg_window=151, cutoff="none", from_=1.0, channels={"x": "x:mm"})
mbk.teleop("design.toml", operator=mbk.load("result.json"))
print(found.model.K, found.to_dict()["model"], first)
"""
WRONG = (('mbk.measure("a.mat", mode="fast")', "mode"), ('mbk.measure("a.mat", sg_window="wide")', "sg_window"),
         ('mbk.measure("a.mat", no_such_option=1)', "no_such_option"), ("mbk.measure(3.5)", "measure"),
         ('mbk.simulate("a", seed=1.5)', "seed"))


class Types(unittest.TestCase):
    def mypy(self, *arguments, folder=None):
        return subprocess.run([sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", *arguments],
                              cwd=folder or PACKAGE.parent, capture_output=True, text=True, check=False, timeout=300,
                              env={**os.environ, "MYPYPATH": str(PACKAGE.parent), "MYPY_CACHE_DIR": self.cache})

    @classmethod
    def setUpClass(cls):
        if importlib.util.find_spec("mypy") is None:
            raise unittest.SkipTest("there is no mypy; Debian has python3-mypy")
        cache = tempfile.TemporaryDirectory(prefix="mbk-mypy-")
        cls.addClassCleanup(cache.cleanup)
        cls.cache = cache.name

    def test_the_package_is_strict(self):
        ran = self.mypy("-p", "mbk")
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_scripts_are_checked_by_it(self):
        with tempfile.TemporaryDirectory() as name:
            script = pathlib.Path(name, "script.py")
            script.write_text(RIGHT)
            ran = self.mypy(script, folder=name)
            self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
            script.write_text("import mbk\n" + "\n".join(line for line, _ in WRONG) + "\n")
            ran = self.mypy(script, folder=name)
            for number, (line, word) in enumerate(WRONG, start=2):
                with self.subTest(line):
                    self.assertRegex(ran.stdout, rf'script\.py:{number}: error: .*"{word}"')


class Documentation(unittest.TestCase):
    def modules(self):
        return [mbk, *(importlib.import_module(f"mbk.{one.name}") for one in pkgutil.iter_modules(mbk.__path__))]

    def test_examples_run(self):
        tried = 0
        for module in self.modules():
            with self.subTest(module.__name__):
                failed, count = doctest.testmod(module, extraglobs={"mbk": mbk}, optionflags=doctest.NORMALIZE_WHITESPACE)
                self.assertEqual(failed, 0)
                tried += count
        self.assertGreaterEqual(tried, 8)

    def test_everything_that_is_exported_says_what_it_is(self):
        for name in mbk.__all__:
            with self.subTest(name):
                thing = getattr(mbk, name)
                self.assertTrue((thing.__doc__ or "").strip(), name)
        for name in ("measure", "transfer_function", "read", "live"):
            text = getattr(mbk, name).__doc__
            for heading in ("Parameters\n    ----------", "Returns\n    -------"):
                self.assertIn(heading, text)


if __name__ == "__main__":
    unittest.main()
