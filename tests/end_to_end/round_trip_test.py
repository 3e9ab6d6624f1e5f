#!/usr/bin/env python3
"""The same recording by other ways: as a table, in another order, with other names, in parts."""

import mat_file
from command import BAD_DATA, COLUMNS, WRONG_USAGE, Case, flat, main, make_log, run, table_of, write_csv

SAME = 1e-12  # relative; the numbers that go in are the same to the last bit
NUMBERS = "x=1,y=3,Fx=-5,Fy=7,xr=2,yr=4,time=6"


def model_of(*arguments):
    return run("measure", "--json", *arguments).json["model"]


class RoundTrip(Case):
    def assert_same(self, model, other):
        for name in ("M", "B", "K", "x0"):
            self.assert_relative(model[name], other[name], SAME)

    def test_a_table_gives_the_model_of_the_matrix(self):
        for protocol in ("sinusoidal", "underdamped"):
            log = make_log(protocol)
            path = write_csv(self.folder / "log.csv", table_of(log))
            for mode in ("default", "reference"):
                self.assert_same(model_of(path, "--mode", mode), model_of(log.path, "--mode", mode))

    def test_semicolons_or_tabs_may_stand_between_the_columns(self):
        for separator in (";", "\t"):
            path = write_csv(self.folder / "log.csv", table_of(make_log()), separator=separator)
            self.assert_same(model_of(path), model_of(make_log().path))

    def test_so_does_one_axis(self):
        log = make_log("sinusoidal", "--one-axis")
        columns = [flat(values) for values in mat_file.read(log.path).values()]
        path = write_csv(self.folder / "log.csv", columns, mat_file.read(log.path).keys())
        self.assert_same(model_of(path), model_of(log.path))

    def test_columns_in_any_order_by_their_numbers(self):
        time, x, y, fx, fy, xr, yr = table_of(make_log())
        path = write_csv(self.folder / "log.csv", [x, xr, y, yr, [-f for f in fx], time, fy], None)
        self.assert_same(model_of(path, "--channels", NUMBERS), model_of(make_log().path))

    def test_long_names_and_units_in_the_header(self):
        time, x, y, fx, fy, xr, yr = table_of(make_log())
        path = write_csv(self.folder / "log.csv", [time, [1e3 * v for v in x], y, fx, fy, xr, yr],
                         ("time [s]", "hand_x_mm", "hand_y (m)", "force_x_N", "force_y", "reference_x", "yr"))
        for name, tolerance in (("M", 1e-9), ("B", 1e-9), ("K", 1e-9), ("x0", 1e-12)):
            self.assert_relative(model_of(path)[name], model_of(make_log().path)[name], tolerance)

    def test_a_logs_matrix_by_another_name(self):
        rows = mat_file.read(make_log().path)["logs"]
        other = mat_file.write(self.folder / "other.mat", {"trial7": rows})
        self.assert_same(model_of(other), model_of(make_log().path))

    def test_a_tall_matrix_with_its_columns_named(self):
        columns = table_of(make_log())
        path = mat_file.write(self.folder / "tall.mat", {"data": list(zip(*columns))})
        self.assert_same(model_of(path, "--channels", "time=1,x=2,y=3,Fx=4,Fy=5,xr=6,yr=7"), model_of(make_log().path))

    def test_a_clock_that_starts_elsewhere(self):
        time, *others = table_of(make_log())
        path = write_csv(self.folder / "log.csv", [[t + 1024.0 for t in time], *others])
        for name in ("M", "B", "K", "x0"):
            self.assert_relative(model_of(path)[name], model_of(make_log().path)[name], 1e-9)


class Parts(Case):
    def parts(self, *ends, stem="log_", first=1):
        """The log cut into numbered tables."""
        columns, names = table_of(make_log()), []
        for k, (begin, end) in enumerate(zip((0, *ends), (*ends, None))):
            path = self.folder / f"{stem}{first + k}.csv"
            names.append(write_csv(path, [column[begin:end] for column in columns]))
        return names

    def test_they_make_the_whole(self):
        parts = self.parts(*range(6000, 60000, 6000), first=2)  # log_2 … log_11: by number, not by letter
        whole = run("measure", "--json", write_csv(self.folder / "whole.csv", table_of(make_log()))).json
        for files in (parts, sorted(parts, reverse=True)):
            joined = self.fine("measure", "--json", "--parts", *files).json
            self.assertEqual((joined["model"], joined["standard_error"]), (whole["model"], whole["standard_error"]))
            self.assertEqual([source["file"] for source in joined["inputs"]], [str(part) for part in parts])
        self.assertEqual(self.fine("info", "--json", "--parts", *parts).json["samples"], 62100)

    def test_without_the_option_each_is_a_recording_of_its_own(self):
        parts = self.parts(31000)
        self.assertEqual(self.fine("measure", "--json", "--quiet", *parts).json["summary"]["trials"], 2)

    def test_a_part_that_is_missing(self):
        parts = self.parts(20000, 40000)
        self.refused(BAD_DATA, "measure", "--parts", parts[0], parts[2], says=["part 2", "; "])

    def test_a_part_that_is_there_twice(self):
        parts = self.parts(20000)
        self.refused(BAD_DATA, "measure", "--parts", parts[0], parts[1], parts[1], says="part 2")

    def test_a_clock_that_restarts(self):
        parts = self.parts(20000)
        time, *others = table_of(make_log())
        write_csv(parts[1], [time[:42100], *(column[20000:] for column in others)])
        self.refused(BAD_DATA, "measure", "--parts", *parts, says=[str(parts[1]), "time", "; "])

    def test_parts_of_different_records(self):
        one, other = self.parts(20000)[0], self.parts(20000, stem="rest_")[1]
        self.refused(BAD_DATA, "measure", "--parts", one, other, says=str(other))

    def test_parts_with_other_channels(self):
        parts = self.parts(20000)
        write_csv(parts[1], [column[20000:] for column in table_of(make_log())[:5]], COLUMNS[:5])
        self.refused(BAD_DATA, "measure", "--parts", *parts, says=[str(parts[1]), "reference_x"])

    def test_a_name_without_a_number(self):
        path = write_csv(self.folder / "log.csv", table_of(make_log(), 100))
        self.refused(WRONG_USAGE, "measure", "--parts", path, says="log.csv")


if __name__ == "__main__":
    main()
