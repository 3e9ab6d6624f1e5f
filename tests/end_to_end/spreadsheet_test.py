#!/usr/bin/env python3
"""Tables as spreadsheets and loggers write them: the same numbers in any dress give the same measurement."""

from command import COLUMNS, Case, main, make_log, table_of

NAMES = (*COLUMNS[:5], "xr_N", "yr_N")
SAMPLES = 62000


class Dress(Case):
    @classmethod
    def setUpClass(cls):
        cls.columns = table_of(make_log(), SAMPLES)
        cls.rows = [list(map(repr, row)) for row in zip(*cls.columns)]

    def model(self, name, content, *options):
        """What is measured, and what is noted."""
        result = self.fine("measure", "--json", self.file(name, content), *options).json
        return result["model"], result.get("notes", [])

    def plain(self):
        lines = [",".join(NAMES), *(",".join(row) for row in self.rows)]
        return self.model("plain.csv", "\n".join(lines) + "\n")[0]

    def test_every_dress_gives_the_same_model(self):
        plain = self.plain()
        commas = [";".join(row).replace(".", ",") for row in self.rows]
        blanks = ["  ".join(f"{float(cell):25.17e}" for cell in row) for row in self.rows]
        clocks = [f"10:{15 + int(float(t)) // 60:02}:{float(t) % 60:06.3f}" for t, *_ in self.rows]
        dresses = {
            "decimal commas": ";".join(NAMES) + "\r\n" + "\r\n".join(commas) + "\r\n",
            "said by its first line": "sep=;\n" + ";".join(NAMES) + "\n" + "\n".join(commas) + "\n",
            "UTF-16": ("\ufeff" + "\t".join(NAMES) + "\r\n" +
                       "".join("\t".join(row) + "\r\n" for row in self.rows)).encode("utf-16-le"),
            "a byte order mark": "\ufeff" + ",".join(NAMES) + "\n" + "".join(",".join(r) + "\n" for r in self.rows),
            "vertical bars": "|".join(NAMES) + "\n" + "".join("|".join(row) + "\n" for row in self.rows),
            "numpy.savetxt": "# " + " ".join(NAMES) + "\n" + "\n".join(blanks) + "\n",
            "a comma at every line's end": ",".join(NAMES) + ",\n" + "".join(",".join(r) + ",\n" for r in self.rows),
            "in quotes": '"' + '","'.join(NAMES) + '"\n' +
                         "".join('"' + '","'.join(row) + '"\n' for row in self.rows),
            "preamble and units": "Recorder 7\nRate:,1000 Hz\n\n" + ",".join(NAMES) + "\ns,m,m,N,N,N,N\n" +
                                  "".join(",".join(row) + "\n" for row in self.rows),
            "words beside": "state," + ",".join(NAMES) + ",ok\n" +
                            "".join("run," + ",".join(row) + ",true\n" for row in self.rows),
        }
        for name, content in dresses.items():
            with self.subTest(name):
                model, notes = self.model("dressed.csv", content)
                self.assertEqual(model, plain)
                if name != "a byte order mark" and name != "in quotes":
                    self.assertTrue(notes, name)
        with self.subTest("times of day"):
            content = ",".join(NAMES) + "\n" + "".join(
                ",".join([clock, *row[1:]]) + "\n" for clock, row in zip(clocks, self.rows))
            model, notes = self.model("clock.csv", content)
            for name in "MBK":
                self.assert_relative(model[name], plain[name], 1e-4)  # the last digits of its seconds are others
            self.assertTrue(any("'time'" in note and "midnight" in note for note in notes), notes)

    def test_segments_of_labview(self):
        def segment(start, rows):
            return (f"Channels\t6\nSamples\t{len(rows)}\nDate\t2024/03/01\nTime\t10:{start}:00,5\n"
                    "Y_Unit_Label" + "\tm\tm\tN\tN\tN\tN\nX_Dimension" + 6 * "\tTime" + "\nX0" + 6 * "\t0,0E+0" +
                    "\nDelta_X" + 6 * "\t0,001" + "\n***End_of_Header***\n" +
                    "\t".join(["X_Value", *NAMES[1:], "Comment"]) + "\n" +
                    "".join("\t".join(row).replace(".", ",") + "\n" for row in rows))

        path = self.file("trial.lvm", "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
                         "X_Columns\tOne\n***End_of_Header***\n\n" + segment(15, self.rows[:1000]) + "\n" +
                         segment(20, self.rows))
        self.assertIn("2 trials", self.fine("info", path).out)
        self.assertEqual(self.fine("measure", "--json", "--trial", "2", path).json["model"], self.plain())
        self.mbk("convert", path, self.folder / "part_{trial}.h5")
        self.assertEqual(self.fine("info", "--json", self.folder / "part_1.h5").json["samples"], 1000)

    def test_units_below_the_names_and_in_them(self):
        plain = self.plain()
        rows = [[repr(1e6 * float(row[0])), repr(1e3 * float(row[1])), *row[2:]] for row in self.rows]
        body = "".join(",".join(row) + "\n" for row in rows)
        below = ",".join(COLUMNS) + "\n\u00b5s,mm,m,N,N,N,N\n" + body
        within = "time [\u00b5s],x_mm,y,Fx,Fy,xr (N),yr_N\n" + body
        for content in (below, within):
            model, _ = self.model("units.csv", content)
            for name in "MBK":
                self.assert_relative(model[name], plain[name], 1e-6)
        nanoseconds = "time_ns,x,y,Fx,Fy,xr_N,yr_N\n" + "".join(
            ",".join([str(round(1e9 * float(row[0]))), *row[1:]]) + "\n" for row in self.rows)
        self.assert_relative(self.model("ns.csv", nanoseconds)[0]["K"], plain["K"], 1e-6)
        self.bad_data(self.file("both.csv", "time,x_mm,F\ns,m,N\n0,1,2\n0.1,2,3\n"), "--axes", "1",
                      says=["'x_mm'", "in mm", "in m "])

    def test_words_in_a_column_that_is_asked_for(self):
        path = self.file("words.csv", "time,x,F,state\n0,1,2,rest\n0.1,2,NA,go\n0.2,3,4,go\n")
        self.bad_data(path, "--axes", "1", says=["reaction", "line 3", "column 3", "'NA'"])
        self.bad_data(path, "--axes", "1", "--channels", "x=x,F=state", says=["line 2", "column 4", "'rest'"])
        facts = self.fine("info", "--json", "--axes", "1", "--channels", "x=x,F=1", path).json
        self.assertIn("3 'F', 4 'state'", " ".join(facts["notes"]))


class Octave(Case):
    def test_its_text_format_is_named(self):
        self.bad_data(self.file("vars.txt", "# Created by Octave 7.3.0, Mon Jan 01 10:00:00 2024 UTC <a@b>\n# name: t\n"
                                            "# type: matrix\n# rows: 3\n# columns: 1\n 0\n 0.001\n 0.002\n\n\n"),
                      says=["Octave", "save -v7"])


if __name__ == "__main__":
    main()
