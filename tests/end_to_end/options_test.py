#!/usr/bin/env python3
"""Every option of mbk measure: it changes the result, or is refused in one line; --out loses and leaves nothing."""

import json
import os
import re
import stat
import unittest

from command import (BAD_DATA, FINE, NOT_SHOWN, WRONG_USAGE, Case, copy, is_root, main, make_log, run, table_of,
                     write_csv)

COMMANDS = ("measure", "identify", "explore", "movement", "tf", "ellipse", "info", "simulate", "springs", "sensor", "robot", "validate",
            "completion", "manual", "passivity", "teleop", "compare", "reproduce")
SUBCOMMANDS = {"springs": ("field", "find", "calibrate"), "sensor": ("calibrate", "delay"),
               "robot": ("workspace", "describe", "identify", "force", "check")}
NO_NUMBERS = ("", " ", "abc", "nan", "inf", "-inf", "1e400", "5Hz", "5,5", "0x10")
NUMBERS = {  # option: what it must not be, besides NO_NUMBERS
    "--rate": ("0", "-1", "-1e300"),
    "--resample": ("0", "-1", "1e300"),
    "--cutoff": ("0", "-1", "1e300", "500", "600"),
    "--from": ("-1", "1e300"),
    "--split": ("0", "-1", "1e300"),
    "--to": ("0", "-1", "1e300"),
    "--handle-mass": ("-1", "1e300"),
    "--hac-lag": ("0", "-1", "1e300", "100000"),
    "--force-delay-ms": ("1001", "-1e300"),
    "--force-rotation-deg": ("181", "-1e300", "1,2", "0,0,181", "1,2,3,4", "0,,1"),
    "--sg-window": ("0", "-5", "1", "100", "3.5", "1e2", "99999999999999999999"),
    "--sg-order": ("0", "-1", "2.5", "1e1", "99999999999999999999"),
    "--padding": ("-1", "1.5", "1e3", "99999999999999999999"),
    "--threads": ("0", "-1", "1.5", "1e1", "99999999999999999999"),
    "--every": ("0", "-1", "1.5", "1e1", "99999999999999999999"),
    "--axes": ("0", "-1", "4", "1.0"),
    "--bootstrap": ("-1", "1.5", "1e1", "99999999999999999999"),
    "--seed": ("-1", "1.5", "1e1", "99999999999999999999"),
}
WORDS = {"--mode": "default|reference", "--procedure": "chapter3|chapter5",
         "--protocol": "auto|sinusoidal|underdamped|free", "--method": "ls|iv", "--extension": "odd|even|constant",
         "--acceleration": "sensor|derivative", "--structure": "full|symmetric|mass-spring",
         "--parameters-from": "identification|all", "--force-source": "sensor|virtual|observer",
         "--domain": "hand|joint"}


class Values(Case):
    """Values that cannot be meant are refused in one line that names option and value."""

    def test_numbers(self):
        log = make_log().path
        for option, wrong in NUMBERS.items():
            for value in (*NO_NUMBERS, *wrong):
                with self.subTest(option=option, value=value):
                    name = option if float_of(value) not in (500.0, 600.0) else option[2:]
                    given = [f"{option}={value}"] if value else [option, value]
                    ran = self.refused(WRONG_USAGE, "measure", log, *given, says=name)
                    if len(value) < 10 and float_of(value) is None:
                        self.assertIn(f"'{value}'", ran.err)
                    elif len(value) < 10:
                        self.assertIn(value, ran.err)

    def test_a_long_value_is_cut(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--cutoff", "9" * 400, says="--cutoff")

    def test_words(self):
        for option, words in WORDS.items():
            for value in ("bogus", "", words.split("|")[0].upper()):
                with self.subTest(option=option, value=value):
                    self.refused(WRONG_USAGE, "measure", make_log().path, option, value,
                                 says=[option, f"'{value}'", words])

    def test_channel_maps(self):
        for value in ("", "x", "x=", "=2", "x=2,x=3", "x=2,,y=3", "speed=2", "xx=2"):
            with self.subTest(value):
                self.refused(WRONG_USAGE, "measure", make_log().path, "--channels", value)

    def test_limits_of_time_in_the_wrong_order(self):
        log = make_log().path
        self.refused(WRONG_USAGE, "measure", log, "--from", "50", "--to", "20", says=["--from 50", "--to 20"])
        self.refused(WRONG_USAGE, "measure", log, "--from", "50", "--split", "20", says=["--from 50", "--split 20"])
        self.refused(WRONG_USAGE, "measure", log, "--split", "50", "--to", "20", says=["--split 50", "--to 20"])

    def test_limits_of_time_outside_the_recording(self):
        for options in (("--from", "63"), ("--to", "63"), ("--split", "63"), ("--from", "62.05", "--to", "62.06")):
            with self.subTest(options=options):
                self.bad_data(make_log().path, *options)

    def test_a_procedure_without_the_reference_mode(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--procedure", "chapter5", says="--mode reference")

    def test_a_resampling_rate_in_the_wrong_unit(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--resample", "1000000", says="--resample 1e+06")

    def test_a_rate_that_contradicts_the_time(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--rate", "500", says=["500", "1000 Hz"])

    def test_a_variable_of_a_table(self):
        path = write_csv(self.folder / "log.csv", table_of(make_log(), 1000))
        self.refused(WRONG_USAGE, "measure", path, "--variable", "logs", says="--variable logs")

    def test_padding_that_no_window_can_bear(self):
        self.bad_data(make_log().path, "--padding", "100000", says=["100000", "--padding"])

    def test_validate(self):
        for option in ("--runs", "--threads", "--seed"):
            for value in (*NO_NUMBERS, "-1", "1.5", "99999999999999999999"):
                with self.subTest(option=option, value=value):
                    self.refused(WRONG_USAGE, "validate", f"{option}={value}", says=option)
        self.refused(WRONG_USAGE, "validate", "--runs", "0", says="--runs")
        self.refused(WRONG_USAGE, "validate", "magic", "--runs", "1", says=["'magic'", "coverage", "springs"])
        self.refused(WRONG_USAGE, "validate", "--runs", "1", "--overwrite", says=["--overwrite", "--charts"])

    def test_reproduce(self):
        for option in ("--threads", "--seed"):
            for value in (*NO_NUMBERS, "0", "-1", "1.5", "99999999999999999999"):
                with self.subTest(option=option, value=value):
                    self.refused(WRONG_USAGE, "reproduce", f"{option}={value}", says=option)
        self.refused(WRONG_USAGE, "reproduce", "--out", "", says="--out")
        self.refused(WRONG_USAGE, "reproduce", "--only", "table-9.9", "--quiet", "--out", self.folder / "made",
                     says=["'table-9.9'", "mbk reproduce --list"])
        self.refused(WRONG_USAGE, "reproduce", "--list", "--out", self.folder / "made", says=["--list", "--out"])
        self.assertEqual(self.names(), [])


def float_of(text):
    try:
        value = float(text)
    except ValueError:
        return None
    return value if abs(value) < 1e300 and text.strip() == text else None


class Commands(Case):
    def test_unknown_options_are_named(self):
        for command in COMMANDS:
            if command in SUBCOMMANDS:
                continue  # their commands have tests of their own
            arguments = {"validate": [], "reproduce": [], "completion": ["bash"],
                         "compare": [make_log().path] * 2}.get(command, [make_log().path])
            self.refused(WRONG_USAGE, command, *arguments, "--cutof=5", says=["--cutof", f"mbk {command} --help"])

    def test_unknown_commands_are_named(self):
        self.refused(WRONG_USAGE, "mesure", make_log().path, says=["'mesure'", "mbk --help"])
        self.refused(WRONG_USAGE, make_log().path, says=str(make_log().path))

    def test_nothing_at_all(self):
        self.refused(WRONG_USAGE, says="mbk --help")
        self.refused(WRONG_USAGE, "measure", says=["FILE", "mbk measure --help"])
        self.refused(WRONG_USAGE, "ellipse", says=["RESULT.json", "mbk ellipse --help"])

    def test_what_was_meant_is_named(self):
        log = make_log().path
        for said, typed in ((("'--cutoff'", "mbk measure --help"), ("measure", log, "--cutof=5")),
                            (("'measure'", "mbk --help"), ("mesure", log)),
                            (("'add'", "mbk study --help"), ("study", "ad"))):
            self.refused(WRONG_USAGE, *typed, says=said)
        ran = self.refused(WRONG_USAGE, "measure", log, "--nonsense")
        self.assertEqual(set(re.findall(r"--[a-z-]+", ran.err)), {"--nonsense", "--help"}, ran)

    def test_too_many_and_too_few_words_are_named(self):
        log = make_log().path
        self.refused(WRONG_USAGE, "simulate", "relaxed", "rigid", says=["'rigid'", "mbk simulate"])
        self.refused(WRONG_USAGE, "study", says="init, defaults, add, import")
        self.refused(WRONG_USAGE, "measure", log, "--cutoff", says=["--cutoff", "HZ|none"])

    def test_overwrite_without_out(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--overwrite", says="--out")


class Effects(Case):
    """What each option changes in the result."""

    def measured(self, *options, log=None, code=FINE):
        return self.mbk("measure", "--json", log or make_log().path, *options, code=code).json

    def preparation(self, *options, **more):
        return self.measured(*options, **more)["preparation"][0]

    def test_each_option_of_the_help_is_known_to_these_tests(self):
        options = set(re.findall(r"(?m)^  (?:-h,)?(--[a-z-]+)", run("measure", "--help").out))
        elsewhere = {"--help", "--channels", "--variable", "--parts", "--trial", "--clock",
                     "--json", "--out", "--overwrite", "--quiet",
                     "--pool", "--decimate-check", "--report", "--report-note",
                     "--summary", "--charts", "--chart-width", "--chart-format",  # tables_and_charts_test.py
                     "--sensor", "--lever-arm-mm", "--sensor-zero", "--sensor-frame", "--sensor-delay",  # sensor_test.py
                     "--robot",  # robot_force_test.py
                     "--ranges", "--ignore-range",  # mistakes_test.py
                     "--side", "--trial",  # kinarm_test.py
                     "--clock",  # of files with several streams
                     "--arm"}  # joint_domain_test.py
        self.assertEqual(options, set(NUMBERS) | set(WORDS) | elsewhere)

    def test_mode_and_procedure(self):
        self.assertEqual(self.measured("--mode", "reference")["mode"], "reference")
        three = self.preparation("--mode", "reference", "--procedure", "chapter3")
        five = self.preparation("--mode", "reference", "--procedure", "chapter5")
        self.assertEqual((three["savitzky_golay"]["window"], three["cutoff_hz"]), (101, 5.0))
        self.assertEqual((five["savitzky_golay"]["window"], five["cutoff_hz"]), (151, 4.5))
        self.assertEqual(three, self.preparation("--mode", "reference"))

    def test_protocol(self):
        self.assertEqual(self.measured("--protocol", "auto"), self.measured())
        free = self.measured("--protocol", "free")
        self.assertEqual((free["protocol"], free["preparation"][0]["protocol_rule"]), ("free", "given"))

    def test_window(self):
        how = self.preparation("--from", "10", "--split", "30", "--to", "50")
        self.assertTrue(10.0 <= how["from_s"] < 10.2)
        self.assertTrue(49.8 < how["to_s"] <= 50.0)
        self.assertEqual(how["split_s"], 30.0)

    def test_filters(self):
        how = self.preparation("--sg-window", "31", "--sg-order", "4", "--cutoff", "8")
        self.assertEqual(how["savitzky_golay"], {"order": 4, "window": 31})
        self.assertEqual((how["cutoff_hz"], how["cutoff_rule"]), (8.0, "given"))
        self.assertIsNone(self.preparation("--cutoff", "none")["cutoff_hz"])

    def test_extension_padding_acceleration_and_lag_move_the_result(self):
        usual = self.measured()
        for options in (("--extension", "even"), ("--extension", "constant"), ("--padding", "500"),
                        ("--acceleration", "sensor"), ("--structure", "symmetric"), ("--parameters-from", "all")):
            with self.subTest(options=options):
                self.assertNotEqual(self.measured(*options)["model"], usual["model"])
        for options in (("--extension", "odd"), ("--padding", "15"), ("--acceleration", "derivative"),
                        ("--structure", "full"), ("--parameters-from", "identification"), ("--hac-lag", "1"),
                        ("--handle-mass", "0"), ("--rate", "1e3"), ("--axes", "2"),
                        ("--variable", "logs")):
            with self.subTest(options=options):
                self.assertEqual(self.measured(*options), usual)
        given = self.measured("--method", "iv")
        self.assertEqual((given["method"], given["model"]), (usual["method"], usual["model"]))
        longer = self.measured("--hac-lag", "3")
        self.assertEqual(longer["model"], usual["model"])
        self.assertNotEqual(longer["standard_error"], usual["standard_error"])

    def test_structures(self):
        symmetric = self.measured("--structure", "symmetric")["model"]
        self.assertEqual(symmetric["K"][0][1], symmetric["K"][1][0])
        self.assertEqual(symmetric["M"][0][1], symmetric["M"][1][0])
        rig = self.mbk("identify", "--json", "--structure", "mass-spring", make_log().path).json["model"]
        self.assertEqual(rig["B"], [[0, 0], [0, 0]])
        self.assertEqual(rig["M"], [[rig["M"][0][0], 0], [0, rig["M"][0][0]]])

    def test_the_handle_is_taken_off_the_inertia(self):
        usual, less = self.measured()["model"], self.measured("--handle-mass", "0.4")["model"]
        self.assertAlmostEqual(usual["M"][0][0] - less["M"][0][0], 0.4, places=12)
        self.assertAlmostEqual(usual["M"][1][1] - less["M"][1][1], 0.4, places=12)
        self.assertEqual((usual["M"][0][1], usual["K"]), (less["M"][0][1], less["K"]))
        self.assertIn("0.4 kg", run("measure", make_log().path, "--handle-mass", "0.4").out)

    def test_decimate_check(self):
        check = self.measured("--decimate-check", "--every", "1")["decimate_check"]
        self.assertEqual(check["rate_hz"], 100.0)
        self.assertLess(check["largest_relative_change"], 0.05)
        self.assertIn("100 Hz", run("measure", make_log().path, "--decimate-check", "--every", "1").out)
        # The rows of the fit are decimated to less than that already: then every other one of them.
        check = self.measured("--decimate-check", "--every", "25")["decimate_check"]
        self.assertEqual(check["rate_hz"], 20.0)
        self.assertLess(check["largest_relative_change"], 0.05)

    def test_every(self):
        all_rows, some = (self.measured("--every", every) for every in ("1", "10"))
        self.assertEqual([r["preparation"][0]["every"] for r in (all_rows, some)], [1, 10])
        for name in ("M", "B", "K", "x0"):
            self.assertNotEqual(all_rows["model"][name], some["model"][name])
            self.assert_relative(some["model"][name], all_rows["model"][name], 1e-3)

    def test_resample(self):
        result = self.measured("--resample", "500")
        self.assertAlmostEqual(result["inputs"][0]["rate_hz"], 500.0, places=9)
        self.assertEqual([warning["code"] for warning in result["warnings"]], ["resampled"])

    def test_rate_stands_in_for_time(self):
        path = write_csv(self.folder / "log.csv", table_of(make_log())[1:], ("x", "y", "Fx", "Fy", "xr", "yr"))
        self.bad_data(path, says="--rate")
        self.assert_relative(self.measured("--rate", "1000", log=path)["model"]["K"], self.measured()["model"]["K"],
                             1e-9)

    def test_channels_flip_and_convert(self):
        usual = self.measured()["model"]
        flipped = self.measured("--channels", "x=2,y=3,Fx=-10,Fy=-11,xr=12,yr=13", code=4)["model"]
        self.assert_relative([[-k for k in row] for row in flipped["K"]], usual["K"], 1e-6)  # instruments are iterated
        # read in the wrong unit, which is computed as asked and not usable
        in_mm = self.measured("--channels", "x=2:mm,y=3:mm,Fx=10,Fy=11,xr=12,yr=13", code=4)["model"]
        self.assert_relative([[k / 1e3 for k in row] for row in in_mm["K"]], usual["K"], 1e-6)

    def test_axes(self):
        one = self.measured("--axes", "1", "--channels", "x=3,F=11,xr=13")
        self.assertEqual(one["axes"], 1)

    def test_quiet_says_nothing_of_progress(self):
        logs = [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2)]
        self.assertEqual(self.fine("measure", "--quiet", *logs).err, "")


class Out(Case):
    def test_it_writes_what_would_be_printed(self):
        path = self.folder / "result.json"
        ran = self.fine("measure", "--json", make_log().path, "--out", path)
        self.assertEqual(ran.out, "")
        self.assertEqual(path.read_bytes(), run("measure", "--json", make_log().path).bytes)
        self.assertEqual(self.names(), ["result.json"])
        self.assertEqual(stat.S_IMODE(path.stat().st_mode) & ~0o666, 0)

    def test_it_keeps_a_file_that_is_there(self):
        path = self.file("result.json", "precious")
        for command in ("measure", "identify", "info"):
            self.refused(WRONG_USAGE, command, make_log().path, "--out", path, says=[str(path), "--overwrite"])
        self.assertEqual((path.read_text(), self.names()), ("precious", ["result.json"]))

    def test_overwrite_replaces_it(self):
        path = self.file("result.json", "precious")
        self.fine("measure", "--json", make_log().path, "--out", path, "--overwrite")
        self.assertIn("mbk.result/2", path.read_text())
        self.assertEqual(self.names(), ["result.json"])

    def test_it_never_replaces_what_is_read(self):
        log = copy(make_log().path, self.folder / "log.mat")
        before = log.read_bytes()
        os.link(log, self.folder / "same.mat")
        for name in ("log.mat", "./log.mat", "same.mat"):
            self.refused(WRONG_USAGE, "measure", "log.mat", "--out", name, "--overwrite", folder=self.folder, says=name)
            self.refused(WRONG_USAGE, "info", "log.mat", "--out", name, "--overwrite", folder=self.folder, says=name)
        self.assertEqual(log.read_bytes(), before)

    def test_it_never_replaces_a_folder_or_a_device(self):
        (self.folder / "results").mkdir()
        for path in (self.folder / "results", "/dev/null"):
            self.refused(WRONG_USAGE, "measure", make_log().path, "--out", path, "--overwrite", says=str(path))
        self.assertTrue(stat.S_ISCHR(os.stat("/dev/null").st_mode))
        self.assertEqual(self.names(), ["results"])

    def test_an_empty_name(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--out", "", says="--out")

    def test_a_folder_that_is_not_there(self):
        path = self.folder / "gone" / "result.json"
        self.refused(BAD_DATA, "measure", make_log().path, "--out", path, says=[str(path), "folder"])
        self.assertEqual(self.names(), [])

    def test_a_file_in_place_of_the_folder(self):
        path = self.file("results", "text") / "result.json"
        self.refused(BAD_DATA, "measure", make_log().path, "--out", path, says=str(path))
        self.assertEqual(self.names(), ["results"])

    @unittest.skipIf(is_root(), "root may write everywhere")
    def test_a_folder_that_may_not_be_written(self):
        self.folder.chmod(0o500)
        self.addCleanup(self.folder.chmod, 0o700)
        path = self.folder / "result.json"
        self.refused(BAD_DATA, "measure", make_log().path, "--out", path, says=[str(path), "permissions"])
        self.assertEqual(self.names(), [])

    def test_a_measurement_that_fails_leaves_nothing(self):
        bad = self.file("bad.csv", "time,x,y,Fx,Fy\n0,1,2,3,a\n1,2,3,4,5\n")
        for arguments in ([bad], [make_log().path, "--from", "100"]):
            self.refused(BAD_DATA, "measure", *arguments, "--out", self.folder / "result.json")
        kept = self.file("kept.json", "precious")
        self.refused(BAD_DATA, "measure", bad, "--out", kept, "--overwrite")
        self.assertEqual((self.names(), kept.read_text()), (["bad.csv", "kept.json"], "precious"))

    def test_a_full_disk_is_said(self):
        with open("/dev/full", "wb") as full:
            for arguments in (["measure", make_log().path], ["info", make_log().path],
                              ["validate", "--runs", "1", "--quiet"]):
                ran = self.mbk(*arguments, code=BAD_DATA, stdout=full)
                self.assertRegex(ran.err, r"\Ambk: [^\n]*standard output[^\n]*\n\Z")


class Help(Case):
    def test_every_command_has_one_with_an_example_within_100_columns(self):
        self.assert_lines_fit(self.fine("--help").out)
        for command in COMMANDS:
            with self.subTest(command):
                text = self.fine(command, "--help").out
                self.assert_lines_fit(text)
                self.assertRegex(text, rf"Examples?:\n  mbk {command}")
            for below in SUBCOMMANDS.get(command, ()):
                with self.subTest(f"{command} {below}"):
                    self.assert_lines_fit(self.fine(command, below, "--help").out)

    def test_options_with_a_value_name_it_or_its_unit(self):
        text = run("measure", "--help").out
        for line in ("--rate HZ", "--resample HZ", "--cutoff HZ|none", "--from S", "--split S", "--to S", "--hac-lag S",
                     "--handle-mass KG", "--sg-window W", "--sg-order N", "--padding N", "--threads N", "--axes N",
                     "--channels MAP", "--variable NAME", "--out FILE",
                     *(f"{option} {words}" for option, words in WORDS.items())):
            self.assertRegex(text, rf"(?m)^  {re.escape(line)}(?: |$)")

    def test_what_most_people_need_comes_first(self):
        text = self.fine("measure", "--help").out
        self.assertEqual(self.fine("measure", "--help-all").out, text)
        first = text.split("\nOptions:\n")[1].split("\n\n")[0]
        found = re.findall(r"(?m)^  (--[a-z-]+)", first)
        main = ["--channels", "--method", "--mode", "--cutoff", "--from", "--to", "--handle-mass", "--report", "--json",
                "--out", "--summary"]
        self.assertEqual([one for one in found if one in main], main)
        for words in ("REQUIRED", "Needs:", "Excludes:", "{false}"):
            self.assertNotIn(words, text + self.fine("run", "--help").out + self.fine("work", "--help").out)

    def test_the_exit_codes_are_explained(self):
        self.assertRegex(" ".join(run("measure", "--help").out.split()), r"\b0 \w+, 2 \w.*, 3 \w.*, 4 \w")

    def test_info_names_its_own_schema(self):
        self.assertIn("mbk.info/1", run("info", "--help").out)

    def test_version(self):
        self.assertRegex(self.fine("--version").out, r"\Ambk \d+\.\d+\.\d+\n(commit  .*\n(.+\n)*)?\Z")

    def test_help_goes_to_standard_output(self):
        self.assertIn("mbk measure log.mat", self.fine("--help").out)


class Console(Case):
    def test_a_run_cannot_wait_for_a_console_that_it_leaves_away(self):
        self.refused(WRONG_USAGE, "run", "relaxed_sinusoidal", "--wait", "--no-console", says=["--wait", "--no-console"])
        self.refused(WRONG_USAGE, "run", "relaxed_sinusoidal", "--port", "70000", says="--port")


class Validate(Case):
    def test_coverage(self):
        ran = self.mbk("validate", "coverage", "--runs", "4", "--json", "--quiet", code=NOT_SHOWN)
        table = ran.json
        self.assertEqual((table["schema"], table["study"], table["runs"], table["seed"]),
                         ("mbk.validation/2", "coverage", 4, 1))
        self.assertEqual([row["what"] for row in table["rows"]][:14],
                         ["m_xx", "m_xy", "m_yx", "m_yy", "b_xx", "b_xy", "b_yx", "b_yy", "k_xx", "k_xy", "k_yx",
                          "k_yy", "x0", "y0"])
        self.assertEqual((table["verdict"], table["met"]), ("not shown", False))
        for row in table["rows"]:
            low, high = row["interval95"]
            self.assertTrue(0.0 <= low <= row["value"] <= high <= 100.0, row)
            # Four runs show nothing, whatever came out.
            self.assertIn((row["verdict"], row["met"]), [("not shown", False), ("informative", None)], row)
            self.assertEqual(row["verdict"] == "informative", row["what"].startswith("passive"), row)

    def test_too_few_runs_are_never_fine(self):
        ran = self.mbk("validate", "coverage", "--runs", "2", "--quiet", code=NOT_SHOWN)
        self.assertIn("not shown", ran.out)
        self.assertNotRegex(ran.out, r"(?m) met$")

    def test_the_help_says_how_many_runs_a_study_needs(self):
        text = self.fine("validate", "--help").out
        self.assertRegex(text, r"(?m)^  coverage +2000\b.*\b226$")
        self.assertIn("6 not shown", text)

    def test_the_seed_decides_and_the_threads_do_not(self):
        def coverage(*options):
            return run("validate", "--runs", "3", "--json", "--quiet", *options).bytes

        self.assertEqual(coverage("--threads", "1"), coverage("--threads", "2"))
        self.assertEqual(coverage("--seed", "5"), coverage("--seed", "5"))
        self.assertIn(b'"seed": 5', coverage("--seed", "5"))

    def test_more_threads_than_runs(self):
        self.mbk("validate", "--runs", "1", "--threads", "1024", "--quiet", code=NOT_SHOWN)

    def test_a_study_without_charts_says_so(self):
        ran = self.mbk("validate", "--runs", "1", "--quiet", "--charts", self.folder / "charts", code=WRONG_USAGE)
        self.assertIn("chart", ran.err)
        self.assertEqual(self.names(), [])

    def test_the_text_is_a_table_of_rows(self):
        text = self.mbk("validate", "--runs", "2", "--quiet", code=NOT_SHOWN).out
        self.assert_lines_fit(text)
        self.assertEqual(text.count("[92, 98]"), 26)


class Reproduce(Case):
    QUICK = ("--only", "table-3.6", "--only", "table-5.3", "--quiet")
    FILES = ["index.html", "reproduction.json", "tables/table-3.6.csv", "tables/table-3.6.json",
             "tables/table-5.3-1.csv", "tables/table-5.3-1.json", "tables/table-5.3-2.csv", "tables/table-5.3-2.json"]

    def made(self, *options, folder="made"):
        """What mbk reproduce says of two tables, and its files with their bytes."""
        out = self.folder / folder
        said = self.fine("reproduce", *self.QUICK, "--out", out, *options).out
        files = sorted(path for path in out.rglob("*") if path.is_file())
        return said, {str(path.relative_to(out)): path.read_bytes() for path in files}

    def test_the_list_names_what_only_takes(self):
        lines = self.fine("reproduce", "--list").out.splitlines()
        names = [line.split()[0] for line in lines]
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual({"table-3.3", "table-3.6", "table-5.3"}, set(names))
        for line in lines:
            self.assertRegex(line, r"^[a-z][\w.-]* +\S")

    def test_a_folder_of_its_own(self):
        self.fine("reproduce", *self.QUICK, folder=self.folder)
        self.assertEqual(self.names(), ["thesis"])

    def test_files_and_summary(self):
        said, files = self.made()
        self.assertEqual(list(files), self.FILES)
        agreement = json.loads(files["reproduction.json"])["agreement"]
        self.assertEqual([agreement[word] for word in ("within rounding", "erratum", "differs")], [8, 8, 0])
        self.assertRegex(said, r"\b16\b")
        self.assert_lines_fit(said, longest=200)
        head = files["tables/table-3.6.csv"].decode().splitlines()[0]
        self.assertEqual(head, "row,column,unit,printed,ours,difference,spread,range_low,range_high,agreement")

    def test_what_is_there_stays_unless_it_may_be_replaced(self):
        _, before = self.made()
        self.refused(WRONG_USAGE, "reproduce", *self.QUICK, "--out", self.folder / "made", says="--overwrite")
        _, again = self.made("--overwrite")
        self.assertEqual(again, before)

    def test_json_is_the_file_beside_the_page(self):
        said, files = self.made("--json")
        self.assertEqual(said.encode(), files["reproduction.json"])

    def test_ours_are_the_same_without_the_printed(self):
        def cells(files):
            exhibits = json.loads(files["reproduction.json"])["exhibits"]
            return [cell for one in exhibits for table in one["tables"] for row in table["rows"] for cell in row["cells"]]

        beside, alone = cells(self.made()[1]), cells(self.made("--without-printed", folder="alone")[1])
        self.assertEqual([cell["ours"] for cell in alone], [cell["ours"] for cell in beside])
        self.assertEqual({cell["printed"] for cell in alone}, {None})
        self.assertEqual({cell["agreement"] for cell in alone}, {"not compared"})
        self.assertEqual(sum(cell["printed"] is not None for cell in beside), 16)


if __name__ == "__main__":
    main()
