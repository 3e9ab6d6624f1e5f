#!/usr/bin/env python3
"""mbk.exe gives what mbk gives: under Wine, for all that needs no real time.

MBK names the program of Linux, MBK_WINDOWS that of Windows (docs/guide/windows.md says how it is built). Skipped where
mbk.exe or Wine is missing. By hand:
  MBK=build/release/bin/mbk MBK_WINDOWS=build/windows/bin/mbk.exe python3 tests/windows/windows_test.py
"""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77
RELATIVE = 1e-9  # of a number, as other libraries of mathematics round
ABSOLUTE = 1e-9  # of numbers near zero, in SI units
NOT_COMPARED = {"software", "input", "file", "files", "command", "created", "added", "time", "elapsed_s"}
WRONG_USAGE = 2
# What says how exact a fit is: differences of nearly equal numbers.
LOOSE = re.compile(r"gradient|condition|p_value|residual")

LINUX = os.environ.get("MBK", "")
WINDOWS = os.environ.get("MBK_WINDOWS", "")
WINE = shutil.which("wine64") or "/usr/lib/wine/wine64"
DATA = os.environ.get("MBK_DATA_DIR")


def wine_environment():
    folder = tempfile.mkdtemp(prefix="mbk-wine-")
    unittest.addModuleCleanup(shutil.rmtree, folder, True)
    # Wine takes the names of files for UTF-8 and the comma for the decimal sign.
    subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", f"{folder}/de_DE.UTF-8"], check=True)
    return {**os.environ, "WINEPREFIX": f"{folder}/wine", "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml=",
            "LOCPATH": folder, "LC_ALL": "de_DE.UTF-8"}


class Ran:
    def __init__(self, process):
        self.code = process.returncode
        self.bytes = process.stdout
        self.out = process.stdout.decode("utf-8")
        self.err = process.stderr.decode("utf-8", "replace")

    def __repr__(self):
        return f"exit {self.code}\n{self.out[:1500]}\n{self.err[:1500]}"


class Case(unittest.TestCase):
    maxDiff = 2000
    loose = False  # everything is

    @classmethod
    def setUpClass(cls):
        cls.environment = wine_environment()
        # Wine fills its folder at the first call, and says so.
        subprocess.run([WINE, WINDOWS, "--version"], env=cls.environment, stdin=subprocess.DEVNULL, timeout=600,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mbk-windows-"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, command, environment, where):
        return Ran(subprocess.run([*command], cwd=where or self.folder, env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=600, check=False))

    def windows(self, *arguments, where=None, **variables):
        return self.run_program([WINE, WINDOWS, *map(str, arguments)], {**self.environment, **variables}, where)

    def linux(self, *arguments, where=None):
        return self.run_program([LINUX, *map(str, arguments)], {**os.environ}, where)

    def both(self, *arguments):
        here, there = self.linux(*arguments), self.windows(*arguments)
        self.assertEqual(there.code, here.code, f"{arguments}\n{here}\n{there}")
        return here, there

    def assert_same(self, there, here, where="", beside=0.0):
        """Two documents of JSON, but for what names a file or a moment. beside: the largest number of the row"""
        if isinstance(here, dict):
            self.assertEqual(list(there), list(here), where)
            for key, value in here.items():
                if key not in NOT_COMPARED:
                    self.assert_same(there[key], value, f"{where}.{key}")
        elif isinstance(here, list):
            self.assertEqual(len(there), len(here), where)
            beside = max((abs(one) for one in here if isinstance(one, float)), default=0.0)
            for k, value in enumerate(here):
                self.assert_same(there[k], value, f"{where}[{k}]", beside)
        elif isinstance(here, float) or isinstance(there, float):
            scale = 1e3 if self.loose or LOOSE.search(where) else 1.0
            beside = beside if self.loose else 0.0
            self.assertTrue(math.isclose(there, here, rel_tol=scale * RELATIVE, abs_tol=scale * max(ABSOLUTE, RELATIVE * beside)),
                            f"{where}: {there!r} instead of {here!r}")
        elif isinstance(here, str) and isinstance(there, str) and re.search(r"\d", here):
            return  # a sentence with numbers
        else:
            self.assertEqual(there, here, where)

    def assert_same_documents(self, *arguments):
        here, there = self.both(*arguments)
        self.assertTrue(here.out, here)
        self.assert_same(json.loads(there.out), json.loads(here.out))

    def simulated(self, name="trial.csv", *options):
        file = self.folder / name
        file.parent.mkdir(exist_ok=True)
        made = self.linux("simulate", "relaxed_sinusoidal", "--seed", 7, "--out", file, "--quiet", *options)
        self.assertEqual(made.code, 0, made)
        return file


class Program(Case):
    def test_says_its_version_as_on_linux(self):
        here, there = self.both("--version")
        self.assertEqual(there.out.splitlines()[0], here.out.splitlines()[0])

    def test_prints_help_with_lines_that_end_as_on_linux(self):
        here, there = self.both("measure", "--help")
        self.assertEqual(there.bytes, here.bytes)

    def test_refuses_what_needs_real_time(self):
        for command in ("run", "validate", "reproduce", "work"):
            with self.subTest(command):
                for words in ((), ("--seed", 1), ("word", "--status")):
                    refused = self.windows(command, *words)
                    self.assertEqual(refused.code, WRONG_USAGE, refused)
                    self.assertIn("Linux", refused.err)

    def test_refuses_wrong_words_as_on_linux(self):
        here, there = self.both("measure", "nothing.csv", "--highpass", "x")
        self.assertEqual(there.err, here.err)


class Numbers(Case):
    @unittest.skipUnless(DATA, "MBK_DATA_DIR is not set")
    def test_of_the_golden_logs_are_those_of_linux(self):
        for log in sorted(pathlib.Path(DATA, "golden").glob("*.mat")):
            with self.subTest(log.name):
                self.assert_same_documents("measure", log, "--json")

    def test_of_every_instruction_set_are_the_same(self):
        file = self.simulated()
        plain = self.linux("measure", file, "--json")
        for simd in ("any", "v3"):
            with self.subTest(simd):
                there = self.windows("measure", file, "--json", MBK_SIMD=simd)
                self.assertEqual(there.code, plain.code, there)
                self.assert_same(json.loads(there.out), json.loads(plain.out))

    def test_of_other_commands_are_those_of_linux(self):
        file = self.simulated()
        for command in (("explore", file), ("identify", file), ("info", file)):
            with self.subTest(command[0]):
                self.loose = command[0] == "explore"  # whose deconvolutions magnify rounding
                self.assert_same_documents(*command, "--json")

    def test_are_simulated_as_on_linux(self):
        here = self.simulated()
        there = self.folder / "there.csv"
        made = self.windows("simulate", "relaxed_sinusoidal", "--seed", 7, "--out", there, "--quiet")
        self.assertEqual(made.code, 0, made)
        self.assertNotIn(b"\r", there.read_bytes())
        tables = [[line for line in file.read_text().splitlines() if not line.startswith("#")] for file in (here, there)]
        rows = [[[float(cell) for cell in line.split(",")] for line in table[1:]] for table in tables]
        self.assertEqual(tables[1][0], tables[0][0])
        self.assertEqual(len(rows[1]), len(rows[0]))
        for a, b in zip(*rows):
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y, delta=1e-7)


class Files(Case):
    @unittest.skipUnless(DATA, "MBK_DATA_DIR is not set")
    def test_of_others_are_read_as_on_linux(self):
        known = {".mat", ".csv", ".c3d", ".xdf", ".mcap"}
        for file in sorted(path for path in pathlib.Path(DATA).rglob("*") if path.suffix in known):
            with self.subTest(file.name):
                here, there = self.both("info", file, "--json")
                if here.out:
                    self.assert_same(json.loads(there.out), json.loads(here.out))

    def test_are_written_and_read_in_every_format(self):
        for end in (".h5", ".mat", ".csv"):
            with self.subTest(end):
                file = self.folder / f"made{end}"
                made = self.windows("simulate", "relaxed_sinusoidal", "--seed", 3, "--out", file, "--quiet")
                self.assertEqual(made.code, 0, made)
                self.assert_same_documents("measure", file, "--json")

    def test_have_names_of_any_language(self):
        file = self.simulated("Größe ß Übung/Жест 手.csv")
        out = file.with_name("ö ü.json")
        there = self.windows("measure", file, "--json", "--out", out)
        self.assertEqual(there.code, 0, there)
        here = self.linux("measure", file, "--json")
        self.assert_same(json.loads(out.read_text(encoding="utf-8")), json.loads(here.out))
        self.assertIn("手.csv", out.read_text(encoding="utf-8"))

    def test_are_not_replaced_unless_asked(self):
        file, out = self.simulated(), self.folder / "out.json"
        out.write_text("mine")
        refused = self.windows("measure", file, "--json", "--out", out)
        self.assertEqual((refused.code, out.read_text()), (WRONG_USAGE, "mine"), refused)
        done = self.windows("measure", file, "--json", "--out", out, "--overwrite")
        self.assertEqual(done.code, 0, done)
        self.assertEqual([path.name for path in self.folder.iterdir() if ".part" in path.name], [])

    def test_may_have_lines_that_end_as_windows_ends_them(self):
        file = self.simulated()
        other = self.folder / "crlf.csv"
        other.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
        here, there = self.linux("measure", file, "--json"), self.windows("measure", other, "--json")
        self.assertEqual(there.code, 0, there)
        mine, its = json.loads(here.out), json.loads(there.out)
        for document in (mine, its):
            for source in document.get("inputs", []):
                source.pop("sha256", None)
        self.assert_same(its, mine)

    def test_are_named_by_patterns(self):
        for k in range(3):
            self.simulated(f"log{k}.csv")
        self.assert_same_documents("measure", "log*.csv", "--json")


class Library(Case):
    def test_is_called_from_c(self):
        ran = self.run_program([WINE, pathlib.Path(WINDOWS).with_name("mbk_c_test.exe")], self.environment, None)
        self.assertEqual(ran.code, 0, ran)


class Places(Case):
    def test_with_a_decimal_comma_change_no_number(self):
        file = self.simulated()
        comma = self.windows("measure", file, "--json")
        point = self.windows("measure", file, "--json", LC_ALL="C")
        self.assertEqual((comma.code, comma.bytes), (point.code, point.bytes))


class Reports(Case):
    def test_are_those_of_linux(self):
        file = self.simulated()
        pages = []
        for run, name in ((self.linux, "here.html"), (self.windows, "there.html")):
            made = run("measure", file, "--report", self.folder / name)
            if "MBK_WEB" in made.err or "built without" in made.err:
                self.skipTest("built without pages")
            self.assertEqual(made.code, 0, made)
            pages.append((self.folder / name).read_bytes())
        self.assertNotIn(b"\r\n", pages[1][-1000:])
        self.assertLess(abs(len(pages[1]) - len(pages[0])), 0.01 * len(pages[0]))
        self.assertTrue(pages[1].startswith(pages[0][:200]))

    def test_have_charts(self):
        file = self.simulated()
        charts = self.folder / "charts"
        made = self.windows("measure", file, "--charts", charts)
        self.assertEqual(made.code, 0, made)
        self.assertTrue(list(charts.rglob("*.svg")))


class Studies(Case):
    def test_store_measure_and_summarise(self):
        study = self.folder / "Studie Ä"
        made = self.windows("study", "init", study, "--title", "Größe")
        self.assertEqual(made.code, 0, made)
        for person in (1, 2, 3):
            for session in (1, 2):
                file = self.folder / f"p{person}s{session}.h5"
                seed = 10 * person + session
                self.linux("simulate", "relaxed_sinusoidal", "--seed", seed, "--out", file, "--quiet")
                added = self.windows("study", "add", file, "--participant", person, "--session", session, "--study",
                                     study, "--quiet")
                self.assertEqual(added.code, 0, added)
        for command in (("measure", "--quiet"), ("check",)):
            ran = self.windows("study", *command, "--study", study)
            self.assertEqual(ran.code, 0, ran)
        self.assert_same_documents("study", "summary", "--study", study, "--json")
        backup = self.windows("study", "backup", self.folder / "copy", "--study", study)
        self.assertEqual(backup.code, 0, backup)
        checked = self.linux("study", "check", "--study", self.folder / "copy")
        self.assertEqual(checked.code, 0, checked)
        page = self.folder / "study.html"
        report = self.windows("study", "report", "--study", study, "--out", page)
        self.assertEqual(report.code, 0, report)
        self.assertIn("Größe", page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    if not (LINUX and WINDOWS and pathlib.Path(WINDOWS).is_file() and pathlib.Path(WINE).is_file()):
        print("skipped: MBK_WINDOWS names no mbk.exe, or Wine is missing")
        sys.exit(SKIPPED)
    unittest.main()
