#!/usr/bin/env python3
"""The guard of bench/instructions.py: it fails where a command costs more than 3 % more, and names the functions."""

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))

import callgrind
import commands
import instructions

# main calls filter twice (400 each) and report (150); filter calls itself, and clear, which stands in another file.
PROFILE = """# callgrind format
version: 1
creator: callgrind-3.19.0
cmd: mbk measure recording.mat
part: 1

positions: line
events: Ir
summary: 1000

ob=(1) /usr/bin/mbk
fl=(1) main.cpp
fn=(1) main
0 40
cfi=(2) filter.cpp
cfn=(2) void mbk::dsp::(anonymous namespace)::filter<4ul>(double const*, long)
calls=2 0
* 800
cfn=(3) mbk::report::text(mbk::Findings const&) [clone .isra.0]
calls=1 0
* 150
+0 10

fl=(2)
fn=(2)
0 500
cfn=(2)
calls=3 0
0 200
cob=(2) /usr/lib/libc.so.6
cfi=(3) memset.S
cfn=(4) __memset_avx2_unaligned_erms
calls=4 0
0 300

fl=(3)
fn=(4)
0 300

fl=(4) text.cpp
fn=(3)
0 150

totals: 1000
"""


def figures(scale=1.0, profile=PROFILE, name="measure"):
    """Figures from which the profile is 1/scale of what they say."""
    kept = instructions.figure_of(callgrind.read(profile))
    kept["instructions"] = round(scale * kept["instructions"])
    kept["functions"] = {one: [round(scale * value) for value in both] for one, both in kept["functions"].items()}
    return {"made_with": {"compiler": "GNU 12.2.0"}, "commands": {name: kept}}


class Names(unittest.TestCase):
    def test_no_template_arguments_parameters_or_suffixes(self):
        for name, short in (
                ("main", "main"), ("(below main)", "(below main)"),
                ("mbk::analyse::largest_shortage(mbk::X const&, std::span<double const, 1ul>) [clone .isra.0]",
                 "mbk::analyse::largest_shortage"),
                ("void mbk::dsp::(anonymous namespace)::run<2ul>(double*)", "mbk::dsp::run"),
                ("operator new(unsigned long)", "operator new"), ("bool a::operator<(a::B const&, a::B const&)", "a::operator<"),
                ("std::ostream& std::operator<< <std::char_traits<char> >(std::ostream&, char const*)", "std::operator<<"),
                ("mbk::Result<void> mbk::f<int>(int)::{lambda(int)#1}::operator()(int) const",
                 "mbk::f::{lambda#1}::operator()"),
                ("Eigen::Matrix<double, -1, 1, 0, -1, 1>::Matrix<(1 < 2)>(int)", "Eigen::Matrix::Matrix"),
                ("f(int)'2", "f"), ("g.constprop.0", "g"), ("mbk::cooperator(int)", "mbk::cooperator")):
            self.assertEqual(callgrind.short_name(name), short)


class Reading(unittest.TestCase):
    def test_self_and_inclusive_of_each_function(self):
        found = callgrind.read(PROFILE)
        self.assertEqual(found.total, 1000)
        self.assertEqual(found.functions, {"main": (1000, 50), "mbk::dsp::filter": (800, 500),
                                           "mbk::report::text": (150, 150), "__memset_avx2_unaligned_erms": (300, 300)})

    def test_the_stand_in_for_instructions_that_valgrind_has_not_is_left_out(self):
        found = callgrind.read(PROFILE.replace("mbk::report::text(mbk::Findings const&) [clone .isra.0]",
                                               "mbk::recording::compress_portable(unsigned int*, void const*)"))
        self.assertEqual((found.total, found.whole), (850, 1000))
        self.assertEqual(found.functions["main"], (1000, 50))
        self.assertNotIn("mbk::recording::compress_portable", found.functions)

    def test_what_is_not_whole_is_refused(self):
        for text in ("", PROFILE.replace("totals: 1000", "").replace("summary: 1000", ""),
                     PROFILE.replace("events: Ir", "events: Dr"), PROFILE.replace("(2) void", "(5) void", 1)):
            with self.assertRaises(callgrind.Failed):
                callgrind.read(text)


class Comparing(unittest.TestCase):
    def compare(self, of, counted=None, expected=("measure",)):
        return instructions.compare(of, {"measure": callgrind.read(PROFILE)} if counted is None else counted, expected)

    def test_five_percent_more_fails_and_names_the_functions(self):
        of = figures()
        of["commands"]["measure"]["instructions"] = 950
        of["commands"]["measure"]["functions"]["mbk::dsp::filter"] = [750, 450]
        text, fine = self.compare(of)
        self.assertFalse(fine)
        self.assertIn("+5.26 %", text)
        self.assertIn("SLOWER", text)
        by_themselves, with_calls = text.split("with what they call")
        self.assertRegex(by_themselves, r"500 +450  mbk::dsp::filter")
        self.assertRegex(with_calls, r"800 +750  mbk::dsp::filter")
        self.assertNotIn("mbk::report::text", text)

    def test_two_percent_more_passes(self):
        of = figures()
        of["commands"]["measure"]["instructions"] = 980
        text, fine = self.compare(of)
        self.assertTrue(fine, text)
        self.assertNotIn("SLOWER", text)

    def test_the_limit_is_three_percent(self):
        for figure, passes in ((972, True), (970, False)):
            of = figures()
            of["commands"]["measure"]["instructions"] = figure
            self.assertEqual(self.compare(of)[1], passes, figure)

    def test_fewer_is_said_and_passes(self):
        text, fine = self.compare(figures(1.05))
        self.assertTrue(fine)
        self.assertIn("--update", text)

    def test_a_function_that_is_new_is_named(self):
        of = figures(0.9)
        del of["commands"]["measure"]["functions"]["mbk::report::text"]
        text, fine = self.compare(of)
        self.assertFalse(fine)
        self.assertRegex(text, r"150 +under +\d+  mbk::report::text")

    def test_a_command_without_a_figure_and_a_figure_without_a_command_fail(self):
        text, fine = self.compare(figures(name="other"), expected=("measure", "other"))
        self.assertFalse(fine)
        self.assertIn("measure: 1,000 instructions and no figure", text)
        text, fine = self.compare(figures(name="other"), {}, ("measure",))
        self.assertFalse(fine)
        self.assertIn("no command any more", text)

    def test_a_command_that_failed_fails(self):
        text, fine = self.compare(figures(), {"measure": callgrind.Failed("exit code 2 of: mbk measure")})
        self.assertFalse(fine)
        self.assertIn("exit code 2", text)

    def test_another_compiler_is_not_comparable(self):
        self.assertEqual(instructions.not_comparable(figures(), {"compiler": "GNU 12.2.0"}), [])
        (line,) = instructions.not_comparable(figures(), {"compiler": "GNU 13.1.0"})
        self.assertIn("13.1.0 here", line)
        self.assertIn("12.2.0 of the figures", line)

    def test_figures_are_read_as_they_were_written(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "figures.json"
            of = figures()
            instructions.write_figures(path, of["made_with"], of["commands"])
            self.assertEqual(instructions.read_figures(path), of)
            self.assertEqual(os.listdir(folder), ["figures.json"])


class Figures(unittest.TestCase):
    def test_every_command_has_a_figure(self):
        kept = instructions.read_figures(instructions.FIGURES)
        self.assertEqual(list(kept["commands"]), [command.name for command in instructions.LOAD.commands()])
        for name, figure in kept["commands"].items():
            self.assertGreater(figure["instructions"], 1_000_000, name)
            self.assertGreater(len(figure["functions"]), 5, name)


@unittest.skipUnless(callgrind.version() and os.environ.get("MBK_BUILD"), "no valgrind, or no build to try it on")
class Run(unittest.TestCase):
    """The program itself, on the cheapest command."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="mbk-")
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "figures.json"

    def guard(self, *more):
        return subprocess.run([sys.executable, "-B", BENCH / "instructions.py", "--build", os.environ["MBK_BUILD"],
                               "--only", "start", "--figures", self.path, *more], capture_output=True, text=True,
                              check=False)

    def figures(self, total, here=None):
        self.path.write_text(json.dumps({
            "made_with": here or instructions.conditions(pathlib.Path(os.environ["MBK_BUILD"])),
            "commands": {command.name: {"instructions": total, "functions": {}}
                         for command in instructions.LOAD.commands()}}), encoding="utf-8")

    def test_it_counts_compares_updates_and_refuses(self):
        self.figures(1)
        ran = self.guard()
        self.assertEqual(ran.returncode, 1, ran)
        counted = int(ran.stdout.partition("start: ")[2].partition(" instructions")[0].replace(",", ""))
        self.assertRegex(ran.stdout, r"functions that grew, by themselves")
        for scale, code in ((0.95, 1), (0.98, 0), (1.05, 0)):
            self.figures(round(scale * counted))
            ran = self.guard()
            self.assertEqual(ran.returncode, code, ran)
        self.assertEqual(self.guard("--update").returncode, 0)
        kept = instructions.read_figures(self.path)["commands"]
        self.assertLess(abs(kept["start"]["instructions"] / counted - 1.0), 0.001)
        self.assertEqual(kept["measure"]["instructions"], round(1.05 * counted))
        self.assertEqual(self.guard().returncode, 0)
        self.figures(counted, {"compiler": "GNU 1.0"})
        ran = self.guard()
        self.assertEqual(ran.returncode, instructions.NOT_COMPARABLE, ran)
        self.assertIn("not comparable", ran.stdout)
        self.assertIn("GNU 1.0 of the figures", ran.stdout)
        self.assertNotEqual(self.guard("--update").returncode, 0)

    def test_a_program_that_is_not_there_fails(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
            with self.assertRaises(SystemExit) as ended:
                instructions.main(["--build", folder])
            self.assertIn("is not there", str(ended.exception))

    def test_a_command_that_mbk_does_not_know_fails(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(callgrind.Failed) as raised:
                callgrind.count([pathlib.Path(os.environ["MBK_BUILD"]).resolve() / "bin/mbk", "mesure"], folder)
        self.assertIn("exit code 2", str(raised.exception))


if __name__ == "__main__":
    unittest.main()
