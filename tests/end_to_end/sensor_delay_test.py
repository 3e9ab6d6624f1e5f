#!/usr/bin/env python3
"""mbk sensor delay: by how much the force is late, from a known mass; and what --force-delay-ms makes of it."""

from command import Case, main, run

MASS = """
[recording]
condition = "a known mass"
[robot]
home_mm = [300, -50]
coulomb_Nm = [0.114, 0.114]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = 40
[rig]
mass_kg = 1.0
stiffness_N_per_m = [[0, 0], [0, 0]]
[sensors.force]
kind = "load_cell"
"""


class SensorDelay(Case):
    def recording(self, name, text):
        path = self.folder / f"{name}.h5"
        ran = run("simulate", self.file(f"{name}.toml", text), "--out", path, "--overwrite", "--quiet")
        self.assertEqual(ran.code, 0, ran)
        return path

    def late(self, milliseconds):
        return self.recording("late", MASS + f"delay_ms = {milliseconds}\n")

    def test_the_delay_is_found_and_undone(self):
        for delay in (0, 3, 12.5):
            with self.subTest(delay):
                path = self.late(delay)
                found = run("sensor", "delay", path, "--mass", 1.194, "--json")
                self.assertEqual(found.code, 0, found)
                low, high = found.json["delay_interval95_s"]
                self.assertLess(abs(1e3 * found.json["delay_s"] - delay), 0.1)
                self.assertLess(high - low, 1e-3)
                text = run("sensor", "delay", path, "--mass", 1.194).out
                self.assertIn(f"{delay:.2f} ±", text)
                again = run("sensor", "delay", path, "--mass", 1.194, "--json")
                self.assertEqual(again.out, found.out)

    def test_what_is_no_mass_of_that_size_gives_no_delay(self):
        wrong = run("sensor", "delay", self.late(3), "--mass", 2, "--json")
        self.assertEqual(wrong.code, 4, wrong)
        self.assertIs(wrong.json["usable"], False)
        self.assertIn("2 kg", " ".join(wrong.json["problems"]))
        arm = self.folder / "arm.h5"
        self.assertEqual(run("simulate", "relaxed_sinusoidal", "--out", arm, "--quiet").code, 0)
        limb = run("sensor", "delay", arm, "--mass", 1.194)
        self.assertEqual(limb.code, 4, limb)
        self.assertIn("handle", limb.out)

    def test_wrong_usage(self):
        path = self.late(0)
        for arguments in ((), ("--mass", 0), ("--mass", -1), ("--mass", "heavy")):
            self.assertEqual(run("sensor", "delay", path, *arguments).code, 2, arguments)
        self.assertEqual(run("sensor", "delay", "none.h5", "--mass", 1).code, 3)
        virtual = run("measure", path, "--force-delay-ms", 3, "--force-source", "virtual")
        self.assertEqual(virtual.code, 2, virtual)

    def test_a_recording_says_that_its_force_was_moved(self):
        text = run("measure", self.late(3), "--force-delay-ms", 3).out
        self.assertIn("3 ms", text)


if __name__ == "__main__":
    main()
