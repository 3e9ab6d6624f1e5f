#!/usr/bin/env python3
"""No sentence of any output contradicts another: every ready scenario, in the terminal, as JSON and in the report."""

import json
import re

from command import Case, main, run

# What must not be said of a person, whatever was measured.
PROMISES = ("beyond reasonable doubt", "made unstable by", "always stable", "counts on a passive limb",
            "by the energy:", "by the model:", "is the limb passive")
NO_GUARANTEE = "Neither statement guarantees that a robot coupled to this person is stable."
SAID = {"passive": "absorbed", "active": "delivered"}


def words_of(text):
    return " ".join(text.split())


def ready_scenarios():
    return re.findall(r"^  (\w+)  ", run("simulate", "--list").out, re.MULTILINE)


class Statements(Case):
    def recording(self, name):
        """Of its first trial, which alone is simulated."""
        trials = re.findall(r'^\[\[trial\]\]\nname = "(\w+)"', run("simulate", "--show", name).out, re.MULTILINE)
        only = ["--trial", trials[0]] if trials else []
        self.fine("simulate", name, *only, "--out", self.folder / f"{name}.mat", "--quiet")
        return sorted(self.folder.glob(f"{name}*.mat"))[0]

    def check_trial(self, trial):
        low, high = trial["interval95"]
        expected = "undecided" if low is None or low <= 0 <= high else "passive" if low > 0 else "active"
        self.assertEqual(trial["verdict"], expected)
        said = trial["statement"]
        if trial["verdict"] == "undecided":
            self.assertIn("without an interval" if low is None else "includes zero", said)
            return
        self.assertNotIn("includes zero", said)
        self.assertRegex(said, f"^in this trial the (hand|limb) {SAID[trial['verdict']]} ")
        self.assertLessEqual(low, trial["absorbed_J"])
        self.assertLessEqual(trial["absorbed_J"], high)

    def check_prediction(self, result):
        passivity = result["passivity"]
        prediction, models = passivity["prediction"], passivity.get("models", [])
        verdict, parts = prediction["verdict"], (prediction["symmetric"], prediction["antisymmetric"])
        said = prediction["statement"]
        if not result["usable"] or not models:
            self.assertEqual((verdict, *parts), ("none", "none", "none"))
            self.assertRegex(said, "^(there is no model|the model is not usable)$")
            self.assertNotIn("min_index", passivity)
            self.assertNotIn("eop", passivity)
            return
        if verdict == "none":
            return self.assertFalse(models[0]["usable"])
        if not models[0]["fits"] or passivity["band_hz"] is None:
            self.assertEqual(verdict, "undecided")
            self.assertRegex(said, "no reference was recorded|coherence of all axes|does not describe the limb well")
            self.assertNotRegex(said, "absorbs energy|generate energy")
        known = [part for part in parts if part != "none"]
        if verdict == "passive":
            self.assertEqual(set(known), {"passive"})
            self.assertIn("absorbs energy", said)
            self.assertNotIn("generate", said)
            self.assertGreater(passivity["min_index"], 0)
            for condition in models[0]["conditions"]:
                self.assertGreater(condition["lower"], 0)
        elif verdict == "active":
            self.assertIn("active", known)
            self.assertIn("can generate energy", said)
        else:
            self.assertNotIn("active", known)
            self.assertIn("undecided", known)

    def check(self, name):
        recording = self.recording(name)
        report = self.folder / f"{name}.html"
        measured = run("measure", recording, "--json", "--quiet", "--report", report)
        self.assertIn(measured.code, (0, 4), measured)
        result = measured.json
        self.assertEqual(result["schema"], "mbk.result/2")
        passivity = result["passivity"]
        for gone in ("verdict", "decided_by", "reason"):
            self.assertNotIn(gone, passivity)
        self.check_prediction(result)
        alone = run("passivity", recording, "--json", "--quiet").json
        self.assertEqual(alone["passivity"], passivity)
        page = json.loads(re.search(r'id="report-data"[^>]*>(.*?)</script>', report.read_text(), re.DOTALL).group(1)
                          .replace("\\u003c", "<"))
        self.assertEqual(page["result"]["passivity"], passivity)
        texts = {"measure": words_of(run("measure", recording, "--quiet").out),
                 "passivity": words_of(run("passivity", recording, "--quiet").out)}
        for command, text in texts.items():
            with self.subTest(command):
                prediction = passivity["prediction"]
                self.assertEqual(text.count(words_of(f"{prediction['verdict']}: {prediction['statement']}")), 1)
                self.assertEqual(text.count(NO_GUARANTEE), 1)
                for promise in PROMISES:
                    self.assertNotIn(promise, text.lower())
                if "trial" in passivity:
                    trial = passivity["trial"]
                    self.assertEqual(text.count(words_of(f"{trial['verdict']}: {trial['statement']}")), 1)
                    self.assertNotIn("no statement on the trial", text)
                else:
                    self.assertIn("no statement on the trial", text)
                if passivity["trial"]["verdict"] == "passive":
                    self.assertNotIn("delivered", text.split("passivity, what the model predicts")[0]
                                     .replace("it delivered energy at", ""))
        if "trial" in passivity:
            self.check_trial(passivity["trial"])
            self.assertEqual(passivity["energy"]["verdict"], passivity["trial"]["verdict"])
            for one in alone["recordings"]:
                self.assertEqual(one["account"]["verdict"], passivity["trial"]["verdict"])
        if name.startswith("relaxed"):
            self.assertEqual(passivity["trial"]["verdict"], "passive")
            self.assertNotEqual(passivity["prediction"]["verdict"], "active")

    def test_the_page_promises_nothing(self):
        recording = self.recording("relaxed_sinusoidal")
        report = self.folder / "page.html"
        run("measure", recording, "--quiet", "--report", report)
        page = report.read_text().lower()
        for promise in PROMISES[:4]:
            self.assertNotIn(promise, page)


def test_of(name):
    return lambda self: self.check(name)


for scenario in ready_scenarios():
    setattr(Statements, f"test_{scenario}", test_of(scenario))


if __name__ == "__main__":
    main()
