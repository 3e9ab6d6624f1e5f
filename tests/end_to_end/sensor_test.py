#!/usr/bin/env python3
"""mbk sensor calibrate, and --sensor: voltages become the force that a load cell read."""

import csv
import math
import random

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main

SLOPE, OFFSET = (-8.56, -8.15), (0.54, 2.3)  # Dyck 2013, eq. E.2 [N/V], [N]
STEP = 20 / 4096                              # 12 bits over ±10 V [V]
LEVER_ARM_MM = 68.8


class Cell:
    """A bending beam with its converter."""

    def __init__(self, seed=1, noise=0.0012, crosstalk=(0.02, -0.01), arm_mm=LEVER_ARM_MM):
        self.random, self.noise, self.crosstalk, self.arm = random.Random(seed), noise, crosstalk, arm_mm / LEVER_ARM_MM

    def voltages(self, fx, fy):
        felt = (fx + self.crosstalk[0] * fy, fy + self.crosstalk[1] * fx)
        volts = (self.arm * f / a - b / a for f, a, b in zip(felt, SLOPE, OFFSET))
        return [round((v + self.random.gauss(0, self.noise)) / STEP) * STEP for v in volts]


def loads(repeats=3):
    for axis in (0, 1):
        up = range(-50, 51, 10)
        for load in (*up, *reversed(up)):
            for _ in range(repeats):
                yield (load, 0) if axis == 0 else (0, load)


class Calibrate(Case):
    def table(self, name="loads.csv", cell=None, rows=None):
        cell = cell or Cell()
        lines = [f"{fx},{fy},{vx!r},{vy!r}" for fx, fy in (rows or loads()) for vx, vy in [cell.voltages(fx, fy)]]
        return self.file(name, "Fx,Fy,Vx,Vy\n" + "\n".join(lines) + "\n")

    def test_slopes_zeros_and_crosstalk_of_hung_weights(self):
        found = self.fine("sensor", "calibrate", self.table(), "--lever-arm-mm", LEVER_ARM_MM, "--bits", 12, "--range", 10,
                          "--json").json
        self.assertEqual(found["schema"], "mbk.sensor/1")
        self.assertEqual(len(found["inputs"][0]["sha256"]), 64)
        self.assertAlmostEqual(found["lever_arm"], 0.0688)
        for k, axis in enumerate(found["axes"]):
            self.assertLess(abs(axis["zero_voltage"] + OFFSET[k] / SLOPE[k]), 5 * axis["zero_voltage_standard_error"])
            # S = C⁻¹, whose diagonal is that of C inverted but for the product of the crosstalks
            self.assertLess(abs(found["slope"][k][k] - SLOPE[k] / (1 + 0.02 * 0.01)),
                            5 * found["slope_standard_error"][k][k])
            self.assertLess(abs(found["crosstalk"][k][1 - k] - (0.02, -0.01)[k]),
                            5 * found["crosstalk_standard_error"][k][1 - k])
            self.assertAlmostEqual(axis["step_voltage"], STEP, delta=1e-6)
            self.assertAlmostEqual(axis["converter_step_voltage"], STEP)
            self.assertGreater(axis["r_squared"], 0.9999)
        self.assertEqual(found["warnings"], [])

    def test_text_says_what_json_says(self):
        table = self.table()
        text = self.fine("sensor", "calibrate", table).out
        self.assert_lines_fit(text)
        for words in ("-8.5", "crosstalk", "4.883 (0.0418)", "Fx"):
            self.assertIn(words, text)

    def test_one_axis_from_hung_masses_in_kilograms(self):
        cell = Cell(crosstalk=(0, 0))
        rows = "".join(f"{m},{1000 * cell.voltages(9.81 * m, 0)[0]!r}\n" for m in (-5, -3, -2, -1, 0, 1, 2, 3, 5))
        path = self.file("masses.csv", "mass,bridge\n" + rows)
        found = self.fine("sensor", "calibrate", "--channels", "Fx=mass*9.81,Vx=bridge:mV", path, "--json").json
        self.assertLess(abs(found["slope"][0][0] - SLOPE[0]), 5 * found["slope_standard_error"][0][0])

    def test_two_runs_share_the_slopes_and_not_the_zero(self):
        cell = Cell()
        first = self.table("first.csv", cell, [row for row in loads() if row[1] == 0])
        second = self.table("second.csv", cell, [row for row in loads() if row[0] == 0])
        found = self.fine("sensor", "calibrate", first, second, "--json").json
        self.assertEqual(len(found["inputs"]), 2)
        self.assertEqual(len(found["zero_voltages"]), 2)
        self.assertLess(abs(found["crosstalk"][0][1] - 0.02), 5 * found["crosstalk_standard_error"][0][1])

    def test_what_cannot_be_calibrated_is_refused(self):
        table = self.table()
        for channels, code, says in (("Fx=1,Vx=2", NOT_USABLE, "voltage_x"),
                                     ("Fx=1,Vx=3,Vy=4", NOT_USABLE, "load on y"),
                                     ("Fx=1,Fy=1,Vx=3,Vy=4", NOT_USABLE, "line"),
                                     ("Fx=1,Fy=2", BAD_DATA, "voltage_x"),
                                     ("Vx=3", BAD_DATA, "force"),
                                     ("Fx=1:V,Vx=3", BAD_DATA, "unit V"),
                                     ("Fx=1*0,Vx=3", WRONG_USAGE, "gain")):
            with self.subTest(channels):
                self.refused(code, "sensor", "calibrate", table, "--channels", channels, says=says)
        self.refused(WRONG_USAGE, "sensor", "calibrate", table, "--bits", 12, says="--range")
        self.refused(BAD_DATA, "sensor", "calibrate", self.file("two.csv", "Fx,Vx\n0,1\n1,2\n"), says="two.csv")

    def test_millivolts_that_are_called_volts_are_noticed(self):
        cell = Cell()
        lines = "".join(f"{f},{1000 * cell.voltages(f, 0)[0]!r}\n" for f in range(-50, 51, 10))
        text = self.fine("sensor", "calibrate", self.file("mv.csv", "Fx,Vx\n" + lines)).out
        self.assertIn("voltage-unlikely", text)
        self.assertIn("--channels Vx=NAME:mV", text)


class Apply(Case):
    """A simulated trial with a load cell, and beside it the voltages of a strain gauge on the last link."""

    def setUp(self):
        super().setUp()
        self.trial = self.folder / "trial.csv"
        self.mbk("simulate", "relaxed_sinusoidal", "--out", self.trial)
        self.calibration = self.folder / "cell.json"

    def with_voltages(self, name, keep_force, **cell):
        """The trial with Vx and Vy, in the axes of the last link (eq. E.4)."""
        sensor = Cell(**cell)
        path = self.folder / name
        with open(self.trial, encoding="utf-8") as source, open(path, "w", encoding="utf-8", newline="") as target:
            rows = csv.reader(line for line in source if not line.startswith("#"))
            header = next(rows)
            fx, fy, q2 = (header.index(column) for column in ("force_x_N", "force_y_N", "joint_2_rad"))
            kept = [k for k in range(len(header)) if keep_force or k not in (fx, fy)]
            writer = csv.writer(target)
            writer.writerow([header[k] for k in kept] + ["Vx", "Vy"])
            for row in rows:
                s, c = math.sin(float(row[q2])), math.cos(float(row[q2]))
                x, y = float(row[fx]), float(row[fy])
                volts = sensor.voltages(s * x - c * y, c * x + s * y)
                writer.writerow([row[k] for k in kept] + [repr(v) for v in volts])
        return path

    def test_the_answer_is_that_of_the_load_cell(self):
        beside = self.with_voltages("beside.csv", keep_force=True)
        self.mbk("sensor", "calibrate", beside, "--lever-arm-mm", LEVER_ARM_MM, "--json", "--out", self.calibration)
        voltages = self.with_voltages("voltages.csv", keep_force=False, seed=2, arm_mm=90)
        expected = self.mbk("measure", self.trial, "--json").json
        handle = ("--handle-mass", 0.194)  # which the table of voltages does not name
        arm = ("--sensor", self.calibration, "--lever-arm-mm", 90)
        measured = self.mbk("measure", voltages, "--json", *arm, *handle).json
        for name in "MBK":
            self.assert_relative(measured["model"][name], expected["model"][name], 0.01)
        # With the arm of the calibration every force is too large by 90/68.8.
        wrong = self.mbk("measure", voltages, "--json", "--sensor", self.calibration).json
        self.assert_relative(wrong["model"]["K"], [[90 / 68.8 * k for k in row] for row in expected["model"]["K"]], 0.01)
        for command in ("identify", "passivity", "info"):
            text = self.mbk(command, voltages, *arm, *(["--json"] if command != "info" else [])).out
            self.assertIn("force_x", text) if command == "info" else self.assertIn("schema", text)
        text = self.mbk("measure", voltages, *arm).out
        self.assertRegex(" ".join(text.split()), r"lever arm .*\b90 mm .*\b68\.8 mm")
        converted = self.folder / "forces.h5"
        self.mbk("convert", voltages, converted, *arm)
        again = self.mbk("measure", converted, "--json").json
        self.assert_relative(again["model"]["K"], measured["model"]["K"], 1e-9)

    def test_wrong_use_is_refused(self):
        table = self.file("loads.csv", "Fx,Fy,Vx,Vy\n" + "".join(
            f"{fx},{fy},{vx!r},{vy!r}\n" for fx, fy in loads() for vx, vy in [Cell().voltages(fx, fy)]))
        self.mbk("sensor", "calibrate", table, "--json", "--out", self.calibration)
        sensor = ("--sensor", self.calibration)
        self.refused(BAD_DATA, "measure", self.trial, *sensor, says="voltage_x")
        self.refused(WRONG_USAGE, "measure", self.trial, "--lever-arm-mm", 90, says="--sensor")
        self.refused(BAD_DATA, "measure", self.trial, "--sensor", table, says="JSON")
        self.refused(BAD_DATA, "measure", self.trial, "--sensor", self.folder / "none.json", says="none.json")
        voltages = self.with_voltages("voltages.csv", keep_force=False)
        self.refused(WRONG_USAGE, "measure", voltages, *sensor, "--lever-arm-mm", 90, says="lever arm")
        for zero in ("auto", "auto:0", "auto:x", "1", "1,2,3", "1,x", "auto:1000"):
            self.refused(WRONG_USAGE, "measure", voltages, *sensor, f"--sensor-zero={zero}")
        self.refused(WRONG_USAGE, "measure", voltages, *sensor, "--sensor-frame", "hand")
        result = self.folder / "result.json"
        self.mbk("measure", self.trial, "--json", "--out", result)
        self.refused(WRONG_USAGE, "passivity", result, *sensor, says="--sensor")


if __name__ == "__main__":
    main()
