#!/usr/bin/env python3
"""mbk study summary and plan: what a study says of people, through the command alone."""

import csv
import io
import pathlib
import shutil
import statistics
import subprocess
import unittest

import command
from command import BAD_DATA, FINE, WRONG_USAGE, run

PEOPLE, SESSIONS = 6, 2
SCENARIO = pathlib.Path(__file__).resolve().parents[2] / "examples" / "scenarios" / "relaxed_sinusoidal.toml"


def made_study(folder):
    """Six people in two sessions: of a recording of 12 s each, the even sessions of odd people tensed."""
    text = SCENARIO.read_text(encoding="utf-8").replace("duration_s = 62.1", "duration_s = 12.0")
    assert "12.0" in text
    (folder / "short.toml").write_text(text, encoding="utf-8")
    study = folder / "study"
    assert run("study", "init", study, "--title", "A study").code == FINE
    for person in range(1, PEOPLE + 1):
        for session in range(1, SESSIONS + 1):
            file = folder / f"{person}_{session}.h5"
            assert run("simulate", folder / "short.toml", "--seed", 10 * person + session, "--quiet", "--out",
                       file).code == FINE
            condition = "relaxed" if person <= 3 else "tensed"
            assert run("study", "add", file, "--participant", person, "--session", session, "--condition", condition,
                       "--study", study).code == FINE
    assert run("study", "measure", "--quiet", "--study", study).code == FINE
    return study


class StatisticsOfAStudy(command.Case):
    study = None

    def setUp(self):
        super().setUp()
        if StatisticsOfAStudy.study is None:
            StatisticsOfAStudy.study = made_study(command.folder_of_logs())

    def do(self, name, *arguments, code=FINE, **options):
        return self.mbk("study", name, *arguments, "--study", self.study, code=code, **options)

    def rows(self, outcome):
        rows = csv.DictReader(io.StringIO(self.do("export").out))
        return [row for row in rows if row["outcome"] == outcome and row["state"] == "usable"]

    def test_no_reliability_is_stated_of_three_people_and_text_and_json_agree(self):
        summary = self.do("summary", "--json").json
        for one in summary["reliability"]:
            self.assertEqual(one["between_sessions"]["support"], "too few people", one["outcome"])
            self.assertEqual(one["between_sessions"]["icc"], [])
        text = self.do("summary").out
        self.assertIn("(3; at least 5 needed)", text)
        self.assertNotIn("ICC(A,1)", text)
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        self.assertNotIn("comparison", summary)

    def table(self, ending, *options):
        out = self.folder / f"table.{ending}"
        self.do("summary", *options, "--out", out)
        return out.read_text(encoding="utf-8")

    def test_tables_for_papers_have_the_numbers_of_the_summary(self):
        summary = self.do("summary", "--json").json
        outcomes = {(one["condition"], one["outcome"]): one for one in summary["outcomes"]}
        rows = list(csv.DictReader(io.StringIO(self.table("csv"))))
        self.assertEqual([(row["condition"], row["outcome"]) for row in rows], list(outcomes))
        for row in rows:
            one = outcomes[row["condition"], row["outcome"]]
            self.assertEqual((float(row["mean"]), float(row["sd"])), (one["mean"], one["standard_deviation"]))
            self.assertEqual((int(row["participants"]), int(row["trials"]), int(row["excluded"])),
                             (one["participants"], one["results"], PEOPLE // 2 * SESSIONS - one["results"]))
            self.assertEqual((row["icc"], row["mdc95"]), ("", ""), "three people have no reliability")
        self.assertEqual(self.table("csv", "--overwrite"), self.do("summary", "--format", "csv").out)
        self.do("summary", "--format", "latex", "--compare", "condition", code=WRONG_USAGE)
        self.do("summary", "--format", "latex", "--json", code=WRONG_USAGE)

    def test_latex_and_markdown_have_as_many_cells_in_each_row(self):
        latex = self.table("tex", "--outcome", "K_xx", "stiffness_lambda_max")
        self.assertEqual(latex.count("{"), latex.count("}"))
        rows = [line for line in latex.splitlines() if line.endswith(r"\\") and "multicolumn" not in line]
        self.assertEqual([line.count("&") for line in rows], [4] * 5, latex)  # no reliability of three people
        for words in (r"$K_{xx}$ & N/m", r"$K_{\max}$ & N/m", r"\caption{", r"\textit{Note.}"):
            self.assertIn(words, latex)
        markdown = self.table("md", "--outcome", "K_xx")
        self.assertEqual({line.count("|") for line in markdown.splitlines() if line.startswith("|")}, {6})

    @unittest.skipUnless(shutil.which("pdflatex"), "no pdflatex")
    def test_latex_compiles_within_the_text(self):
        packages = "".join(rf"\usepackage{{{name}}}" for name in ("booktabs", "graphicx", "rotating", "amsmath"))
        recordings = [command.folder_of_logs() / f"1_{session}.h5" for session in (1, 2)]
        for name, files in (("one", recordings[:1]), ("two", recordings)):
            self.mbk("measure", "--quiet", *files, "--summary", self.folder / f"{name}.tex")
        tables = [self.table("tex")] + [(self.folder / f"{name}.tex").read_text(encoding="utf-8") for name in ("one", "two")]
        document = rf"\documentclass{{article}}{packages}\begin{{document}}" + "\n".join(tables) + r"\end{document}"
        (self.folder / "paper.tex").write_text(document, encoding="utf-8")
        ran = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"], cwd=self.folder,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False)
        self.assertEqual(ran.returncode, 0, ran.stdout[-2000:])
        self.assertNotIn(b"Overfull \\hbox", ran.stdout)

    def test_groups_are_compared_by_the_means_of_their_people(self):
        groups = ("--group", "even=2,4,6", "--group", "odd=1,3,5")
        one = self.do("summary", "--compare", "condition", "--outcome", "K_xx", "--json").json["comparison"]
        self.assertEqual(one["levels"], ["relaxed", "tensed"])
        (row,) = one["outcomes"]
        of_person = {}
        for result in self.rows("K_xx"):
            of_person.setdefault((result["condition"], result["participant"]), []).append(float(result["value"]))
        means = {c: [statistics.fmean(v) for (condition, _), v in of_person.items() if condition == c]
                 for c in one["levels"]}
        self.assertAlmostEqual(row["difference"], statistics.fmean(means["tensed"]) - statistics.fmean(means["relaxed"]),
                               places=9)
        self.assertEqual((row["pairing"], row["first_participants"], row["second_participants"]), ("unpaired", 3, 3))
        self.assertEqual(row["verdict"], "too few people")  # three against three: no permutation reaches 0.05
        self.assertGreater(row["permutation"]["smallest_p"], 0.05)
        ran = self.do("summary", "--compare", "group", *groups)
        self.assertNotIn(" *\n", ran.out)
        self.assertLessEqual(max(map(len, ran.out.splitlines())), 80)

    def test_sessions_are_compared_in_the_same_people(self):
        rows = self.do("summary", "--compare", "session", "1", "2", "--outcome", "K_xx", "--json").json["comparison"]
        self.assertEqual({row["condition"] for row in rows["outcomes"]}, {"relaxed", "tensed"})
        for row in rows["outcomes"]:
            self.assertEqual((row["pairing"], row["first_participants"]), ("paired", 3))

    def test_what_is_not_there_is_refused(self):
        for arguments in (("--outcome", "stifness"), ("--compare", "colour"), ("--compare", "condition", "relaxed"),
                          ("--compare", "group"), ("--group", "a=1"), ("--compare", "group", "--group", "a=1-"),
                          ("--compare", "group", "--group", "a=1-3", "--group", "b=3-4"),
                          ("--compare", "condition", "relaxed", "asleep")):
            self.do("summary", *arguments, code=WRONG_USAGE)

    def test_numbers_are_compared_however_they_are_typed(self):
        self.assertRegex(self.do("measure", "--quiet", "--cutoff", "8").out, r"\b12\b")
        for same in ("8.0", "08", "8e0"):
            self.assertNotRegex(self.do("measure", "--quiet", "--cutoff", same).out, "[1-9]")
        self.assertRegex(self.do("measure", "--quiet", "--cutoff", "8.5").out, r"\b12\b")


class RatersOfAStudy(command.Case):
    """Six people, each measured once by two raters in one session."""
    study = None

    def setUp(self):
        super().setUp()
        if StatisticsOfAStudy.study is None:
            StatisticsOfAStudy.study = made_study(command.folder_of_logs())
        if RatersOfAStudy.study is not None:
            return
        study = command.folder_of_logs() / "rated"
        assert run("study", "init", study).code == FINE
        for person in range(1, PEOPLE + 1):
            for session, rater in ((1, "A"), (2, "b")):
                assert run("study", "add", command.folder_of_logs() / f"{person}_{session}.h5", "--participant", person,
                           "--condition", "relaxed", "--rater", rater, "--study", study).code == FINE
        assert run("study", "measure", "--quiet", "--study", study).code == FINE
        RatersOfAStudy.study = study

    def do(self, name, *arguments, code=FINE, **options):
        return self.mbk("study", name, *arguments, "--study", self.study, code=code, **options)

    def test_are_listed_shown_and_exported(self):
        recordings = self.do("list", "--json").json["recordings"]
        self.assertEqual([(one["rater"], one["session"], one["trial"]) for one in recordings],
                         [("A", 1, 1), ("B", 1, 1)] * PEOPLE)
        self.assertIn("rater", self.do("list").out.splitlines()[3])
        self.assertIn("rater B", self.do("show", 2).out)
        rows = list(csv.DictReader(io.StringIO(self.do("export").out)))
        self.assertEqual({row["rater"] for row in rows}, {"A", "B"})
        self.assertEqual(self.do("check", "--quick", "--json").json["problems"], [])

    def test_go_to_bids_and_back(self):
        self.do("export", "--bids", self.folder / "bids")
        names = [file.name for file in (self.folder / "bids").rglob("*_motion.tsv")]
        self.assertEqual(len(names), 2 * PEOPLE)
        self.assertTrue(all("_acq-rater" in name for name in names), names)
        again = self.folder / "again"
        self.mbk("study", "init", again)
        self.mbk("study", "import", self.folder / "bids", "--quiet", "--study", again)
        facts = [(one["participant"], one["rater"], one["condition"])
                 for one in self.mbk("study", "list", "--json", "--study", again).json["recordings"]]
        self.assertEqual(sorted(facts), [(p, r, "relaxed") for p in range(1, PEOPLE + 1) for r in "AB"])

    def test_names_are_refused_and_not_repeated(self):
        file = command.folder_of_logs() / "1_1.h5"
        for name in ("Jane", "JD", "A B", ""):
            ran = self.do("add", file, "--participant", 1, "--rater", name, code=WRONG_USAGE)
            self.assertNotIn("Jane", ran.err)
        sheet = self.folder / "sheet.csv"
        sheet.write_text(f"file,participant,rater\n{file},1,Jane\n", encoding="utf-8")
        self.assertNotIn("Jane", self.do("import", "--sheet", sheet, code=BAD_DATA).err)
        other = self.do("add", file, "--participant", 1, "--condition", "relaxed", "--rater", "C", code=BAD_DATA)
        self.assertIn("rater A", other.err)

    def test_are_taken_from_file_names(self):
        study = self.folder / "named"
        self.mbk("study", "init", study)
        shutil.copy(command.folder_of_logs() / "1_1.h5", self.folder / "p1_r02.h5")
        self.mbk("study", "import", self.folder / "p1_r02.h5", "--pattern", "p{participant}_{rater}.h5", "--study", study)
        self.assertEqual(self.mbk("study", "list", "--json", "--study", study).json["recordings"][0]["rater"], "R2")

    def test_have_the_coefficients_of_their_two_way_table(self):
        summary = self.do("summary", "--outcome", "K_xx", "--raters", 3, "--json").json
        raters = summary["reliability"][0]["raters"]
        self.assertEqual((raters["support"], raters["participants"], raters["raters"], raters["results"]),
                         ("enough", PEOPLE, 2, 2 * PEOPLE))
        self.assertEqual(raters["variances"][-1]["pooled"], ["participant×rater"])
        self.assertEqual([one["raters"] for one in raters["of_numbers"]], [1, 2, 3])
        scores = {}
        for row in csv.DictReader(io.StringIO(self.do("export").out)):
            if row["outcome"] == "K_xx" and row["state"] == "usable":
                scores.setdefault(row["participant"], {})[row["rater"]] = float(row["value"])
        differences = [one["A"] - one["B"] for one in scores.values()]
        residual = statistics.variance(differences) / 2
        bias = max(0.0, (statistics.fmean(differences) ** 2 - statistics.variance(differences) / PEOPLE) / 2)
        people = statistics.variance([(one["A"] + one["B"]) / 2 for one in scores.values()]) - residual / 2
        variances = {one["term"]: one["value"] for one in raters["variances"]}
        if bias > 0 and people > 0:  # the analysis of variance; otherwise the likelihood is largest at a bound
            self.assertAlmostEqual(variances["participant"] / people, 1, places=4)
            self.assertAlmostEqual(variances["residual"] / residual, 1, places=4)
        one = raters["of_numbers"][0]
        total = sum(variances.values())
        self.assertAlmostEqual(one["absolute"], variances["participant"] / total, places=9)
        self.assertAlmostEqual(one["absolute_error"]["sem"], (total - variances["participant"]) ** 0.5, places=9)
        self.assertTrue(0 <= one["absolute95"][0] <= one["absolute"] <= one["absolute95"][1] <= 1)

    def test_are_in_text_and_table_and_nowhere_without_them(self):
        for options in ((), ("--outcome", "K_xx", "--raters", "2", "--trials", "2")):
            text = self.do("summary", *options).out
            self.assertIn("Φ", text)
            self.assertLessEqual(max(map(len, text.splitlines())), 80, max(text.splitlines(), key=len))
        self.assertIn("more trials", text)
        self.assertIn(",phi,", self.do("summary", "--format", "csv").out.splitlines()[0])
        self.assertIn("Phi", self.do("summary", "--format", "latex").out)
        self.assertIn("rater", self.do("summary", "--format", "markdown").out.split("K_{xx}")[0])
        self.do("summary", "--raters", 2, code=WRONG_USAGE)  # of which outcome?
        study = ("--study", StatisticsOfAStudy.study)
        self.mbk("study", "summary", "--outcome", "K_xx", "--raters", 2, *study, code=WRONG_USAGE)
        for words in (("summary",), ("summary", "--json"), ("summary", "--format", "csv"), ("list",), ("list", "--json"),
                      ("export",)):
            self.assertNotIn("rater", self.mbk("study", *words, *study).out, words)


class APlan(command.Case):
    def test_of_stated_variances_is_what_simulated_studies_show(self):
        plan = self.mbk("study", "plan", "--sd-people", "60", "--sd-sessions", "15", "--sd-trials", "25",
                        "--difference", "50", "--trials", "2", "--simulate", "2000", "--json").json
        self.assertEqual(len(plan["plans"]), 2)
        for one in plan["plans"]:
            self.assertGreaterEqual(one["power"]["value"], 0.8)
            low, high = one["simulated_power"]["interval95"]
            self.assertTrue(low - 0.02 <= one["power"]["value"] <= high + 0.02, one)
        self.assertIsNone(plan["pilot"])
        text = self.mbk("study", "plan", "--sd-people", "60", "--sd-trials", "25", "--mdc", "60").out
        self.assertIn("*", text)

    def test_needs_a_quantity_and_its_source(self):
        for arguments in (("--sd-people", "60", "--sd-trials", "25"), ("--sd-people", "60", "--mdc", "5"),
                          ("--sd-people", "60", "--sd-trials", "25", "--difference", "0"),
                          ("--difference", "5", "--study", self.folder)):
            self.mbk("study", "plan", *arguments, code=WRONG_USAGE)

    def test_is_not_made_from_a_pilot_of_three(self):
        if StatisticsOfAStudy.study is None:
            StatisticsOfAStudy.study = made_study(command.folder_of_logs())
        ran = self.mbk("study", "plan", "--outcome", "K_xx", "--condition", "relaxed", "--difference", "50", "--study",
                       StatisticsOfAStudy.study, code=BAD_DATA)
        self.assertIn("3 people", ran.err)
        ran = self.mbk("study", "plan", "--outcome", "K_xx", "--condition", "relaxed", "tensed", "--difference", "50",
                       "--study", StatisticsOfAStudy.study, "--json")
        self.assertEqual(ran.json["pilot"]["participants"], 6)
        low, high = ran.json["plans"][0]["people"]["interval95"]
        self.assertTrue(low <= ran.json["plans"][0]["people"]["value"] and (high is None or high >= low), ran)


if __name__ == "__main__":
    command.main()
