#!/usr/bin/env python3
"""What the operator excluded on the console's pages is heeded by whoever reads the recording, and never silently."""

import functools

from command import BAD_DATA, FINE, NOT_USABLE, Case, flat, folder_of_logs, main, make_log, run, table_of, write_csv

COUGH = (20.0, 24.0)  # [s]


@functools.lru_cache(maxsize=None)
def columns():
    return table_of(make_log("sinusoidal", "--coloured-force-noise", "0.3"))


@functools.lru_cache(maxsize=None)
def table(coughed):
    """The recording as CSV, with a push of 30 N in the middle where somebody coughed."""
    time, x, y, fx, *rest = columns()
    push = [f + 30.0 * (coughed and COUGH[0] <= t <= COUGH[1]) for t, f in zip(time, fx)]
    path = write_csv(folder_of_logs() / f"exclusions_{coughed}.csv", [time, x, y, push, *rest])
    return path.read_text(encoding="utf-8")


def codes_of(ran):
    return [warning["code"] for warning in ran.json["warnings"]]


class Exclusions(Case):
    def recording(self, name="trial.csv", coughed=False, **metadata):
        comments = "".join(f"# {key}: {value}\n" for key, value in metadata.items())
        (self.folder / name).write_text("# mbk.recording/1\n" + comments + table(coughed), encoding="utf-8")
        return self.folder / name

    def measured(self, *arguments):
        ran = run("measure", "--json", *arguments)
        self.assertIn(ran.code, (FINE, NOT_USABLE), ran)
        return ran

    def distance(self, ran):
        """Of K from the truth, relative."""
        truth = make_log("sinusoidal", "--coloured-force-noise", "0.3").truth["K"]
        return max(abs(a - b) for a, b in zip(flat(ran.json["model"]["K"]), flat(truth))) / max(map(abs, flat(truth)))

    def test_a_window_is_left_out_and_that_is_said(self):
        spoilt = self.measured(self.recording(coughed=True))
        without = self.measured(self.recording("marked.csv", coughed=True, excluded_windows="20-24 s: coughed"))
        clean = self.measured(self.recording("clean.csv"))
        self.assertLess(self.distance(without), 2 * self.distance(clean) + 0.01)
        self.assertGreater(self.distance(spoilt), self.distance(without))
        self.assertNotIn("excluded-window", codes_of(without))
        text = " ".join(run("measure", self.folder / "marked.csv").out.split())
        for fact in ("20 s", "24 s", "coughed"):
            self.assertIn(fact, text)
        seconds = [ran.json["passivity"]["energy"]["duration_s"] for ran in (clean, without)]
        self.assertTrue(4.0 <= seconds[0] - seconds[1] < 4.5, seconds)

    def test_nothing_else_changes(self):
        """A window that is not measured anyway."""
        alone, marked = (self.measured(self.recording(name, excluded_windows=window)).json
                         for name, window in (("a.csv", "100-104 s: later"), ("b.csv", "")))
        self.assertEqual(alone["model"], marked["model"])
        self.assertEqual(alone["standard_error"], marked["standard_error"])

    def test_reference_mode_takes_it_and_warns(self):
        ran = self.measured("--mode", "reference", self.recording(excluded_windows="20-24 s: coughed"))
        self.assertIn("excluded-window", codes_of(ran))
        self.assertIn("20-24 s: coughed", ran.out)
        beside = self.measured("--mode", "reference", self.recording("b.csv", excluded_windows="1-2 s: before it"))
        self.assertNotIn("excluded-window", codes_of(beside))

    def test_windows_that_cannot_be_read_are_said(self):
        ran = self.measured(self.recording(excluded_windows="the first half"))
        self.assertIn("excluded-window", codes_of(ran))
        self.assertIn("the first half", ran.out)

    def test_where_nothing_is_left_it_refuses(self):
        path = self.recording(excluded_windows="0-100 s: slept")
        self.refused(BAD_DATA, "measure", path, says=("slept",))

    def test_an_excluded_trial_is_measured_with_its_reason(self):
        path = self.recording(excluded="hand slipped")
        ran = self.measured(path)
        self.assertEqual(codes_of(ran), [*codes_of(self.measured(self.recording("b.csv"))), "excluded-trial"])
        self.assertIn("hand slipped", " ".join(run("measure", path).out.split()))

    def test_a_mean_leaves_it_out(self):
        paths = [self.recording(f"{k}.csv", trial=k, **({"excluded": "hand slipped"} if k == 2 else {}))
                 for k in range(3)]
        summary = self.measured(*paths).json["summary"]
        self.assertEqual(summary["trials"], 2)
        self.assertIn("hand slipped", summary["omitted"][0]["why"])

    def test_commands_that_leave_nothing_out_say_so(self):
        path = self.recording(excluded="hand slipped", excluded_windows="20-24 s: coughed")
        for command in (("explore",), ("movement",)):
            err = run(*command, path).err
            for words in ("hand slipped", "20 s", "24 s"):
                self.assertIn(words, err, command)

    def test_a_study_takes_it_as_excluded(self):
        study = self.folder / "study"
        self.mbk("study", "init", study)
        add = ("study", "add", "--study", study, "--participant", "7", "--condition", "relaxed")
        first = self.mbk(*add, self.recording(excluded="hand slipped"))
        self.assertRegex(first.out, r"recording 1: .*hand slipped\n\Z")
        marked = self.mbk(*add, self.recording("b.csv", excluded_windows="20-24 s: coughed"))
        self.assertIn("20-24 s: coughed", marked.err)
        again = self.mbk(*add, "--trial", "1", self.folder / "trial.csv")
        self.assertIn("hand slipped", again.out)
        ran = self.mbk("study", "measure", "--study", study, "--quiet")
        shown = self.mbk("study", "list", "--study", study).out
        self.assertIn("hand slipped", shown, ran)
        self.assertIn("1 usable", shown, ran)
        self.mbk("study", "check", "--study", study, "--quick")
        self.mbk("study", "exclude", "1", "--undo", "--why", "it was fine", "--study", study)
        self.assertNotIn("hand slipped", self.mbk("study", "list", "--study", study).out)


if __name__ == "__main__":
    main()
