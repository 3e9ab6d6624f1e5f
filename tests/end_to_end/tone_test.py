#!/usr/bin/env python3
"""Muscle tone and reflexes: EMG after perturbations, and stretches at constant velocity, from scenario to study."""

import json
import math
import os
import pathlib
import random
import shutil
import unittest

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main, run

ELBOW = ("--axes", 1, "--channels", "x=angle_deg:deg,F=-torque_Nm:N.m")


class Tone(Case):
    scenarios = {}

    def recorded(self, scenario, seed=1):
        name = f"{scenario}_{seed}.h5"
        if name not in self.scenarios:
            self.scenarios[name] = self.folder.parent / name
            self.fine("simulate", scenario, "--seed", seed, "--out", self.scenarios[name], "--quiet", "--overwrite")
        return self.scenarios[name]

    def test_muscles_respond_after_their_latency_and_only_if_stretched(self):
        emg = self.fine("explore", self.recorded("elbow_perturbed"), "--only", "emg", "--json").json["emg"]
        self.assertEqual([channel["name"] for channel in emg["channels"]], ["emg_biceps", "emg_triceps"])
        for channel, stretched in zip(emg["channels"], (0, 1)):
            one, other = channel["directions"][stretched], channel["directions"][1 - stretched]
            low, high = one["latency"]["interval95"]
            self.assertLess(abs(one["latency"]["value_s"] - 0.025), 0.003, channel["name"])
            self.assertLess(low, high)
            self.assertTrue(all(window["response"] == "increase" for window in one["windows"]))
            self.assertIsNone(other.get("latency"))
            self.assertTrue(all(window["response"] == "none" for window in other["windows"]))

    def test_stiffness_follows_the_co_contraction_of_two_muscles(self):
        random.seed(6)
        table = self.folder / "holding.csv"
        lines, level, states = ["time_s,angle_rad,torque_Nm,emg_biceps (mV),emg_triceps (mV)"], 0.0, [0.0] * 4
        for k in range(40 * 1000):
            if k % 60 == 0:
                level = random.choice((-1, 1)) * 0.1
            states = [state + 0.03 * ((states[j - 1] if j else level) - state) for j, state in enumerate(states)]
            angle = states[3]
            activity = 0.5 - 0.4 * math.cos(2 * math.pi * k / 20000)
            torque = -(10 + 40 * activity) * angle + random.gauss(0, 0.02)
            lines.append(f"{k / 1000:.3f},{angle:.7f},{torque:.5f},{random.gauss(0, 0.2 * activity):.5f},"
                         f"{random.gauss(0, 0.3 * activity):.5f}")
        table.write_text("\n".join(lines) + "\n")
        asked = ("explore", table, "--axes", 1, "--channels", "x=angle_rad,F=torque_Nm", "--only", "time-course", "--json")
        course = self.fine(*asked, "--schedule", "co-contraction", "--muscles", "biceps,triceps").json["time_course"]
        self.assertEqual(course["verdict"], "changes")
        self.assertEqual((course["variable"], course["unit"]), ("co-contraction of emg_biceps and emg_triceps", "mean"))
        for at, stiffness in zip(course["at"], course["K"]["value"][0]):
            if 0.4 < at < 1.6:  # at the ends the noise of the envelopes counts
                self.assertLess(abs(stiffness - (10 + 40 * 0.5 * at)), 2.5, at)
        one = self.fine(*asked, "--schedule", "emg_biceps").json["time_course"]
        self.assertEqual(one["variable"], "emg_biceps")
        for muscles in ((), ("--muscles", "biceps"), ("--muscles", "biceps,triceps", "--mvc", "biceps=0.001")):
            self.refused(WRONG_USAGE, *asked, "--schedule", "co-contraction", *muscles)
        self.refused(BAD_DATA, *asked, "--schedule", "co-contraction", "--muscles", "biceps,deltoid")

    def test_emg_needs_no_force_and_is_read_from_any_table(self):
        random.seed(4)
        table = self.folder / "emg.csv"
        onsets = [1 + 1.1 * k for k in range(12)]
        lines = ["time_s,angle_deg,EMG biceps (mV),Triceps EMG (uV)"]
        for k in range(15 * 2000):
            time, angle, burst = k / 2000, 0.0, 1
            for onset in onsets:
                since = time - onset
                angle += 3 * min(1, max(0, since / 0.03)) - 3 * min(1, max(0, (since - 0.5) / 0.03))
                burst = 3 if 0.04 <= since < 0.09 else burst
            lines.append(f"{time:.4f},{90 + angle + random.gauss(0, 1e-3):.4f},{random.gauss(0, 0.02 * burst):.5f},"
                         f"{random.gauss(0, 20):.3f}")
        table.write_text("\n".join(lines) + "\n")
        emg = self.fine("explore", table, "--only", "emg", "--axes", 1, "--channels", "x=angle_deg:deg", "--json").json["emg"]
        self.assertEqual(emg["onset_rule"], "motion")
        biceps, triceps = emg["channels"]
        self.assertLess(abs(biceps["directions"][0]["latency"]["value_s"] - 0.04), 0.003)
        for channel in emg["channels"]:
            self.assertLess(abs(channel["background"] / (0.8 * 20e-6 * math.sqrt(0.43)) - 1), 0.1)  # E|x| = 0.8 σ; 430 of 1000 Hz
        self.assertIsNone(triceps["directions"][0].get("latency"))
        self.assertEqual([channel["unit"] for channel in emg["channels"]], ["V", "V"])
        bare = self.folder / "bare.csv"
        bare.write_text(table.read_text().replace("EMG biceps (mV)", "EMG biceps"))
        told = self.fine("explore", bare, "--only", "emg", "--axes", 1, "--channels", "x=angle_deg:deg").out
        self.assertRegex(told, r"emg_biceps: background 0\.010\d* \(the recording states no unit\)")
        info = self.fine("info", table, "--axes", 1, "--channels", "x=angle_deg:deg")
        self.assertIn("emg_biceps", info.out)
        measured = run("identify", self.recorded("elbow_perturbed"))
        self.assertIn("EMG was found but not read: emg_biceps, emg_triceps", " ".join(measured.out.split()), measured)

    def test_recordings_without_emg_or_onsets_are_refused(self):
        still = self.folder / "still.csv"
        still.write_text("time,position_rad,emg_1_mV\n" + "".join(
            f"{k / 1000},{1e-4 * math.sin(k / 300)},{math.sin(k * k)}\n" for k in range(4000)))
        self.refused(BAD_DATA, "explore", still, "--only", "emg")
        self.fine("simulate", "ankle_reflex", "--out", self.folder / "ankle.h5", "--quiet")
        self.refused(BAD_DATA, "explore", self.folder / "ankle.h5", "--only", "emg")
        self.refused(WRONG_USAGE, "explore", still, "--only", "emg", "--emg-band", "450,20")
        self.refused(WRONG_USAGE, "explore", still, "--only", "emg", "--emg-band", "20")
        self.refused(WRONG_USAGE, "explore", still, "--only", "emg", "--mvc", "biceps")

    def test_a_healthy_elbow_is_not_velocity_dependent(self):
        found = self.fine("explore", self.recorded("elbow_healthy"), "--protocol", "stretch", "--json").json["stretch"]
        self.assertNotEqual(found["directions"][0]["verdict"], "velocity-dependent")
        self.assertTrue(all(speed["catch"] != "found" for speed in found["directions"][0]["speeds"]))
        low, high = found["directions"][0]["slope"]["interval95"]
        self.assertTrue(low < 0.1 < high)  # N·m·s/rad, the viscosity of the scenario

    @unittest.skipUnless(os.environ.get("MBK_DATA_DIR"), "MBK_DATA_DIR is not set")
    def test_a_real_healthy_elbow_is_not_called_spastic(self):
        folder = pathlib.Path(os.environ["MBK_DATA_DIR"]) / "elbow"
        files = [folder / f"v{speed}.csv" for speed in range(10, 100, 10)]
        found = self.fine("explore", *files, *ELBOW, "--only", "stretch", "--json").json["stretch"]["directions"][0]
        self.assertEqual(found["verdict"], "not-shown")
        self.assertEqual(len(found["speeds"]), 9)
        self.assertTrue(all(speed["catch"] == "cannot-be-judged" for speed in found["speeds"][1:]))
        ran = run("explore", *files, "--axes", 1, "--channels", "x=angle_deg:deg,F=torque_Nm:N.m", "--only", "stretch")
        self.assertEqual(ran.code, NOT_USABLE, ran)
        self.assertIn("force-sign-reversed", ran.out)

    def test_a_report_shows_both(self):
        for scenario, part, words in (("elbow_perturbed", "emg", "EMG after perturbations"),
                                      ("elbow_spastic", "stretch", "Stretches at constant velocity")):
            page = self.folder / f"{part}.html"
            self.fine("explore", self.recorded(scenario), "--only", part, "--report", page, "--quiet")
            self.assertIn(words, page.read_text(encoding="utf-8"))

    def test_a_study_holds_stretches_as_outcomes(self):
        study = self.folder / "study"
        self.fine("study", "init", study)
        for person in (1, 2):
            for session in (1, 2):
                self.fine("study", "add", self.recorded("elbow_healthy", 10 * person + session), "--study", study,
                          "--participant", person, "--session", session, "--condition", "rest")
        self.fine("study", "measure", "--study", study, "--explore", "stretch", "--quiet")
        self.fine("study", "defaults", "--study", study, "--explore", "stretch")
        summary = self.fine("study", "summary", "--study", study, "--json").json
        outcomes = {row["outcome"]: row for row in summary["outcomes"]}
        self.assertIn("stretch_increasing_slope", outcomes)
        self.assertLess(abs(outcomes["stretch_increasing_slope"]["mean"] - 0.1), 0.03)

    def test_a_participant_is_shown_beside_the_controls_and_left_beside_right(self):
        study = self.folder / "sides"
        self.fine("study", "init", study)
        self.fine("study", "defaults", "--study", study, "--explore", "stretch")
        short = {}
        for scenario in ("elbow_healthy", "elbow_spastic"):
            text = self.fine("simulate", "--show", scenario).out
            text = text.replace("[10, 30, 60, 90, 150, 210]", "[10, 60, 180]").replace("repetitions = 5", "repetitions = 2")
            short[scenario] = text.replace("rate_hz = 2000", "rate_hz = 1000")
        for person in range(1, 8):
            for side in ("left", "right"):
                scenario = "elbow_spastic" if person == 1 and side == "left" else "elbow_healthy"
                text = short[scenario].replace("viscosity_Nms_per_rad = 0.1", f"viscosity_Nms_per_rad = {0.08 + 0.005 * person}")
                (self.folder / "elbow.toml").write_text(text)
                recording = self.folder / f"{person}_{side}.h5"
                self.fine("simulate", self.folder / "elbow.toml", "--seed", 10 * person + (side == "left"), "--out", recording,
                          "--quiet")
                self.fine("study", "add", recording, "--study", study, "--participant", person, "--condition", side, "--quiet")
        # The same limb, once over other positions (8) and once with a slower fastest speed (9).
        full = short["elbow_healthy"]
        for person, other in ((8, full.replace("amplitude_deg = 70", "amplitude_deg = 40")),
                              (9, full.replace("[10, 60, 180]", "[10, 60, 120]"))):
            for session, side, text in ((1, "left", full), (2, "left", other), (2, "right", full)):
                (self.folder / "elbow.toml").write_text(text)
                recording = self.folder / f"{person}_{session}_{side}.h5"
                self.fine("simulate", self.folder / "elbow.toml", "--seed", 10 * person + session, "--out", recording, "--quiet")
                self.fine("study", "add", recording, "--study", study, "--participant", person, "--session", session,
                          "--condition", side, "--quiet")
        self.fine("study", "measure", "--study", study, "--quiet")

        def report(name, *arguments):
            out = self.folder / name
            self.fine("study", "report", "--study", study, "--out", out, "--quiet", "--json", *arguments)
            return json.loads(out.read_text(encoding="utf-8"))

        found = report("one.json", "--participant", 1, "--group", "controls=2-7")
        self.assertEqual(found["controls"], {"name": "controls", "participants": 6, "is_one": False})
        curves = {one["condition"]: one for one in found["stretches"]}
        fast = {side: one["speeds"][-1] for side, one in curves.items()}
        self.assertEqual([curve["controls"] for curve in fast.values()], [6, 6])
        self.assertGreater(fast["left"]["above"], 0.9)
        self.assertLess(fast["right"]["above"] + fast["right"]["below"], 0.5)
        for low, mean, high in zip(fast["left"]["low95"], fast["left"]["mean"], fast["left"]["high95"]):
            self.assertTrue(mean is None or low is None or low < mean < high)
        slope = {one["condition"]: one for one in found["ranges"] if one["outcome"] == "stretch_increasing_slope"}
        self.assertEqual((slope["left"]["verdict"], slope["right"]["verdict"]), ("above", "inside"))
        side = next(one for one in found["sides"] if one["outcome"] == "stretch_increasing_slope")
        self.assertEqual((side["error_basis"], side["verdict"], side["range_verdict"]), ("recordings", "unknown", "above"))
        self.assertEqual({one["participant"] for one in found["recordings"]}, {1})

        def one_of(rows, outcome, **facts):
            return next(row for row in rows if row["outcome"] == f"stretch_increasing_{outcome}" and
                        all(row[name] == value for name, value in facts.items()))

        # As controls they do not count where the outcome depends on what differs.
        wider = report("wider.json", "--participant", 1, "--group", "controls=2-9")
        for outcome, controls in (("torque", 6), ("slope", 7)):
            normal = one_of(wider["ranges"], outcome, condition="left")["normal"]
            self.assertEqual((normal["controls"], normal["not_comparable"]), (controls, 8 - controls), outcome)
            normal = one_of(wider["sides"], outcome)["normal"]
            self.assertEqual((normal["controls"], normal["not_comparable"]), (controls, 8 - controls), outcome)
        for person, outcomes in ((8, ("torque", "slope")), (9, ("torque",))):
            page = report(f"{person}.json", "--participant", person, "--group", "controls=2-7")
            for outcome in outcomes:
                row = one_of(page["ranges"], outcome, condition="left")
                self.assertEqual((row["verdict"], row["normal"]["controls"], row["normal"]["not_comparable"]), ("unknown", 0, 6))
                self.assertTrue(row["why_not_comparable"])
                row = one_of(page["sides"], outcome)
                self.assertEqual((row["verdict"], row["range_verdict"], row["error95"]), ("unknown", "unknown", None))
                self.assertIn("left ", row["why_not_comparable"])
                change = one_of(page["courses"], outcome, condition="left")["participants"][0]["changes"][0]
                self.assertEqual(change["verdict"], "unknown")
                self.assertIn("before ", change["why_not_comparable"])
            self.assertNotIn("why_not_comparable", one_of(page["ranges"], "torque", condition="right"))
        self.assertNotIn("why_not_comparable", one_of(page["sides"], "slope"))  # of person 9

        few = report("few.json", "--participant", 1, "--group", "controls=2-5")
        self.assertEqual({one["verdict"] for one in few["ranges"]}, {"unknown"})
        self.assertTrue(all(value is None for one in few["stretches"] for curve in one["speeds"] for value in curve["low95"]))
        own = report("own.json", "--participant", 2, "--group", "controls=2-7")
        self.assertEqual(own["controls"], {"name": "controls", "participants": 5, "is_one": True})
        alone = report("alone.json", "--participant", 1)
        self.assertNotIn("controls", alone)
        self.assertEqual((alone["ranges"], len(alone["stretches"])), ([], 2))
        for groups in (("a=1",), ("a=2", "b=3"), ("a",)):
            arguments = [word for group in groups for word in ("--group", group)]
            self.refused(WRONG_USAGE, "study", "report", "--study", study, "--participant", 1, "--out",
                         self.folder / "none.html", *arguments)


if __name__ == "__main__":
    main()
