#!/usr/bin/env python3
"""mbk measure on recordings whose truth is known: the JSON contract, the intervals, several files, repeatability."""

import ctypes
import itertools
import math
import os
import statistics
import struct
import zipfile

from numpy_opensim_test import npy

from command import NOT_USABLE, WRONG_USAGE, Case, copy, flat, main, make_log, run, table_of

NORMAL95 = 1.96
SLACK = 1.8  # a dozen intervals of 95 % at once hold the truth all together only when each is this much wider
PROTOCOLS = ("sinusoidal", "underdamped")


def results_of(*arguments):
    return run("measure", "--json", *arguments).json


class Opens:
    """Counts how often a file is opened, by inotify."""

    def __init__(self, path):
        self.libc = ctypes.CDLL(None, use_errno=True)
        self.fd = self.libc.inotify_init1(os.O_NONBLOCK)
        self.libc.inotify_add_watch(self.fd, os.fsencode(path), 0x20)  # IN_OPEN

    def count(self):
        """Since the last call."""
        try:
            return len(os.read(self.fd, 1 << 16)) // 16
        except BlockingIOError:
            return 0


class Json(Case):
    """Every field of the interface, with its shape."""

    def assert_shape(self, value, *shape):
        if not shape:
            self.assertIsInstance(value, (int, float), value)
            return
        self.assertEqual(len(value), shape[0], value)
        for item in value:
            self.assert_shape(item, *shape[1:])

    def assert_result(self, result, log, axes, protocol, mode):
        self.assertEqual(result["schema"], "mbk.result/2")
        self.assertRegex(result["software"], r"\Ambk \d+\.\d+\.\d+")
        (source,) = result["inputs"]
        self.assertEqual(source["file"], str(log.path))
        self.assertRegex(source["sha256"], r"\A[0-9a-f]{64}\Z")
        self.assertGreater(source["duration_s"], 60.0)
        self.assertAlmostEqual(source["rate_hz"], 1000.0, places=5)
        self.assertEqual((result["mode"], result["protocol"], result["method"]), (mode, protocol, "iv" if mode == "default" else "ls"))
        for part in ("model", "standard_error"):
            for matrix in "MBK":
                self.assert_shape(result[part][matrix], axes, axes)
            self.assert_shape(result[part]["x0"], axes)
        self.assertTrue(all(se > 0.0 for part in "MBK" for se in flat(result["standard_error"][part])))
        self.assert_shape(result["fit"]["VAF"], axes)
        self.assert_shape(result["fit"]["RMSE"], axes)
        self.assertEqual(result["fit"]["validated_on"], "held-out")
        self.assertIsInstance(result["alternatives"], list)
        self.assertIn("disagreement", result)
        self.assertEqual(result["warnings"], [])
        self.assertIs(result["usable"], True)
        self.assertEqual("ellipses" in result, axes == 2)
        self.assertEqual("antisymmetry" in result, axes == 2)

    def assert_findings(self, result):
        self.assertEqual(set(result["ellipses"]), {"inertia", "damping", "stiffness"})
        for ellipse in result["ellipses"].values():
            for name in ("area", "shape", "orientation_deg"):
                low, high = ellipse["interval95"][name]
                self.assertLess(low, ellipse[name])
                self.assertLess(ellipse[name], high)
            self.assertGreaterEqual(ellipse["shape"], 1.0)
            self.assertTrue(0.0 <= ellipse["orientation_deg"] < 180.0)
        self.assertEqual(set(result["antisymmetry"]), {"inertia", "stiffness"})
        for finding in result["antisymmetry"].values():
            self.assert_shape(finding["value"])
            self.assert_shape(finding["zmean_percent"])
            self.assert_shape(finding["interval95"], 2)

    def assert_truth(self, result, log):
        model, error = result["model"], result["standard_error"]
        for name, truth in log.truth.items():
            for got, se, true in zip(flat(model[name]), flat(error[name]), flat(truth)):
                self.assertLessEqual(abs(got - true), SLACK * NORMAL95 * se + 5e-5, f"{name}: {got} ± {se}, {true}")

    def test_two_axes_of_both_protocols_in_both_modes(self):
        for protocol, mode in itertools.product(PROTOCOLS, ("default", "reference")):
            with self.subTest(protocol=protocol, mode=mode):
                log = make_log(protocol)
                result = self.fine("measure", "--json", "--mode", mode, log.path).json
                self.assert_result(result, log, 2, protocol, mode)
                self.assert_findings(result)
                if mode == "default":
                    self.assert_truth(result, log)
                else:  # its filters run over the edges of the pulses, so a little of the truth is lost
                    self.assert_relative(result["model"]["M"], log.truth["M"], 0.02)
                    self.assert_relative(result["model"]["K"], log.truth["K"], 0.02)

    def test_one_axis_of_both_protocols(self):
        for protocol in PROTOCOLS:
            with self.subTest(protocol=protocol):
                log = make_log(protocol, "--one-axis")
                result = self.fine("measure", "--json", log.path).json
                self.assert_result(result, log, 1, protocol, "default")
                self.assert_truth(result, log)

    def test_what_a_person_adds_widens_the_intervals_and_they_still_hold_the_truth(self):
        quiet, moving = make_log("sinusoidal"), make_log("sinusoidal", "--coloured-force-noise", "0.3")
        result = results_of(moving.path)
        self.assert_truth(result, moving)
        self.assertGreater(result["standard_error"]["K"][0][0],
                           3.0 * results_of(quiet.path)["standard_error"]["K"][0][0])

    def test_a_model_that_must_not_be_used_says_so_and_ends_with_4(self):
        ran = self.mbk("measure", "--json", "--handle-mass", "5", make_log().path, code=NOT_USABLE)
        self.assertEqual(ran.err, "")
        self.assertIs(ran.json["usable"], False)
        (warning,) = [w for w in ran.json["warnings"] if w["code"] == "handle-mass-too-large"]
        self.assertIn("kg", warning["message"])
        self.assertTrue(warning["try"])
        ran = self.mbk("measure", "--handle-mass", "5", make_log().path, code=NOT_USABLE)
        self.assertIn("NOT USABLE", ran.out)
        self.assertIn("! handle-mass-too-large: ", ran.out)


class Text(Case):
    def test_it_names_the_file_the_choices_and_the_unit_of_every_row(self):
        log = make_log()
        text = self.fine("measure", log.path).out
        for line in (rf"{log.path}   62\.1 s at 1000 Hz", r"  protocol +sinusoidal\b",
                     r"  inertia M .*±.* kg", r"  damping B .*±.* N·s/m", r"  stiffness K .*±.* N/m",
                     r"  equilibrium +x .*± .* y .*± .* mm", r"  fit on held-out data +VAF .* % +RMSE .* N"):
            self.assertRegex(text, rf"(?m)^{line}")

    def test_lines_fit_a_terminal_of_100_columns(self):
        for options in ([], ["--mode", "reference"], ["--handle-mass", "5"], ["--decimate-check"]):
            for protocol in PROTOCOLS:
                log = copy(make_log(protocol).path, self.folder / "log.mat")
                self.assert_lines_fit(run("measure", log.name, *options, folder=self.folder).out)

    def test_numbers_with_units_stand_in_one_column(self):
        lines = self.fine("measure", make_log().path).out.splitlines()
        rows = [line for line in lines if "±" in line and line.startswith("  ") and not line.startswith("  (")]
        rows = rows[:4]  # of the model; other tables follow
        self.assertEqual(len(rows), 4)
        starts = {row.rindex(unit) for row, unit in zip(rows, ("kg", "N·s/m", "N/m", "mm"))}
        self.assertEqual(len(starts), 1, "\n".join(rows))

    def test_no_line_ends_in_blanks(self):
        for log in (make_log(), make_log("underdamped"), make_log("sinusoidal", "--one-axis")):
            for line in run("measure", "--handle-mass", "5", log.path).out.splitlines():
                self.assertEqual(line, line.rstrip())


class SeveralFiles(Case):
    def logs(self):
        return [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2, 3)]

    def test_each_has_its_result_and_the_summary_their_mean_and_standard_error(self):
        both = self.fine("measure", "--json", "--quiet", *self.logs()).json
        self.assertEqual(both["schema"], "mbk.results/1")
        self.assertEqual(both["results"], [results_of(log) for log in self.logs()])
        summary = both["summary"]
        self.assertEqual(summary["trials"], 3)
        for name in ("M", "B", "K", "x0"):
            trials = list(zip(*(flat(result["model"][name]) for result in both["results"])))
            self.assert_relative(summary["model"][name], [statistics.fmean(values) for values in trials], 1e-13)
            self.assert_relative(summary["between_trial_standard_error"][name],
                                 [statistics.stdev(values) / math.sqrt(3) for values in trials], 1e-9)

    def test_the_text_ends_with_the_mean(self):
        text = self.fine("measure", "--quiet", *self.logs()).out
        self.assertRegex(text, r"(?m)^mean of 3 trials\b")
        self.assertIn("95 %", text)

    def test_pool_makes_one_fit_over_all(self):
        pooled = self.fine("measure", "--json", "--pool", *self.logs()).json
        self.assertEqual(pooled["schema"], "mbk.result/2")
        self.assertEqual([source["file"] for source in pooled["inputs"]], [str(log) for log in self.logs()])
        one = results_of(self.logs()[0])
        self.assertEqual(pooled["estimation"]["samples"], 3 * one["estimation"]["samples"])
        self.assertLess(pooled["standard_error"]["K"][0][0], one["standard_error"]["K"][0][0])
        self.assertIn("3 trials", self.fine("measure", "--pool", *self.logs()).out)

    def test_one_and_two_axes_have_no_common_mean(self):
        other = make_log("sinusoidal", "--one-axis").path
        said = " ".join(self.fine("measure", "--quiet", make_log().path, other).out.split())
        for fact in ("axes", str(make_log().path), str(other)):
            self.assertIn(fact, said)
        self.refused(3, "measure", "--pool", make_log().path, other, says=[str(other), "axes"])


class Repeatability(Case):
    def test_the_same_input_gives_the_same_bytes(self):
        log = make_log("underdamped").path
        for options in ([], ["--json"]):
            self.assertEqual(run("measure", log, *options).bytes, run("measure", log, *options).bytes)

    def test_the_number_of_threads_changes_nothing(self):
        logs = [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2, 3)]
        for options in ([], ["--json"], ["--json", "--pool"]):
            outputs = {run("measure", *logs, *options, "--threads", n).bytes for n in (1, 2, 5)}
            self.assertEqual(len(outputs), 1)

    def test_vector_instructions_change_no_more_than_the_last_digits(self):
        log = make_log("sinusoidal").path
        here = results_of(log)["model"]
        for simd in ("any", "v3", "v4"):  # more than the processor has is what it has
            other = run("measure", "--json", log, environment={"MBK_SIMD": simd}).json["model"]
            for key in ("M", "B", "K"):
                largest = max(map(abs, flat(here[key])))
                for one, two in zip(flat(here[key]), flat(other[key])):
                    self.assertLess(abs(one - two), 1e-9 * largest)
        refused = run("measure", log, environment={"MBK_SIMD": "v9"})
        self.assertEqual(refused.code, WRONG_USAGE)
        self.assertIn("any, v3, v4", refused.err)

    def test_the_name_of_the_file_does_not_matter(self):
        odd = copy(make_log().path, self.folder / "Versuch 3 (späß), neu.csv")
        renamed, plain = self.fine("measure", "--json", odd).json, results_of(make_log().path)
        self.assertEqual(renamed["inputs"][0].pop("file"), str(odd))
        plain["inputs"][0].pop("file")
        self.assertEqual(renamed, plain)


class JitteringClock(Case):
    """Stamps that deviate by a tenth of an interval: the recorded times are the times, or the message says why not."""

    def measured(self, scenario, stamps):
        experiment = self.file("jitter.toml", run("simulate", "--show", scenario).out + stamps)
        self.fine("simulate", experiment, "--out", self.folder / "trial.h5", "--quiet", "--overwrite")
        return results_of(self.folder / "trial.h5")

    def test_it_changes_neither_protocol_nor_model(self):
        for scenario in ("relaxed_sinusoidal", "relaxed_underdamped"):
            steady = self.measured(scenario, "")
            for stamps, said in (("actual", "position"), ("nominal", None)):
                with self.subTest(scenario, stamps=stamps):
                    found = self.measured(scenario, f'\n[sensors.clock]\njitter_us = 100\ntimestamps = "{stamps}"\n')
                    self.assertEqual(found["protocol"], steady["protocol"])
                    for matrix in "MBK":
                        for one, other, se in zip(flat(found["model"][matrix]), flat(steady["model"][matrix]),
                                                  flat(steady["standard_error"][matrix])):
                            self.assertLess(abs(one - other), 0.5 * se, matrix)
                    messages = [one["message"] for one in found["warnings"] if one["code"] == "clock-jitter"]
                    self.assertEqual(len(messages), 1 if said else 0, "stamps as planned show nothing")
                    if said:
                        self.assertIn(said, messages[0])


class OpenedOnce(Case):
    def test_a_recording_is_opened_once(self):
        log = make_log().path
        for suffix in (".mat", ".h5", ".csv", ".npz"):
            file = self.folder / f"log{suffix}"
            if suffix == ".mat":
                copy(log, file)
            elif suffix == ".npz":
                with zipfile.ZipFile(file, "w") as archive:
                    for name, column in zip(("time", "x", "y", "Fx", "Fy"), table_of(make_log())):
                        data = struct.pack(f"<{len(column)}d", *column)
                        archive.writestr(f"{name}.npy", npy("'<f8'", f"({len(column)},)", data))
            else:
                self.mbk("convert", log, file)
            opens = Opens(file)
            for command in (("measure", file), ("info", file), ("explore", file),
                            ("convert", file, self.folder / f"copy_of_{suffix[1:]}.h5")):
                with self.subTest(f"{command[0]} {suffix}"):
                    self.mbk(*command)
                    self.assertEqual(opens.count(), 1)

    def test_a_study_opens_what_it_copies_once(self):
        log = self.folder / "log.mat"
        copy(make_log().path, log)
        self.mbk("study", "init", self.folder / "study", "--title", "opens")
        opens = Opens(log)
        self.mbk("study", "add", log, "--participant", "1", "--study", self.folder / "study", "--quiet")
        self.assertEqual(opens.count(), 1)


if __name__ == "__main__":
    main()
