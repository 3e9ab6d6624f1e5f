#!/usr/bin/env python3
"""Each step of examples/ runs as it stands, writes only where it is told, and says what is true.

usage: examples_test.py STEP    where STEP is a folder of examples/, or `all` for what concerns every one of them
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
STEPS = sorted(path.parent.name for path in EXAMPLES.glob("[0-9][0-9]_*/run.sh"))


def ran(*command, **options):
    process = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=100, check=False, **options)
    if process.returncode != 0:
        raise AssertionError(f"{command}\nexit {process.returncode}\n{process.stdout}\n{process.stderr}")
    return process.stdout


class Step(unittest.TestCase):
    """Runs one script once; `said` is what it printed, `out` the folder that it was given."""

    step = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-example-")
        cls.addClassCleanup(folder.cleanup)
        place = pathlib.Path(folder.name)
        cls.elsewhere = place / "elsewhere"  # where it runs, and where nothing may be left
        cls.out = place / "given"
        cls.elsewhere.mkdir()
        before = snapshot(EXAMPLES / cls.step)
        cls.said = ran("bash", EXAMPLES / cls.step / "run.sh", cls.out, cwd=cls.elsewhere)
        if snapshot(EXAMPLES / cls.step) != before:
            raise AssertionError(f"{cls.step}/run.sh changed its own folder")
        if any(cls.elsewhere.iterdir()):
            raise AssertionError(f"{cls.step}/run.sh left something where it was run")

    def result(self, name):
        return json.loads((self.out / name).read_text())

    def assert_near(self, found, true, within):
        for row, true_row in zip(found, true):
            for value, expected in zip(row, true_row):
                self.assertAlmostEqual(value, expected, delta=within)


def snapshot(folder):
    return sorted((str(path), path.stat().st_size) for path in folder.rglob("*"))


class Measure(Step):
    step = "01_measure"

    def test_finds_the_simulated_arm_in_columns_without_names(self):
        model = self.result("result.json")["model"]
        # Participant 1 of relaxed_sinusoidal.toml; the tolerances are the 95 % intervals that measure prints, doubled.
        self.assert_near(model["M"], [[1.326, -0.935], [-0.935, 1.883]], 0.06)
        self.assert_near(model["B"], [[5.76, -2.14], [-2.14, 10.56]], 0.6)
        self.assert_near(model["K"], [[42.4, -28.6], [-28.6, 125.3]], 12)
        self.assertAlmostEqual(model["x0"][0], 0.300, delta=1e-3)

    def test_shows_the_channels_in_si_units_and_both_procedures(self):
        self.assertRegex(self.said, r"hand_x +m +0\.2")
        self.assertEqual(len(re.findall(r"^ *stiffness K  ", self.said, re.MULTILINE)), 2)

    def test_writes_a_report(self):
        self.assertIn("<html", (self.out / "report.html").read_text()[:200])


class SimulateAndMeasure(Step):
    step = "02_simulate_and_measure"

    def test_it_is_participant_4_who_was_measured(self):
        self.assertRegex(self.said, r"truth_M +" + re.escape("[[1.419, -1.025], [-1.025, 1.885]]"))
        pooled = self.result("pooled.json")
        self.assert_near(pooled["model"]["M"], [[1.419, -1.025], [-1.025, 1.885]], 0.08)
        self.assert_near(pooled["model"]["K"], [[36.6, -43.3], [-43.3, 151.6]], 8)
        self.assertEqual(len(pooled["inputs"]), 2)

    def test_facts_come_before_anything_moves(self):
        self.assertLess(self.said.index("crest factor"), self.said.index("absorbed"))


class Passivity(Step):
    step = "03_passivity"

    def test_the_amplitude_decides(self):
        verdict = {name: self.result(f"{name}.json")["passivity"] for name in ("relaxed", "small", "large")}
        trials = {name: one["trial"]["verdict"] for name, one in verdict.items()}
        self.assertEqual(trials, {"relaxed": "passive", "small": "active", "large": "passive"})
        self.assertEqual(verdict["relaxed"]["prediction"]["verdict"], "passive")
        self.assertIn(verdict["small"]["prediction"]["verdict"], ("none", "undecided"))
        self.assertNotEqual(verdict["large"]["prediction"]["verdict"], "active")
        self.assertLess(verdict["small"]["energy"]["absorbed_J"], -0.2)
        self.assertGreater(verdict["large"]["energy"]["absorbed_J"], 1.0)


class ClosedLoop(Step):
    step = "04_closed_loop"

    def test_least_squares_is_not_usable_and_instruments_are(self):
        least, instrumental = self.result("ls.json"), self.result("iv.json")
        self.assertFalse(least["usable"])
        self.assertTrue(instrumental["usable"])
        self.assertIn("inertia-not-positive", [one["code"] for one in least["warnings"]])
        true_k_yy = float(re.search(r"truth_K .*, ([\d.]+)\]\]", self.said).group(1))
        self.assertLess(least["model"]["K"][1][1], 0.7 * true_k_yy)
        self.assertAlmostEqual(instrumental["model"]["K"][1][1], true_k_yy, delta=0.2 * true_k_yy)
        self.assertRegex(self.said, "method ls: .*exit code 4")
        self.assertNotIn("method iv: ", self.said)


class TransferFunction(Step):
    step = "05_transfer_function"

    def test_the_impedance_of_the_joint_comes_back(self):
        impedance = self.result("ankle.json")["impedance"]
        for name, true in (("M", 0.015), ("B", 0.8), ("K", 50)):
            value = impedance[name]
            value = value["value"] if isinstance(value, dict) else value
            self.assertAlmostEqual(value, true, delta=0.02 * true, msg=name)

    def test_the_orders_are_tabled_and_one_is_chosen(self):
        self.assertEqual(len(re.findall(r"^ +\d +\d +(?:0\.\d+|no converged stable)", self.said, re.MULTILINE)), 10)
        self.assertEqual(self.said.count("chosen"), 1)


class VirtualForce(Step):
    step = "06_virtual_force"

    def test_the_rig_is_the_same_by_either_force(self):
        for name in ("sensor.json", "virtual.json"):
            model = self.result(name)["model"]
            self.assert_near(model["M"], [[0.539, 0], [0, 0.539]], 0.01)
            self.assert_near(model["K"], [[421.57, -18.87], [-18.87, 213.35]], 1.5)

    def test_the_robot_is_that_of_table_a_1(self):
        for name, true in (("alpha1", 0.06929), ("alpha2", 0.04217), ("alpha3", 0.04416)):
            found = float(re.search(rf"{name} +([\d.]+) ±", self.said).group(1))
            self.assertAlmostEqual(found, true, delta=1e-4)


class Teleoperation(Step):
    step = "07_teleoperation"

    def test_a_measured_hand_widens_the_interval_on_both_sides(self):
        def interval(name):
            (one,) = self.result(name)["admissible"]["intervals"]
            return one["low"]["value"], one["high"]["value"]

        low, high = interval("any_hand.json")
        # Roots of 4 (b_m + d_m)(b_s + d_s) k_m k_s = (d_m k_s + d_s k_m)², with the numbers of the design.
        product = 4 * 11 * 21 * 100
        middle, root = (product - 2 * 10 * 20 * 100) / 200, ((product - 40000) ** 2 - 4 * 100 * 2000**2) ** 0.5 / 200
        self.assertAlmostEqual(low, middle - root, places=6)
        self.assertAlmostEqual(high, middle + root, places=6)
        self.assertLess(interval("this_hand.json")[0], low - 20)
        self.assertGreater(interval("this_hand.json")[1], high + 100)
        for fact in ("92.76", "431.2", "operator"):
            self.assertIn(fact, self.said)


class Session(Step):
    step = "08_session"

    def test_it_is_planned_recorded_and_measured(self):
        self.assertRegex(self.said, r"\b25\.0 s")
        self.assertRegex(self.said, r"force .*handle +[\d.]+ N +of +20")
        self.assertRegex(self.said, r"ended +completed")
        self.assertIn("0 dropped", self.said)
        self.assertFalse(list(self.out.glob("*.journal")))
        result = self.result("p07.json")
        self.assertAlmostEqual(result["model"]["M"][1][1], 1.883, delta=0.15)
        self.assertTrue(result["usable"])


class YourOwnRobot(Step):
    step = "09_your_own_robot"

    def test_the_robot_that_was_simulated_is_found(self):
        for name, true, within in (("alpha1", 0.09, 1e-4), ("alpha2", 0.05, 2e-4), ("alpha3", 0.055, 1e-4),
                                   ("viscous_1", 0.08, 2e-3), ("viscous_2", 0.06, 2e-3)):
            found = float(re.search(rf"{name} +([\d.]+) ±", self.said).group(1))
            self.assertAlmostEqual(found, true, delta=within, msg=name)

    def test_an_empty_handle_has_nearly_no_force(self):
        for axis in "xy":
            rms = float(re.search(rf"^  F{axis}  ([\d.]+) N", self.said, re.MULTILINE).group(1))
            self.assertLess(rms, 0.05)

    def test_the_urdf_is_described(self):
        self.assertIn("13 of 28 coefficients", (self.out / "described.txt").read_text())


class ThreeAxes(Step):
    step = "10_three_axes"

    def test_the_hand_of_the_log_is_found(self):
        result = self.result("result.json")
        self.assertTrue(result["usable"])
        model = result["model"]
        # M, B, K and X0 of franka_log.py; the noise of the force is 0.05 N.
        self.assert_near(model["M"], [[1.3, -0.4, 0.1], [-0.4, 1.8, 0.2], [0.1, 0.2, 1.1]], 0.02)
        self.assert_near(model["B"], [[8, -2, 0.5], [-2, 11, 1], [0.5, 1, 7]], 0.3)
        self.assert_near(model["K"], [[90, -25, 5], [-25, 140, 10], [5, 10, 70]], 5)
        for found, true in zip(model["x0"], (0.45, 0.02, 0.40)):
            self.assertAlmostEqual(found, true, delta=1e-3)

    def test_says_whose_force_it_is(self):
        self.assertRegex(self.said, r"hand_z +m ")
        self.assertIn("-O_F_ext_hat_K", self.said)


class UseTheLibrary(unittest.TestCase):
    step = "use_the_library"

    def program(self, name, *arguments):
        return ran(pathlib.Path(os.environ["PROGRAMS"]) / name, *arguments)

    def test_measure_recording_finds_the_truth_of_its_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder) / "recording.mat"
            ran(os.environ["MAKE_LOG"], "--protocol", "sinusoidal", "--out", recording)
            said = dict(line.split(" ", 1) for line in self.program("measure_with_two_modules", recording).splitlines())
        # The truth that make_log prints; its log has no noise but that of its sensors.
        for value, true in zip(map(float, said["K"].split()), (42.4, -20.9, -36.3, 125.3)):
            self.assertAlmostEqual(value, true, delta=0.3)

    def test_filter_a_signal_differentiates(self):
        said = self.program("filter_a_signal")
        self.assertIn("-3 dB at 23.03 Hz", said)
        percent = [float(one) for one in re.findall(r"\(([\d.]+) %\)", said)]
        self.assertEqual(len(percent), 3)
        for value, limit in zip(percent, (0.1, 0.3, 1.0)):
            self.assertLess(value, limit)

    def test_judge_a_model_decides_both_ways(self):
        said = self.program("judge_a_model")
        self.assertIn("0.16 Hz", said)
        self.assertIn("the model: not passive", said)
        self.assertIn("the symmetric part: passive", said)
        # λ_min(B_s) of the printed matrix, by hand: 8.16 − √(2.4² + 2.14²)
        excess = float(re.search(r"excess of passivity ([\d.]+)", said).group(1))
        self.assertAlmostEqual(excess, 8.16 - (2.4**2 + 2.14**2) ** 0.5, delta=5e-4)

    def test_simulate_a_participant_finds_the_participant(self):
        rows = re.findall(r"^(\w+) +(-?[\d.]+) +([\d.]+) +(-?[\d.]+) ", self.program("simulate_a_participant"), re.MULTILINE)
        self.assertEqual(len(rows), 14)
        for name, found, within, true in rows:
            self.assertLess(abs(float(found) - float(true)), 2 * float(within), name)

    def test_run_a_study_records_and_measures_both_trials(self):
        with tempfile.TemporaryDirectory() as folder:
            said = self.program("run_a_study", folder)
            self.assertEqual(sorted(os.listdir(folder)), ["p07_left.h5", "p07_right.h5"])
        self.assertEqual(len(re.findall(r"^p07_\w+\.h5: \d+ ticks, motors confirmed$", said, re.MULTILINE)), 2)
        for trial in ("left", "right"):
            self.assertRegex(said, rf"(?m)^{trial}: 25\.\d s, at most \d+\.\d of 20 N at the handle$")
        stiffness = [list(map(float, one.split())) for one in re.findall(r"K (.+) N/m", said)]
        self.assertEqual(len(stiffness), 2)
        # Participant 1 at the first place; twice the 95 % intervals that mbk prints.
        for value, true in zip(stiffness[0], (42.4, -28.6, -28.6, 125.3)):
            self.assertAlmostEqual(value, true, delta=12)
        self.assertTrue(said.endswith("completed\n"))


class All(unittest.TestCase):
    step = "all"

    def test_every_numbered_step_has_a_test_a_page_and_a_row(self):
        tested = {kind.step for kind in globals().values() if isinstance(kind, type) and issubclass(kind, Step)}
        self.assertEqual(sorted(tested - {None}), STEPS)
        overview = (EXAMPLES / "README.md").read_text()
        rows = re.findall(r"^\| (\d\d) \| \[[^\]]+\]\((\w+)/README\.md\)", overview, re.MULTILINE)
        self.assertEqual([number for number, _ in rows], [f"{i:02}" for i in range(1, len(rows) + 1)])
        self.assertEqual([folder for _, folder in rows], [*STEPS, "use_the_library"])
        for step in STEPS:
            page = (EXAMPLES / step / "README.md").read_text()
            self.assertIn("(run.sh)", page)
            self.assertIn(f"bash {step}/run.sh", page)

    def test_scripts_stop_at_the_first_error_and_take_the_program_from_outside(self):
        for step in STEPS:
            script = (EXAMPLES / step / "run.sh").read_text()
            self.assertIn("\nset -euo pipefail\nmbk=${MBK:-mbk}", script)
            self.assertNotRegex(script, r"(?m)^\s*mbk ")

    def test_a_failing_program_fails_the_step(self):
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.run(["bash", EXAMPLES / STEPS[0] / "run.sh", folder], env={**os.environ, "MBK": "false"},
                                     capture_output=True, timeout=60, check=False)
        self.assertNotEqual(process.returncode, 0)


def main():
    step = sys.argv.pop(1) if len(sys.argv) > 1 else sys.exit(__doc__)
    kinds = [kind for kind in globals().values()
             if isinstance(kind, type) and issubclass(kind, unittest.TestCase) and getattr(kind, "step", None) == step]
    if not kinds:
        sys.exit(f"there is no step '{step}'")
    suite = unittest.TestSuite(unittest.defaultTestLoader.loadTestsFromTestCase(kind) for kind in kinds)
    sys.exit(not unittest.TextTestRunner().run(suite).wasSuccessful())


if __name__ == "__main__":
    main()
