#!/usr/bin/env python3
"""What a person gets wrong is not called usable, and the hint names it; what is right raises no such word.

Each mistake is made on two recordings, with MBK_MISTAKES=all on every arm and drive that it can be made on; its twin is
the same recording without it. Of a ready scenario with many trials the first two are looked at, with MBK_MISTAKES=all
all of them."""

import os
import re

from command import BAD_DATA, FINE, NOT_USABLE, Case, data_folder, flat, main, make_log, run
from mistakes import (COLUMNS, COLUMNS_OF_ONE_AXIS, MISTAKES, as_option, first_options, numbered,
                      right_map)

ARMS = ("relaxed_sinusoidal", "relaxed_underdamped", "rigid_underdamped_8N", "abnormal_tone")
JOINTS = ("ankle_reflex",)
ALL = os.environ.get("MBK_MISTAKES") == "all"
CAUSES = {"implausible-scale", "axes-scaled-differently", "axes-mismatched", "same-column", "other-column",
          "handle-mass-too-large", "force-sign-reversed"}
SEEDS = int(os.environ.get("MBK_MISTAKE_SEEDS", "1"))  # of each ready scenario, for false alarms


def codes_of(ran):
    return {warning["code"] for warning in ran.json["warnings"]}


def model_of(ran):
    model = ran.json["model"]
    return [flat(model[name]) for name in "MBK"]


class Mistakes(Case):
    def setUp(self):
        super().setUp()
        self.twins = {}  # by recording

    def recording(self, name):
        path = self.folder / f"{name}.h5"
        if not path.exists():
            run("simulate", name, "--out", path, "--quiet")
        return path

    def without_names(self, name, axes):
        """The recording as a table of columns that have neither names nor units."""
        path = self.folder / f"{name}.csv"
        if not path.exists():
            named = self.folder / "named.csv"
            run("convert", self.recording(name), named, "--overwrite")
            lines = [line for line in named.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
            header = lines[0].split(",")
            order = [next(i for i, full in enumerate(header) if full.startswith(column))
                     for column in (COLUMNS_OF_ONE_AXIS if axes == 1 else COLUMNS)]
            rows = (line.split(",") for line in lines[1:])
            path.write_text("\n".join(",".join(row[i] for i in order) for row in rows) + "\n", encoding="utf-8")
        return path

    def twin_of(self, path, right):
        """What the recording gives where it is read rightly; measured once."""
        if path not in self.twins:
            twin = self.twins[path] = self.measured(path, right)
            self.assertIn(twin.code, (FINE, NOT_USABLE), twin)
            self.assertFalse(CAUSES & codes_of(twin), (path.name, twin.json["warnings"]))
        return self.twins[path]

    def measured(self, path, entries, *options):
        return run("measure", "--json", "--quiet", *as_option(entries), *options, path)

    def assert_found(self, mistake, name):
        path = self.without_names(name, mistake.axes) if mistake.unnamed else self.recording(name)
        right, wrong = right_map(mistake.axes), mistake.change(right_map(mistake.axes))
        if mistake.unnamed:
            right, wrong = numbered(right, mistake.axes), numbered(wrong, mistake.axes)
        twin = self.twin_of(path, right)
        ran = self.measured(path, wrong, *mistake.options)
        if ran.code == BAD_DATA:  # refused, with the same hint
            said, hint = ran.err, ran.err
        else:
            self.assertEqual(ran.code, NOT_USABLE, ran)
            self.assertIs(ran.json["usable"], False)
            first = ran.json["warnings"][0]
            self.assertIn(first["code"], mistake.code.split("|"), (name, ran.json["warnings"]))
            said, hint = first["message"] + " " + first["try"], first["try"]
        for words in mistake.says:
            self.assertIn(words, said, name)
        if mistake.cured:
            options = first_options(hint)
            self.assertTrue(options, hint)
            cured = run("measure", "--json", "--quiet", *options, *mistake.options, path)
            self.assertEqual(cured.code, twin.code, (options, cured))
            for got, expected in zip(model_of(cured), model_of(twin)):
                self.assert_relative(got, expected, 1e-6)

    def test_every_mistake_is_found_and_named(self):
        for k, mistake in enumerate(MISTAKES):
            possible = JOINTS if mistake.axes == 1 else [name for name in ARMS if mistake.drives in name]
            start, step = k % len(possible), 1 + k // len(possible) % max(len(possible) - 1, 1)
            for name in possible if ALL else sorted({possible[start], possible[(start + step) % len(possible)]}):
                with self.subTest(mistake=mistake.name, on=name):
                    self.assert_found(mistake, name)

    def test_there_are_thirty_of_them(self):
        self.assertGreaterEqual(len(MISTAKES), 30)
        self.assertEqual(len({mistake.name for mistake in MISTAKES}), len(MISTAKES))


    def test_a_file_that_names_its_columns_contradicts_the_map(self):
        log = make_log().path
        for entries, name in (({"x": "12", "y": "13", "Fx": "10", "Fy": "11"}, "reference_x"),
                              ({"x": "2", "y": "3", "Fx": "18", "Fy": "19"}, "acceleration_x")):
            ran = self.measured(log, entries)
            first = ran.json["warnings"][0]
            self.assertEqual(first["code"], "other-column", ran)
            self.assertIn(name, first["message"])
        self.assertNotIn("other-column", codes_of(self.measured(log, {"x": "3", "y": "2", "Fx": "11", "Fy": "10"})))

    def test_a_file_that_knows_its_units_refuses_another_quantity(self):
        path = self.recording("relaxed_sinusoidal")
        self.bad_data(path, *as_option({**right_map(), "x": "force_x"}), says=["force_x", "hand_x", "'N'"])


class FalseAlarms(Case):
    def test_no_ready_scenario_raises_any(self):
        listed = run("simulate", "--list").out.splitlines()[1:]
        names = [line.split()[0] for line in listed]
        self.assertGreater(len(names), 10)
        for name in names:
            trials = re.findall(r'^\[\[trial\]\]\nname = "(\w+)"', run("simulate", "--show", name).out, re.MULTILINE)
            only = [] if ALL else [word for trial in trials[:2] for word in ("--trial", trial)]
            run("simulate", name, *only, "--seeds", SEEDS, "--out", self.folder / f"{name}.h5", "--quiet")
            recordings = sorted(self.folder.glob(f"{name}*.h5"))
            self.assertTrue(recordings, name)
            for path in recordings:
                with self.subTest(path.name):
                    ran = run("measure", "--json", "--quiet", path)
                    self.assertIn(ran.code, (FINE, NOT_USABLE), ran)
                    self.assertFalse(CAUSES & codes_of(ran), ran)
                path.unlink()

    def test_no_real_joint_raises_any(self):
        for name in ("z_df", "z_pf", "z_df2"):
            with self.subTest(name):
                ran = run("measure", "--json", "--axes", "1", "--channels", "x=position_rad,F=torque_Nm", "--split",
                          "40", data_folder("ankle") / f"{name}.csv")
                self.assertFalse(CAUSES & codes_of(ran), ran)

    def test_no_golden_log_raises_any(self):
        for name in ("sinusoidal", "underdamped"):
            for mode in ("default", "reference"):
                with self.subTest(name, mode=mode):
                    ran = run("measure", "--json", "--mode", mode, data_folder("golden") / f"{name}.mat")
                    self.assertFalse(CAUSES & codes_of(ran), ran)


class Ranges(Case):
    def test_they_are_printed(self):
        for command in ("measure", "identify"):
            text = self.fine(command, "--ranges").out
            for word in ("inertia", "damping", "stiffness", "motion", "force", "rate", "Tsuji", "Kearney", "kg", "rad"):
                self.assertIn(word, text)
            self.assert_lines_fit(text)

    def test_one_is_switched_off_by_name(self):
        path = self.folder / "arm.h5"
        run("simulate", "relaxed_sinusoidal", "--out", path, "--quiet")
        wrong = as_option({**right_map(), "Fx": "force_x*100", "Fy": "force_y*100"})
        ran = run("measure", "--json", "--quiet", *wrong, path)
        self.assertEqual(ran.code, NOT_USABLE, ran)
        without = run("measure", "--json", "--quiet", *wrong, "--ignore-range", "inertia,damping,stiffness,force", path)
        self.assertEqual(without.code, FINE, without)
        self.assertIn("inertia", " ".join(without.json["notes"]))
        partly = run("measure", "--json", "--quiet", *wrong, "--ignore-range", "inertia", path)
        self.assertEqual(partly.code, NOT_USABLE, partly)


if __name__ == "__main__":
    main()
