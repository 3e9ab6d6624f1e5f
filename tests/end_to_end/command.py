"""What every end-to-end test needs: the built programs, a folder of its own, and what a refusal must look like.

The programs are named by the environment: MBK and MAKE_LOG (set by CTest). By hand:
  MBK=build/release/bin/mbk MAKE_LOG=build/release/bin/make_log python3 tests/end_to_end/info_test.py
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

import mat_file
import schemas

SKIPPED = 77  # exit code of a file whose tests were all skipped; CTest reports it as such
FINE, FALLS_SHORT, WRONG_USAGE, BAD_DATA, NOT_USABLE, NOT_SHOWN = 0, 1, 2, 3, 4, 6
LONGEST_LINE = 100  # columns of a terminal window
COLUMNS = ("time", "x", "y", "Fx", "Fy", "xr", "yr")
LOGS_ROWS = (0, 1, 2, 9, 10, 11, 12)  # where these stand in a logs matrix


class Ran:
    """What a program wrote and how it ended."""

    def __init__(self, process, name):
        self.code, self.name = process.returncode, name
        self.bytes = process.stdout
        self.out = process.stdout.decode("utf-8")
        self.err = process.stderr.decode("utf-8")

    @property
    def json(self):
        return json.loads(self.out)

    def __repr__(self):
        return f"{self.name}\nexit {self.code}\n--- stdout\n{self.out[:1500]}\n--- stderr\n{self.err[:1500]}"


def program(variable):
    path = os.environ.get(variable)
    if not path:
        sys.exit(f"set {variable} to the path of that program; ctest does so by itself")
    return path


def run(*arguments, folder=None, timeout=120, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, environment=None):
    """mbk with these arguments, in `folder`, with `environment` beside what is set. A JSON document that it prints or
    writes has to fit its schema."""
    arguments = [argument if isinstance(argument, bytes) else str(argument) for argument in arguments]
    process = subprocess.run([program("MBK"), *arguments], cwd=folder, stdin=stdin, stdout=stdout,
                             stderr=subprocess.PIPE, timeout=timeout, check=False,
                             env=None if environment is None else {**os.environ, **environment})
    if process.stdout is None:
        process.stdout = b""
    ran = Ran(process, "mbk " + " ".join(map(str, arguments)))
    schemas.check_printed(ran.out)
    if "--json" in arguments and "--out" in arguments and ran.code in (FINE, NOT_USABLE):
        out = pathlib.Path(folder or ".", arguments[arguments.index("--out") + 1])
        if out.is_file():
            schemas.check_printed(out.read_text(encoding="utf-8"))
    return ran


@functools.lru_cache(maxsize=None)
def folder_of_logs():
    folder = tempfile.TemporaryDirectory(prefix="mbk-logs-")
    unittest.addModuleCleanup(folder.cleanup)
    return pathlib.Path(folder.name)


class Log:
    """A recording that make_log wrote, and the truth that it printed."""

    def __init__(self, path, printed):
        self.path = path
        self.truth = {}
        rows = None
        for line in printed.splitlines()[1:]:
            symbol, numbers = re.match(r"  (\w*)\s+(?:kg|N\.s/m|N/m|m)?\s*(-?\d.*)", line).groups()
            rows = self.truth.setdefault(symbol, []) if symbol else rows
            rows.append([float(number) for number in numbers.split()])
        self.truth["x0"] = self.truth["x0"][0]


def make_log(protocol="sinusoidal", *options):
    """A log of 62 s or more, written once for each test file."""
    return made_log(protocol, *options)


@functools.lru_cache(maxsize=None)
def made_log(protocol, *options):
    path = folder_of_logs() / f"{'_'.join([protocol, *options]).replace('--', '')}.mat"
    process = subprocess.run([program("MAKE_LOG"), "--protocol", protocol, *options, "--out", path],
                             capture_output=True, text=True, timeout=120, check=True)
    return Log(path, process.stdout)


@functools.lru_cache(maxsize=None)
def table_of(log, samples=None):
    """The columns of a two-axis log: time, hand, force, reference; the first `samples` of them."""
    rows = mat_file.read(log.path)["logs"]
    return [tuple(rows[k][:samples]) for k in LOGS_ROWS]


def write_csv(path, columns, names=COLUMNS, separator=","):
    """Every digit of the numbers, so that nothing is lost on the way."""
    lines = [separator.join(names)] if names else []
    lines += [separator.join(map(repr, row)) for row in zip(*columns)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def flat(value):
    """The numbers of a list of lists."""
    return [number for item in value for number in flat(item)] if isinstance(value, list) else [value]


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="mbk-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def mbk(self, *arguments, code=FINE, **options):
        """Runs mbk and asks for an exit code."""
        ran = run(*arguments, **options)
        self.assertEqual(ran.code, code, ran)
        return ran

    def fine(self, *arguments, **options):
        """Succeeds without a message, except for the names of files that it wrote."""
        ran = self.mbk(*arguments, **options)
        self.assertEqual(re.sub(r"(?m)^mbk: wrote .*\n", "", ran.err), "", ran)
        return ran

    def refused(self, code, *arguments, says=(), **options):
        """mbk refuses: the exit code, one short line on stderr that holds every word of `says`, nothing on stdout."""
        ran = self.mbk(*arguments, code=code, **options)
        self.assertEqual(ran.out, "", ran)
        refusal = re.sub(r"(?m)^mbk: warning: .*\n", "", ran.err)
        self.assertRegex(refusal, r"\Ambk: [^\n]+\n\Z", ran)
        self.assertLess(len(refusal), 600, ran)
        self.assertNotRegex(ran.err, r"\d{25}", ran)
        for words in [says] if isinstance(says, str) else says:
            self.assertIn(words, ran.err, ran)
        return ran

    def bad_data(self, file, *options, says=(), command="measure"):
        """Refused as bad data; the line names the file, what is wrong and, after a semicolon, what to do."""
        ran = self.refused(BAD_DATA, command, file, *options, says=says)
        self.assertIn(str(file), ran.err, ran)
        self.assertRegex(ran.err, r"; \w", f"no word of what to do in: {ran.err}")
        return ran

    def file(self, name, content):
        path = self.folder / name
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            path.write_text(content, encoding="utf-8")
        return path

    def names(self):
        """What is in the test's folder, hidden files too."""
        return sorted(os.listdir(self.folder))

    def assert_relative(self, got, want, tolerance):
        """Every number within `tolerance` of the largest in `want`."""
        got, want = flat(got), flat(want)
        self.assertEqual(len(got), len(want))
        scale = max(map(abs, want))
        for one, other in zip(got, want):
            self.assertLessEqual(abs(one - other), tolerance * scale, (got, want))

    def assert_lines_fit(self, text, longest=LONGEST_LINE):
        for line in text.splitlines():
            self.assertLessEqual(len(line), longest, line)


def data_folder(*parts):
    """A folder of outside recordings; the test is skipped where there is none."""
    root = os.environ.get("MBK_DATA_DIR")
    if not root:
        raise unittest.SkipTest("MBK_DATA_DIR is not set")
    return pathlib.Path(root).joinpath(*parts)


def is_root():
    return hasattr(os, "geteuid") and os.geteuid() == 0


def copy(source, target):
    return pathlib.Path(shutil.copyfile(source, target))


def main():
    """unittest.main, with an exit code of its own where every test was skipped."""
    result = unittest.main(module="__main__", exit=False).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if len(result.skipped) >= max(result.testsRun, 1) else 0)
