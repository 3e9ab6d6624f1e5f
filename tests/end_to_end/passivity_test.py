#!/usr/bin/env python3
"""mbk passivity: the verdict on recordings and on stored results, and what it refuses."""

import json

from command import BAD_DATA, WRONG_USAGE, Case, copy, main, make_log, run, table_of, write_csv

VERDICTS = {  # of the thesis, seed 1: and whether the model or the energy says so; what the energy alone says
    "relaxed_sinusoidal": ("passive", "model", "passive"), "relaxed_underdamped": ("passive", "model", "passive"),
    "rigid_underdamped_2N": ("active", "energy", "active"), "rigid_underdamped_8N": ("passive", "model", "passive")}


class Recordings(Case):
    def test_the_ready_scenarios_have_their_verdicts(self):
        for name, (verdict, source, energy) in VERDICTS.items():
            with self.subTest(name):
                path = self.folder / f"{name}.mat"
                self.fine("simulate", name, "--out", path, "--quiet")
                text = run("passivity", path, "--quiet").out
                self.assertIn(f"\npassivity: {verdict}, by the {source}\n", text)
                self.assertIn(f"\n  energy: {energy}\n", text)
                self.assert_lines_fit(text)

    def test_least_squares_and_instruments_disagree_on_a_rigid_arm(self):
        path = self.folder / "rigid.mat"
        self.fine("simulate", "rigid_sinusoidal_6N", "--out", path, "--quiet")
        found = run("passivity", path, "--json", "--quiet").json["passivity"]
        self.assertEqual([model["method"] for model in found["models"]], ["iv", "ls"])
        self.assertNotEqual(found["models"][0]["verdict"], "active")
        inertia = [model["conditions"][0]["value"] for model in found["models"]]
        self.assertGreater(inertia[0], 0.3)
        self.assertLess(inertia[1], 0.1)
        self.assertEqual(found["energy"]["verdict"], "passive")

    def test_json_is_that_of_measure_and_has_the_energy_over_time(self):
        log = make_log().path
        alone = self.fine("passivity", log, "--json", "--quiet").json
        self.assertEqual(alone["schema"], "mbk.passivity/1")
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
        self.assertIn("from 0.7 to 1.9 Hz", text)

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

    def test_a_stored_model_is_judged_as_its_recording_was(self):
        fresh = self.fine("passivity", make_log().path, "--json", "--quiet").json["passivity"]
        stored = self.fine("passivity", self.stored(), "--json").json["passivity"]
        for key in ("verdict", "symmetric_part", "published_rule", "band_hz", "conditions", "min_index", "eop"):
            self.assertEqual(stored["models"][0][key], fresh["models"][0][key], key)
        self.assertEqual(stored["verdict"], fresh["verdict"])
        self.assertIsNone(stored.get("energy"))

    def test_without_a_stored_band_one_must_be_given(self):
        result = json.loads(self.stored().read_text())
        del result["passivity"]
        path = self.file("bare.json", json.dumps(result))
        self.refused(WRONG_USAGE, "passivity", path, says=[str(path), "--band LOW:HIGH"])
        self.assertIn("from 0.5 to 2 Hz", self.fine("passivity", path, "--band", "0.5:2").out)


class Refusals(Case):
    def test_bands_that_are_none(self):
        for band in ("3", "3:1", "1:1", "a:b", "0:2", "-1:2", "nan:2", "1:nan", "1:inf", "1:2:3", "1:", ":2", "1 :2"):
            with self.subTest(band):
                self.refused(WRONG_USAGE, "passivity", make_log().path, f"--band={band}", says=["--band", f"'{band}'"])

    def test_files_that_are_no_recordings_and_no_results(self):
        self.bad_data(self.folder / "nothing.mat", command="passivity", says="no such file")
        self.bad_data(self.folder / "nothing.json", command="passivity", says="no such file")
        for name, content, says in (("other", '{"a": 1}', "mbk.result/1"), ("empty", "", "empty"),
                                    ("text", "K = 3 N/m", "byte 1")):
            with self.subTest(name):
                self.bad_data(self.file(f"{name}.json", content), command="passivity", says=says)
        self.refused(WRONG_USAGE, "passivity", says="FILE")

    def test_a_result_and_a_recording_together(self):
        log = copy(make_log().path, self.folder / "log.mat")
        result = self.folder / "result.json"
        self.fine("measure", log, "--json", "--quiet", "--out", result)
        self.refused(BAD_DATA, "passivity", result, log, says=[str(log), "JSON"])
        self.refused(BAD_DATA, "passivity", log, result, says=str(result))


if __name__ == "__main__":
    main()
