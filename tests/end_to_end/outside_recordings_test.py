#!/usr/bin/env python3
"""Recordings that others made, in the folder MBK_DATA_DIR: published values, real sensors, broken files."""

import json
import re
import statistics

from command import NOT_USABLE, Case, data_folder, flat, main, run

GOLDEN = 1e-9  # of the largest element of each matrix: reference mode against 113-bit arithmetic
ANKLE = ("--axes", "1", "--channels", "x=position_rad,F=torque_Nm", "--split", "40")


class Golden(Case):
    def test_reference_mode_agrees_with_113_bit_arithmetic(self):
        folder = data_folder("golden")
        expected = json.loads((folder / "expected.json").read_text(encoding="utf-8"))
        logs = [name for name in expected if name != "about"]
        self.assertGreaterEqual(len(logs), 2)
        for name in logs:
            with self.subTest(name):
                ran = run("measure", "--json", "--mode", "reference", folder / f"{name}.mat")
                self.assertIn(ran.code, (0, NOT_USABLE), ran)
                result = ran.json
                computed = {**result["model"], "VAF": result["fit"]["VAF"]}
                self.assertEqual(set(expected[name]["quad"]), set(computed))
                for quantity, values in expected[name]["quad"].items():
                    self.assert_relative(computed[quantity], values, GOLDEN)
                for quantity, values in expected[name]["octave"].items():
                    self.assertEqual(len(flat(computed[quantity])), len(flat(values)))
                    self.assert_relative(computed[quantity], values, 1e-6)


class Ankle(Case):
    VAF = {"z_df": 87.2, "z_pf": 61.0, "z_df2": 92.7}

    def test_the_published_fit(self):
        folder = data_folder("ankle")
        for name, vaf in self.VAF.items():
            with self.subTest(name):
                ran = run("measure", "--json", *ANKLE, "--sg-window", "31", "--sg-order", "6", "--cutoff", "25",
                          folder / f"{name}.csv")
                self.assertIn(ran.code, (0, NOT_USABLE), ran)
                self.assertAlmostEqual(ran.json["fit"]["VAF"][0], vaf, delta=2.0)
                self.assertEqual(ran.json["units"]["K"], "N·m/rad")

    def test_a_filter_that_hides_the_inertia_is_flagged(self):
        folder = data_folder("ankle")
        for name in self.VAF:
            with self.subTest(name):
                result = run("measure", "--json", *ANKLE, "--sg-window", "101", "--sg-order", "6", "--cutoff", "5",
                             folder / f"{name}.csv").json
                codes = {warning["code"] for warning in result["warnings"]}
                self.assertTrue(codes & {"inertia-not-positive", "band-too-narrow"}, codes)
                if result["model"]["M"][0][0] <= 0.0:
                    self.assertIs(result["usable"], False)

    def test_the_matrix_is_read_and_the_objects_beside_it_are_named(self):
        folder = data_folder("ankle")
        options = ("--axes", "1", "--variable", "z", "--rate", "1000", "--channels", "x=1,F=2")
        facts = self.fine("info", "--json", *options, folder / "z.mat").json
        self.assertEqual(facts["samples"], 60000)
        notes = " ".join(facts["notes"])
        self.assertRegex(notes, "class|object")
        self.assertRegex(notes, "nldat|segdat")
        table = run("measure", "--json", *ANKLE, folder / "z_df.csv").json["model"]
        matrix = run("measure", "--json", *options, "--split", "40", folder / "z.mat").json["model"]
        for name in "MBK":
            self.assert_relative(matrix[name], table[name], 1e-3)  # the table has fewer digits


class RealFiles(Case):
    def test_every_matlab_file_is_read_or_refused_at_once(self):
        files = sorted(data_folder("mat").glob("*.mat"))
        self.assertGreater(len(files), 5)
        for path in files:
            with self.subTest(path.name):
                ran = run("info", path, timeout=60)  # seconds, where none takes one
                self.assertIn(ran.code, (0, 2, 3), ran)
                self.assertLessEqual(ran.err.count("\n"), 1, ran)
                self.assertEqual(bool(ran.out), ran.code == 0, ran)

    def test_streams_are_listed_with_what_was_corrected(self):
        for path in sorted(data_folder("xdf").glob("*.xdf")):
            with self.subTest(path.name):
                self.assertIn("stream '", self.fine("info", path).out)

    def test_a_jittering_clock_and_its_gaps_are_reported(self):
        channels = ("--channels", "time=1,q1=2,q2=3")
        jittering = 0
        for path in sorted(data_folder("double_pendulum").glob("*.csv")):
            with self.subTest(path.name):
                times = [float(line.split(",")[0]) for line in path.read_text().splitlines()[1:]]
                intervals = [later - earlier for earlier, later in zip(times, times[1:])]
                middle, spread = statistics.median(intervals), statistics.stdev(intervals)
                facts, text = self.fine("info", "--json", *channels, path).json, self.fine("info", *channels, path).out
                self.assertAlmostEqual(facts["interval_s"]["standard_deviation"], spread, delta=1e-9)
                typical = middle if facts["gaps"] else statistics.fmean(intervals)
                self.assertAlmostEqual(facts["rate_hz"], 1.0 / typical, delta=1e-6)
                self.assertEqual([gap["after_sample"] for gap in facts["gaps"]],
                                 [i + 1 for i, interval in enumerate(intervals) if interval > 1.5 * middle])
                uneven = bool(facts["gaps"]) or spread > 0.01 * middle
                jittering += uneven
                self.assertEqual(re.search(r"! .*(gap|clock)", text) is not None, uneven, text)
        self.assertGreater(jittering, 1)


if __name__ == "__main__":
    main()
