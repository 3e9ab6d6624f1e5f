"""mbk simulate: from a scenario to recordings, and what becomes of them."""

import json
import re
import struct
import unittest
import zlib

import mat_file
from command import BAD_DATA, NOT_SHOWN, WRONG_USAGE, Case, main, run

SHORT = """
[robot]
handle_mass_kg = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = 20
[participant]
kind = "linear"
mass_kg = [[1.3, -0.9], [-0.9, 1.9]]
damping_Ns_per_m = [[5.8, -2.1], [-2.1, 10.6]]
stiffness_N_per_m = [[42, -29], [-29, 125]]
"""
TABLE = "rig_table_3_1"
ONE_AXIS = """
[robot]
kind = "one_axis"
[control]
kind = "position"
[perturbation]
kind = "pulses"
amplitude_deg = 1.5
[participant]
kind = "joint"
"""
TRIALS = SHORT + '[[trial]]\nname = "a"\n[[trial]]\nname = "b"\nrecording.seed = 7\n'


def without_structures(data):
    """The same file, byte by byte, without its structures: no metadata, no events."""
    kept, place = data[:128], 128
    while place < len(data):
        kind, size = struct.unpack_from("<II", data, place)
        whole = data[place:place + 8 + (size if kind == mat_file.COMPRESSED else (size + 7) // 8 * 8)]
        inner = zlib.decompress(whole[8:]) if kind == mat_file.COMPRESSED else whole
        (_, matrix), = mat_file.elements(inner)
        if next(mat_file.elements(matrix))[1][0] != mat_file.STRUCTURE:
            kept += whole
        place += len(whole)
    return kept


class Recordings(Case):
    def test_a_scenario_becomes_a_recording_with_its_truth(self):
        scenario = self.file("mine.toml", SHORT)
        ran = self.mbk("simulate", scenario, "--out", self.folder / "mine.mat")  # may tell how far it is
        self.assertRegex(ran.out, r"mine\.mat: 20\.0 s.* 1000 Hz.* seed 1\b.* [+-]\d\.\d{3} J\n")
        info = self.fine("info", "--json", self.folder / "mine.mat").json
        self.assertEqual(json.loads(info["metadata"]["truth_M"]), [[1.3, -0.9], [-0.9, 1.9]])
        self.assertEqual(info["metadata"]["handle_mass_kg"], "0.1")
        model = self.fine("measure", "--json", "--handle-mass", "0.1", self.folder / "mine.mat").json["model"]
        for name, expected in (("M", 1.3), ("B", 5.8), ("K", 42.0)):
            self.assertAlmostEqual(model[name][0][0], expected, delta=0.15 * expected)

    def test_ready_scenarios_are_listed_shown_and_run_by_name(self):
        names = re.findall(r"(?m)^  (\w+) ", self.fine("simulate", "--list").out)
        for name in ("relaxed_sinusoidal", "relaxed_underdamped", "rigid_underdamped_2N", "rigid_underdamped_8N",
                     "rigid_sinusoidal_6N", "one_axis_random_binary", "rig_table_3_1", "rig_table_5_1",
                     "rig_springs_table_3_1", "rig_springs_table_5_1", "free_motion", "relaxed_space",
                     "elbow_healthy", "elbow_spastic", "elbow_perturbed"):
            self.assertIn(name, names)
        shown = self.file("copy.toml", self.fine("simulate", "--show", "free_motion").out)
        self.fine("simulate", shown, "--out", self.folder / "a.mat", "--quiet")
        self.fine("simulate", "free_motion", "--out", self.folder / "b.mat", "--quiet")
        one, two = (without_structures((self.folder / name).read_bytes()) for name in ("a.mat", "b.mat"))
        self.assertTrue(one == two)

    def test_facts_of_the_perturbation_are_told_without_simulating(self):
        facts = self.fine("simulate", "rigid_underdamped_2N", "--facts").out
        self.assertRegex(facts, r"peak +3\.4\d* N\b")  # 2 N times 1 + exp(-pi 0.1/sqrt(0.99))
        self.assertEqual(self.names(), [])

    def test_a_hand_in_space_has_three_axes(self):
        facts = self.fine("simulate", "relaxed_space", "--facts").out
        self.assertRegex(facts, r"peak +[\d.]+ mm at .*; first axis 8, second 8, third 8\n")
        self.fine("simulate", "relaxed_space", "--out", self.folder / "space.csv", "--quiet")
        lines = (self.folder / "space.csv").read_text().splitlines()
        header = next(line for line in lines if "hand_x" in line)
        for name in ("hand", "force", "reference", "acceleration"):
            for axis in "xyz":
                self.assertIn(f"{name}_{axis}", header)
        self.fine("simulate", "relaxed_space", "--out", self.folder / "space.h5", "--quiet")
        metadata = self.fine("info", "--json", self.folder / "space.h5").json["metadata"]
        for name in ("truth_M", "truth_B", "truth_K"):
            self.assertEqual([len(row) for row in json.loads(metadata[name])], [3, 3, 3])
        self.assertEqual(len(json.loads(metadata["truth_x0"])), 3)
        self.refused(BAD_DATA, "run", "relaxed_space", "--dry-run", says="in space")

    def test_an_elbow_has_emg_and_the_truth_of_its_reflex(self):
        facts = self.fine("simulate", "elbow_spastic", "--facts").out
        self.assertRegex(facts, r"peak +70 ° ")
        self.assertRegex(facts, r"speed +peak 210 °/s ")
        short = re.sub("repetitions = 5", "repetitions = 1", self.fine("simulate", "--show", "elbow_spastic").out)
        scenario = self.file("spastic.toml", short)
        for name in ("spastic.h5", "spastic.mat"):
            self.fine("simulate", scenario, "--out", self.folder / name, "--quiet")
        self.fine("simulate", scenario, "--out", self.folder / "spastic.csv", "--quiet", "--blind")
        lines = (self.folder / "spastic.csv").read_text().splitlines()
        header = next(line for line in lines if "reaction" in line and not line.startswith("#"))
        for name in ("position", "reference", "emg_biceps", "emg_triceps"):
            self.assertIn(name, header)
        metadata = self.fine("info", "--json", self.folder / "spastic.h5").json["metadata"]
        speeds = json.loads(metadata["truth_stretch_speed_rad_per_s"])
        thresholds = json.loads(metadata["truth_stretch_threshold_rad"])
        for v, threshold in zip(speeds, thresholds, strict=True):  # the reflex begins while the speed is constant
            self.assertAlmostEqual(threshold, float(metadata["truth_biceps_threshold_rad"]) - 0.1 * v, places=6)
        self.refused(BAD_DATA, "run", "elbow_spastic", "--dry-run", says="one-axis")

    def test_facts_of_a_one_axis_machine_are_in_its_units(self):
        facts = self.fine("simulate", self.file("joint.toml", ONE_AXIS), "--facts").out
        self.assertRegex(facts, r"peak +2\.59\d* °")  # 1.5 degrees times 1 + exp(-pi 0.1/sqrt(0.99))
        self.assertNotIn("mm", facts)

    def test_a_recording_that_is_there_is_replaced_only_when_told(self):
        scenario, out = self.file("mine.toml", SHORT), self.folder / "mine.mat"
        self.fine("simulate", scenario, "--out", out, "--quiet")
        first = out.read_bytes()
        self.refused(WRONG_USAGE, "simulate", scenario, "--out", out, "--seed", 2, says=["mine.mat", "--overwrite"])
        self.assertEqual(out.read_bytes(), first)
        ran = self.fine("simulate", scenario, "--out", out, "--seed", 2, "--overwrite", "--quiet")
        self.assertEqual((ran.out, self.names()), ("", ["mine.mat", "mine.toml"]))
        self.assertNotEqual(out.read_bytes(), first)

    def test_many_seeds_are_the_same_on_any_number_of_threads(self):
        scenario = self.file("mine.toml", SHORT)
        for threads in (1, 2):
            self.fine("simulate", scenario, "--out", self.folder / f"on{threads}.mat", "--seeds", 3, "--seed", 5,
                      "--threads", threads, "--quiet")
        for seed in (5, 6, 7):
            one, two = (self.folder / f"on{threads}_seed{seed}.mat" for threads in (1, 2))
            self.assertEqual(one.read_bytes(), two.read_bytes())
        self.assertNotEqual(one.read_bytes(), (self.folder / "on1_seed5.mat").read_bytes())

    def test_trials_become_files_of_their_own_and_can_be_chosen(self):
        scenario = self.file("mine.toml", TRIALS)
        self.fine("simulate", scenario, "--out", self.folder / "all.mat", "--quiet")
        self.assertEqual(self.names(), ["all_a.mat", "all_b.mat", "mine.toml"])
        self.fine("simulate", scenario, "--trial", "b", "--out", self.folder / "one.mat", "--quiet")
        self.assertEqual((self.folder / "one_b.mat").read_bytes(), (self.folder / "all_b.mat").read_bytes())

    def test_what_measures_never_reads_the_truth(self):
        for name in ("relaxed_sinusoidal", "rigid_underdamped_2N"):
            with self.subTest(name):
                folders = {kind: self.folder / name / kind for kind in ("told", "blind", "stripped")}
                for folder in folders.values():
                    folder.mkdir(parents=True)
                self.fine("simulate", name, "--out", folders["told"] / "log.mat", "--quiet")
                self.fine("simulate", name, "--out", folders["blind"] / "log.mat", "--quiet", "--blind")
                told = (folders["told"] / "log.mat").read_bytes()
                self.assertIn(b"truth", b"".join(zlib.decompress(data) for kind, data in mat_file.elements(told[128:])
                                                 if kind == mat_file.COMPRESSED))
                (folders["stripped"] / "log.mat").write_bytes(without_structures(told))
                texts, results = {}, {}
                for kind in ("told", "blind"):
                    texts[kind] = run("measure", "log.mat", folder=folders[kind]).bytes
                    results[kind] = run("measure", "--json", "log.mat", folder=folders[kind]).json
                    del results[kind]["inputs"][0]["sha256"]  # of the file's own bytes
                self.assertEqual(texts["blind"], texts["told"])
                self.assertEqual(results["blind"], results["told"])
                # Without any metadata handle mass and method have to be given; then it is the same model.
                told = results["told"]
                stripped = run("measure", "--json", "--handle-mass", str(told["estimation"]["handle_mass_kg"]), "--method",
                               told["method"], "log.mat", folder=folders["stripped"]).json
                for part in ("model", "standard_error", "covariance", "fit"):
                    self.assertEqual(stripped[part], told[part], part)
                info = run("info", "log.mat", folder=folders["blind"]).out
                self.assertNotIn("truth", info)
                self.assertNotIn(name, info)


class Refusals(Case):
    def test_an_experiment_that_cannot_be_is_named_by_file_and_trial_and_leaves_nothing(self):
        mistakes = {
            SHORT.replace("[1.3, -0.9]", "[1.3, 0.5]"): ["participant", "symmetric"],
            SHORT.replace("peak_deg = 2", "peak_deg = 60"): ["perturbation", "limit 0°", "amplitude"],
            SHORT.replace("peak_deg = 2", "peak_N = 2"): ["position", "force"],
            SHORT + '[[trial]]\nname = "a"\nperturbation.moving_in_s = 30\n': ["trial 'a'", "30"],
        }
        for text, words in mistakes.items():
            with self.subTest(words):
                bad = self.file("bad.toml", text)
                self.refused(WRONG_USAGE, "simulate", bad, "--out", self.folder / "r.mat", says=[str(bad), *words])
                self.assertEqual(self.names(), ["bad.toml"])

    def test_mistakes_of_usage(self):
        scenario, out = self.file("mine.toml", SHORT), self.folder / "r.mat"
        self.refused(WRONG_USAGE, "simulate", says="scenario")
        self.refused(WRONG_USAGE, "simulate", scenario, says="--out")
        self.refused(WRONG_USAGE, "simulate", scenario, "--out", self.folder / "r.c3d",
                     says=[".c3d", ".h5", ".mat", ".csv"])
        self.refused(WRONG_USAGE, "simulate", scenario, "--out", out, "--trial", "x", says="[[trial]]")
        self.refused(WRONG_USAGE, "simulate", TABLE, "--out", out, "--trial", "x", says="config_1")
        self.refused(WRONG_USAGE, "simulate", TABLE, "--out", out, "--trial", "config_1", "--trial", "config_1",
                     says="'config_1'")
        self.refused(WRONG_USAGE, "simulate", "--show", "nothing", says="--list")
        self.refused(BAD_DATA, "simulate", "relaxed", "--out", out, says=["relaxed", "--list"])
        self.refused(BAD_DATA, "simulate", self.folder, "--out", out, says=str(self.folder))
        self.refused(BAD_DATA, "simulate", scenario, "--out", self.folder / "gone" / "r.mat", "--quiet", says="folder")
        for option in ("--seeds=0", "--seeds=x", "--seed=-1", "--threads=0"):
            self.refused(WRONG_USAGE, "simulate", scenario, "--out", out, option, says=option.split("=")[0])
        kept = self.file("kept.mat", "precious")
        self.refused(WRONG_USAGE, "simulate", scenario, "--out", kept, says="--overwrite")
        self.assertEqual((self.names(), kept.read_text()), (["kept.mat", "mine.toml"], "precious"))

    def test_bad_scenarios_are_named_by_file_line_key_and_value_and_leave_nothing(self):
        mistakes = {
            SHORT.replace("peak_deg = 2", "peak_deg = -2"): ["line 8", "perturbation.peak_deg", "-2"],
            SHORT.replace("peak_deg", "peak_dge"): ["line 8", "'peak_dge'", "'peak_deg'"],
            SHORT.replace('"linear"', '"liner"'): ["participant.kind", "'liner'", "linear"],
            SHORT.replace("peak_deg = 2", "peak_Nm = 2"): ["line 8", "perturbation.peak_Nm", "peak_deg"],
            SHORT.replace("peak_deg = 2", 'peak_deg = "2"'): ["line 8", "perturbation.peak_deg", "number"],
            SHORT.replace("peak_deg = 2", "peak_deg = 2\npeak_mm = 2"): ["line 9", "peak_mm", "unit"],
            SHORT + "[rig]\nmass_kg = 1\nstiffness_N_per_m = [[1, 0], [0, 1]]\n": ["participant", "rig"],
            SHORT.replace('kind = "linear"', ""): ["line 10", "'kind'"],
            SHORT.replace("[perturbation]", "[disturbance]"): ["bad.toml", "perturbation", "kind"],
            SHORT + "[robot\n": ["line"],
            "\0\0\0": ["bad.toml"],
        }
        for text, words in mistakes.items():
            with self.subTest(words):
                bad = self.file("bad.toml", text)
                self.refused(BAD_DATA, "simulate", bad, "--out", self.folder / "r.mat", says=["bad.toml", *words])
                self.assertEqual(self.names(), ["bad.toml"])
        self.refused(BAD_DATA, "simulate", self.folder / "nothing.toml", "--out", self.folder / "r.mat", says="--list")

    def test_springs_of_a_scenario(self):
        field = self.fine("springs", "field", "rig_springs_table_3_1", "--trial", "config_1").out
        self.assertIn("443.860", field)
        self.refused(WRONG_USAGE, "springs", "field", "rig_springs_table_3_1", says="--trial")
        self.refused(BAD_DATA, "springs", "field", "rig_table_3_1", "--trial", "config_1", says="[[rig.spring]]")
        self.refused(WRONG_USAGE, "springs", "field", says="--spring")


class Studies(Case):
    def test_springs_are_met_and_one_run_does_not_show_it(self):
        ran = self.mbk("validate", "springs", "--runs", 1, "--quiet", "--json", "--charts", self.folder / "charts",
                       code=NOT_SHOWN)
        self.assertEqual({row["interval95"][0] for row in ran.json["rows"] if "3.1" in row["what"]}, {None})
        self.assertEqual(ran.json["rows"][0]["unit"], "N/m")
        self.assertEqual(sorted(path.name for path in (self.folder / "charts").iterdir()),
                         ["springs-1.svg", "springs-2.svg"])


if __name__ == "__main__":
    main()
