#!/usr/bin/env python3
"""A hand that reaches and is displaced: simulated and run as an experiment, and the stiffness that mbk explore reads off."""

import json

from command import BAD_DATA, FINE, NOT_USABLE, WRONG_USAGE, Case, main, run

REACHING = """
[recording]
seed = {seed}
[robot]
home_mm = [300, -120]
coulomb_Nm = [0.114, 0.114]
handle_mass_kg = 0.194
[control]
kind = "{control}"
{gains}
[perturbation]
kind = "{kind}"
amplitude_mm = 8
repetitions = {repetitions}
undisturbed_first = {first}
undisturbed_between = 10
trigger_mm = 125
reach_s = 1.0
quiet_s = 1
[participant]
kind = "{limb}"
{numbers}
[participant.reaching]
duration_spread_percent = 4
length_spread_percent = 3
bend_mm = 4
end_spread_mm = 4
[participant.remnant]
floor_N = 0.1
[safety]
speed_mm_per_s = {speed}
excursion_mm = 330
handle_force_N = 30
joint_torque_Nm = [8, 8]
"""
STIFFNESS = ((150.0, -55.0), (-75.0, 330.0))
USUAL = dict(seed=1, control="position", kind="servo_displacement", repetitions=8, first=30, speed=900, limb="linear",
             gains="proportional_Nm_per_rad = [3000, 3000]\nderivative_Nms_per_rad = [60, 60]\n"
                   "velocity_cutoff_hz = 200",
             numbers="mass_kg = [[1.33, -0.93], [-0.93, 1.88]]\ndamping_Ns_per_m = [[12, -4], [-4, 20]]\n"
                     "stiffness_N_per_m = [[150, -55], [-75, 330]]")


class Reaching(Case):
    def scenario(self, **changes):
        return self.file("reaching.toml", REACHING.format(**{**USUAL, **changes}))

    def explored(self, log):
        """Whether usable or not: a trial of 64 displacements is short."""
        found = run("explore", log, "--only", "servo-displacement", "--json")
        self.assertIn(found.code, (FINE, NOT_USABLE), found)
        return found.json["servo_displacement"]

    def assert_holds(self, part, truth, displaced):
        """Within three standard errors, where those are below a quarter of K."""
        stiffness = part["own_past"]["stiffness"]
        self.assertGreaterEqual(stiffness["displacements"], displaced)
        self.assertEqual(stiffness["directions"], 8)
        self.assertLess(stiffness["relative_error"], 0.25)
        for row in range(2):
            for column in range(2):
                low, high = stiffness["interval95"][row][column]
                self.assertLess(abs(stiffness["K"][row][column] - truth[row][column]), 0.75 * (high - low))

    def test_the_stiffness_of_a_simulated_reach_comes_back(self):
        log = self.folder / "reaching.h5"
        self.fine("simulate", self.scenario(), "--out", log, "--quiet")
        part = self.explored(log)
        self.assertEqual(part["trigger"], "trigger")
        self.assertGreaterEqual(part["undisturbed"], 40)
        self.assert_holds(part, STIFFNESS, 60)
        self.assertLess(part["own_past"]["prediction_error"], 0.5 * part["mean_reach"]["prediction_error"])

    def test_the_truth_of_a_linear_limb_is_its_stiffness(self):
        log = self.folder / "truth.h5"
        self.fine("simulate", self.scenario(repetitions=1), "--out", log, "--quiet")
        metadata = self.fine("info", log, "--json").json["metadata"]
        truth = json.loads(metadata["truth_K"])
        for row in range(2):
            for column in range(2):
                self.assertAlmostEqual(truth[row][column], STIFFNESS[row][column], delta=1e-3)

    def test_an_arm_of_two_links_reaches_too(self):
        log = self.folder / "arm.h5"
        arm = ("shoulder_mm = [350, -430]\nstiffness_Nm_per_rad = [[30, 9], [9, 22]]\n"
               "damping_Nms_per_rad = [[3, 1], [1, 1.5]]")
        self.fine("simulate", self.scenario(limb="arm", numbers=arm), "--out", log, "--quiet")
        truth = json.loads(self.fine("info", log, "--json").json["metadata"]["truth_K"])
        self.assert_holds(self.explored(log), truth, 60)

    def test_it_runs_as_an_experiment_and_gives_the_same(self):
        experiment, log = self.scenario(), self.folder / "run.h5"
        plan = self.fine("run", experiment, "--dry-run").out
        self.assertIn("8 mm", plan)
        self.assertNotIn("SAFETY STOP", plan)
        ran = self.fine("run", experiment, "--fast", "--no-console", "--quiet", "--out", log).out
        self.assertIn("completed", ran)
        self.assertIn("mbk explore", ran)
        self.assertIn("0 dropped", ran)
        self.assert_holds(self.explored(log), STIFFNESS, 60)

    def test_mistakes_are_named(self):
        out = self.folder / "bad.h5"
        self.refused(BAD_DATA, "simulate", self.scenario(first=5), "--out", out, says="undisturbed_first")
        self.refused(WRONG_USAGE, "simulate", self.scenario(control="force", gains=""), "--out", out, says="quantity")
        self.refused(WRONG_USAGE, "run", self.scenario(speed=300), "--dry-run", says="safety.speed_mm_per_s")
        text = self.scenario().read_text().replace("trigger_mm = 125", "trigger_mm = 300")
        self.refused(WRONG_USAGE, "simulate", self.file("late.toml", text), "--out", out, says="trigger")
        arm = self.scenario(limb="arm", numbers="")
        self.refused(WRONG_USAGE, "simulate", arm, "--out", out, says="shoulder")
        text = self.scenario().read_text().replace('kind = "servo_displacement"', 'kind = "ramp_and_hold"')
        self.refused(BAD_DATA, "simulate", self.file("ramps.toml", text), "--out", out, says="reach")


if __name__ == "__main__":
    main()
