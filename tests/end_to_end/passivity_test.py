#!/usr/bin/env python3
"""mbk passivity: what happened and what the model predicts, of recordings and of stored results; what it refuses."""

import json
import pathlib

from command import BAD_DATA, WRONG_USAGE, Case, copy, main, make_log, run, table_of, write_csv

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples/teleop"

TRIALS = {  # of the thesis, seed 1: what happened in the trial
    "relaxed_sinusoidal": "passive", "relaxed_underdamped": "passive", "rigid_sinusoidal_6N": "passive",
    "rigid_underdamped_2N": "active", "rigid_underdamped_8N": "passive"}


def words_of(text):
    return " ".join(text.split())


class Recordings(Case):
    def test_the_ready_scenarios_have_their_energy_usable_or_not(self):
        for name, verdict in TRIALS.items():
            with self.subTest(name):
                path = self.folder / f"{name}.mat"
                self.fine("simulate", name, "--out", path, "--quiet")
                found = run("passivity", path, "--json", "--quiet").json["passivity"]
                self.assertEqual(found["trial"]["verdict"], verdict)
                self.assertNotIn("verdict", found)
                text = run("passivity", path, "--quiet").out
                self.assertIn(f"{verdict}: {found['trial']['statement']}", words_of(text))
                self.assertIn(f"{found['prediction']['verdict']}: {found['prediction']['statement']}", words_of(text))
                self.assertIn("Neither statement guarantees that a robot coupled to this person is stable.",
                              words_of(text))
                self.assert_lines_fit(text)

    def test_pulses_that_no_model_explains_are_told_by_the_energy_alone(self):
        path = self.folder / "pushed.mat"
        self.fine("simulate", "rigid_underdamped_2N", "--out", path, "--quiet")
        found = run("passivity", path, "--json", "--quiet").json["passivity"]
        self.assertEqual(found["trial"]["verdict"], "active")
        self.assertIn(found["prediction"]["verdict"], ("none", "undecided"))
        self.assertLess(found["trial"]["interval95"][1], 0)
        self.assertNotIn("lines", found["trial"])

    def test_a_multisine_is_told_line_by_line(self):
        path = self.folder / "relaxed.mat"
        self.fine("simulate", "relaxed_sinusoidal", "--out", path, "--quiet")
        trial = run("passivity", path, "--json", "--quiet").json["passivity"]["trial"]
        expected = [h / 10 for h in (1, 4, 7, 10, 13, 16, 20, 23, 26, 29)]
        self.assertEqual(len(trial["lines"]), len(expected))
        for line, frequency in zip(trial["lines"], expected):
            self.assertAlmostEqual(line["frequency_hz"], frequency, delta=1e-9)
            self.assertLess(line["interval95"][0], line["absorbed_J"])
            self.assertAlmostEqual(line["duration_s"], 50, delta=1e-9)  # periods after the sines have grown from rest
        # Nearly all of the energy is at the lines.
        power = sum(line["absorbed_J"] / line["duration_s"] for line in trial["lines"])
        self.assertAlmostEqual(power, trial["absorbed_J"] / 62, delta=0.15 * power)
        self.assertIn("2.9 ", run("passivity", path, "--quiet").out)

    def test_a_force_of_the_other_sign_says_nothing_of_the_trial(self):
        path = self.folder / "relaxed.mat"
        self.fine("simulate", "relaxed_sinusoidal", "--out", path, "--quiet")
        flipped = ("--channels", "x=2,y=3,Fx=-10,Fy=-11,xr=12,yr=13")
        found = run("passivity", path, *flipped, "--json", "--quiet").json
        self.assertNotIn("trial", found["passivity"])
        self.assertEqual(found["passivity"]["prediction"]["verdict"], "none")
        self.assertEqual(found["recordings"][0]["account"]["verdict"], "undecided")
        self.assertIn("no statement on the trial", words_of(run("passivity", path, *flipped, "--quiet").out))

    def test_each_method_stands_beside_its_fit(self):
        path = self.folder / "rigid.mat"
        self.fine("simulate", "rigid_sinusoidal_6N", "--out", path, "--quiet")
        found = run("passivity", path, "--json", "--quiet").json["passivity"]
        self.assertEqual([model["method"] for model in found["models"]], ["iv", "ls"])
        self.assertEqual([len(model["VAF"]) for model in found["models"]], [2, 2])
        self.assertEqual(found["models"][0]["symmetric"], "passive")
        self.assertNotEqual(found["models"][1]["symmetric"], "passive")
        self.assertEqual(found["models"][1]["published_rule"], "active")  # the headline of table 4.3
        inertia = [model["conditions"][0]["value"] for model in found["models"]]
        self.assertGreater(inertia[0], 0.3)
        self.assertLess(inertia[1], 0.1)
        self.assertEqual(found["trial"]["verdict"], "passive")
        self.assertIn(found["prediction"]["verdict"], ("none", "undecided"))

    def test_json_is_that_of_measure_and_has_the_energy_over_time(self):
        log = make_log().path
        alone = self.fine("passivity", log, "--json", "--quiet").json
        self.assertEqual(alone["schema"], "mbk.passivity/2")
        measured = run("measure", log, "--json", "--quiet").json["passivity"]
        self.assertEqual(alone["passivity"], measured)
        self.assertEqual(alone["inputs"][0]["file"], str(log))
        self.assertEqual(len(alone["recordings"]), 1)

    def test_several_files_give_one_document(self):
        logs = [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2)]
        several = self.fine("passivity", *logs, "--json", "--quiet").json
        self.assertEqual(several["schema"], "mbk.passivities/1")
        self.assertEqual([one["inputs"][0]["file"] for one in several["results"]], [str(log) for log in logs])

    def test_the_band_may_be_chosen(self):
        text = self.fine("passivity", make_log().path, "--band", "0.7:1.9", "--quiet").out
        self.assertIn("from 0.7 to 1.9 Hz", words_of(text))
        self.assertNotIn("extrapolated", text)

    def test_a_band_beyond_the_data_is_extrapolated_and_said_to_be(self):
        beyond = ("passivity", make_log().path, "--band", "0.01:20", "--quiet")
        found = self.fine(*beyond, "--json").json["passivity"]
        self.assertTrue(found["prediction"]["extrapolated"])
        self.assertLess(found["band_hz"][1], 20)
        self.assertIn("extrapolated beyond the coherent band", words_of(self.fine(*beyond).out))

    def test_without_a_reference_least_squares_is_judged_alone(self):
        columns = table_of(make_log())
        path = write_csv(self.folder / "log.csv", columns[:5], ("time", "x", "y", "Fx", "Fy"))
        found = run("passivity", path, "--split", "50", "--json", "--quiet").json["passivity"]
        self.assertEqual([model["method"] for model in found["models"]], ["ls"])
        self.bad_data(path, "--split", "50", "--method", "iv", command="passivity", says=["reference", "--method ls"])


class Results(Case):
    def stored(self, *options):
        path = self.folder / "result.json"
        self.fine("measure", make_log().path, "--json", "--quiet", "--out", path, "--overwrite", *options)
        return path

    def test_a_stored_result_says_what_its_recording_did(self):
        for options in ((), ("--method", "iv"), ("--band", "0.7:1.9")):
            band = options if "--band" in options else ()
            with self.subTest(options):
                fresh = self.fine("passivity", make_log().path, *options, "--json", "--quiet").json["passivity"]
                path = self.stored(*(options if not band else ()))
                stored = self.fine("passivity", path, *band, "--json").json["passivity"]
                self.assertEqual(stored, fresh)

    def test_a_result_of_the_first_version_is_still_read(self):
        result = json.loads(self.stored().read_text())
        found = result["passivity"]
        result["schema"] = "mbk.result/1"
        for one in result["alternatives"]:
            del one["covariance"], one["warnings"]
        models = [{**model, "band_rule": "the part of the excited band in which the perturbation explains 0.8"}
                  for model in found["models"]]
        result["passivity"] = {"verdict": "passive", "decided_by": "model", "reason": "", "explained_percent": 99.0,
                               "band_hz": found["band_hz"], "models": models, "energy": found["energy"]}
        first = self.file("first.json", json.dumps(result))
        again = self.fine("passivity", first, "--json").json["passivity"]
        for key in ("verdict", "absorbed_J", "interval95", "statement"):
            self.assertEqual(again["trial"][key], found["trial"][key], key)
        self.assertEqual(again["prediction"], found["prediction"])
        self.assertEqual(again["band_hz"], found["band_hz"])
        # It wrote the excited band where there was no other, which is none to predict in.
        for model in models:
            model["band_rule"] = "the excited band"
        excited = self.fine("passivity", self.file("excited.json", json.dumps(result)), "--json").json["passivity"]
        self.assertIsNone(excited["band_hz"])
        self.assertEqual(excited["prediction"]["verdict"], "undecided")
        for command in (("ellipse", first), ("compare", first, first),
                        ("teleop", EXAMPLES / "position_position.toml", "--operator", first)):
            self.fine(*command)

    def test_what_is_not_usable_predicts_nothing(self):
        result = json.loads(self.stored().read_text())
        result["usable"] = False
        found = self.fine("passivity", self.file("bad.json", json.dumps(result)), "--json").json["passivity"]
        self.assertEqual(found["prediction"]["verdict"], "none")
        self.assertEqual(found["trial"]["verdict"], "passive")

    def test_without_a_stored_band_one_must_be_given(self):
        result = json.loads(self.stored().read_text())
        del result["passivity"]
        path = self.file("bare.json", json.dumps(result))
        self.refused(WRONG_USAGE, "passivity", path, says=[str(path), "--band LOW:HIGH"])
        found = self.fine("passivity", path, "--band", "0.5:2", "--json").json["passivity"]
        self.assertTrue(found["prediction"]["extrapolated"])
        self.assertEqual(found["prediction"]["verdict"], "undecided")  # nothing says in which band it holds


class Refusals(Case):
    def test_bands_that_are_none(self):
        for band in ("3", "3:1", "1:1", "a:b", "0:2", "-1:2", "nan:2", "1:nan", "1:inf", "1:2:3", "1:", ":2", "1 :2"):
            with self.subTest(band):
                self.refused(WRONG_USAGE, "passivity", make_log().path, f"--band={band}", says=["--band", f"'{band}'"])

    def test_files_that_are_no_recordings_and_no_results(self):
        self.bad_data(self.folder / "nothing.mat", command="passivity", says="no such file")
        self.bad_data(self.folder / "nothing.json", command="passivity", says="no such file")
        for name, content, says in (("other", '{"a": 1}', "mbk.result/2"), ("empty", "", "empty"),
                                    ("text", "K = 3 N/m", "byte 1")):
            with self.subTest(name):
                self.bad_data(self.file(f"{name}.json", content), command="passivity", says=says)
        self.refused(WRONG_USAGE, "passivity", says="FILE")

    def test_a_result_and_a_recording_together(self):
        log = copy(make_log().path, self.folder / "log.mat")
        result = self.folder / "result.json"
        self.fine("measure", log, "--json", "--quiet", "--out", result)
        for files, bad in (((result, log), log), ((log, result), result)):  # the first says which kind is meant
            ran = run("passivity", *files, "--quiet")
            self.assertEqual(ran.code, BAD_DATA, ran)
            self.assertIn(str(bad), ran.err)
            self.assertIn("what happened", ran.out)


if __name__ == "__main__":
    main()
