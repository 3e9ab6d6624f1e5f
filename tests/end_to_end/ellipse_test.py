#!/usr/bin/env python3
"""mbk identify and mbk ellipse: the two halves of mbk measure."""

import json
import math

from command import NOT_USABLE, Case, main, make_log, run


class Identify(Case):
    def test_it_is_measure_without_the_ellipses(self):
        log = make_log().path
        measured, identified = (self.fine(command, "--json", log).json for command in ("measure", "identify"))
        self.assertEqual({key for key in measured if key not in identified}, {"ellipses", "antisymmetry", "passivity"})
        self.assertEqual(identified, {key: measured[key] for key in identified})

    def test_the_text_has_the_model_and_no_ellipse(self):
        text = self.fine("identify", make_log().path).out
        self.assertIn("stiffness K", text)
        self.assertNotIn("ellipse", text)


class Ellipse(Case):
    def result(self, *logs, command="measure"):
        path = self.folder / "result.json"
        self.fine(command, "--json", "--quiet", *logs, "--out", path, "--overwrite")
        return path

    def test_it_gives_the_ellipses_of_measure(self):
        log = make_log().path
        measured = run("measure", "--json", log).json
        for command in ("measure", "identify"):
            alone = self.fine("ellipse", "--json", self.result(log, command=command)).json
            self.assertEqual(alone["schema"], "mbk.ellipse/1")
            self.assertEqual(alone["ellipses"], measured["ellipses"])
            self.assertEqual(alone["antisymmetry"], measured["antisymmetry"])

    def test_its_text_is_the_table_and_picture_of_measure(self):
        log = make_log().path
        alone = self.fine("ellipse", self.result(log)).out
        self.assertEqual(alone.splitlines()[0], str(log))
        self.assertIn("\n".join(alone.splitlines()[2:]), run("measure", log).out)

    def test_several_results_give_one_document(self):
        logs = [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2)]
        several = self.fine("ellipse", "--json", self.result(*logs)).json
        self.assertEqual(several["schema"], "mbk.ellipses/1")
        for one, log in zip(several["results"], logs):
            self.assertEqual(one["inputs"][0]["file"], str(log))
            self.assertEqual(one["ellipses"], run("measure", "--json", log).json["ellipses"])
        text = self.fine("ellipse", self.result(*logs)).out
        for log in logs:
            self.assertIn(f"{log}\n", text)

    def test_a_result_that_is_not_usable_shows_none(self):
        path = self.folder / "unusable.json"
        self.mbk("measure", "--json", "--handle-mass", 5, make_log().path, "--out", path, code=NOT_USABLE)
        ran = self.mbk("ellipse", path, code=NOT_USABLE)
        self.assertIn("NOT USABLE", ran.out)
        self.assertNotIn("stiffness", ran.out)
        self.assertIn("ellipses", self.mbk("ellipse", "--json", path, code=NOT_USABLE).json)

    def spatial(self, principal):
        """A stored result with three axes, whose stiffness has these principal values along turned axes."""
        c, s = math.cos(0.4), math.sin(0.4)
        axes = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
        stiffness = [[sum(value * axis[i] * axis[j] for value, axis in zip(principal, axes)) for j in range(3)]
                     for i in range(3)]
        one = [[2.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, 1.0]]
        error = [[0.01] * 3] * 3
        return self.file("spatial.json", json.dumps({
            "schema": "mbk.result/2", "model": {"M": one, "B": one, "K": stiffness, "x0": [0.0] * 3},
            "standard_error": {"M": error, "B": error, "K": error, "x0": [0.01] * 3}}))

    def test_three_axes_have_ellipsoids(self):
        path = self.spatial((400.0, 200.0, 100.0))
        found = self.fine("ellipse", "--json", path).json
        self.assertNotIn("ellipses", found)
        stiffness = found["ellipsoids"]["stiffness"]
        self.assertTrue(stiffness["closed"])
        self.assertAlmostEqual(stiffness["shape"], 4.0, places=9)
        for one, value in zip(stiffness["principal"], (400.0, 200.0, 100.0), strict=True):
            self.assertAlmostEqual(one["value"], value, places=9)
            self.assertLess(one["half_angle95_deg"], 1.0)
        self.assertAlmostEqual(stiffness["principal"][0]["direction"][0], math.cos(0.4), places=9)
        self.assertFalse(found["antisymmetry_vectors"]["stiffness"]["significant"])
        text = self.fine("ellipse", path).out
        self.assert_lines_fit(text)
        self.assertNotIn("not positive", text)

    def test_a_matrix_that_may_be_indefinite_has_no_ellipsoid(self):
        path = self.spatial((400.0, 200.0, -20.0))
        stiffness = self.fine("ellipse", "--json", path).json["ellipsoids"]["stiffness"]
        self.assertEqual((stiffness["closed"], stiffness["volume"], stiffness["shape"]), (False, None, None))
        self.assertIn("not positive beyond its interval", self.fine("ellipse", path).out)

    def test_one_axis_has_none(self):
        path = self.result(make_log("sinusoidal", "--one-axis").path)
        self.bad_data(path, command="ellipse", says="axis")

    def test_a_result_without_covariance_uses_its_standard_errors(self):
        result = json.loads(self.result(make_log().path).read_text())
        del result["covariance"]
        alone = self.fine("ellipse", "--json", self.file("short.json", json.dumps(result))).json
        self.assertAlmostEqual(alone["ellipses"]["inertia"]["area"], result["ellipses"]["inertia"]["area"], places=12)

    def test_what_is_no_result_is_refused(self):
        good = json.loads(self.result(make_log().path).read_text())
        wrong_shape = {**good, "model": {**good["model"], "K": [[1, 2, 3], [4, 5, 6]]}}
        wrong_kind = {**good, "model": {**good["model"], "K": [[1, 2], [3, "4"]]}}
        no_model = {key: value for key, value in good.items() if key != "model"}
        for name, content, says in (
                ("broken", json.dumps(good)[:400], "byte 401"),
                ("empty", "", ()),
                ("text", "M = 3 kg", "byte 1"),
                ("list", "[]", "mbk.result/2"),
                ("other schema", json.dumps({**good, "schema": "mbk.validation/2"}), "mbk.result/2"),
                ("later schema", json.dumps({**good, "schema": "mbk.result/3"}), "mbk.result/2"),
                ("number as schema", '{"schema": 3}', "mbk.result/2"),
                ("no model", json.dumps(no_model), "'model'"),
                ("wrong shape", json.dumps(wrong_shape), "'K'"),
                ("wrong kind", json.dumps(wrong_kind), "string"),
                ("no results", '{"schema": "mbk.results/1"}', "results"),
                ("empty results", '{"schema": "mbk.results/1", "results": []}', "results"),
                ("deep", "[" * 200_000, "byte")):
            with self.subTest(name):
                self.bad_data(self.file(f"{name}.json", content), command="ellipse", says=says)

    def test_a_recording_is_no_result(self):
        self.bad_data(make_log().path, command="ellipse", says="JSON")
        self.bad_data(self.folder / "nothing.json", command="ellipse")
        self.bad_data(self.folder, command="ellipse")


if __name__ == "__main__":
    main()
