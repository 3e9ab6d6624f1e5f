#!/usr/bin/env python3
"""mbk tf: from a file to a transfer function, and what it refuses."""

import json
import math
import random
import re

import mat_file
import schemas
from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main, make_log, run

W, ZETA, GAIN = 2 * math.pi * 1.5, 0.2, 4.0  # GAIN W²/(s² + 2 ZETA W s + W²)
STEP = 0.01


def oscillator(noise=0.02, seed=1, samples=3000):
    """Rows time, u, y: u is held, and the answer is that of the differential equation."""
    chance = random.Random(seed)
    y = v = u = 0.0
    rows = []
    ringing = W * math.sqrt(1 - ZETA**2)
    decay, sine, cosine = math.exp(-ZETA * W * STEP), math.sin(ringing * STEP) / ringing, math.cos(ringing * STEP)
    for i in range(samples):
        last, u = u, (chance.choice((-1.0, 1.0)) if i % 12 == 0 else u)
        off = y - GAIN * last  # it rings about where the last u would have held it
        y = GAIN * last + decay * (off * cosine + (v + ZETA * W * off) * sine)
        v = decay * (v * cosine - (ZETA * W * v + W * W * off) * sine)
        rows.append((i * STEP, u, y + noise * chance.gauss(0, 1)))
    return rows


class TransferFunction(Case):
    def csv(self, rows, header="time,force,motion"):
        lines = [header] + [",".join(f"{value:.12g}" for value in row) for row in rows]
        return self.file("signals.csv", "\n".join(lines) + "\n")

    def test_comes_back_with_intervals_by_names_and_by_numbers(self):
        file = self.csv(oscillator())
        found = self.fine("tf", file, "--input", "force", "--output", "motion", "--poles", "2", "--zeros", "0",
                          "--json").json
        self.assertEqual((found["schema"], found["method"]), ("mbk.tf/1", "srivc"))
        pole, = found["poles"]
        self.assertAlmostEqual(pole["frequency_hz"], 1.5, delta=0.02)
        self.assertAlmostEqual(pole["damping"], ZETA, delta=0.02)
        self.assertAlmostEqual(found["gain"], GAIN, delta=0.1)
        self.assertGreater(found["fit"]["R2_held_out"], 0.99)
        self.assertEqual(len(found["numerator"]), 1)
        self.assertEqual(found["denominator"][0], 1)
        by_number = self.fine("tf", file, "--input", "2", "--output", "3", "--poles", "2", "--zeros", "0", "--json")
        self.assertEqual(by_number.json["poles"], found["poles"])

    def test_an_input_that_is_held_between_samples_is_seen_and_said(self):
        file = self.csv(oscillator(0.01))
        signals = ("--input", "force", "--output", "motion", "--poles", "2", "--zeros", "0")
        found = self.fine("tf", file, *signals, "--json").json
        self.assertEqual((found["hold"], found["hold_found"]), ("zero", True))
        told = self.fine("tf", file, *signals, "--hold", "zero", "--json").json
        self.assertEqual((told["hold"], told["hold_found"], told["poles"]), ("zero", False, found["poles"]))
        self.assertIn("zero-order hold", self.fine("tf", file, *signals).out)

        def off(document):
            truth = {"a0": W * W, "a1": 2 * ZETA * W, "b0": GAIN * W * W}
            return max(abs(one["value"] - truth[one["name"]]) / one["standard_error"]
                       for one in document["parameters"])

        self.assertLess(off(found), 4)
        lines = self.fine("tf", file, *signals, "--hold", "first", "--json").json
        self.assertEqual(lines["hold"], "first")
        self.assertGreater(off(lines), 10)  # half a sample of delay goes into its coefficients
        self.refused(WRONG_USAGE, "tf", file, *signals, "--method", "oe", "--hold", "zero", says="--hold")
        self.refused(WRONG_USAGE, "tf", file, *signals, "--sample-rate", "50", "--hold", "zero", says="input")
        oe = self.fine("tf", file, *signals[:-1], "2", "--method", "oe", "--json").json
        self.assertNotIn("hold", oe)

    def test_a_delay_that_is_found_has_an_interval(self):
        rows = oscillator()
        file = self.csv([(time, u, y) for (time, _, y), (_, u, _) in zip(rows, rows[2:])])  # u is known 2 samples early
        signals = ("--input", "force", "--output", "motion", "--poles", "2", "--zeros", "0", "--delay", "auto")
        found = self.fine("tf", file, *signals, "--json").json
        self.assertLess(abs(found["delay_s"] - 2 * STEP), 4 * found["delay_standard_error_s"])
        self.assertLess(found["delay_standard_error_s"], 0.1 * STEP)
        self.assertIn("uncertainty", self.fine("tf", file, *signals).out)

    def test_text_says_what_was_found(self):
        ran = self.fine("tf", self.csv(oscillator()), "--input", "force", "--output", "motion", "--orders", "1:3")
        for words in ("G(s) =", "pole pair", "YIC"):
            self.assertIn(words, ran.out)

    def test_the_truth_is_chosen_from_a_table_of_orders(self):
        found = self.fine("tf", self.csv(oscillator(0.2)), "--input", "force", "--output", "motion", "--orders",
                          "1/0,2/0,2/1,3/1", "--json").json
        chosen, = [order for order in found["orders"] if order["chosen"]]
        self.assertEqual((chosen["poles"], chosen["zeros"]), (2, 0))

    def test_discrete_models_come_back_in_hertz_too(self):
        file = self.csv(oscillator(0.2))
        signals = ("--input", "force", "--output", "motion", "--poles", "2", "--zeros", "2")
        for method in ("oe", "bj"):
            with self.subTest(method=method):
                found = self.fine("tf", file, *signals, "--method", method, "--json").json
                self.assertEqual((found["schema"], found["method"], found["variable"]), ("mbk.tf/1", method, "q^-1"))
                self.assertAlmostEqual(found["sample_time"], STEP)
                self.assertEqual(found["denominator"][0], 1)
                pole, = found["poles"]
                self.assertAlmostEqual(pole["frequency_hz"], 1.5, delta=0.02)
                self.assertAlmostEqual(pole["damping"], ZETA, delta=0.02)
                self.assertAlmostEqual(found["gain"], GAIN, delta=0.1)
                self.assertGreater(len({start["made_by"] for start in found["starts"]}), 3)
        text = self.fine("tf", file, *signals, "--method", "oe", "--sample-rate", "50").out
        for words in ("G(q) =", "q^-1", "100", "50 Hz", "output error"):
            self.assertIn(words, text)
        every = self.fine("tf", file, *signals, "--method", "oe", "--sample-rate", "recorded", "--json").json
        self.assertNotIn("recorded_rate_hz", every)

    def test_a_discrete_model_needs_an_even_clock(self):
        rows = [(t + (0.004 if i % 7 == 0 else 0.0), u, y) for i, (t, u, y) in enumerate(oscillator(samples=400))]
        self.refused(WRONG_USAGE, "tf", self.csv(rows), "--input", "force", "--output", "motion", "--poles", "2",
                     "--method", "oe", says=["uniform", "--resample"])

    def test_an_unstable_system_is_refused(self):
        rows, y = [], 0.0
        for t, u, _ in oscillator(0.0):
            y += STEP * (0.3 * y + u)
            rows.append((t, u, y))
        for method in ("srivc", "oe"):
            self.refused(NOT_USABLE, "tf", self.csv(rows), "--input", "force", "--output", "motion", "--poles", "1",
                         "--zeros", "0", "--method", method, says="unstable")

    def test_wrong_words_are_refused_in_one_line(self):
        file = self.csv(oscillator(samples=200))
        signals = ("--input", "force", "--output", "motion")
        for options, says in ((("--poles", "2", "--zeros", "3"), "3 zeros"), ((), "--poles"),
                              (("--orders", "3-4"), "--orders"), (("--orders", "5:2"), "--orders"),
                              (("--orders", "1:2", "--poles", "2"), "--orders"),
                              (("--poles", "2", "--method", "clsrivc"), "--reference"),
                              (("--poles", "2", "--delay", "soon"), "'soon'"),
                              (("--poles", "2", "--delay", "-1"), "--delay"),
                              (("--poles", "2", "--method", "oe", "--delay", "0.013"), "0.013"),
                              (("--poles", "2", "--sample-rate", "fast"), "'fast'"),
                              (("--poles", "2", "--sample-rate", "0"), "--sample-rate"),
                              (("--poles", "2", "--sample-rate", "400"), "400 Hz")):
            with self.subTest(options=options):
                self.refused(WRONG_USAGE, "tf", file, *signals, *options, says=says)
        self.refused(BAD_DATA, "tf", file, "--input", "nothing", "--output", "motion", "--poles", "1", says="nothing")
        self.refused(BAD_DATA, "tf", file, *signals, "--poles", "1", "--from", "50", says="--from")

    def test_a_constant_input_is_refused(self):
        rows = [(t, 1.0, y) for t, _, y in oscillator(samples=300)]
        self.refused(BAD_DATA, "tf", self.csv(rows), "--input", "force", "--output", "motion", "--poles", "1",
                     says="constant")

    def test_a_frequency_response_stands_in_the_json_with_its_interval(self):
        found = self.fine("tf", self.csv(oscillator()), "--input", "force", "--output", "motion", "--poles", "2",
                          "--zeros", "0", "--json").json
        response = found["frequency_response"]
        low, high = response["magnitude_interval95"]
        for k, hertz in enumerate(response["frequency_hz"]):
            s = 2j * math.pi * hertz
            a2, a1, a0 = found["denominator"]
            value = found["numerator"][0] / (a2 * s * s + a1 * s + a0)
            self.assertAlmostEqual(response["magnitude"][k], abs(value), delta=1e-9 * abs(value))
            self.assertAlmostEqual(response["imaginary"][k], value.imag, delta=1e-9 * abs(value))
            self.assertTrue(low[k] < abs(value) < high[k])


class Charts(Case):
    def test_are_three_files_that_are_not_lost_unasked(self):
        lines = ["time,force,motion"] + [",".join(f"{v:.12g}" for v in row) for row in oscillator()]
        file, prefix = self.file("signals.csv", "\n".join(lines) + "\n"), self.folder / "plot"
        options = ("tf", file, "--input", "force", "--output", "motion", "--poles", "2", "--zeros", "0", "--charts", prefix)
        self.fine(*options)
        for name in ("magnitude", "phase", "nyquist"):
            self.assertTrue((self.folder / f"plot_{name}.svg").read_text(encoding="utf-8").startswith("<svg "))
        self.assertIn("band", (self.folder / "plot_phase.svg").read_text(encoding="utf-8"))
        self.refused(WRONG_USAGE, *options, says="--overwrite")
        self.fine(*options, "--overwrite")


class Signals(Case):
    """Which signals of a file are meant, and that names for them stand in nobody's way."""

    POLES = ("--poles", "2", "--zeros", "0", "--json")

    def poles(self, *arguments):
        return self.fine("tf", *arguments, *self.POLES).json["poles"]

    def test_variables_called_input_and_output_harm_no_other_command(self):
        log = mat_file.read(make_log().path)["logs"]
        alone, beside = self.folder / "alone.mat", self.folder / "beside.mat"
        signals = {name: [log[row][:20000]] for name, row in
                   (("time", 0), ("x", 1), ("y", 2), ("Fx", 9), ("Fy", 10), ("xr", 11), ("yr", 12))}
        mat_file.write(alone, signals)
        mat_file.write(beside, {**signals, "Input": [[1.0, 2.0, 3.0]], "output": [[4.0, 5.0]],
                                "drive": [[1.0, 2.0], [3.0, 4.0]]})
        of = {}
        for path in (alone, beside):
            of[path] = self.fine("measure", path, "--json").json
            self.assertEqual(len(self.fine("info", path, "--json").json["channels"]), 6)
        self.assertEqual(of[alone]["model"], of[beside]["model"])
        self.assertIn("Input", " ".join(of[beside]["notes"]))

    def test_by_name_by_alias_by_row_by_unit_and_flipped(self):
        log = mat_file.read(make_log().path)["logs"]
        wide = self.folder / "wide.mat"
        mat_file.write(wide, {"logs": log})
        named = self.poles(wide, "--input", "Fx", "--output", "x")
        for names in (("force_x", "hand_x"), ("10", "2"), ("Fx", "2"), ("10", "x")):
            self.assertEqual(self.poles(wide, "--input", names[0], "--output", names[1]), named, names)
        self.assertEqual(self.poles(wide, "--channels", "Fx=10,x=2,time=1", "--input", "Fx", "--output", "x"), named)
        straight, flipped = (self.fine("tf", wide, f"--input={sign}Fx", "--output", "x", *self.POLES).json
                             for sign in ("", "-"))
        by_row = self.fine("tf", wide, "--input=-10", "--output", "2:mm", *self.POLES).json
        self.assertAlmostEqual(flipped["gain"], -straight["gain"], delta=1e-9 * abs(straight["gain"]))
        self.assertAlmostEqual(by_row["gain"], -1e-3 * straight["gain"], delta=1e-9 * abs(straight["gain"]))
        self.assertEqual((by_row["input"]["name"], by_row["output"]), ("\N{MINUS SIGN}10", {"name": "2", "unit": "m"}))

    def test_a_file_whose_columns_are_called_input_and_output_is_taken_as_it_is(self):
        rows = oscillator()
        lines = ["time,Input [V],Output_mm"] + [f"{t:.12g},{u:.12g},{y:.12g}" for t, u, y in rows]
        file = self.file("plant.csv", "\n".join(lines) + "\n")
        found = self.fine("tf", file, "--input", "Input [V]", "--output", "Output_mm", *self.POLES).json
        self.assertEqual((found["input"]["unit"], found["output"]["unit"]), ("V", "m"))
        self.assertAlmostEqual(found["gain"], 1e-3 * GAIN, delta=1e-4)

    def test_what_is_not_asked_for_does_not_matter(self):
        rows = list(zip(*oscillator()))
        path = self.folder / "beside.mat"
        mat_file.write(path, {"time": [rows[0]], "Fx": [rows[1]], "x": [rows[2]], "ax": [[1.0, 2.0, 3.0]]})
        self.assertAlmostEqual(self.poles(path, "--input", "Fx", "--output", "x")[0]["frequency_hz"], 1.5, delta=0.02)
        self.refused(BAD_DATA, "measure", path, says="samples")

    def test_input_and_output_are_channels_that_can_be_converted_and_read_back(self):
        file = self.file("columns.csv", "\n".join(",".join(f"{v:.12g}" for v in row) for row in oscillator()) + "\n")
        for name in ("plant.h5", "plant.csv", "plant.mat"):
            path = self.folder / name
            self.mbk("convert", file, path, "--channels", "time=1,input=2:V,output=3")
            self.assertAlmostEqual(self.poles(path)[0]["frequency_hz"], 1.5, delta=0.02)


class Inverted(Case):
    """The impedance of a limb as the inverse of its admittance, beside the truth of a simulated one."""

    TRUTH = {"M": 0.015, "B": 0.8, "K": 50.0}
    SCENARIO = """
[recording]
seed = 3
[robot]
kind = "one_axis"
inertia_kg_m2 = 0.02
viscous_Nms_per_rad = 0.1
[control]
kind = "position"
proportional_Nm_per_rad = {gain}
derivative_Nms_per_rad = {damping}
[perturbation]
kind = "random_binary"
amplitude_deg = 1.5
switching_time_s = 0.15
natural_frequency_rad_per_s = 60
damping_ratio = 0.7
duration_s = 42.1
[participant]
kind = "joint"
inertia_kg_m2 = 0.015
viscosity_Nms_per_rad = 0.8
stiffness_Nm_per_rad = 50
[participant.reflex]
gain_Nms_per_rad = 0
"""

    def simulated(self, gain, damping):
        scenario = self.file("joint.toml", self.SCENARIO.format(gain=gain, damping=damping))
        path = self.folder / "joint.mat"
        self.mbk("simulate", scenario, "--out", path, "--quiet", "--overwrite")
        return path

    OPTIONS = ("--input=-F", "--output", "x", "--reference", "xr", "--method", "clsrivc", "--poles", "2", "--zeros", "0",
               "--invert", "position")

    def test_holds_the_truth_of_a_joint_in_a_stiff_and_in_a_soft_loop(self):
        for gain, damping in ((800, 12), (20, 0.5)):
            path = self.simulated(gain, damping)
            impedance = self.fine("tf", path, *self.OPTIONS, "--json").json["impedance"]
            measured = self.mbk("measure", path, "--method", "iv", "--json").json
            self.assertEqual((impedance["admittance_to"], impedance["units"]["K"]), ("position", "N·m/rad"))
            for name, truth in self.TRUTH.items():
                one = impedance[name]
                with self.subTest(gain=gain, name=name):
                    self.assertLess(abs(one["value"] - truth), 3 * one["standard_error"])
                    self.assertLess(one["standard_error"], 0.05 * truth)
                    self.assertAlmostEqual(one["value"], measured["model"][name][0][0], delta=0.05 * truth)
            response = impedance["force_per_velocity"]
            low, high = response["real_interval95"]
            for k, hertz in enumerate(response["frequency_hz"]):
                self.assertTrue(low[k] - 0.02 < self.TRUTH["B"] < high[k] + 0.02, hertz)

    def test_is_said_in_words_too_and_refused_with_a_delay(self):
        path = self.simulated(800, 12)
        ran = self.fine("tf", path, *self.OPTIONS)
        for words in ("impedance", "N·m/rad", "Re Z"):
            self.assertIn(words, ran.out)
        self.refused(WRONG_USAGE, "tf", path, *self.OPTIONS, "--delay", "0.01", says="delay")


class Report(Case):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "tf.html"
        if "MBK_WEB" in run("tf", "nothing.mat", "--poles", "1", "--report", self.path).err:
            self.skipTest("this mbk was built without the page")

    def test_holds_the_result_that_json_prints_and_the_simulation(self):
        log = make_log().path
        ran = self.fine("tf", log, "--input", "Fx", "--output", "x", "--orders", "1:2", "--json", "--report", self.path,
                        "--report-note", "<b>Ward 3")
        text = self.path.read_text(encoding="utf-8")
        document = json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL).group(1))
        schemas.check(document)
        self.assertEqual((document["schema"], document["note"]), ("mbk.tf_report/1", "<b>Ward 3"))
        self.assertEqual(document["result"], ran.json)
        lengths = {len(document["simulation"][name]) for name in ("time_s", "measured", "simulated")}
        self.assertEqual(len(lengths), 1)
        self.assertGreater(lengths.pop(), 100)
        self.refused(WRONG_USAGE, "tf", log, "--input", "Fx", "--output", "x", "--poles", "1", "--report", self.path,
                     says="--overwrite")


if __name__ == "__main__":
    main()
