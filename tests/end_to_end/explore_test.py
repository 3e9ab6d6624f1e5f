#!/usr/bin/env python3
"""mbk explore: what recordings say of a limb without M, B and K."""

import json
import math
import re
import statistics

import mat_file
import schemas
from command import BAD_DATA, WRONG_USAGE, Case, data_folder, main, make_log, run

try:
    import numpy
    import scipy.signal
except ImportError:
    scipy = None

ANKLE = ("--axes", "1", "--channels", "x=position_rad:rad,F=torque_Nm:N.m")
HERTZ = (1, 2, 5, 10, 20, 30)


class Welch(Case):
    # scipy.signal.coherence and csd/welch, Hann 2000, half overlap, constant detrend
    COHERENCE = {"z_df": (0.94273, 0.942317, 0.933617, 0.979298, 0.986462, 0.996395),
                 "z_df2": (0.972458, 0.944128, 0.96265, 0.964692, 0.992272, 0.99368),
                 "z_pf": (0.872808, 0.774411, 0.268549, 0.724822, 0.977429, 0.991347)}
    MAGNITUDE = {"z_df": (119.949, 109.4241, 79.095, 101.0275, 178.0519, 580.7178)}

    def test_of_a_real_ankle_is_that_of_scipy(self):
        for name, coherence in self.COHERENCE.items():
            with self.subTest(name):
                found = self.fine("explore", *ANKLE, "--method", "welch", "--json", data_folder("ankle") / f"{name}.csv").json
                response = found["frequency_response"]
                at = [response["frequency_hz"].index(hertz) for hertz in HERTZ]
                for k, value in zip(at, coherence):
                    self.assertAlmostEqual(response["multiple_coherence"][0][k], value, delta=6e-7)
                    self.assertAlmostEqual(response["responses"][0]["partial_coherence"][k], value, delta=6e-7)
                for k, value in zip(at, self.MAGNITUDE.get(name, ())):
                    self.assertAlmostEqual(response["responses"][0]["magnitude"][k], value, delta=6e-5 * value)


    def test_agrees_with_scipy_at_every_line(self):
        if scipy is None:
            self.skipTest("SciPy is not installed")
        path = data_folder("ankle") / "z_df2.csv"
        table = numpy.genfromtxt(path, delimiter=",", names=True)
        x, F = table["position_rad"], table["torque_Nm"]
        rate = 1 / numpy.median(numpy.diff(table["time_s"])) if "time_s" in table.dtype.names else 1000.0
        options = dict(fs=round(rate), window="hann", nperseg=2 * round(rate), detrend="constant")
        hertz, cross = scipy.signal.csd(x, -F, **options)
        _, power = scipy.signal.welch(x, **options)
        _, coherence = scipy.signal.coherence(x, F, **options)
        found = self.fine("explore", *ANKLE, "--method", "welch", "--only", "frequency-response", "--json", path).json
        self.assertNotIn("impulse_response", found)
        self.assertNotIn("parallel_cascade", found)
        response = found["frequency_response"]
        count = len(response["frequency_hz"])
        self.assertGreaterEqual(count, 90)
        numpy.testing.assert_allclose(response["frequency_hz"], hertz[1:count + 1], rtol=1e-12)
        one = response["responses"][0]
        got = numpy.array(one["real"]) + 1j * numpy.array(one["imaginary"])
        want = (cross / power)[1:count + 1]
        self.assertLess(abs(got - want).max(), 1e-9 * abs(want).max())
        self.assertLess((abs(got - want) / abs(want)).max(), 1e-9)
        numpy.testing.assert_allclose(response["multiple_coherence"][0], coherence[1:count + 1], rtol=1e-9)


class Ankle(Case):
    # fitted on 0 to 40 s, VAF on the rest: intrinsic alone, with reflex
    VAF = {"z_df": (87.0, 95.0), "z_df2": (94.0, 95.5), "z_pf": (67.5, 90.0)}

    def test_has_a_reflex_to_stretch_in_one_direction(self):
        for name, (alone, both) in self.VAF.items():
            with self.subTest(name):
                file = data_folder("ankle") / f"{name}.csv"
                found = self.fine("explore", *ANKLE, "--split", "40", "--json", file).json
                cascade = found["parallel_cascade"]
                self.assertEqual(cascade["delayed_response"], "reflex")
                self.assertEqual(cascade["validated_on"], "held-out")
                shares = cascade["shares"][0]
                self.assertGreaterEqual(shares["intrinsic_alone"]["VAF"], alone)
                self.assertGreaterEqual(shares["both"]["VAF"], both)
                low, high = shares["both"]["VAF_interval95"]
                self.assertTrue(low < shares["both"]["VAF"] < high)
                self.assertEqual(cascade["reflex"]["direction"], [1])
                self.assertEqual([one["direction"] for one in cascade["candidates"]], [[1], None, [-1]])
                self.assertTrue(0.04 <= cascade["reflex"]["delay_s"] <= 0.08)
                self.assertGreater(cascade["reflex"]["gain_along"]["value"], 0)
                response = found["impulse_response"]
                self.assertFalse(response["model"]["enough"]["enough"])
                self.assertGreater(response["explained"][0]["VAF"], response["explained_by_model"][0]["VAF"])
                text = self.fine("explore", *ANKLE, "--split", "40", file).out
                self.assert_lines_fit(text)
                for words in ("impulse response", "reflex", "stretch"):
                    self.assertIn(words, text)


    def test_is_where_the_warnings_of_measure_lead(self):
        file = data_folder("ankle") / "z_pf.csv"
        measured = run("measure", *ANKLE, "--json", file).json
        hints = {warning["code"]: warning["try"] for warning in measured["warnings"]}
        self.assertIn("mbk explore", hints["fit-poor"])
        self.assertIn("mbk explore", hints["missing-dynamics"])
        found = self.fine("explore", *ANKLE, "--json", file).json
        self.assertEqual(found["parallel_cascade"]["delayed_response"], "reflex")
        self.assertIs(found["impulse_response"]["model"]["enough"]["enough"], False)
        # what M, B and K lack is there to be had
        self.assertGreater(found["parallel_cascade"]["shares"][0]["both"]["VAF"], measured["fit"]["VAF"][0] + 10)


class Report(Case):
    def test_holds_the_result_that_json_prints(self):
        path = self.folder / "explored.html"
        if "MBK_WEB" in run("explore", "nothing.mat", "--report", path).err:
            self.skipTest("this mbk was built without the page")
        log = make_log().path
        ran = self.fine("explore", log, "--json", "--report", path, "--report-note", "<b>Ward 3")
        text = path.read_text(encoding="utf-8")
        document = json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL).group(1))
        schemas.check(document)
        self.assertEqual((document["schema"], document["note"]), ("mbk.explore_report/1", "<b>Ward 3"))
        self.assertEqual(document["result"], ran.json)
        responses = ran.json["frequency_response"]["responses"]
        K = ran.json["impulse_response"]["model"]["K"]["value"]
        self.assertEqual(len(document["model_responses"]), len(responses))
        lowest = ran.json["frequency_response"]["frequency_hz"][0]
        self.assertLess(lowest, 2)
        for k, model in enumerate(document["model_responses"]):
            self.assertEqual(len(model["magnitude"]), len(responses[k]["magnitude"]))
        self.assertGreater(document["model_responses"][0]["magnitude"][0], 0.3 * abs(K[0][0]))
        self.refused(WRONG_USAGE, "explore", log, "--report", path, says="--overwrite")


class FlexibleArm(Case):
    """Torque to acceleration of a real robot arm, ten periods of an odd multisine to 24 Hz (Kollár et al. 1994)."""

    def explored(self, *options):
        path = data_folder("flexible_arm") / "contsid_robotarm.mat"
        return path, self.fine("explore", path, "--input", "Input", "--output", "Output", "--rate", "500", *options)

    def test_is_the_response_of_the_file_with_the_noise_of_its_periods(self):
        path, ran = self.explored("--json")
        response = ran.json["frequency_response"]
        self.assertEqual(response["method"], "fast")
        self.assertEqual((response["periodic"]["period_s"], response["periodic"]["periods"]), (8.192, 10))
        self.assertEqual(response["frequency_hz"], [k / 8.192 for k in range(1, 200, 2)])
        one, = response["responses"]
        values = [complex(a, b) for a, b in zip(one["real"], one["imaginary"])]
        for got, want in zip(values, mat_file.read_complex(path)["G"]):
            self.assertLess(abs(got - want), 1e-12 * abs(want))
        relative = [deviation / abs(value) for deviation, value in zip(one["noise_standard_error"], values)]
        self.assertAlmostEqual(statistics.median(relative), 0.0144, delta=0.0001)
        for k, deviation in ((0, 0.00783), (29, 1.71), (99, 0.00183)):
            self.assertAlmostEqual(one["noise_standard_error"][k], deviation, delta=0.005 * deviation)

    def test_has_no_even_distortion_once_what_the_input_carries_is_subtracted(self):
        _, ran = self.explored("--json")
        periodic = ran.json["frequency_response"]["periodic"]
        even = periodic["even_distortion"]
        for name, amplitude in (("uncorrected", 7.0e-4), ("relative", 3.8e-4), ("noise", 4.7e-4)):
            self.assertAlmostEqual(even["output_amplitude"] * even[name], amplitude, delta=0.06e-4)
        self.assertIs(even["detected"], False)
        self.assertNotIn("odd_distortion", periodic)
        text = " ".join(self.explored()[1].out.split())
        for words in ("even", "odd", "8.192 s"):
            self.assertIn(words, text)


class TwoAxes(Case):
    def test_text_and_json_say_the_same(self):
        log = make_log().path
        found = self.fine("explore", log, "--json").json
        self.assertEqual(found["schema"], "mbk.explore/1")
        self.assertEqual(found["axes"], 2)
        responses = found["frequency_response"]["responses"]
        self.assertEqual([(one["input"], one["output"]) for one in responses],
                         [(f"hand_{j}", f"−force_{i}") for j in "xy" for i in "xy"])
        text = self.fine("explore", log).out
        self.assert_lines_fit(text)
        for words in ("frequency response", "hand_x → −force_x", "hand_y → −force_x", "N/m"):
            self.assertIn(words, text)


ARM = """
[recording]
seed = {seed}
[robot]
home_mm = [300, -50]
coulomb_Nm = [0.114, 0.114]
[control]
kind = "{control}"
[perturbation]
kind = "multisine"
{peak}
period_s = 5
odd_harmonics_to = {highest}
odd_group = {group}
phase_seed = {phases}
axes = "{axes}"
duration_s = 35.1
[participant]
kind = "linear"
mass_kg = [[1.33, -0.9], [-0.9, 1.9]]
damping_Ns_per_m = [[5.8, -2.1], [-2.1, 10.6]]
stiffness_N_per_m = [[42, -20], [-36, 125]]
{more}
[participant.remnant]
floor_N = {noise}
[sensors.force]
kind = "load_cell"
white_noise_N = {sensor}
"""
K = ((42, -20), (-36, 125))
B = ((5.8, -2.1), (-2.1, 10.6))
M = ((1.33, -0.9), (-0.9, 1.9))


def stiffness(i, j, hertz):
    """Dynamic stiffness of that arm."""
    omega = 2 * math.pi * hertz
    return K[i][j] + 1j * omega * B[i][j] - omega**2 * M[i][j]


def trial(case, name, seed, phases, axes="independent", control="position", peak="peak_mm = 8", noise=0.05, more="",
          highest=19, group=0, sensor=0.02):
    """A simulated trial of a linear arm."""
    text = ARM.format(seed=seed, phases=phases, axes=axes, control=control, peak=peak, noise=noise, more=more,
                      highest=highest, group=group, sensor=sensor)
    path = case.folder / f"{name}.h5"
    case.mbk("simulate", case.file(f"{name}.toml", text), "--out", path, "--quiet", "--overwrite")
    return path


class Realisations(Case):
    def pairs(self, count, **how):
        return [trial(self, f"pair{k}{axes}", 10 * k + which, k, f"hadamard_{axes}", **how)
                for k in range(1, count + 1) for which, axes in enumerate(("first", "second"))]

    def explored(self, files, *options):
        found = self.fine("explore", *files, "--json", *options).json
        return found, found["frequency_response"]

    def assert_covered(self, response, least):
        inside = lines = 0
        for one in response["responses"]:
            i, j = "xy".index(one["output"][-1]), "xy".index(one["input"][-1])
            for k, hertz in enumerate(response["frequency_hz"]):
                value = complex(one["real"][k], one["imaginary"][k])
                inside += abs(value - stiffness(i, j, hertz)) <= one["region95_radius"][k]
                lines += 1
        self.assertGreaterEqual(inside, least * lines, f"{inside} of {lines}")

    def test_of_a_linear_arm_in_orthogonal_pairs_have_its_response_and_no_distortion(self):
        for control, peak in (("position", "peak_mm = 8"), ("force", "peak_N = 5")):
            with self.subTest(control):
                found, response = self.explored(self.pairs(4, control=control, peak=peak))
                periodic = response["periodic"]
                self.assertEqual((response["method"], periodic["orthogonal"], periodic["realisations"]),
                                 ("robust", True, 8))
                lines = [k / 5 for k in range(1, 20, 2)]
                self.assertEqual([round(hertz, 9) for hertz in response["frequency_hz"]], lines)
                self.assert_covered(response, 0.8)  # 95 % of 40, of the handle's inertia too
                self.assertLess(periodic["total_over_noise"]["ratio"], 2)
                self.assertNotIn("nonlinear-distortion", [warning["code"] for warning in found["warnings"]])

    def test_of_a_hardening_arm_show_its_distortion(self):
        hardening = "[participant.departures]\ncubic_stiffness_N_per_m3 = 2e5"
        found, response = self.explored(self.pairs(3, more=hardening))
        self.assertGreater(response["periodic"]["total_over_noise"]["ratio"], 2)
        self.assertIn("nonlinear-distortion", [warning["code"] for warning in found["warnings"]])
        text = " ".join(self.fine("explore", *self.folder.glob("pair*.h5")).out.split())
        self.assertIn("distortion", text)


class TwoTrials(Case):
    def test_one_trial_of_two_axes_is_not_taken_apart_by_periods_and_the_text_says_why(self):
        path = trial(self, "one", 1, 1)
        text = " ".join(self.fine("explore", path).out.split())
        self.assertIn("one trial", text)
        self.assertIn("two inputs", text)
        self.refused(BAD_DATA, "explore", path, "--method", "robust", says="one trial")
        self.refused(WRONG_USAGE, "explore", path, "--method", "robust", "--period", "0.0005", says="period")


class ChangeOverTime(Case):
    def simulated(self, name, more=""):
        text = self.mbk("simulate", "--show", "relaxed_sinusoidal").out + more
        path = self.folder / f"{name}.h5"
        self.mbk("simulate", self.file(f"{name}.toml", text), "--out", path, "--quiet")
        return path

    def test_a_constant_arm_is_called_constant_and_one_that_triples_is_followed(self):
        constant = self.fine("explore", self.simulated("constant"), "--json").json["time_course"]
        self.assertEqual(constant["verdict"], "constant")
        self.assertTrue(constant["instruments"])
        self.assertNotIn("value", constant["K"])
        levels = "".join(f"\n[[participant.stiffness_at]]\ntime_s = {t}\nfactor = {factor}\n"
                         for t, factor in ((31, 1), (32, 3)))
        path = self.simulated("triples", levels)
        triples = self.fine("explore", path, "--json").json["time_course"]
        self.assertEqual(triples["verdict"], "changes")
        self.assertIn("K", triples["varying"])
        diagonal = triples["K"]["value"][3]
        early = [k for t, k in zip(triples["at"], diagonal) if 5 < t < 28]
        late = [k for t, k in zip(triples["at"], diagonal) if 35 < t < 58]
        self.assertAlmostEqual(statistics.mean(late) / statistics.mean(early), 3, delta=0.45)
        text = self.fine("explore", path).out
        self.assert_lines_fit(text)
        for words in ("BIC", "K_xx [N/m]"):
            self.assertIn(words, text)

    def test_is_followed_over_a_channel(self):
        log = make_log().path
        found = self.fine("explore", log, "--schedule", "hand_x", "--json").json["time_course"]
        self.assertEqual((found["variable"], found["unit"]), ("hand_x", "m"))
        self.refused(BAD_DATA, "explore", log, "--schedule", "nothing", says="nothing")

    def test_is_followed_over_a_column_of_any_name(self):
        rows = ["time_s,position_m,reaction_N,cocontraction"]
        for i in range(8000):
            t = i / 200
            waves = [(2 * math.pi * f, 2 * math.pi * f * t + f * f) for f in (0.3, 0.7, 1.1, 1.7, 2.3, 2.9)]
            x, v, a = (0.004 * sum(part(w, p) for w, p in waves)
                       for part in (lambda w, p: math.sin(p), lambda w, p: w * math.cos(p), lambda w, p: -w * w * math.sin(p)))
            level = 0.5 + 0.4 * math.sin(2 * math.pi * t / 17)
            noise = 0.05 * math.sin(1000 * i * i)
            rows.append(f"{t},{x:.9g},{-(1.5 * a + 10 * v + (80 + 100 * level) * x) + noise:.9g},{level:.9g}")
        path = self.file("levels.csv", "\n".join(rows))
        plain = ("explore", path, "--only", "time-course", "--json")
        for how in (("--schedule", "cocontraction"), ("--schedule", "4"),
                    ("--schedule", "4", "--channels", "x=2,F=3"), ("--schedule", "cocontraction", "--channels", "time=1:s"),
                    ("--schedule", "schedule", "--channels", "x=2,F=3,schedule=4"),
                    ("--schedule", "4", "--input", "2", "--output=-3")):
            with self.subTest(how):
                found = self.fine(*plain, *how).json
                course = found["time_course"]
                self.assertEqual(course["variable"], how[1])
                self.assertEqual(course["varying"], "K")
                for level, stiffness in zip(course["at"], course["K"]["value"][0]):
                    self.assertAlmostEqual(stiffness, 80 + 100 * level, delta=4)
                self.assertNotIn("cocontraction", " ".join(found["notes"]))
        self.refused(BAD_DATA, *plain, "--schedule", "nothing", says="nothing")

    def test_is_followed_since_an_event(self):
        log = make_log().path
        self.refused(BAD_DATA, "explore", log, "--align", "nothing", says="nothing")
        self.refused(WRONG_USAGE, "explore", log, "--align", "reference", "--schedule", "hand_x", says="--schedule")


class AfterOnset(Case):
    def test_tells_the_inertia_and_says_what_it_cannot_tell(self):
        path = self.folder / "pulses.h5"
        self.mbk("simulate", "rigid_underdamped_2N", "--out", path, "--quiet")
        found = self.fine("explore", path, "--after-onset", "120", "--json").json["after_onset"]
        self.assertIs(found["K"]["identifiable"], False)
        self.assertEqual(found["handle_mass"], 0.194)
        text = self.fine("explore", path, "--after-onset", "120").out
        self.assert_lines_fit(text)
        self.assertIn("120 ms", text)
        self.assertIn("identifiable", text)

    def test_needs_onsets(self):
        path = self.folder / "sines.h5"
        self.mbk("simulate", "relaxed_sinusoidal", "--out", path, "--quiet")
        self.refused(BAD_DATA, "explore", path, "--after-onset", "120", says="of rest")
        self.refused(WRONG_USAGE, "explore", path, "--after-onset", "-5", says="--after-onset")


class Mistakes(Case):
    def test_are_refused_in_one_line(self):
        log = make_log().path
        for options, says in ((("--segment", "0"), "--segment"), (("--max-frequency", "-1"), "--max-frequency"),
                              (("--from", "5", "--to", "3"), "--from"), (("--protocol", "sometimes"), "--protocol")):
            with self.subTest(options):
                self.refused(WRONG_USAGE, "explore", log, *options, says=says)
        self.refused(BAD_DATA, "explore", log, "--method", "welch", "--segment", "1000", says="segment")
        self.refused(BAD_DATA, "explore", log, "--only", "ramp-and-hold", says=("ramps and holds", "--only"))
        self.refused(BAD_DATA, "explore", self.folder / "none.mat", says="none.mat")
        self.refused(WRONG_USAGE, "explore", log, "--input", "x", says="--output")
        self.refused(BAD_DATA, "explore", log, "--input", "x", "--output", "nothing", says="nothing")


if __name__ == "__main__":
    main()
