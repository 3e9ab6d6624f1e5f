#!/usr/bin/env python3
"""Several recordings: a mean is of usable, different trials of one condition; one bad file costs only itself."""

from command import BAD_DATA, NOT_USABLE, Case, copy, main, make_log, run

SCENARIO = """
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = 20
moving_in_s = 2
[participant]
kind = "arm"
number = 1
"""


def logs(*seeds):
    return [make_log("sinusoidal", "--seed", str(seed)).path for seed in seeds]


def flipped(folder, log, name="flipped.csv"):
    """The same recording with the force's sign reversed: not usable."""
    path = folder / name
    run("convert", log, path)
    lines = path.read_text(encoding="utf-8").splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("time"))
    names = lines[start].split(",")
    turned = [k for k, one in enumerate(names) if one.startswith("force_")]
    for k in range(start + 1, len(lines)):
        cells = lines[k].split(",")
        for column in turned:
            cells[column] = repr(-float(cells[column]))
        lines[k] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


class Mean(Case):
    def test_what_is_not_usable_is_not_in_it_and_is_named(self):
        bad = flipped(self.folder, logs(3)[0])
        ran = self.mbk("measure", "--json", "--quiet", *logs(1, 2), bad, code=NOT_USABLE)
        clean = self.fine("measure", "--json", "--quiet", *logs(1, 2)).json
        self.assertEqual(ran.json["summary"]["model"], clean["summary"]["model"])
        self.assertEqual(ran.json["summary"]["trials"], 2)
        (omitted,) = ran.json["summary"]["omitted"]
        self.assertEqual(omitted["file"], str(bad))
        self.assertIn("not usable", omitted["why"])
        self.assertEqual(len(ran.json["results"]), 3)
        text = " ".join(run("measure", "--quiet", *logs(1, 2), bad).out.split())
        self.assertIn("mean of 2 of 3 trials", text)
        self.assertIn(f"{bad}: not usable", text)

    def test_the_same_file_counts_once_and_is_named(self):
        first, second = logs(1, 2)
        twin = copy(first, self.folder / "twin.mat")
        ran = self.fine("measure", "--json", "--quiet", first, second, twin)
        self.assertEqual(ran.json["summary"]["model"],
                         self.fine("measure", "--json", "--quiet", first, second).json["summary"]["model"])
        (omitted,) = ran.json["summary"]["omitted"]
        self.assertEqual(omitted["file"], str(twin))
        self.assertIn(str(first), omitted["why"])

    def test_the_same_file_twice_is_not_pooled(self):
        (log,) = logs(1)
        self.refused(BAD_DATA, "measure", "--pool", log, copy(log, self.folder / "twin.mat"), says="twin.mat")

    def test_one_usable_trial_has_no_mean(self):
        (log,) = logs(1)
        bad = flipped(self.folder, logs(2)[0])
        ran = self.mbk("measure", "--json", "--quiet", log, bad, code=NOT_USABLE)
        self.assertNotIn("summary", ran.json)
        self.assertIn(ran.json["no_summary"], " ".join(run("measure", "--quiet", log, bad).out.split()))

    def simulated(self, name, condition, seed):
        path = self.folder / f"{name}.csv"
        self.fine("simulate", self.file("scenario.toml", SCENARIO), "--seed", seed, "--blind", "--quiet", "--out", path)
        first, rest = path.read_text(encoding="utf-8").split("\n", 1)
        path.write_text(f"{first}\n# condition: {condition}\n{rest}", encoding="utf-8")
        return path

    def test_different_conditions_have_no_mean_and_why_is_said(self):
        relaxed, other, rigid = (self.simulated("a", "relaxed", 1), self.simulated("b", "relaxed", 2),
                                 self.simulated("c", "rigid", 3))
        self.assertIn("summary", self.fine("measure", "--json", "--quiet", relaxed, other).json)
        ran = self.fine("measure", "--json", "--quiet", relaxed, other, rigid)
        self.assertNotIn("summary", ran.json)
        for words in ("condition", "relaxed", "rigid"):
            self.assertIn(words, ran.json["no_summary"])
        self.assertIn("condition", run("measure", "--quiet", relaxed, rigid).out)

    def test_different_protocols_and_axes_have_no_mean(self):
        for other, word in ((make_log("underdamped").path, "protocol"),
                            (make_log("sinusoidal", "--one-axis").path, "axes")):
            ran = self.fine("measure", "--json", "--quiet", make_log().path, other)
            self.assertNotIn("summary", ran.json)
            self.assertIn(word, ran.json["no_summary"])

    def test_plus_minus_is_the_95_percent_interval_of_the_mean(self):
        both = self.fine("measure", "--json", "--quiet", *logs(1, 2, 3)).json
        text = self.fine("measure", "--quiet", *logs(1, 2, 3)).out
        tail = text[text.index("mean of 3 trials"):]
        self.assertIn("95 %", tail)
        half = 4.302653 * both["summary"]["between_trial_standard_error"]["K"][0][0]  # Student, two degrees of freedom
        line = next(line for line in tail.splitlines() if "stiffness K" in line)
        shown = float(line.split("±")[1].split()[0])
        self.assertAlmostEqual(shown / half, 1.0, delta=0.05)


class OneBadFile(Case):
    def check(self, *options, command="measure"):
        first, second = logs(1, 2)
        bad, none = self.file("bad.csv", "time,x\n0,1\n1,a\n"), self.folder / "none.mat"
        ran = self.mbk(command, first, bad, second, none, *options, code=BAD_DATA)
        for file in (bad, none):
            self.assertRegex(ran.err, rf"(?m)^mbk: {file}(, [^:]*)?: .*; \w")
        return ran

    def test_it_costs_only_itself_and_is_named(self):
        ran = self.check("--quiet")
        for log in logs(1, 2):
            self.assertRegex(ran.out, rf"(?m)^{log} ")
        self.assertEqual(ran.out.count("stiffness K"), 3)  # two and their mean
        ran = self.check("--quiet", "--json")
        self.assertEqual([one["inputs"][0]["file"] for one in ran.json["results"]], [str(log) for log in logs(1, 2)])
        self.assertEqual([one["file"] for one in ran.json["failed"]],
                         [f'{self.folder / "bad.csv"}, channel hand_x, line 3, column 2', str(self.folder / "none.mat")])
        self.assertTrue(all(one["message"] and one["try"] for one in ran.json["failed"]))
        self.assertEqual(ran.json["summary"]["trials"], 2)
        self.check("--quiet", command="identify")

    def test_what_fails_while_it_is_measured_costs_only_itself_too(self):
        short = self.folder / "short.csv"
        run("convert", logs(1)[0], short)
        lines = short.read_text(encoding="utf-8").splitlines()
        short.write_text("\n".join(lines[:60]) + "\n", encoding="utf-8")
        ran = self.mbk("measure", "--quiet", "--json", *logs(1, 2), short, code=BAD_DATA)
        self.assertEqual(len(ran.json["results"]), 2)
        self.assertIn(str(short), ran.err)

    def test_where_none_is_left_nothing_is_printed(self):
        bad, none = self.file("bad.csv", "time,x\n0,1\n1,a\n"), self.folder / "none.mat"
        ran = self.mbk("measure", bad, none, code=BAD_DATA)
        self.assertEqual(ran.out, "")
        self.assertEqual(ran.err.count("mbk: "), 2)

    def test_pooled_they_are_one_measurement_which_fails(self):
        bad = self.file("bad.csv", "time,x\n0,1\n1,a\n")
        self.refused(BAD_DATA, "measure", "--pool", *logs(1, 2), bad, says=str(bad))

    def test_other_commands_do_the_same(self):
        for command in ("passivity", "info"):
            with self.subTest(command):
                ran = self.check("--json", command=command)
                self.assertEqual(ran.out.count('"sha256"'), 2)


class NotUsable(Case):
    def test_no_number_of_the_model_stands_in_the_text_and_json_keeps_it(self):
        bad = flipped(self.folder, logs(1)[0])
        ran = self.mbk("measure", bad, code=NOT_USABLE)
        for words in ("±", "inertia M", "stiffness K", "ellipse", "⠨"):
            self.assertNotIn(words, ran.out)
        self.assertIn("NOT USABLE", ran.out)
        self.assertIn("! force-sign-reversed", ran.out)
        result = self.mbk("measure", "--json", bad, code=NOT_USABLE).json
        self.assertIsInstance(result["model"]["K"][0][0], float)
        self.assertIsInstance(result["fit"]["VAF"][0], float)


if __name__ == "__main__":
    main()
