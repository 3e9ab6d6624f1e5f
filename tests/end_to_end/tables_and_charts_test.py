#!/usr/bin/env python3
"""Folders and patterns in the place of files; tables of many trials (--summary) and drawings (--charts)."""

import csv
import re
import shutil
import unittest
import xml.dom.minidom

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, copy, main, make_log, run
from several_files_test import flipped

NORMAL95 = 1.959963984540054


def logs(*seeds):
    return [make_log("sinusoidal", "--seed", str(seed)).path for seed in seeds]


class Files(Case):
    def setUp(self):
        super().setUp()
        self.trials = self.folder / "trials"
        self.trials.mkdir()
        self.two = copy(logs(1)[0], self.trials / "trial_2.mat")
        self.ten = copy(logs(2)[0], self.trials / "trial_10.MAT")
        (self.trials / "notes.txt").write_text("no recording\n", encoding="utf-8")
        (self.trials / ".hidden.mat").write_bytes(b"no recording")

    def inputs(self, *words, **options):
        ran = self.fine("measure", "--json", "--quiet", *words, **options)
        return [one["inputs"][0]["file"] for one in ran.json["results"]]

    def test_a_folder_stands_for_its_recordings_in_natural_order(self):
        self.assertEqual(self.inputs(self.trials), [str(self.two), str(self.ten)])

    def test_a_pattern_stands_for_the_files_that_fit(self):
        self.assertEqual(self.inputs("trials/trial_[0-9]*.*", folder=self.folder),
                         ["trials/trial_2.mat", "trials/trial_10.MAT"])
        self.assertEqual(self.inputs("*/trial_?.mat", self.ten, folder=self.folder), ["trials/trial_2.mat", str(self.ten)])

    def test_a_name_that_is_there_is_no_pattern(self):
        odd = copy(self.two, self.folder / "a[1]*.mat")
        copy(self.two, self.folder / "a1.mat")
        ran = self.fine("measure", "--json", "--quiet", odd)
        self.assertEqual(ran.json["inputs"][0]["file"], str(odd))

    def test_where_nothing_is_found_it_says_so(self):
        self.bad_data(self.folder / "*.mat")
        self.bad_data(self.folder, says=".mat")

    def test_what_is_read_is_never_overwritten(self):
        self.refused(WRONG_USAGE, "measure", self.trials, "--out", self.two, "--overwrite", says=str(self.two))
        table = copy(self.two, self.trials / "table.csv")
        self.refused(WRONG_USAGE, "measure", self.trials, "--summary", table, "--overwrite", says=str(table))

    def test_identify_and_explore_take_them_too(self):
        ran = self.fine("identify", "--json", "--quiet", self.trials)
        self.assertEqual(len(ran.json["results"]), 2)
        ran = self.mbk("explore", "--json", "--quiet", "--only", "frequency-response", self.trials)
        self.assertEqual([one["file"] for one in ran.json["inputs"]], [str(self.two), str(self.ten)])


class Summary(Case):
    def table(self, *files, code=0, **options):
        out = self.folder / "table.csv"
        ran = self.mbk("measure", "--json", "--quiet", *files, "--summary", out, code=code, **options)
        with open(out, encoding="utf-8", newline="") as file:
            return ran.json, list(csv.DictReader(file))

    def test_one_row_a_trial_with_the_numbers_of_the_results(self):
        document, rows = self.table(*logs(1, 2))
        self.assertEqual([row["file"] for row in rows], [str(log) for log in logs(1, 2)])
        for result, row in zip(document["results"], rows):
            self.assertEqual(row["state"], "usable")
            for letter, unit in (("m", "kg"), ("b", "N·s/m"), ("k", "N/m")):
                for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
                    name = f"{letter}_{'xy'[i]}{'xy'[j]}"
                    value, error = (result[part][letter.upper()][i][j] for part in ("model", "standard_error"))
                    self.assertAlmostEqual(float(row[f"{name} [{unit}]"]), value, delta=1e-9 * abs(value))
                    for end, sign in (("low", -1), ("high", 1)):
                        self.assertAlmostEqual(float(row[f"{name} 95 % {end} [{unit}]"]), value + sign * NORMAL95 * error,
                                               delta=1e-9 * abs(value))
            ellipse = result["ellipses"]["stiffness"]
            self.assertAlmostEqual(float(row["stiffness_orientation [°]"]), ellipse["orientation_deg"], places=9)
            self.assertAlmostEqual(float(row["stiffness_shape 95 % low"]), ellipse["interval95"]["shape"][0], places=9)
            self.assertAlmostEqual(float(row["VAF_x [%]"]), result["fit"]["VAF"][0], places=9)

    def test_what_is_not_usable_has_no_numbers_and_what_failed_says_why(self):
        good, bad = logs(1)[0], flipped(self.folder, logs(2)[0])
        broken = self.file("broken.csv", "time,x\n0,1\n1,a\n")
        _, rows = self.table(good, bad, broken, code=BAD_DATA)
        self.assertEqual([row["state"].split(":")[0] for row in rows], ["usable", "not usable", "failed"])
        self.assertIn("force-sign-reversed", rows[1]["warnings"])
        self.assertEqual(rows[1]["k_xx [N/m]"], "")
        self.assertEqual(rows[2]["k_xx [N/m]"], "")
        self.assertIn("broken.csv", rows[2]["file"])
        self.assertTrue(all(None not in row and None not in row.values() for row in rows), rows)

    def test_one_axis_has_its_own_columns(self):
        one_axis = make_log("sinusoidal", "--one-axis").path
        _, rows = self.table(one_axis, logs(1)[0])
        self.assertTrue(any(name.startswith("k [") for name in rows[0]), rows[0].keys())
        self.assertEqual(rows[0]["k_xx [N/m]"], "")
        self.assertNotEqual(rows[1]["k_xx [N/m]"], "")

    def test_latex(self):
        out = self.folder / "table.tex"
        bad = flipped(self.folder, logs(3)[0], "bad_trial.csv")
        self.mbk("measure", "--quiet", *logs(1, 2), bad, "--summary", out, code=NOT_USABLE)
        text = out.read_text(encoding="utf-8")
        for words in (r"\toprule", r"\midrule", r"\bottomrule", "$M_{xx}$", r"[N$\cdot$s/m]", r"bad\_trial.csv",
                      "not usable", "Mean of 2", r"95\,\%"):
            self.assertIn(words, text)
        self.assertEqual(text.count("{"), text.count("}"))
        rows = [line for line in text.splitlines() if line.endswith(r"\\") and "multicolumn" not in line]
        self.assertEqual({line.count("&") for line in rows}, {14})  # three matrices of four, and VAF along two axes
        first = next(line for line in rows if "seed_1" in line.replace("\\", ""))
        self.assertEqual(len(re.findall(r"\$-?[\d.]+ \\pm [\d.]+\$", first)), 12, first)

    def test_latex_of_one_trial_has_its_matrices(self):
        out = self.folder / "trial.tex"
        ran = self.mbk("measure", "--json", logs(1)[0], "--summary", out)
        self.assertIn(str(out), ran.err)
        text = out.read_text(encoding="utf-8")
        self.assertEqual(text.count(r"\begin{bmatrix}"), 4)
        self.assertNotIn("tabular", text)
        matrices = re.findall(r"\\mathbf\{([MBK])\} &= \\begin\{bmatrix\} (.*?) \\end", text)
        self.assertEqual([letter for letter, _ in matrices], ["M", "B", "K"])
        for letter, elements in matrices:
            printed = [row.split(" & ") for row in elements.split(r" \\ ")]
            for i in range(2):
                for j in range(2):
                    value, half = map(float, printed[i][j].split(r" \pm "))
                    error = ran.json["standard_error"][letter][i][j]
                    self.assertAlmostEqual(value, ran.json["model"][letter][i][j], delta=0.1 * NORMAL95 * error)
                    self.assertAlmostEqual(half, NORMAL95 * error, delta=0.06 * NORMAL95 * error)
        bad = flipped(self.folder, logs(2)[0])
        self.mbk("measure", "--quiet", bad, "--summary", out, "--overwrite", code=NOT_USABLE)
        self.assertNotIn("bmatrix", out.read_text(encoding="utf-8"))

    def test_wrong_names_are_refused_before_the_work(self):
        log = logs(1)[0]
        self.refused(WRONG_USAGE, "measure", log, "--summary", "table.xlsx", says=["--summary", ".csv", ".tex"])
        there = self.file("table.csv", "mine\n")
        self.refused(WRONG_USAGE, "measure", log, "--summary", there, says=["table.csv", "--overwrite"])
        self.assertEqual(there.read_text(encoding="utf-8"), "mine\n")
        self.mbk("measure", "--quiet", log, "--summary", there, "--overwrite")
        self.assertIn("k_xx", there.read_text(encoding="utf-8"))


class Charts(Case):
    def drawn(self, command, *words):
        folder = self.folder / "charts"
        self.mbk(command, "--quiet", *words, "--charts", folder)
        for file in folder.iterdir():
            root = xml.dom.minidom.parse(str(file)).documentElement
            self.assertEqual(root.tagName, "svg", file)
        return sorted(file.name for file in folder.iterdir())

    def test_measure_draws_what_shows_how_good_a_result_is(self):
        log = copy(logs(1)[0], self.folder / "my trial.mat")
        names = ["coherence", "damping-ellipse", "ellipses", "force-spectrum", "force-x", "force-y", "inertia-ellipse", "residual",
                 "stiffness-ellipse"]
        self.assertEqual(self.drawn("measure", log), [f"my_trial-{name}.svg" for name in names])
        text = (self.folder / "charts" / "my_trial-force-x.svg").read_text(encoding="utf-8")
        for words in ("measured", "predicted", "time [s]", "force [N]", "held-out"):
            self.assertIn(words, text)

    def test_two_files_of_one_name_are_both_drawn(self):
        (self.folder / "b").mkdir()
        one, other = copy(logs(1)[0], self.folder / "t.mat"), copy(logs(2)[0], self.folder / "b" / "t.mat")
        names = self.drawn("identify", one, other)
        self.assertIn("t-residual.svg", names)
        self.assertIn("t-2-residual.svg", names)
        self.assertFalse(any("ellipse" in name for name in names))

    def test_a_result_that_is_not_usable_has_no_ellipse(self):
        bad = flipped(self.folder, logs(1)[0])
        self.mbk("measure", "--quiet", bad, "--charts", self.folder / "charts", code=NOT_USABLE)
        names = [file.name for file in (self.folder / "charts").iterdir()]
        self.assertIn("flipped-force-x.svg", names)
        self.assertFalse(any("ellipse" in name for name in names), names)

    def test_explore_draws_its_responses(self):
        log = copy(logs(1)[0], self.folder / "t.mat")
        names = self.drawn("explore", log)
        self.assertLessEqual({"t-response-magnitude.svg", "t-response-phase.svg", "t-impulse-response.svg"}, set(names))
        text = (self.folder / "charts" / "t-response-magnitude.svg").read_text(encoding="utf-8")
        self.assertIn("[N/m]", text)

    def test_they_are_as_wide_as_a_column_with_text_that_can_be_read(self):
        log = copy(logs(1)[0], self.folder / "t.mat")
        for words, width in (((), 85), (("--chart-width", "180"), 180)):
            self.drawn("measure", log, "--overwrite", *words)
            for file in (self.folder / "charts").iterdir():
                svg = xml.dom.minidom.parse(str(file)).documentElement
                wide, high = (float(svg.getAttribute(name).removesuffix("mm")) for name in ("width", "height"))
                left, top, units, units_high = map(float, svg.getAttribute("viewBox").split())
                self.assertEqual((left, top, wide), (0, 0, width))
                self.assertAlmostEqual(high / wide, units_high / units, places=3)
                sizes = [float(size) for size in re.findall(r'font-size="([\d.]+)"', file.read_text(encoding="utf-8"))]
                self.assertGreaterEqual(min(sizes) * wide / units, 7 * 25.4 / 72, file)  # 7 pt
                title = svg.getElementsByTagName("title")[0].firstChild.data
                self.assertFalse(any(title == text.firstChild.data for text in svg.getElementsByTagName("text")), file)
        three = (self.folder / "charts" / "t-ellipses.svg").read_text(encoding="utf-8")
        for unit in ("[kg]", "[N·s/m]", "[N/m]"):
            self.assertIn(unit, three)
        for wrong in ("0", "1000", "wide"):
            self.refused(WRONG_USAGE, "measure", log, "--charts", "c", "--chart-width", wrong, says="--chart-width")
        self.refused(WRONG_USAGE, "measure", log, "--chart-width", "85", says="--charts")

    @unittest.skipUnless(any(map(shutil.which, ("rsvg-convert", "inkscape", "chromium"))), "nothing makes a PDF")
    def test_pdf_has_the_size_of_the_drawing(self):
        log = copy(logs(1)[0], self.folder / "t.mat")
        folder = self.folder / "pdf"
        self.mbk("explore", "--quiet", "--only", "impulse-response", log, "--charts", folder, "--chart-format", "pdf")
        (file,) = folder.iterdir()
        self.assertEqual(file.name, "t-impulse-response.pdf")
        pdf = file.read_bytes()
        self.assertTrue(pdf.startswith(b"%PDF"))
        box = re.search(rb"/MediaBox\s*\[\s*0 0 ([\d.]+) ([\d.]+)", pdf)
        if box:  # not in a compressed part
            self.assertAlmostEqual(float(box.group(1)), 85 / 25.4 * 72, delta=1.0)

    def test_without_a_program_that_makes_a_pdf_it_says_what_to_install(self):
        self.refused(WRONG_USAGE, "measure", logs(1)[0], "--charts", self.folder / "c", "--chart-format", "pdf",
                     says=["rsvg-convert", "librsvg2-bin"], environment={"PATH": str(self.folder)})

    def test_they_are_not_overwritten_unless_asked(self):
        log = logs(1)[0]
        self.drawn("measure", log)
        self.refused(WRONG_USAGE, "measure", log, "--charts", self.folder / "charts", says=["-force-x.svg", "--overwrite"])
        self.mbk("measure", "--quiet", log, "--charts", self.folder / "charts", "--overwrite")
        self.refused(WRONG_USAGE, "measure", log, "--charts", self.file("file", "x"), says="folder")


class Spreadsheets(Case):
    def test_no_cell_is_a_formula_and_numbers_stay_numbers(self):
        for name in ("=cmd|calc!A1.mat", "+1+1.mat", "@SUM(A1).mat", "-2+3.mat"):
            copy(logs(1)[0], self.folder / name)
        table = self.folder / "table.csv"
        self.mbk("measure", "--quiet", "./=cmd|calc!A1.mat", "./+1+1.mat", "./@SUM(A1).mat", "./-2+3.mat", "--summary", table,
                 folder=self.folder)
        self.mbk("measure", "--quiet", "=cmd|calc!A1.mat", "--summary", table, "--overwrite", folder=self.folder)
        head, row = list(csv.reader(table.read_text(encoding="utf-8").splitlines()))[:2]
        self.assertEqual(row[0], "'=cmd|calc!A1.mat")
        numbers = [cell for cell in row if re.fullmatch(r"-?[0-9.]+(e[+-][0-9]+)?", cell)]
        self.assertTrue(any(cell.startswith("-") for cell in numbers), row)
        self.assertEqual([cell for cell in head + row if cell[:1] in ("=", "+", "@")], [])

    def test_names_of_channels_are_no_formulas_either(self):
        rows = "".join(f"{k / 100},{k % 7},{k % 5}\n" for k in range(300))
        file = self.file("log.csv", "time_s,=cmd|calc!A1,@b\n" + rows)
        out = self.folder / "out.csv"
        ran = self.mbk("convert", file, out)
        self.assertIn("_cmd|calc!A1,_b", out.read_text(encoding="utf-8"))
        self.assertIn("=cmd|calc!A1", ran.out + ran.err, "the changed name is reported")


if __name__ == "__main__":
    main()
