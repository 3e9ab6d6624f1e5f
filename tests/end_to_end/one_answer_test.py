#!/usr/bin/env python3
"""One recording, one answer: what mbk run says of a trial is what mbk measure says of its recording, missed ticks and
the handle's mass included."""

from command import Case, main, run

TICK = 1e-3
SHORT = """
[recording]
condition = "{name}"
[robot]
handle_mass_kg = 0.194
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "{control}"
[perturbation]
kind = "multisine"
{peak}
duration_s = 20
moving_in_s = 2
[participant]
kind = "arm"
number = 1
"""
POSITION = SHORT.format(name="relaxed", control="position", peak="peak_deg = 2")
FORCE = SHORT.format(name="relaxed, force", control="force", peak="peak_N = 3")


class OneAnswer(Case):
    def performed(self, text, *options):
        """A session's recording, and what mbk run printed of it."""
        recording = self.folder / "trial.h5"
        ran = run("run", self.file("trial.toml", text), "--fast", "--quiet", "--no-console", "--out", recording,
                  *options)
        self.assertEqual(ran.code, 0, ran)
        return recording, ran.out

    def without(self, recording, missed):
        """The recording as a table without the ticks that `missed` names."""
        table = self.folder / "table.csv"
        self.mbk("convert", recording, table, "--overwrite")
        lines = table.read_text(encoding="utf-8").splitlines()
        start = next(k for k, line in enumerate(lines) if line.startswith("time_s")) + 1
        kept = [line for k, line in enumerate(lines[start:]) if not missed(k)]
        return self.file("gaps.csv", "\n".join(lines[:start] + kept) + "\n")

    def model(self, *arguments):
        return self.mbk("measure", "--json", *arguments).json

    def test_run_prints_what_measure_prints_of_its_recording(self):
        for text in (POSITION, FORCE):
            with self.subTest(text):
                recording, said = self.performed(text)
                measured = run("measure", recording)
                self.assertIn(measured.out, said)
                recording.unlink()

    def test_the_handle_is_subtracted_by_default_and_said_but_not_in_reference_mode_unless_asked(self):
        recording, _ = self.performed(POSITION)
        by_default, given, none = (self.model(recording, *options)
                                   for options in ((), ("--handle-mass", 0.194), ("--handle-mass", 0)))
        self.assertEqual(by_default["model"], given["model"])
        self.assertEqual(by_default["estimation"]["handle_mass_kg"], 0.194)
        self.assertEqual(by_default["estimation"]["handle_mass_from"], "recording")
        self.assertEqual(given["estimation"]["handle_mass_from"], "option")
        for k in range(2):
            self.assertAlmostEqual(none["model"]["M"][k][k] - by_default["model"]["M"][k][k], 0.194, places=9)
        self.assertRegex(self.mbk("measure", recording).out, r"handle mass +0\.194 kg")
        published = self.model(recording, "--mode", "reference")
        self.assertEqual(published["estimation"]["handle_mass_kg"], 0)
        asked = self.model(recording, "--mode", "reference", "--handle-mass", 0.194)
        self.assertAlmostEqual(published["model"]["M"][0][0] - asked["model"]["M"][0][0], 0.194, places=9)
        self.assertRegex(self.mbk("measure", "--mode", "reference", recording).out, r"handle mass +none")

    def test_a_mass_that_is_none_is_refused_unless_another_is_given(self):
        recording, _ = self.performed(POSITION)
        table = self.folder / "table.csv"
        self.mbk("convert", recording, table)
        text = table.read_text(encoding="utf-8")
        for mass in ("heavy", "-1", "nan"):
            bad = self.file("bad.csv", text.replace("# handle_mass_kg: 0.194", f"# handle_mass_kg: {mass}"))
            self.bad_data(bad, says=["handle_mass_kg", "--handle-mass"])
            self.assertEqual(run("measure", bad, "--handle-mass", 0.194).code, 0)

    def test_missed_ticks_are_bridged_and_said(self):
        recording, _ = self.performed(POSITION)
        whole = self.model(recording)
        gaps = self.without(recording, lambda k: k % 450 in (7, 8, 9, 10))  # of 5 ms, 42 and more
        bridged = self.model(gaps)
        (warning,) = [w for w in bridged["warnings"] if w["code"] == "resampled"]
        self.assertRegex(warning["message"], r"1000 Hz.*\d\d gaps.*0\.005 s")
        for name in "MBK":
            for k in range(2):
                self.assertLess(abs(bridged["model"][name][k][k] - whole["model"][name][k][k]),
                                0.3 * whole["standard_error"][name][k][k])

    def test_what_is_too_much_to_be_bridged_is_refused(self):
        recording, _ = self.performed(POSITION)
        long = self.without(recording, lambda k: 9000 <= k < 9300)
        self.bad_data(long, says=["gap", "--from"])
        many = self.without(recording, lambda k: k % 50 in range(1, 10))
        self.bad_data(many, says=["gap", "--from"])

    def test_a_foreign_recording_with_gaps_is_not_put_on_another_clock_unasked(self):
        recording, _ = self.performed(POSITION)
        gaps = self.without(recording, lambda k: k % 450 in (7, 8, 9, 10))
        foreign = self.file("foreign.csv", "\n".join(line for line in gaps.read_text(encoding="utf-8").splitlines()
                                                     if not line.startswith("# rate_hz")) + "\n")
        self.bad_data(foreign, says=["gap", "--resample"])


if __name__ == "__main__":
    main()
