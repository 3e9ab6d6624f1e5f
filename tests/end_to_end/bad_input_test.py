#!/usr/bin/env python3
"""Bad recordings: each is refused in one line that says file, what, where and what to do; nothing is half said."""

import math
import random
import struct
import unittest
import zlib

import mat_file
from command import BAD_DATA, COLUMNS, Case, is_root, main, make_log, run, table_of, write_csv

SAMPLES = 15000  # 15 s: enough for a measurement without warnings


class BadInput(Case):
    def setUp(self):
        super().setUp()
        self.columns = [list(column) for column in table_of(make_log(), SAMPLES)]

    def csv(self, name="log.csv", names=COLUMNS, **options):
        return write_csv(self.folder / name, self.columns, names, **options)

    def logs(self, name="log.mat", typecode="d", **changed):
        """A logs matrix of the columns."""
        rows = [[0.0] * len(self.columns[0]) for _ in range(19)]
        for row, column in zip((0, 1, 2, 9, 10, 11, 12), self.columns):
            rows[row] = column
        return mat_file.write(self.folder / name, {changed.get("variable", "logs"): rows}, typecode)


class Files(BadInput):
    def test_what_is_no_readable_file(self):
        self.bad_data(self.folder / "gone.mat")
        self.bad_data(self.folder, says="folder")
        self.bad_data(self.file("empty.mat", ""))
        self.bad_data("/dev/zero")

    @unittest.skipIf(is_root(), "root may read everything")
    def test_a_file_that_may_not_be_read(self):
        path = self.csv()
        path.chmod(0)
        self.bad_data(path, says="permissions")

    def test_a_mat_file_cut_short_at_any_place(self):
        whole = make_log().path.read_bytes()
        places = [1, 64, 127, 128, 130, 136, 200, 5000, len(whole) // 2, len(whole) - 1]
        for place in places:
            with self.subTest(bytes=place):
                self.bad_data(self.file("cut.mat", whole[:place]))

    def test_an_uncompressed_mat_file_cut_short_at_any_place(self):
        self.columns = [column[:2000] for column in self.columns]
        whole = self.logs().read_bytes()
        for place in (*range(129, 200, 7), len(whole) // 2, len(whole) - 8, len(whole) - 1):
            with self.subTest(bytes=place):
                self.bad_data(self.file("cut.mat", whole[:place]))

    def test_a_mat_file_with_damaged_bytes_never_breaks_the_program(self):
        self.columns = [column[:400] for column in self.columns]
        whole = self.logs().read_bytes()
        chance = random.Random(1)
        for trial in range(60):
            with self.subTest(trial=trial):
                damaged = bytearray(whole)
                for _ in range(3):
                    damaged[chance.randrange(0, 260)] = chance.randrange(256)
                ran = run("info", self.file("damaged.mat", bytes(damaged)))
                self.assertIn(ran.code, (0, 2, 3), ran)
                self.assertLessEqual(ran.err.count("\n"), 1, ran)

    def test_a_mat_file_that_claims_absurd_sizes(self):
        for rows, columns in ((2**31 - 1, 2**31 - 1), (19, 2**31 - 1), (-19, 10), (0, 0)):
            data = (mat_file.element(6, struct.pack("<II", 6, 0)) + mat_file.element(5, struct.pack("<ii", rows, columns))
                    + mat_file.element(1, b"logs") + mat_file.element(9, bytes(80)))
            header = mat_file.write(self.folder / "claims.mat", {}).read_bytes()
            for content in (mat_file.element(14, data),
                            struct.pack("<II", 15, 0xFFFFFF00) + zlib.compress(mat_file.element(14, data))):
                with self.subTest(rows=rows, columns=columns):
                    self.bad_data(self.file("claims.mat", header + content))

    def test_what_is_no_recording(self):
        for name, content in (("png", b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 8),
                              ("zip", b"PK\x03\x04" + bytes(range(256)) * 8),
                              ("gzip", b"\x1f\x8b\x08" + bytes(range(256)) * 8),
                              ("pdf", b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n1 0 obj\n" + bytes(range(256)) * 8),
                              ("zeros", bytes(4096)),
                              ("json", b'{"schema": "mbk.result/1", "model": {"M": [[1]]}}\n'),
                              ("text", b"Dear diary,\ntoday nothing was measured.\n"),
                              ("one word", b"hello"),
                              ("blank lines", b"\n\n\n"),
                              ("comments", b"# only\n# comments\n")):
            with self.subTest(name):
                ran = self.bad_data(self.file(f"{name}.mat", content))
                self.assertNotIn("C3D file", ran.err)

    def test_one_bad_file_among_good_ones(self):
        good, bad = self.csv("good.csv"), self.file("bad.csv", "time,x\n0,1\n1,a\n")
        for files in ((good, bad), (bad, good)):
            for options in ([], ["--json"]):  # it costs only itself
                ran = self.mbk("measure", *files, *options, code=BAD_DATA)
                self.assertIn(str(bad), ran.err)
                self.assertIn(str(good), ran.out)
            self.refused(BAD_DATA, "measure", *files, "--pool", says=str(bad))

    def test_names_that_are_no_utf_8(self):
        path = bytes(self.folder) + b"/caf\xe9.csv"
        self.csv("good.csv").rename(path.decode("utf-8", "surrogateescape"))
        for command in ("measure", "info"):
            self.assertIn("caf\ufffd.csv", self.fine(command, "--json", path).json["inputs"][0]["file"])


class Tables(BadInput):
    def lines(self, count=SAMPLES):
        return [",".join(map(repr, row)) for row in zip(*(column[:count] for column in self.columns))]

    def table(self, lines, header=",".join(COLUMNS), end="\n"):
        return self.file("log.csv", "\n".join([header, *lines]) + end)

    def test_a_table_cut_short_keeps_its_complete_lines_and_says_so(self):
        cut = self.table([*self.lines(), self.lines(1)[0][:30]], end="")
        result = self.fine("measure", "--json", cut).json
        whole = self.fine("measure", "--json", self.csv("whole.csv")).json
        self.assertEqual(result["model"], whole["model"])
        line = f"line {SAMPLES + 2}"
        self.assertIn(line, " ".join(result["notes"]))
        self.assertIn(line, " ".join(self.fine("info", "--json", cut).json["notes"]))
        self.assertIn(line, self.fine("measure", cut).out)

    def test_a_header_and_nothing_else(self):
        self.bad_data(self.table([]), says="numbers")
        self.bad_data(self.table([], end=""), says="numbers")

    def test_letters_in_a_cell(self):
        lines = self.lines()
        cells = lines[100].split(",")
        lines[100] = ",".join([*cells[:3], "12a4", *cells[4:]])
        self.bad_data(self.table(lines), says=["line 102", "column 4", "'12a4'"])

    def test_commas_that_may_stand_for_two_things(self):
        lines = [line.replace(".", ",") for line in self.lines(200)]
        self.bad_data(self.table(lines), says=["7 columns", "line 2", "14", "semicolons"])
        thousands = ["1,234;2,345"] * 100
        self.bad_data(self.table(thousands, "time;x"), says=["comma", "thousands"])

    def test_a_header_with_fewer_names_than_columns(self):
        self.bad_data(self.table(self.lines(), "time,x,y,Fx,Fy"), says=["5 columns", "line 2"])

    def test_a_line_with_too_few_or_too_many_cells(self):
        for extra in (",1.0", ""):
            lines = self.lines(200)
            lines[50] = lines[50] + extra if extra else lines[50].rpartition(",")[0]
            self.bad_data(self.table(lines), says="line 52")

    def test_a_column_out_of_range(self):
        path = self.csv(names=None)
        self.bad_data(path, "--channels", "time=1,x=2,y=3,Fx=4,Fy=8", says=["column 8", "7 columns"])
        self.bad_data(path, "--channels", "time=1,x=0,y=3,Fx=4,Fy=5", says="column 0")
        self.bad_data(self.csv(), "--channels", "x=hand", says=["'hand'", "time, x, y, Fx, Fy, xr, yr"])

    def test_columns_without_names(self):
        self.bad_data(self.csv(names=None), says=["7 columns", "--channels"])

    def test_latin_1_in_the_header(self):
        path = self.file("latin.csv", self.csv().read_bytes().replace(b",xr,", b",Winkel [\xb0],", 1))
        self.assertIn("Winkel [°]", " ".join(self.fine("info", "--json", path).json["notes"]))
        self.assertIn("Winkel [°]", self.fine("info", path).out)
        self.fine("info", path, "--channels", "x=Winkel [°],time=time")


class Content(BadInput):
    def test_a_missing_channel(self):
        self.columns.pop(4)
        path = self.csv(names=("time", "x", "y", "Fx", "xr", "yr"))
        self.bad_data(path, says=["'force_y'", "hand_x, hand_y, force_x", "--channels", "force_y="])

    def test_values_that_are_no_numbers(self):
        for value in (math.nan, math.inf):
            self.columns[3][7000] = value
            self.bad_data(self.logs(), says=["'force_x'", "sample 7001", "7.000"])
        self.fine("measure", self.logs(), "--protocol", "free", "--to", "6.9")

    def test_too_few_samples(self):
        for count, says in ((1, "1 sample "), (2, "2 samples"), (10, "10 samples"), (60, "")):
            with self.subTest(samples=count):
                self.columns = [column[:count] for column in table_of(make_log(), SAMPLES)]
                self.bad_data(self.csv(), says=says)
                self.bad_data(self.logs(), says=says)

    def test_wrong_units(self):
        path = self.csv(names=None)
        for unit in ("N", "furlong", "", "MM"):
            ran = self.refused(BAD_DATA, "measure", path, "--channels", f"time=1,x=2:{unit},y=3,Fx=4,Fy=5",
                               says=["channel x", "mm"])
            self.assertIn(unit, ran.err)

    def test_position_in_rad_with_reaction_in_newton(self):
        path = write_csv(self.folder / "log.csv", [self.columns[0], self.columns[2], self.columns[4]],
                         ("time", "position_rad", "reaction_N"))
        self.bad_data(path, says=["rad", "N", "--channels"])

    def test_trouble_with_time(self):
        time = list(self.columns[0])
        for name, says, trouble in (("repeats", "time", time[:8000] + time[7999:-1]),
                                    ("runs backwards", "time", time[:8000] + [t - 5.0 for t in time[8000:]]),
                                    ("has a gap", "0.501 s", time[:8000] + [t + 0.5 for t in time[8000:]])):
            with self.subTest(name):
                self.columns[0] = trouble
                for mode in ("default", "reference"):
                    window = ["--from", "1", "--to", "9", "--mode", mode]
                    self.bad_data(self.logs(), *window, says=[says, "sample 8001", "--from"])
                self.fine("measure", "--json", self.logs(), "--to", "7.9")

    def test_a_force_that_never_changes(self):
        force = self.columns[3], self.columns[4]
        for axes, value in (((3, 4), 0.0), ((3,), 1.5), ((4,), 0.0)):
            with self.subTest(axes=axes, value=value):
                self.columns[3], self.columns[4] = map(list, force)
                for axis in axes:
                    self.columns[axis] = [value] * SAMPLES
                self.bad_data(self.logs(), says=[("force_x", "force_y")[axes[0] - 3], f"{value:g}"])

    def test_a_position_that_never_changes(self):
        self.columns[1], self.columns[2] = [0.2] * SAMPLES, [0.1] * SAMPLES
        self.bad_data(self.logs(), says=["'hand_x'", "0.2"])

    def test_a_transposed_logs_matrix(self):
        rows = mat_file.read(self.logs())["logs"]
        path = mat_file.write(self.folder / "tall.mat", {"logs": [list(row) for row in zip(*rows)]})
        self.bad_data(path, says=["'logs'", f"{SAMPLES}×19"])

    def test_a_logs_matrix_of_whole_numbers(self):
        self.bad_data(self.logs(typecode="h"), says=["time", "sample"])

    def test_a_matrix_of_other_height(self):
        rows = mat_file.read(self.logs())["logs"]
        self.bad_data(mat_file.write(self.folder / "short.mat", {"logs": rows[:18]}), says=["18×", "19 rows"])
        self.bad_data(mat_file.write(self.folder / "no.mat", {"data": rows[:5]}), says=["data", "5×", "--channels"])

    def test_two_matrices_that_could_be_meant(self):
        rows = mat_file.read(self.logs())["logs"]
        path = mat_file.write(self.folder / "two.mat", {"first": rows, "second": rows})
        self.refused(2, "measure", path, says=["first", "second", "--variable"])
        self.fine("measure", path, "--variable", "second")

    def test_a_variable_that_is_not_there(self):
        self.bad_data(self.logs(), "--variable", "log", says=["'log'", "19×"])


if __name__ == "__main__":
    main()
