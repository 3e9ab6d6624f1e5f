#!/usr/bin/env python3
"""mbk info: what is in a recording, and every kind of trouble at its place. Samples are counted from 1."""

import math

from command import Case, copy, main, make_log, write_csv

RATE = 1000.0


class Info(Case):
    def recording(self, samples=2000):
        """Columns of a small recording without trouble: time, x, y, Fx, Fy."""
        time = [i / RATE for i in range(samples)]
        waves = [[math.sin(0.01 * (k + 1) * i) for i in range(samples)] for k in range(4)]
        return [time, *waves]

    def info(self, columns):
        path = write_csv(self.folder / "log.csv", columns, ("time", "x", "y", "Fx", "Fy"))
        return self.fine("info", "--json", path).json, self.fine("info", path).out

    def test_a_log_of_the_robot(self):
        path = make_log().path
        facts, text = self.fine("info", "--json", path).json, self.fine("info", path).out
        self.assertEqual(facts["schema"], "mbk.info/1")
        self.assertEqual(facts["samples"], 62100)
        self.assertAlmostEqual(facts["rate_hz"], 1000.0, places=6)
        self.assertAlmostEqual(facts["duration_s"], 62.099, places=9)
        self.assertEqual((facts["gaps"], facts["non_finite"]), ([], []))
        self.assertEqual((facts["duplicated_times"], facts["backward_times"]), (0, 0))
        units = {channel["name"]: channel["unit"] for channel in facts["channels"]}
        self.assertEqual((units["hand_x"], units["force_y"], units["acceleration_x"]), ("m", "N", "m/s2"))
        self.assertNotIn("torque_1", units)  # a row that is NaN throughout was not recorded
        self.assertIn("joint_1, joint_2, torque_1, torque_2", text)
        self.assertIn("1000 Hz", text)
        self.assertNotIn("! ", text)
        self.assertIn("4, 5, 8, 9, 16", " ".join(text.split()))

    def test_numbers_that_are_too_large_for_a_limb(self):
        time = [i / RATE for i in range(8000)]
        x = [0.3 + 0.01 * math.sin(0.01 * i) for i in range(8000)]
        force = [math.sin(0.011 * i) for i in range(8000)]
        still = [0.0] * 8000
        for columns, says in (
                ((time, x, x, force, force), None),
                ((time, still, still, still, still), None),
                ((time, [1e3 * v for v in x], [1e3 * v for v in x], force, force),
                 "--channels time=time,x=x:mm,y=y:mm,Fx=Fx,Fy=Fy"),
                ((time, x, x, [1e3 * v for v in force], force), "Fx=Fx:mN"),
                (([200 * t for t in time], x, x, force, force), None)):  # a slow log
            facts, text = self.info(columns)
            notes = [note for note in facts["notes"] if "--channels" in note]
            self.assertEqual(bool(notes), says is not None, notes)
            if says:
                self.assertIn(says, notes[0])
                self.assertIn("--channels", text)

    def test_the_text_fits_a_terminal(self):
        log = copy(make_log().path, self.folder / "log.mat")
        self.assert_lines_fit(self.fine("info", log.name, folder=self.folder).out)

    def test_other_rates(self):
        columns = self.recording()
        columns[0] = [3.0 + i / 250.0 for i in range(2000)]
        facts, text = self.info(columns)
        self.assertAlmostEqual(facts["rate_hz"], 250.0, places=6)
        self.assertIn("250 Hz", text)

    def test_a_gap_and_where_it_is(self):
        columns = self.recording()
        columns[0][500:] = [t + 0.25 for t in columns[0][500:]]
        facts, text = self.info(columns)
        (gap,) = facts["gaps"]
        self.assertEqual(gap["after_sample"], 500)
        self.assertAlmostEqual(gap["length_s"], 0.251, places=9)
        self.assertAlmostEqual(gap["time_s"], 0.499, places=9)
        self.assertRegex(text, r"! .*0\.251 s.*sample 500\b.*0\.499 s")

    def test_many_gaps_are_counted_and_the_first_shown(self):
        columns = self.recording()
        columns[0] = [t + 0.01 * (i // 100) for i, t in enumerate(columns[0])]
        facts, text = self.info(columns)
        self.assertEqual(len(facts["gaps"]), 19)
        self.assertRegex(text, r"! .*\b14\b")

    def test_time_that_repeats(self):
        columns = self.recording()
        columns[0][700] = columns[0][699]
        columns[0][900] = columns[0][899]
        facts, text = self.info(columns)
        self.assertEqual(facts["duplicated_times"], 2)
        self.assertRegex(text, r"! time .*\b2\b.*sample 701\b")

    def test_time_that_runs_backwards(self):
        columns = self.recording()
        columns[0][1200:] = [t - 1.0 for t in columns[0][1200:]]
        facts, text = self.info(columns)
        self.assertEqual(facts["backward_times"], 1)
        self.assertRegex(text, r"! time .*sample 1201\b")

    def test_values_that_are_no_numbers(self):
        columns = self.recording()
        for sample in (41, 42, 1999):
            columns[3][sample - 1] = math.nan
        facts, text = self.info(columns)
        self.assertEqual(facts["non_finite"], [{"channel": "force_x", "count": 3, "first_sample": 41}])
        self.assertRegex(text, r"! .*force_x.*\b3\b.*sample 41\b")

    def test_a_sensor_at_its_limit(self):
        columns = self.recording()
        columns[3] = [max(-0.8, min(0.8, value)) for value in columns[3]]
        facts, text = self.info(columns)
        self.assertEqual([c["name"] for c in facts["channels"] if c["clipped"]], ["force_x"])
        self.assertRegex(text, r"force_x .*! ")

    def test_a_channel_that_never_changes(self):
        columns = self.recording()
        columns[4] = [0.25] * len(columns[4])
        facts, text = self.info(columns)
        self.assertEqual([c["name"] for c in facts["channels"] if c["constant"]], ["force_y"])
        self.assertRegex(text, r"force_y +N +0\.25 +0\.25 +\w")

    def test_a_clock_that_jitters(self):
        columns = self.recording()
        columns[0] = [t + 1e-4 * math.sin(i) for i, t in enumerate(columns[0])]
        facts, text = self.info(columns)
        self.assertGreater(facts["interval_s"]["standard_deviation"], 5e-5)
        self.assertRegex(text, "! .*clock")

    def test_one_sample_has_no_rate(self):
        facts, text = self.info([column[:1] for column in self.recording()])
        self.assertEqual((facts["samples"], facts["rate_hz"]), (1, None))
        self.assertNotIn("nan", text)

    def test_several_files_are_one_document(self):
        paths = [make_log().path, make_log("sinusoidal", "--one-axis").path]
        both = self.fine("info", "--json", *paths).json
        self.assertEqual(both["schema"], "mbk.infos/1")
        self.assertEqual([one["inputs"][0]["file"] for one in both["results"]], [str(path) for path in paths])
        text = self.fine("info", *paths).out
        for path in paths:
            self.assertIn(str(path), text)

    def test_a_number_is_a_column_and_its_unit_is_converted(self):
        path = write_csv(self.folder / "log.csv", self.recording(), None)
        facts = self.fine("info", "--json", "--channels", "time=1,x=2:mm,y=3,Fx=-4,Fy=5:kN", path).json
        ranges = {c["name"]: (c["unit"], c["minimum"], c["maximum"]) for c in facts["channels"]}
        low, high = min(self.recording()[1]), max(self.recording()[1])
        self.assertEqual(ranges["hand_x"], ("m", low / 1e3, high / 1e3))
        low, high = min(self.recording()[3]), max(self.recording()[3])
        self.assertEqual(ranges["force_x"], ("N", -high, -low))
        low, high = min(self.recording()[4]), max(self.recording()[4])
        self.assertEqual(ranges["force_y"], ("N", 1e3 * low, 1e3 * high))

    def test_a_file_without_channels_shows_its_columns_and_what_to_do(self):
        path = write_csv(self.folder / "log.csv", self.recording(100), ("time", "u", "v", "w", "z"))
        listing = self.fine("info", "--json", path).json
        self.assertEqual((listing["schema"], listing["kind"]), ("mbk.contents/1", "table"))
        self.assertEqual([array["name"] for array in listing["arrays"]], ["time", "u", "v", "w", "z"])
        self.assertEqual({array["rows"] for array in listing["arrays"]}, {100})
        self.assertEqual(listing["arrays"][1]["maximum"], max(self.recording(100)[1]))
        self.assertIn("--channels", listing["unrecognised"]["try"])
        text = self.fine("info", path).out
        self.assertIn("--channels", text)


if __name__ == "__main__":
    main()
