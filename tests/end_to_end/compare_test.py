#!/usr/bin/env python3
"""mbk compare: how far two results or recordings are apart."""

import json
import math

from command import NOT_USABLE, WRONG_USAGE, Case, main, make_log, run

MATRICES = ("inertia", "damping", "stiffness")


class Width(Case):
    def stored(self, name="result.json", usable=True, **changed):
        """A stored result, with some of its matrices changed."""
        path = self.folder / name
        result = json.loads(run("measure", "--json", "--quiet", make_log().path).out)
        result["model"] |= changed
        result["usable"] = usable
        path.write_text(json.dumps(result), encoding="utf-8")
        return path

    def matrix(self, name):
        return json.loads(run("measure", "--json", "--quiet", make_log().path).out)["model"][name]

    def test_sevenfold_stiffness_is_its_closed_form(self):
        stiffer = [[7.0 * k for k in row] for row in self.matrix("K")]
        found = self.fine("compare", self.stored(), self.stored("rigid.json", K=stiffer), "--json").json
        self.assertEqual(found["schema"], "mbk.compare/1")
        stiffness = found["width"]["stiffness"]
        self.assertAlmostEqual(stiffness["distance"], math.sqrt(2.0) * math.log(7.0), places=9)
        self.assertTrue(stiffness["distinguishable"])
        low, high = stiffness["interval95"]
        self.assertTrue(0.0 < low < stiffness["distance"] < high)
        for one in stiffness["second_to_first"]:
            self.assertAlmostEqual(one["ratio"], 7.0, places=9)
        self.assertAlmostEqual(found["width"]["inertia"]["distance"], 0.0, places=9)
        self.assertFalse(found["width"]["inertia"]["distinguishable"])
        self.assertEqual(found["refused"], {})

    def test_results_recordings_and_one_of_each_give_the_same(self):
        logs = [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2)]
        paths = []
        for k, log in enumerate(logs):
            paths.append(self.folder / f"{k}.json")
            self.fine("measure", log, "--json", "--quiet", "--out", paths[-1])
        by_recordings = self.fine("compare", *logs, "--json").json["width"]
        self.assertEqual(self.fine("compare", *paths, "--json").json["width"], by_recordings)
        self.assertEqual(self.fine("compare", paths[0], logs[1], "--json").json["width"], by_recordings)
        back = self.fine("compare", *reversed(paths), "--json").json["width"]
        for name in MATRICES:
            self.assertAlmostEqual(back[name]["distance"], by_recordings[name]["distance"], places=9)

    def test_the_text_has_each_matrix_and_both_files(self):
        text = self.fine("compare", self.stored(), self.stored("other.json")).out
        for word in (*MATRICES, "by least squares", f"first   {make_log().path}\n", f"second  {make_log().path}\n", "not distinct"):
            self.assertIn(word, text)
        self.assert_lines_fit(text)

    def test_a_matrix_that_is_not_positive_definite_has_none(self):
        wrong = self.stored("wrong.json", K=[[10.0, 50.0], [50.0, 10.0]])
        ran = self.mbk("compare", self.stored(), wrong, code=NOT_USABLE)
        self.assertIn("stiffness has no width: the second matrix is not positive definite", " ".join(ran.out.split()))
        found = self.mbk("compare", self.stored(), wrong, "--json", code=NOT_USABLE).json
        self.assertIsNone(found["width"]["stiffness"])
        self.assertIn("eigenvalue is -40", found["refused"]["stiffness"])
        self.assertIsNotNone(found["width"]["inertia"])

    def test_a_result_that_is_not_usable_shows_no_width(self):
        ran = self.mbk("compare", self.stored(), self.stored("wrong.json", usable=False), code=NOT_USABLE)
        self.assertIn("second result is not usable", ran.out)
        self.assertNotIn("stiffness", ran.out)

    def test_what_cannot_be_compared_is_refused(self):
        one = self.folder / "one.json"
        self.fine("measure", make_log("sinusoidal", "--one-axis").path, "--json", "--quiet", "--out", one)
        self.refused(3, "compare", self.stored(), one, says="axis")
        self.refused(WRONG_USAGE, "compare", self.stored(), says="FILE")
        self.refused(WRONG_USAGE, "compare", self.stored(), self.stored("b.json"), self.stored("c.json"))
        self.bad_data(self.folder / "nothing.json", self.stored(), command="compare", says="no such file")
        several = self.folder / "several.json"
        self.fine("measure", make_log().path, make_log().path, "--json", "--quiet", "--out", several)
        self.bad_data(several, self.stored(), command="compare", says="2 results")


if __name__ == "__main__":
    main()
