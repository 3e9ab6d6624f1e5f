#!/usr/bin/env python3
"""Ramps and holds: from the scenario to the stiffness that mbk explore reads off their plateaus."""

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main

ARM = """
[recording]
seed = {seed}
[robot]
home_mm = [300, -50]
[control]
kind = "position"
proportional_Nm_per_rad = [{gain}, {gain}]
derivative_Nms_per_rad = [{damping}, {damping}]
[perturbation]
kind = "ramp_and_hold"
amplitude_mm = {amplitude}
ramp_s = {ramp}
hold_s = {hold}
return_s = 0.2
directions = {directions}
repetitions = {repetitions}
shortest_pause_s = 0.5
longest_pause_s = 0.7
quiet_s = 0.5
tail_s = 0.1
[participant]
kind = "linear"
mass_kg = [[1.33, -0.9], [-0.9, 1.9]]
damping_Ns_per_m = [[5.8, -2.1], [-2.1, 10.6]]
stiffness_N_per_m = [[42, -20], [-36, 125]]
[participant.remnant]
floor_N = {noise}
"""
USUAL = dict(seed=1, gain=1000, damping=20, amplitude=6, ramp=0.12, hold=0.25, directions=8, repetitions=5, noise=0.05)
TRUTH = ((42, -20), (-36, 125))


class RampAndHold(Case):
    def recorded(self, **changes):
        name = "-".join(f"{key}{value}" for key, value in sorted(changes.items())) or "usual"
        scenario, log = self.folder / f"{name}.toml", self.folder / f"{name}.h5"
        if not log.exists():
            scenario.write_text(ARM.format(**{**USUAL, **changes}))
            self.fine("simulate", scenario, "--out", log, "--quiet")
        return log

    def not_usable(self, code, *options, **changes):
        """Warned of with that code and not usable, in JSON and in text."""
        log = self.recorded(**changes)
        found = self.mbk("explore", log, "--json", *options, code=NOT_USABLE).json
        self.assertIs(found["usable"], False)
        self.assertIs(found["ramp_and_hold"]["usable"], False)
        self.assertIn(code, [warning["code"] for warning in found["warnings"]])
        text = self.mbk("explore", log, *options, code=NOT_USABLE).out
        self.assert_lines_fit(text)
        self.assertIn("not usable", text)
        return found

    def test_the_stiffness_comes_back_with_its_intervals(self):
        log = self.recorded()
        found = self.fine("explore", log, "--json").json
        part = found["ramp_and_hold"]
        stiffness = part["stiffness"]
        self.assertEqual((stiffness["displacements"], stiffness["directions"]), (40, 8))
        self.assertEqual(len(part["plateaus"]), 40)
        self.assertAlmostEqual(part["plateau_s"][1], 0.3)
        self.assertLess(part["motion_share"], 0.02)
        self.assertAlmostEqual(stiffness["reached"], 1.0, delta=0.05)
        for row, truth_row in zip(range(2), TRUTH):
            for column, truth in zip(range(2), truth_row):
                low, high = stiffness["interval95"][row][column]
                self.assertAlmostEqual((low + high) / 2, stiffness["K"][row][column], delta=1e-6)
                self.assertLess(abs(stiffness["K"][row][column] - truth), 0.75 * (high - low))  # 3 standard errors
                self.assertLess(high - low, 16)
        low, high = stiffness["antisymmetry"]["value_interval95"]
        self.assertTrue(low < 8 < high and low > 0)  # k_a = 8 N/m is seen
        self.assertLess(stiffness["ellipse"]["interval95"]["area"][0], 3.1416 * (42 * 125 - 28 * 28))
        self.assertGreater(stiffness["ellipse"]["interval95"]["area"][1], 3.1416 * (42 * 125 - 28 * 28))
        text = self.fine("explore", log).out
        self.assert_lines_fit(text)
        for words in ("40", "8 directions", "6 mm", "300 ms", "stiffness K", "ellipse", "antisymm", "linearity"):
            self.assertIn(words, text)

    def test_a_window_may_be_chosen_and_one_in_which_the_hand_moves_is_not_usable(self):
        log = self.recorded()
        part = self.fine("explore", log, "--json", "--plateau-from", "250", "--plateau-to", "350").json["ramp_and_hold"]
        self.assertEqual(part["plateau_s"], [0.25, 0.35])
        early = self.not_usable("missing-dynamics", "--plateau-from", "30", "--plateau-to", "90")
        self.assertGreater(abs(early["ramp_and_hold"]["stiffness"]["K"][1][1] - 125), 30)
        self.refused(WRONG_USAGE, "explore", log, "--plateau-from", "300", "--plateau-to", "200",
                     says=("300 ms", "200 ms"))
        self.refused(BAD_DATA, "explore", log, "--plateau-to", "900", says="--plateau-to")

    def test_a_control_that_is_too_soft_is_not_usable(self):
        self.not_usable("closed-loop-bias", gain=3, damping=1, hold=1.0)

    def test_ramps_that_are_small_beside_the_noise_are_not_usable(self):
        self.not_usable("motion-too-small", amplitude=0.2, noise=0.3, repetitions=2)

    def test_too_few_directions_give_no_stiffness(self):
        found = self.fine("explore", self.recorded(directions=2), "--json").json
        self.assertNotIn("ramp_and_hold", found)
        self.refused(BAD_DATA, "explore", self.recorded(directions=2), "--plateau-to", "300", says="axis")

    def test_ramps_that_leave_no_plateau_before_a_reaction_give_none(self):
        found = self.fine("explore", self.recorded(ramp=0.3, repetitions=2), "--json").json
        self.assertNotIn("ramp_and_hold", found)
        self.assertIn("--plateau-to", " ".join(found["notes"]))

    def test_several_recordings_are_pooled(self):
        one, two = self.recorded(), self.recorded(seed=2)
        alone = self.fine("explore", one, "--json").json["ramp_and_hold"]["stiffness"]
        both = self.fine("explore", one, two, "--json").json["ramp_and_hold"]["stiffness"]
        self.assertEqual(both["displacements"], 80)
        self.assertLess(both["relative_error"], alone["relative_error"])

    def test_other_perturbations_have_no_such_part(self):
        for scenario in ("relaxed_underdamped", "relaxed_sinusoidal"):
            log = self.folder / f"{scenario}.h5"
            self.fine("simulate", scenario, "--out", log, "--quiet")
            self.assertNotIn("ramp_and_hold", self.fine("explore", log, "--json").json)

    def test_mistakes_in_the_scenario_are_named(self):
        for change, words in ((dict(amplitude=-6), "amplitude_mm"), (dict(ramp=0), "ramp_s"), (dict(hold=0), "hold_s")):
            bad = self.file("bad.toml", ARM.format(**{**USUAL, **change}))
            self.refused(BAD_DATA, "simulate", bad, "--out", self.folder / "bad.h5", says=words)
        lines = ARM.format(**USUAL).replace('kind = "position"', 'kind = "force"', 1).splitlines()
        force = self.file("force.toml", "\n".join(line for line in lines if "_Nm" not in line))
        self.refused(WRONG_USAGE, "simulate", force, "--out", self.folder / "bad.h5", says="quantity")

    def test_it_can_be_run(self):
        ran = self.fine("run", "relaxed_ramp_and_hold", "--dry-run")
        self.assertIn("measured force", ran.out)
        self.assertNotIn("SAFETY STOP", ran.out)


if __name__ == "__main__":
    main()
