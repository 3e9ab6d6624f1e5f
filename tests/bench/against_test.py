#!/usr/bin/env python3
"""bench/against.py: the intervals of ratios, turns, and what two programs of known speed come out as."""

import math
import os
import pathlib
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))

import against
import commands

PROGRAM = """#!{python} -S
import pathlib, sys
with open("order", "a") as order:
    order.write("{letter}")
total = 0
for k in range({loops}):
    total += k * k
sys.exit({code})
"""


class Intervals(unittest.TestCase):
    def test_ranks_hold_the_median_with_95_percent_and_one_rank_less_would_not(self):
        for n in range(6, 60):
            low, high = against.interval(list(range(1, n + 1)))
            self.assertEqual(low + high, n + 1)

            def coverage(rank):
                return 1.0 - 2.0 * sum(math.comb(n, k) for k in range(rank)) / 2.0 ** n

            self.assertGreaterEqual(coverage(low), 0.95)
            self.assertLess(coverage(low + 1), 0.95)

    def test_verdicts(self):
        quiet = [0.99, 1.0, 1.01, 1.0, 0.99, 1.01, 1.0]
        for factor, said in ((1.2, "slower"), (0.8, "faster"), (1.0, "no difference shown"),
                             (1.005, "no difference shown")):
            self.assertEqual(against.verdict([factor * one for one in quiet], quiet), said, factor)
        noisy = [0.7, 1.3, 1.0, 0.8, 1.25, 0.9, 1.1]
        self.assertEqual(against.verdict([1.2 * one for one in quiet], noisy), "no difference shown")


class Programs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="mbk-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def program(self, letter, loops, code=0):
        path = self.folder / letter
        path.write_text(PROGRAM.format(python=sys.executable, letter=letter, loops=loops, code=code), encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def rounds(self, before, now, count=6):
        return against.rounds_of(before, now, commands.Command("it", []), self.folder, count)

    def test_they_take_turns_and_each_place_is_everybodys(self):
        self.rounds(self.program("a", 1), self.program("b", 1), 2)
        self.assertEqual((self.folder / "order").read_text(), "aba" "baa" "aab")

    def test_what_works_twice_as_much_is_slower(self):
        found = self.rounds(self.program("a", 300_000), self.program("b", 2_000_000))
        line = against.line("it", found)
        self.assertIn("slower", line)
        self.assertEqual(len(found), 6)

    def test_a_program_that_fails_is_named(self):
        with self.assertRaisesRegex(against.Failed, "the build before: exit code 3"):
            self.rounds(self.program("a", 1, 3), self.program("b", 1))
        with self.assertRaisesRegex(against.Failed, "the present build: exit code 2"):
            self.rounds(self.program("a", 1), self.program("b", 1, 2))

    def test_a_build_that_is_not_there_is_refused(self):
        ran = subprocess.run([sys.executable, "-B", BENCH / "against.py", "--before", self.folder, "--now", self.folder],
                             capture_output=True, text=True, check=False)
        self.assertNotEqual(ran.returncode, 0)
        self.assertIn("is not there", ran.stderr)


LISTS = """cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES C)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
add_executable(mbk mbk.c)
add_executable(make_log mbk.c)
"""
PRESETS = """{"version": 6,
 "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/release",
                       "cacheVariables": {"CMAKE_BUILD_TYPE": "Release"}}],
 "buildPresets": [{"name": "release", "configurePreset": "release"}]}
"""
SOURCE = "int main(void) { volatile double sum = 0; for (long k = 0; k < %d; ++k) sum += k; return 0; }\n"


@unittest.skipUnless(all(map(shutil.which, ("git", "cmake", "ninja", "cc"))), "git, cmake, ninja and cc are needed")
class Tool(unittest.TestCase):
    """tools/bench --against, in a small repository of its own, whose program became faster with its last commit."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="mbk-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for file in ("tools/bench", "tools/lib.sh", "tools/install-packages", "tools/packages", "bench/against.py",
                     "bench/commands.py"):
            (self.root / file).parent.mkdir(exist_ok=True)
            shutil.copy(BENCH.parent / file, self.root / file)
        for name, text in (("CMakeLists.txt", LISTS), ("CMakePresets.json", PRESETS), (".gitignore", "build/\n"),
                           ("mbk.c", SOURCE % 40_000_000)):
            (self.root / name).write_text(text, encoding="utf-8")
        self.git("init", "--quiet")
        self.commit("slow")
        (self.root / "mbk.c").write_text(SOURCE % 10_000_000, encoding="utf-8")
        self.commit("fast")

    def git(self, *arguments):
        ran = subprocess.run(["git", "-c", "user.name=test", "-c", "user.email=test@example.org", *arguments],
                             cwd=self.root, capture_output=True, text=True, check=True)
        return ran.stdout.strip()

    def commit(self, message):
        self.git("add", "--all")
        self.git("commit", "--quiet", "--message", message)

    def bench(self, *arguments):
        return subprocess.run([self.root / "tools/bench", "--against", *arguments], capture_output=True, text=True,
                              check=False, env={**os.environ, "MBK_SKIP_PACKAGES": "1"})

    def test_it_builds_both_and_compares_them(self):
        ran = self.bench("HEAD~1", "--rounds", "6", "--only", "start")
        self.assertEqual(ran.returncode, 0, ran)
        self.assertRegex(ran.stdout, r"(?m)^  start .* faster$")
        before = self.git("rev-parse", "HEAD~1")
        self.assertEqual([path.name for path in (self.root / "build/against").iterdir()], [before])
        self.assertEqual(len(self.git("worktree", "list").splitlines()), 1)
        self.assertEqual(self.git("status", "--short"), "")
        again = self.bench("HEAD~1", "--rounds", "6", "--only", "start")
        self.assertEqual(again.stdout.count("configuring"), 1, again)

    def test_what_is_no_commit_or_cannot_be_built_is_refused(self):
        self.assertIn("there is no commit 'nothing'", self.bench("nothing").stderr)
        (self.root / "mbk.c").write_text("int main(void) { return }\n", encoding="utf-8")
        self.commit("broken")
        ran = self.bench("HEAD")
        self.assertNotEqual(ran.returncode, 0)
        self.assertIn("cannot be built", ran.stderr)
        self.assertEqual(len(self.git("worktree", "list").splitlines()), 1)


if __name__ == "__main__":
    unittest.main()
