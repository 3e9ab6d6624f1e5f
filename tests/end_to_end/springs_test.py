#!/usr/bin/env python3
"""mbk springs field, find and calibrate."""

import math
import os
import pathlib
import random
import re
import subprocess

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main, program

ARRAY = ("k=60,l=110mm,anchor=215:-183", "k=45N/m,l=90,anchor=215:0", "k=110,l=120,anchor=215:183",
         "k=80,l=85,anchor=390:183", "k=35,l=130,anchor=565:183", "k=120,l=95,anchor=565:0",
         "k=70,l=100,anchor=565:-183", "k=90,l=80,anchor=390:-183")
WANTED = (443.86, 232.34, 16.74)  # Dyck 2013, table 3.1, field 1 [N/m]


def options(springs):
    return [word for spring in springs for word in ("--spring", spring)]


def force(springs, x, y):
    """Equation (D.1), from what the JSON says of the springs."""
    fx = fy = 0.0
    for spring in springs:
        dx, dy = (hand + hole - anchor for hand, hole, anchor in zip((x, y), spring["hole"], spring["anchor"]))
        length = math.hypot(dx, dy)
        tension = spring["stiffness"] * (length - spring["rest_length"])
        fx, fy = fx - tension * dx / length, fy - tension * dy / length
    return fx, fy


class Field(Case):
    def test_force_is_zero_at_its_equilibrium_and_K_is_minus_its_gradient(self):
        found = self.fine("springs", "field", *options(ARRAY), "--json").json
        self.assertEqual((found["schema"], found["what"]), ("mbk.springs/1", "field"))
        x, y = found["equilibrium"]
        self.assertLess(math.hypot(*force(found["springs"], x, y)), 1e-10)
        self.assertLess(found["residual_force"], 1e-10)
        h = 1e-6
        for axis, (dx, dy) in enumerate(((h, 0), (0, h))):
            ahead, behind = force(found["springs"], x + dx, y + dy), force(found["springs"], x - dx, y - dy)
            for row in range(2):
                self.assertAlmostEqual(found["K"][row][axis], (behind[row] - ahead[row]) / (2 * h), delta=1e-4)
        self.assertEqual(found["K"][0][1], found["K"][1][0])

    def test_linearisation_holds_at_its_rim(self):
        found = self.fine("springs", "field", *options(ARRAY), "--json", "--radius", "25").json
        (x, y), K, line = found["equilibrium"], found["K"], found["linearisation"]
        largest = 0.0
        for k in range(360):
            dx, dy = (0.025 * f(math.radians(k)) for f in (math.cos, math.sin))
            fx, fy = force(found["springs"], x + dx, y + dy)
            largest = max(largest, math.hypot(fx + K[0][0] * dx + K[0][1] * dy, fy + K[1][0] * dx + K[1][1] * dy))
        self.assertAlmostEqual(line["radius"], 0.025)
        self.assertAlmostEqual(line["largest_error"], largest, delta=0.01 * largest)

    def test_the_published_grid_stands_beside_it(self):
        found = self.fine("springs", "field", *options(ARRAY), "--json", "--grid-step", "0.15").json
        grid = found["grid"]
        self.assertFalse(grid["at_border"])
        for value in grid["equilibrium"]:
            self.assertAlmostEqual(value / 0.15e-3, round(value / 0.15e-3), places=6)
        self.assertLess(math.dist(grid["equilibrium"], found["equilibrium"]), 0.15e-3 * math.sqrt(2))
        self.assert_relative(grid["K"], found["K"], 1e-3)
        self.assertNotEqual(grid["K"], found["K"])

    def test_text_says_what_json_says(self):
        ran = self.fine("springs", "field", *options(ARRAY), "--grid-step", "0.15")
        found = self.fine("springs", "field", *options(ARRAY), "--json").json
        x, y = (1000 * value for value in found["equilibrium"])
        self.assertIn(f"equilibrium  x {x:.4f}, y {y:.4f} mm", ran.out)
        self.assertIn(f"{found['K'][0][0]:.3f}  {found['K'][0][1]:.3f}", ran.out)
        self.assert_lines_fit(ran.out)

    def test_turning_the_disc_changes_the_moment(self):
        held = [f"{spring},hole={hx}:{hy}" for spring, hx, hy in zip(ARRAY, (-8, -11, -8, 0, 8, 11, 8, 0),
                                                                    (-8, 0, 8, 11, 8, 0, -8, -11))]
        moments = [self.fine("springs", "field", *options(held), "--rotation", str(angle), "--json").json["moment"]
                   for angle in (-10, 0, 10)]
        self.assertGreater(moments[0], moments[1])  # springs that pull outwards turn the disc back
        self.assertGreater(moments[1], moments[2])

    def test_wrong_springs_are_refused(self):
        for spring, says in (("k=60", "'l'"), ("k=60,l=90", "'anchor'"),
                             ("k=-1,l=90,anchor=0:0", "k '-1'"), ("k=6x,l=90,anchor=0:0", "k '6x'"),
                             ("k=60,l=90cm,anchor=0:0", "l '90cm'"), ("k=60,l=90,anchor=12", "x:y"),
                             ("k=60,l=90,anchor=1:2:3", "x:y"), ("k=60,k=60,l=90,anchor=0:0", "'k'"),
                             ("k=60,l=90,anker=0:0", "'anker'"), ("k=nan,l=90,anchor=0:0", "k 'nan'"),
                             ("k=60,l=90,anchor=0:inf", "x:y"), ("k", "'='"), ("", "'='")):
            with self.subTest(spring):
                self.refused(WRONG_USAGE, "springs", "field", "--spring", spring, says=says)
        self.refused(WRONG_USAGE, "springs", "field", says="--spring")
        self.refused(WRONG_USAGE, "springs", "field", *options(ARRAY), "--radius", "-3", says="--radius")
        self.refused(WRONG_USAGE, "springs", "field", *options(ARRAY), "--grid-step", "0.0001", says="points")
        self.refused(WRONG_USAGE, "springs", "field", *options(ARRAY), "--start", "here", says="--start 'here'")
        self.refused(WRONG_USAGE, "springs", says="springs")

    def test_an_array_without_an_equilibrium_is_not_usable(self):
        slack = ("k=60,l=300,anchor=215:0", *ARRAY)
        self.refused(NOT_USABLE, "springs", "field", *options(slack), says="spring 1")
        self.refused(NOT_USABLE, "springs", "field", *options(ARRAY[:1]), "--start", "390:0", says="mbk: ")

    def test_nothing_is_overwritten_unasked(self):
        kept = self.file("kept.json", "precious")
        self.refused(WRONG_USAGE, "springs", "field", *options(ARRAY), "--out", kept, says="--overwrite")
        self.assertEqual(kept.read_text(), "precious")
        self.fine("springs", "field", *options(ARRAY), "--json", "--out", kept, "--overwrite")
        self.assertIn("mbk.springs/1", kept.read_text())


class Find(Case):
    def find(self, *more):
        return self.fine("springs", "find", "--stiffness", ",".join(map(str, WANTED)), "--at", "393:-55", *more)

    def test_gives_the_expected_stiffness_and_equilibrium(self):
        found = self.find("--json", "--payload", "0.293").json
        self.assertEqual(found["what"], "find")
        kxx, kyy, ks = WANTED
        self.assert_relative(found["K"], [[kxx, ks], [ks, kyy]], 1e-6)
        self.assertLess(math.dist(found["equilibrium"], (0.393, -0.055)), 1e-6)
        self.assertGreaterEqual(found["linearisation"]["smallest_extension"], 0.002 - 1e-6)
        low, high = found["natural_frequencies_hz"]
        self.assertAlmostEqual(low, math.sqrt(found["principal"]["stiffness"][1] / 0.293) / (2 * math.pi), places=9)
        self.assertLess(low, high)

    def test_its_options_give_the_field_back(self):
        for more in ((), ("--disc",)):
            text = self.find(*more).out
            springs = re.findall(r"--spring (\S+)", text)
            self.assertGreaterEqual(len(springs), 3)
            found = self.fine("springs", "field", *options(springs), "--json").json
            kxx, kyy, ks = WANTED
            self.assert_relative(found["K"], [[kxx, ks], [ks, kyy]], 1e-5)  # four decimals of N/m and mm
            self.assertLess(math.dist(found["equilibrium"], (0.393, -0.055)), 1e-6)
            self.assertEqual(text.count("[[rig.spring]]"), len(springs))
            self.assertEqual(text.count("hole_mm"), len(springs) if more else 0)
            self.assert_lines_fit(text)

    def test_keeps_to_the_springs_that_can_be_had(self):
        found = self.find("--json", "--spring-stiffness", "40:200", "--spring-length", "70:120", "--max-springs",
                          "5").json
        self.assertLessEqual(len(found["springs"]), 5)
        for spring in found["springs"]:
            self.assertTrue(40 - 1e-6 <= spring["stiffness"] <= 200 + 1e-6, spring)
            self.assertTrue(0.07 - 1e-8 <= spring["rest_length"] <= 0.12 + 1e-8, spring)

    def test_what_cannot_be_is_said(self):
        self.refused(NOT_USABLE, "springs", "find", "--stiffness", "9000,9000,0", says=("nearest", "kxx"))
        for given, says in (("300,300", "kxx,kyy,ks"), ("300,300,x", "kxx,kyy,ks"), ("300,300,400", "principal")):
            self.refused(WRONG_USAGE, "springs", "find", "--stiffness", given, says=says)
        for option, value in (("--spring-stiffness", "400:20"), ("--spring-length", "60"), ("--at", "3"),
                              ("--max-springs", "2"), ("--payload", "0"), ("--eye", "a:b")):
            self.refused(WRONG_USAGE, "springs", "find", "--stiffness", "300,300,0", option, value, says=option)


def stretch(stiffness, hook_mm=0.0, hook_N=1.0, noise_N=0.01, seed=1):
    """time, position in mm, reaction: out and back over 60 mm in 60 s, hooks in series with the spring."""
    rows = ["time,position_mm,reaction"]
    noise = random.Random(seed)
    for i in range(3001):
        reach = 60.0 * (1 - abs(i / 1500 - 1))
        low, high = 0.0, stiffness
        for _ in range(60):  # by bisection, since the curve is stated the other way round
            tension = (low + high) / 2
            far = 1000 * tension / stiffness + hook_mm * (1 - math.exp(-tension / hook_N)) < reach
            low, high = (tension, high) if far else (low, tension)
        rows.append(f"{i / 50},{100 + reach!r},{-low + noise.gauss(0, noise_N)!r}")
    return "\n".join(rows) + "\n"


class Calibrate(Case):
    def test_constant_and_rest_position_come_back(self):
        plain, hooked = self.file("a.csv", stretch(150)), self.file("b.csv", stretch(120, 1.5, 0.7))
        ran = self.fine("springs", "calibrate", plain, hooked, "--json").json
        self.assertEqual(ran["what"], "calibrate")
        a, b = ran["constants"]
        self.assertEqual(b["inputs"][0]["file"], str(hooked))
        line = a["straight"]
        self.assertLess(abs(line["stiffness"] - 150), 4 * line["stiffness_standard_error"])
        self.assertLess(line["stiffness_standard_error"], 0.1)
        self.assertAlmostEqual(line["rest"], 0.1, delta=1e-4)
        self.assertNotIn("hooks", a)
        self.assertAlmostEqual(b["hooks"]["deflection"], 1.5e-3, delta=4 * b["hooks"]["deflection_standard_error"])
        self.assertAlmostEqual(b["hooks"]["force"], 0.7, delta=0.1)
        self.assertAlmostEqual(b["straight"]["stiffness"], 120, delta=0.6)
        self.assertGreater(abs(b["bias_of_whole"]), 0.005)

    def test_text_says_rule_and_bias(self):
        ran = self.fine("springs", "calibrate", self.file("b.csv", stretch(120, 1.5, 0.7)))
        for words in ("straight part", "whole range", " 1 %", "63 %"):
            self.assertIn(words, ran.out)
        self.assert_lines_fit(ran.out)

    def test_a_gauge_that_reads_tension_is_turned_by_the_channel_map(self):
        turned = stretch(150).replace(",-", ",").replace("position_mm", "a").replace("reaction", "b")
        path = self.file("gauge.csv", turned)
        wrong = self.refused(NOT_USABLE, "springs", "calibrate", path, "--channels", "time=1,x=2:mm,F=3", says="F=-3")
        self.assertIn(str(path), wrong.err)
        found = self.fine("springs", "calibrate", path, "--channels", "time=1,x=2:mm,F=-3", "--json").json
        self.assertAlmostEqual(found["constants"][0]["straight"]["stiffness"], 150, delta=0.5)

    def test_what_is_no_stretch_is_refused(self):
        still = "time,position_mm,reaction\n" + "".join(f"{0.01 * i:.2f},100,{-i}\n" for i in range(50))
        for name, content, says in (("still", still, "position"), ("short", stretch(150)[:400], "11 samples"),
                                    ("words", "nothing here\n", "")):
            with self.subTest(name):
                path = self.file(f"{name}.csv", content)
                ran = self.refused(BAD_DATA, "springs", "calibrate", path, says=says)
                self.assertIn(name, ran.err)
        self.refused(BAD_DATA, "springs", "calibrate", self.folder / "none.csv", says="none.csv")


class Guide(Case):
    """docs/guide/calibration.md shows what its commands print; a line of only an ellipsis stands for any lines."""

    def examples(self):
        text = (pathlib.Path(__file__).parents[2] / "docs/guide/calibration.md").read_text(encoding="utf-8")
        for block in re.findall(r"^```\n(\$ .*?)^```", text, re.S | re.M):
            for example in re.split(r"^\$ ", block, flags=re.M)[1:]:
                lines, command = example.splitlines(), ""
                while not command or command.endswith("\\\n") or command.count("'") % 2:
                    command += lines.pop(0) + "\n"
                yield command, "\n".join(lines)

    def test_prints_what_the_commands_print(self):
        folder = os.path.dirname(os.path.abspath(program("MBK")))
        examples = list(self.examples())
        self.assertEqual(len(examples), 4)
        for command, shown in examples:
            ran = subprocess.run(command, shell=True, cwd=self.folder, capture_output=True, text=True, timeout=120,
                                 env={**os.environ, "PATH": folder + os.pathsep + os.environ["PATH"]}, check=True)
            # the force left over is rounding, and a line of only an ellipsis stands for any number of lines
            shown, printed = (re.sub(r"\d+e-\d+ N left", "N left", words) for words in (shown, ran.stdout.rstrip()))
            self.assertRegex(printed, r"\A" + re.escape(shown).replace("…", r"(.|\n)*") + r"\Z", command)


if __name__ == "__main__":
    main()
