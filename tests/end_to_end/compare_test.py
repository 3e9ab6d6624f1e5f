#!/usr/bin/env python3
"""mbk compare: how far two results or recordings are apart."""

import json
import math
import re

import schemas
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

    def test_three_axes_have_directions_in_space(self):
        def stored(name, stiffness):
            unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            error = [[0.01] * 3] * 3
            diagonal = [[value * one for one in row] for value, row in zip(stiffness, unit)]
            return self.file(name, json.dumps({
                "schema": "mbk.result/2", "model": {"M": unit, "B": unit, "K": diagonal, "x0": [0.0] * 3},
                "standard_error": {"M": error, "B": error, "K": error, "x0": [0.01] * 3}}))
        files = stored("a.json", (100.0, 100.0, 100.0)), stored("b.json", (100.0, 200.0, 700.0))
        stiffness = self.fine("compare", *files, "--json").json["width"]["stiffness"]
        self.assertAlmostEqual(stiffness["distance"], math.hypot(math.log(2.0), math.log(7.0)), places=9)
        self.assertEqual([len(one["direction"]) for one in stiffness["second_to_first"]], [3, 3, 3])
        for found, expected in zip(stiffness["second_to_first"][-1]["direction"], (0.0, 0.0, 1.0)):
            self.assertAlmostEqual(found, expected, places=9)
        self.assertNotIn("direction_deg", stiffness["second_to_first"][0])
        text = self.fine("compare", *files).out
        self.assertIn("0.00  0.00  1.00", text)
        self.assert_lines_fit(text)

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
        for word in MATRICES:
            self.assertIn(word, text)
        self.assertEqual(text.count(f"{make_log().path}\n"), 2)
        self.assert_lines_fit(text)

    def test_a_matrix_that_is_not_positive_definite_has_none(self):
        wrong = self.stored("wrong.json", K=[[10.0, 50.0], [50.0, 10.0]])
        ran = self.mbk("compare", self.stored(), wrong, code=NOT_USABLE)
        self.assertIn("-40", ran.out)
        found = self.mbk("compare", self.stored(), wrong, "--json", code=NOT_USABLE).json
        self.assertIsNone(found["width"]["stiffness"])
        self.assertIn("-40", found["refused"]["stiffness"])
        self.assertIsNotNone(found["width"]["inertia"])

    def test_a_result_that_is_not_usable_shows_no_width(self):
        ran = self.mbk("compare", self.stored(), self.stored("wrong.json", usable=False), code=NOT_USABLE)
        self.assertIn("second result is not usable", ran.out)
        self.assertNotIn("stiffness", ran.out)

    def test_what_cannot_be_compared_is_refused(self):
        one = self.folder / "one.json"
        self.fine("measure", make_log("sinusoidal", "--one-axis").path, "--json", "--quiet", "--out", one)
        self.refused(3, "compare", self.stored(), one, says="axis")
        self.refused(WRONG_USAGE, "compare", says="FILE")
        self.refused(WRONG_USAGE, "compare", self.stored(), says="result")
        self.refused(3, "compare", self.stored(), self.stored("b.json"), one, says=["axis", "one.json"])
        self.bad_data(self.folder / "nothing.json", self.stored(), command="compare")
        (self.folder / "empty").mkdir()
        self.refused(3, "compare", self.folder / "empty",
                     says=[str(self.folder / "empty"), "mbk measure FILE --json --out"])

    def test_of_more_than_two_each_is_compared_with_the_first(self):
        first, second, third = self.stored(), self.stored("b.json", K=[[200.0, 0.0], [0.0, 200.0]]), self.stored("c.json")
        found = self.fine("compare", first, second, third, "--json").json
        self.assertEqual(found["schema"], "mbk.comparisons/1")
        pairs = [self.fine("compare", first, other, "--json").json["width"] for other in (second, third)]
        self.assertEqual([one["width"] for one in found["results"]], pairs)
        several = self.folder / "several.json"
        self.fine("measure", make_log().path, make_log().path, "--json", "--quiet", "--out", several)
        self.assertEqual(len(self.fine("compare", several, first, "--json").json["results"]), 2)
        text = self.fine("compare", first, second, third).out
        for name in ("b.json", "c.json"):
            self.assertIn(f"{self.folder / name}\n", text)

    def report(self, name):
        """The document in a page, which fits its schema."""
        page = (self.folder / name).read_text(encoding="utf-8")
        document = json.loads(re.search(r'id="report-data">(.*?)</script>', page, re.S).group(1))
        schemas.check(document)
        return document

    def test_a_page_holds_the_results_and_how_far_they_are_apart(self):
        first, second = self.stored(), self.stored("rigid.json", K=[[600.0, 0.0], [0.0, 900.0]])
        ran = self.fine("compare", first, second, "--json", "--report", self.folder / "page.html", "--report-note", "May")
        document = self.report("page.html")
        self.assertEqual(document["names"], [str(first), str(second)])
        self.assertEqual([one["width"] for one in document["comparisons"]], [ran.json["width"]])
        self.assertEqual(document["note"], "May")
        for stored, shown in zip((first, second), document["result"]["results"], strict=True):
            written = json.loads(stored.read_text(encoding="utf-8"))
            for field in ("model", "standard_error", "fit", "covariance", "usable", "units"):
                self.assertEqual(shown[field], written[field], field)
        self.refused(WRONG_USAGE, "compare", first, second, "--report", self.folder / "page.html", says="--overwrite")

    def test_a_folder_is_every_result_in_it_and_says_what_it_leaves_out(self):
        folder = self.folder / "results"
        folder.mkdir()
        for name in ("a.json", "b.json", "c.json"):
            (folder / name).write_bytes(self.stored().read_bytes())
        (folder / "notes.json").write_text('{"schema": "mine/1"}', encoding="utf-8")
        (folder / "readme.txt").write_text("no result", encoding="utf-8")
        ran = self.mbk("compare", folder, "--report", self.folder / "all.html", code=0)
        self.assertIn("notes.json", ran.err)
        self.assertNotIn("readme", ran.err)
        document = self.report("all.html")
        self.assertEqual(document["names"], [str(folder / name) for name in ("a.json", "b.json", "c.json")])
        self.assertIn("notes.json", document["result"]["failed"][0]["file"])
        self.assertEqual(len(document["comparisons"]), 2)

    def test_recordings_bring_who_was_measured_into_the_page(self):
        logs = [make_log("sinusoidal", "--seed", str(seed)).path for seed in (1, 2)]
        self.fine("compare", *logs, "--report", self.folder / "logs.html")
        document = self.report("logs.html")
        self.assertEqual([len(one["recordings"]) for one in document["trials"]], [1, 1])
        self.assertIn("passivity", document["result"]["results"][0])


if __name__ == "__main__":
    main()
