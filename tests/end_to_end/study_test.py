#!/usr/bin/env python3
"""mbk study: many people and trials in one folder, through the command alone.

MBK_STUDY_KILLS says how many times a command is killed in mid-work (20).
"""

import collections
import contextlib
import csv
import fcntl
import hashlib
import io
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import time

import command
import schemas
from c3d_test import limb, texts, write_c3d
from kinarm_test import write_exam
from command import BAD_DATA, FINE, WRONG_USAGE, run

KILLS = int(os.environ.get("MBK_STUDY_KILLS", "20"))


def short_trial(folder, seed, name=None, **metadata):
    """A recording of 12 s of a simulated participant, with these metadata beside its own, as CSV."""
    name = name or f"trial_{seed}.csv"
    whole = folder / f".{name}"
    made = run("simulate", "relaxed_sinusoidal", "--seed", seed, "--quiet", "--out", whole.with_suffix(".csv"))
    assert made.code == FINE, made
    lines = whole.with_suffix(".csv").read_text(encoding="utf-8").splitlines(keepends=True)
    comments = [line for line in lines if line.startswith("#")]
    rows = [line for line in lines if not line.startswith("#")]
    comments += [f"# {key}: {value}\n" for key, value in metadata.items()]
    (folder / name).write_text("".join(comments + rows[:12001]), encoding="utf-8")
    whole.with_suffix(".csv").unlink()
    return folder / name


class StudyCase(command.Case):
    trials = None

    @classmethod
    def setUpClass(cls):
        if StudyCase.trials is None:
            folder = command.folder_of_logs()
            StudyCase.trials = [short_trial(folder, seed) for seed in range(1, 5)]

    def setUp(self):
        super().setUp()
        self.study = self.folder / "study"
        self.mbk("study", "init", self.study, "--title", "A study")

    def do(self, name, *arguments, code=FINE, **options):
        return self.mbk("study", name, *arguments, "--study", self.study, code=code, **options)

    def assert_nothing_measured(self, *options):
        """Everything was measured with these options before: no count but 0 is printed."""
        self.assertNotRegex(self.do("measure", *options).out, "[1-9]", options)

    def listed(self):
        return self.do("list", "--json").json

    def checked(self, *options, code=FINE):
        return self.do("check", "--json", *options, code=code).json


class AStudy(StudyCase):
    def test_goes_from_recordings_to_a_summary(self):
        for participant, trial in zip((7, 7, 8), self.trials):
            self.do("add", trial, "--participant", participant, "--session", 2, "--condition", "relaxed")
        self.assertEqual([r["trial"] for r in self.listed()["recordings"]], [1, 2, 1])
        ran = self.do("measure")
        self.assertIn("3 usable", ran.out)
        self.assert_nothing_measured()
        summary = self.do("summary", "--json").json
        self.assertEqual(summary["counts"]["usable"], 3)
        outcome = {one["outcome"]: one for one in summary["outcomes"]}
        each = [run("measure", trial, "--json").json["model"]["K"][0][0] for trial in self.trials[:3]]
        self.assertAlmostEqual(outcome["K_xx"]["mean"], ((each[0] + each[1]) / 2 + each[2]) / 2, places=9)
        self.assertEqual((outcome["K_xx"]["participants"], outcome["K_xx"]["results"]), (2, 3))
        self.assertEqual((outcome["K_xx"]["minimum"], outcome["K_xx"]["maximum"]), (min(each), max(each)))
        text = self.do("summary").out
        self.assertRegex(text, r"\b3 recordings\b.*\b2 participants\b.*\b3 usable\b")
        self.assert_lines_fit(text)
        check = self.checked()
        self.assertEqual((check["repeated"], check["problems"], check["notes"]), (3, [], []))

    def test_result_is_that_of_measure(self):
        self.do("add", self.trials[0], "--participant", 1)
        self.do("measure", "--quiet")
        stored = self.do("show", 1, "--result").json
        measured = run("measure", self.trials[0], "--json").json
        self.assertRegex(stored["inputs"][0].pop("file"), r"^recordings/[0-9a-f]{2}/[0-9a-f]{64}\.csv$")
        measured["inputs"][0].pop("file")
        self.assertEqual(stored, measured)
        out = self.folder / "result.json"
        self.do("show", 1, "--result", "--out", out)
        self.mbk("ellipse", out)

    def test_is_found_from_within_its_folder(self):
        inner = self.study / "recordings"
        self.assertIn("0 recordings", self.mbk("study", "list", folder=inner).out)
        self.refused(WRONG_USAGE, "study", "list", folder=self.folder, says="study")

    def test_measures_only_what_is_new_or_changed(self):
        self.do("add", self.trials[0], "--participant", 1)
        self.do("measure")
        self.do("add", self.trials[1], "--participant", 2)
        self.assertRegex(self.do("measure").out, r"\b1\b")
        self.assertRegex(self.do("measure", "--cutoff", "4").out, r"\b2\b")
        self.assert_nothing_measured("--cutoff", "4")
        self.do("defaults", "--cutoff", "4")
        self.assert_nothing_measured()  # the default is what was measured already
        listed = self.listed()
        self.assertEqual([one["options"] for one in listed["analyses"]], [{}, {"--cutoff": ["4"]}])
        first, second = (self.do("summary", "--json", "--analysis", n).json["outcomes"][0]["mean"] for n in (1, 2))
        self.assertNotEqual(first, second)

    def test_a_default_that_is_typed_makes_no_other_analysis(self):
        self.do("add", self.trials[0], "--participant", 1)
        self.do("measure")
        for typed in (["--mode", "default"], ["--padding", "15", "--protocol", "auto"], ["--hac-lag=1", "--seed", "1"],
                      ["--bootstrap", "0", "--domain", "hand", "--force-delay-ms", "0"]):
            self.assert_nothing_measured(*typed)
        chapter3, chapter5 = (["--mode", "reference", "--procedure", one] for one in ("chapter3", "chapter5"))
        self.do("measure", *chapter3, code=BAD_DATA)  # the trial is too short for it, which is a result
        self.assert_nothing_measured("--mode", "reference")
        self.assertRegex(self.do("measure", *chapter5, code=BAD_DATA).out, r"\b1\b")
        self.do("defaults", "--mode", "reference")
        self.assert_nothing_measured("--mode", "default")  # it takes the place of another default
        self.assertEqual([one["options"] for one in self.listed()["analyses"]],
                         [{}, {"--mode": ["reference"]}, {"--mode": ["reference"], "--procedure": ["chapter5"]}])

    def test_results_of_before_are_found_under_a_key_that_says_defaults(self):
        self.do("add", self.trials[0], "--participant", 1)
        self.do("measure", "--cutoff", "4")
        key = '{"--cutoff":["4"],"--mode":["default"]}'  # as it was stored once
        with contextlib.closing(sqlite3.connect(self.study / "study.sqlite")) as database, database:
            database.execute("UPDATE analysis SET options = ?, options_sha256 = ?",
                             (key, hashlib.sha256(key.encode()).hexdigest()))
        self.do("add", self.trials[1], "--participant", 2)
        self.assertRegex(self.do("measure", "--cutoff", "4").out, r"\b1\b")
        self.assert_nothing_measured("--cutoff", "4", "--mode", "default")
        self.assertEqual([one["options"] for one in self.listed()["analyses"]], [{"--cutoff": ["4"], "--mode": ["default"]}])
        self.assertEqual(self.do("summary", "--json").json["counts"]["usable"], 2)

    def test_same_study_for_any_number_of_threads_and_any_order(self):
        exports = []
        for threads, trials in ((1, self.trials), (3, self.trials[::-1])):
            study = self.folder / f"of_{threads}"
            self.mbk("study", "init", study)
            for trial in trials:
                self.mbk("study", "add", trial, "--study", study, "--participant", self.trials.index(trial) + 1)
            self.mbk("study", "measure", "--study", study, "--threads", threads)
            with sqlite3.connect(study / "study.sqlite") as database:
                exports.append(database.execute("SELECT sha256, text FROM document JOIN result ON result = result.number "
                                                "JOIN recording ON recording = recording.number ORDER BY sha256").fetchall())
        self.assertEqual(len(exports[0]), 4)
        self.assertEqual(exports[0], exports[1])

    def test_unusable_results_are_kept_and_do_not_count(self):
        self.do("add", *self.trials[:2], "--participant", 1)
        ran = self.do("measure", "--channels", "x=hand_x_m,y=hand_y_m,Fx=-force_x_N,Fy=-force_y_N", code=command.NOT_USABLE)
        self.assertIn("0 usable, 2 not usable", ran.out)
        listed = self.listed()["recordings"]
        lines = ran.out.splitlines()[1:]
        self.assertEqual(len(lines), 2)
        for line, one in zip(lines, listed):
            self.assertIn(f"recording {one['number']}: participant 1", line)
            self.assertTrue(line.endswith(": " + one["reason"].split(",")[0]), line)
        self.assertEqual({one["state"] for one in listed}, {"not-usable"})
        self.assertTrue(all(one["reason"] for one in listed))
        summary = self.do("summary", "--json").json
        self.assertEqual((summary["counts"]["not_usable"], summary["outcomes"]), (2, []))

    def test_exclusion_has_a_reason_and_can_be_taken_back(self):
        self.do("add", *self.trials[:2], "--participant", 1)
        self.do("measure")
        self.refused(WRONG_USAGE, "study", "exclude", 1, "--study", self.study)
        self.do("exclude", 1, "--why", "hand slipped")
        self.assertIn("hand slipped", self.do("list").out)
        self.assertEqual(self.do("summary", "--json").json["counts"]["excluded"], 1)
        self.do("exclude", 1, "--undo", "--why", "it was trial 2")
        self.assertEqual(self.do("summary", "--json").json["counts"]["usable"], 2)
        self.do("exclude", 1, "--why", "hand slipped")
        self.do("exclude", 1, "--undo")
        self.assertEqual(self.do("summary", "--json").json["counts"]["excluded"], 0)
        self.assertEqual(self.checked("--quick")["problems"], [])

    def test_exports(self):
        self.do("add", self.trials[0], "--participant", 7, "--condition", "relaxed, seated")
        self.do("add", self.trials[1], "--participant", 8, "--condition", "stiff_100%")
        self.do("measure")
        rows = list(csv.DictReader(io.StringIO(self.do("export").out)))
        result = self.do("show", 1, "--result").json
        k_xx = next(row for row in rows if row["participant"] == "7" and row["outcome"] == "K_xx")
        self.assertEqual(float(k_xx["value"]), result["model"]["K"][0][0])
        self.assertEqual(float(k_xx["standard_error"]), result["standard_error"]["K"][0][0])
        self.assertEqual((k_xx["condition"], k_xx["state"], k_xx["unit"]), ("relaxed, seated", "usable", "N/m"))
        document = self.do("export", "--format", "json").json
        self.assertEqual(len(document["recordings"]), 2)
        latex = self.do("export", "--format", "latex").out
        self.assertIn(r"stiff\_100\%", latex)
        self.assertEqual(latex.count("{"), latex.count("}"))
        self.assertEqual(latex, self.do("summary", "--format", "latex").out)
        out = self.folder / "outcomes.csv"
        self.assertIn(str(out), self.do("export", "--out", out).err)
        self.assertEqual(self.do("export", "--out", self.folder / "quiet.csv", "--quiet").err, "")
        self.do("export", "--bids", self.folder / "bids")
        description = json.loads((self.folder / "bids" / "dataset_description.json").read_text(encoding="utf-8"))
        self.assertEqual(description["Name"], "A study")

    def test_forgets_a_participant(self):
        self.do("add", *self.trials[:2], "--participant", 7, "--condition", "seldom-word")
        self.do("add", self.trials[2], "--participant", 8)
        self.do("measure")
        hashes = [one["sha256"] for one in self.listed()["recordings"]]
        self.do("forget", "--participant", 7, "--why", "consent withdrawn", "--role", "data-manager")
        self.assertEqual([one["participant"] for one in self.listed()["recordings"]], [8])
        left = b"".join(path.read_bytes() for path in self.study.rglob("*") if path.is_file())
        for secret in (hashes[0].encode(), hashes[1].encode(), b"seldom-word"):
            self.assertNotIn(secret, left)
        self.assertRegex(self.do("log").out, "forget.* 7.*consent withdrawn")
        self.assertEqual(self.checked()["problems"], [])
        self.refused(WRONG_USAGE, "study", "forget", "--participant", 7, "--why", "x", "--study", self.study)

    def test_backup_can_be_used_in_its_place(self):
        self.do("add", self.trials[0], "--participant", 7)
        self.do("measure")
        ran = self.do("backup", self.folder / "copy")
        shutil.rmtree(self.study)
        (self.folder / "copy").rename(self.study)
        self.assertEqual(self.checked()["problems"], [])
        self.assertIn(self.do("log", "--json").json["head"], ran.out)

    def test_log_shows_a_change(self):
        self.do("add", self.trials[0], "--participant", 7)
        head = self.do("log", "--json").json["head"]
        self.do("log", "--verify", "--head", head)
        with sqlite3.connect(self.study / "study.sqlite") as database:
            database.execute("DROP TRIGGER IF EXISTS log_is_never_changed")
            database.execute("UPDATE log SET why = 'nothing' WHERE number = 1")
        self.assertIn("line 1", self.do("log", "--verify", code=BAD_DATA).out)
        self.assertTrue(self.checked("--quick", code=BAD_DATA)["problems"])

    def test_log_can_be_recomputed_by_others(self):
        self.do("add", self.trials[0], "--participant", 7)
        self.do("exclude", 1, "--why", "Größe")
        before = ""
        for line in self.do("log", "--json").json["lines"]:
            text = json.dumps(["mbk.study.log/1", line["number"], line["time"], line["role"], line["action"],
                               line.get("recording"), line.get("analysis"), line.get("participant"),
                               line.get("digest", ""), line.get("why", ""), before],
                              separators=(",", ":"), ensure_ascii=False)
            before = hashlib.sha256(text.encode()).hexdigest()
            self.assertEqual(line["hash"], before)

    def test_check_finds_a_file_that_changed(self):
        self.do("add", self.trials[0], "--participant", 7)
        stored = next(self.study.glob("recordings/*/*.csv"))
        stored.write_bytes(stored.read_bytes().replace(b"1", b"2", 1))
        self.assertIn(stored.name, self.do("check", code=BAD_DATA).out)
        ran = self.do("measure", code=BAD_DATA)
        self.assertIn(stored.name, ran.err)
        self.assertEqual(self.listed()["recordings"][0]["state"], "not-measured", "a damaged file has no result")


class Importing(StudyCase):
    def test_by_a_pattern(self):
        names = ["p07_s1_relaxed_1_Jane.csv", "p07_s1_stiff_1_Jane.csv", "other.csv"]
        files = [command.copy(trial, self.folder / name) for trial, name in zip(self.trials, names)]
        ran = self.do("import", *files, "--pattern", "p{participant}_s{session}_{condition}_{trial}_*.csv",
                      code=WRONG_USAGE)
        self.assertIn("other.csv", ran.err)
        self.assertEqual([(r["participant"], r["session"], r["condition"], r["trial"])
                          for r in self.listed()["recordings"]], [(7, 1, "relaxed", 1), (7, 1, "stiff", 1)])
        everything = b"".join(path.read_bytes() for path in self.study.rglob("*") if path.is_file())
        self.assertNotIn(b"Jane", everything)

    def test_by_a_sheet(self):
        for k, trial in enumerate(self.trials[:2]):
            command.copy(trial, self.folder / f"{k}.csv")
        sheet = self.file("sheet.csv", "file,participant,condition,surname\n0.csv,3,relaxed,Doe\n1.csv,4,stiff,Roe\n")
        ran = self.do("import", "--sheet", sheet)
        self.assertIn("surname", ran.err)
        self.assertEqual([(r["participant"], r["condition"]) for r in self.listed()["recordings"]],
                         [(3, "relaxed"), (4, "stiff")])
        self.refused(BAD_DATA, "study", "import", "--study", self.study, "--sheet",
                     self.file("wrong.csv", "file,participant\n0.csv,Jane\n"), says="row 2")

    def test_of_mbk_run_by_what_it_wrote(self):
        trial = short_trial(self.folder, 9, "run.csv", participant=12, condition="relaxed", withdrawn="no")
        self.do("import", trial)
        (one,) = self.listed()["recordings"]
        self.assertEqual((one["participant"], one["condition"], one["session"]), (12, "relaxed", 1))
        withdrawn = short_trial(self.folder, 9, "withdrawn.csv", participant=12, withdrawn="yes")
        self.refused(BAD_DATA, "study", "import", withdrawn, "--study", self.study, says="withdrawn")
        self.refused(WRONG_USAGE, "study", "add", self.trials[0], "--study", self.study, says="--participant")

    def test_refuses_or_strips_what_may_identify_a_person(self):
        named = short_trial(self.folder, 10, "named.csv", patient_name="Jane Doe", participant=5)
        ran = self.refused(BAD_DATA, "study", "add", named, "--study", self.study, says=("patient_name", "--strip"))
        self.assertIn("named.csv", ran.err)
        self.assertNotIn("Jane", ran.err)
        self.do("add", named, "--strip")
        (one,) = self.listed()["recordings"]
        self.assertNotEqual(one["sha256"], one["origin_sha256"])
        everything = b"".join(path.read_bytes() for path in self.study.rglob("*") if path.is_file())
        self.assertNotIn(b"Jane", everything)
        self.assertIn("recording 1", self.do("add", named, "--strip").out)
        self.do("measure")
        stored, measured = self.do("show", 1, "--result").json, run("measure", named, "--json").json
        self.assertEqual(stored["model"], measured["model"])
        self.assertEqual(self.checked()["problems"], [])

    def test_what_an_exam_says_of_a_person_unseen_is_stripped(self):
        exam = write_exam(self.folder / "exam.kinarm", (1, 2), sides=("Left", "Right"))
        self.do("defaults", "--side", "left", "--channels", "x=hand_x,y=hand_y,Fx=force_x,Fy=force_y")
        self.refused(BAD_DATA, "study", "add", exam, "--participant", 7, "--study", self.study, says=("exam", "--strip"))
        self.assertEqual(list(self.study.glob("recordings/*/*")), [])
        ran = self.do("add", exam, "--participant", 7, "--strip")
        self.assertIn("recording 2", ran.out)
        everything = b"".join(path.read_bytes() for path in self.study.rglob("*") if path.is_file())
        for secret in (b"Erika", b"1961-02", b"Musterfrau"):
            self.assertNotIn(secret, everything)
        # how the exam is read was applied when the copy was made, and is not applied again
        run("study", "measure", "--study", self.study)
        stored = self.do("show", 2, "--result").json["model"]
        measured = run("measure", exam, "--side", "left", "--trial", 2, "--json", "--channels",
                       "x=hand_x,y=hand_y,Fx=force_x,Fy=force_y").json["model"]
        self.assertEqual(stored, measured)

    def test_what_a_c3d_file_says_of_a_person_unseen_is_stripped(self):
        angle, torque = limb(4000)
        file = write_c3d(self.folder / "limb.c3d", {}, {"Knee angle": angle, "Torque": torque}, ["deg", "Nm"])
        plain = command.copy(file, self.folder / "plain.c3d")
        data = file.read_bytes()
        end = len(data[:1536].rstrip(b"\0")) + 1
        subjects = b"\x08\xfdSUBJECTS\x03\0\0" + texts(3, "NAMES", ["Erika Muster"])
        file.write_bytes((data[:end] + subjects).ljust(1536, b"\0") + data[1536:])
        self.do("defaults", "--axes", "1", "--channels", "x=Knee angle,F=Torque")
        self.do("add", plain, "--participant", 6)
        self.refused(BAD_DATA, "study", "add", file, "--participant", 7, "--study", self.study,
                     says=("SUBJECTS:NAMES", "--strip"))
        ran = self.do("add", file, "--participant", 7, "--strip")
        self.assertIn("SUBJECTS:NAMES", ran.err)
        everything = b"".join(path.read_bytes() for path in self.study.rglob("*") if path.is_file())
        self.assertNotIn(b"Erika", everything)
        run("study", "measure", "--study", self.study)
        models = [self.do("show", number, "--result").json["model"] for number in (1, 2)]
        self.assertEqual(models[0], models[1])

    def test_refuses_a_name_for_a_participant(self):
        self.refused(WRONG_USAGE, "study", "add", self.trials[0], "--study", self.study, "--participant", "Jane",
                     says="Jane")

    def test_one_bad_file_costs_only_itself(self):
        bad = self.file("bad.csv", "nothing of use")
        ran = self.do("add", bad, self.trials[0], "--participant", 1, code=BAD_DATA)
        self.assertIn("bad.csv", ran.err)
        self.assertNotIn(".part", ran.err)
        self.assertIn("recording 1", ran.out)
        self.assertEqual(self.checked("--quick")["notes"], [])

    def test_reads_as_the_defaults_say(self):
        text = self.trials[0].read_text(encoding="utf-8")
        names, _, rows = text[text.index("time_s,"):].partition("\n")
        unnamed = self.file("unnamed.csv", "\n".join([",".join(f"c{k}" for k in range(1, names.count(",") + 2)), rows]))
        self.do("add", unnamed, "--participant", 1, code=BAD_DATA)
        columns = [name.rpartition("_")[0] for name in names.split(",")]
        expected = {"time": "time", "hand_x": "x", "hand_y": "y", "force_x": "Fx", "force_y": "Fy", "reference_x": "xr",
                  "reference_y": "yr"}
        channels = ",".join(f"{expected[name]}={columns.index(name) + 1}" for name in expected)
        self.do("defaults", "--channels", channels)
        self.do("add", unnamed, "--participant", 1)
        self.assertIn("1 usable", self.do("measure").out)


class DataSets(StudyCase):
    def exported(self):
        for trial, condition in zip(self.trials, ("relaxed", "stiff_100%", "stiff 100", "")):
            extra = ("--condition", condition) if condition else ()
            self.do("add", trial, "--participant", 7, "--session", 2, *extra)
        data_set = self.folder / "data_set"
        self.assertIn("4 recordings", self.do("export", "--bids", data_set).out)
        return data_set

    def test_come_back_as_they_were(self):
        data_set = self.exported()
        self.do("measure")
        self.assertEqual(len(list(data_set.rglob("*_motion.tsv"))), 4)
        channels = next(data_set.rglob("*_channels.tsv")).read_text(encoding="utf-8")
        self.assertRegex(channels, r"force_x\t.*\tMISC\t")
        other = self.folder / "other"
        self.mbk("study", "init", other)
        self.mbk("study", "import", data_set, "--study", other)
        self.mbk("study", "measure", "--study", other)

        def facts(study):
            listed = self.mbk("study", "list", "--json", "--study", study).json["recordings"]
            return {(r["participant"], r["session"], r["condition"], r["trial"], r["state"]) for r in listed}

        def numbers(study):
            rows = csv.DictReader(io.StringIO(self.mbk("study", "export", "--study", study).out))
            return {(row["condition"], row["outcome"]): row["value"] for row in rows}

        self.assertEqual(facts(other), facts(self.study))
        self.assertEqual(numbers(other), numbers(self.study))
        self.mbk("study", "import", data_set, "--study", other)
        self.assertEqual(len(self.mbk("study", "list", "--json", "--study", other).json["recordings"]), 4)

    def test_of_nothing_are_not_made(self):
        self.refused(WRONG_USAGE, "study", "export", "--bids", self.folder / "none", "--study", self.study)
        self.assertFalse((self.folder / "none").exists())

    def test_leave_out_what_is_excluded_and_are_not_written_over(self):
        data_set = self.exported()
        self.refused(WRONG_USAGE, "study", "export", "--bids", data_set, "--study", self.study,
                     says=str(data_set))
        self.do("exclude", 2, "--why", "hand slipped")
        ran = self.do("export", "--bids", self.folder / "second")
        self.assertIn("3 recordings", ran.out)
        self.assertRegex(ran.err, r"\b2\b")
        self.assertEqual([path for path in self.folder.iterdir() if ".part" in path.name], [])
        self.refused(WRONG_USAGE, "study", "export", "--bids", self.folder / "third", "--format", "json", "--study",
                     self.study)

    def test_names_of_people_are_refused(self):
        data_set = self.exported()
        session = data_set / "sub-07"
        (data_set / "sub-jane").mkdir()
        for path in session.rglob("*relaxed*run-1_*"):
            shutil.copy(path, data_set / "sub-jane" / path.name.replace("sub-07", "sub-jane"))
        before = len(self.listed()["recordings"])
        self.refused(WRONG_USAGE, "study", "import", data_set, "--study", self.study, says=("sub-jane", "--sheet"))
        self.assertEqual(len(self.listed()["recordings"]), before)
        self.refused(BAD_DATA, "study", "import", self.study, "--study", self.study, says="BIDS")


class Reading(StudyCase):
    """By those who may read a study and not write it."""

    def setUp(self):
        super().setUp()
        self.do("add", *self.trials[:2], "--participant", 7)
        self.do("measure", "--quiet")
        self.folder.chmod(0o755)
        self.allow(read_only=True)
        self.addCleanup(self.allow, read_only=False)

    def allow(self, read_only):
        for path in (self.study, *self.study.rglob("*")):
            path.chmod((0o555 if path.is_dir() else 0o444) if read_only else (0o700 if path.is_dir() else 0o600))

    def as_reader(self, name, *arguments, code=FINE):
        """Runs a command as someone to whom permissions apply."""
        user = {"user": 65534, "group": 65534, "extra_groups": []} if command.is_root() else {}
        ran = subprocess.run([command.program("MBK"), "study", name, *map(str, arguments), "--study", self.study],
                             capture_output=True, text=True, check=False, cwd="/", **user)
        self.assertEqual(ran.returncode, code, ran)
        return ran

    def test_a_study_without_permission_to_write(self):
        self.assertRegex(self.as_reader("list").stdout, r"\b2 recordings\b.*\b1 participant\b.*\b2 usable\b")
        said = {words: self.as_reader(*words.split()).stdout for words in ("show 1", "summary", "export", "log --verify")}
        self.allow(read_only=False)
        self.assertEqual(said, {words: self.do(*words.split()).out for words in said})
        self.allow(read_only=True)
        check = json.loads(self.as_reader("check", "--json").stdout)
        self.assertEqual((check["files"], check["repeated"], check["problems"]), (2, 2, []))
        self.assertEqual(len(check["notes"]), 1, check["notes"])
        before = {path: path.read_bytes() for path in self.study.rglob("*") if path.is_file()}
        for words in (["exclude", 1, "--why", "x"], ["forget", "--participant", 7, "--why", "x"], ["defaults", "--cutoff", 4],
                      ["add", self.trials[2], "--participant", 8], ["measure", "--cutoff", 4]):
            self.assertIn("permission", self.as_reader(*words, code=BAD_DATA).stderr.lower(), words)
        self.assertEqual({path: path.read_bytes() for path in self.study.rglob("*") if path.is_file()}, before)

    def test_what_another_process_has_not_yet_written_is_never_missed(self):
        self.allow(read_only=False)
        with contextlib.closing(sqlite3.connect(self.study / "study.sqlite")) as writer:
            writer.execute("UPDATE fact SET value = 'Another title' WHERE name = 'title'")
            writer.commit()
            self.allow(read_only=True)
            ran = self.as_reader("list", code=BAD_DATA)
            self.assertIn("process", ran.stderr)
            self.allow(read_only=False)
        self.allow(read_only=True)
        self.assertIn("Another title", self.as_reader("list").stdout)


class Waiting(StudyCase):
    def test_for_another_process_is_said_at_once(self):
        holder = sqlite3.connect(self.study / "study.sqlite", isolation_level=None)
        holder.execute("BEGIN IMMEDIATE")
        with open(self.study / "lock", "w", encoding="utf-8") as lock:
            for what, release in ((["defaults", "--cutoff", "4"], lambda: holder.execute("ROLLBACK")),
                                  (["check", "--quick"], lambda: fcntl.flock(lock, fcntl.LOCK_UN))):
                fcntl.flock(lock, fcntl.LOCK_EX)
                waits = subprocess.Popen([command.program("MBK"), "study", *what, "--study", self.study],
                                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                self.assertIn("process", waits.stderr.readline())
                self.assertIsNone(waits.poll())
                release()
                self.assertEqual((waits.wait(timeout=120), waits.stderr.read()), (FINE, ""))
                waits.stderr.close()
        holder.close()


class Log(StudyCase):
    def write_anew(self, times):
        """The log with other times and the hashes that belong to them, as one who knows how it is made could do."""
        with contextlib.closing(sqlite3.connect(self.study / "study.sqlite")) as database:
            database.execute("DROP TRIGGER IF EXISTS log_is_never_changed")
            head = ""
            rows = database.execute("SELECT number, role, action, recording, analysis, participant, digest, why FROM log "
                                    "ORDER BY number").fetchall()
            for (number, *rest), at in zip(rows, times):
                line = json.dumps(["mbk.study.log/1", number, at, *rest, head], separators=(",", ":"), ensure_ascii=False)
                head = hashlib.sha256(line.encode()).hexdigest()
                database.execute("UPDATE log SET time = ?, hash = ? WHERE number = ?", (at, head, number))
            database.commit()

    def test_whose_times_run_back_is_seen(self):
        self.do("defaults", "--cutoff", "4")
        self.do("defaults", "--cutoff", "5")
        self.write_anew(["2026-05-04T09:30:00Z", "2026-05-04T09:30:00Z", "2026-05-04T09:29:30Z"])
        self.assertEqual(self.checked()["problems"], [], "clocks of two computers differ a little")
        self.write_anew(["2026-05-04T09:30:00Z", "2026-05-04T09:31:00Z", "2026-05-03T09:31:00Z"])
        problems = self.checked(code=BAD_DATA)["problems"]
        self.assertEqual(len(problems), 1)
        self.assertIn("86400 s", problems[0])
        self.assertIn("line 3", self.do("log", "--verify", code=BAD_DATA).out)
        self.write_anew(["2026-05-04T09:30:00Z", "yesterday", "2026-05-04T09:31:00Z"])
        self.assertIn("'yesterday'", self.checked(code=BAD_DATA)["problems"][0])

    def test_reasons_that_stay_after_forgetting_are_named(self):
        self.do("add", *self.trials[:2], "--participant", 7)
        self.do("add", self.trials[2], "--participant", 8)
        self.do("exclude", 1, "--why", "Jane coughed")
        self.do("exclude", 3, "--why", "hand slipped")
        said = self.do("forget", "--participant", 7, "--why", "consent withdrawn").out
        self.assertIn("line 5", said)
        self.do("add", self.trials[3], "--participant", 9)
        self.assertNotRegex(self.do("forget", "--participant", 9, "--why", "consent withdrawn").out, r"line \d")


class Pages(StudyCase):
    """What a page holds; how it looks is tested in a browser (tests/web/study_test.mjs)."""

    def setUp(self):
        super().setUp()
        if "MBK_WEB" in run("study", "report", "--out", self.folder / "x.html", "--study", self.study).err:
            self.skipTest("this mbk was built without its pages")

    def document(self, *options):
        out = self.folder / "page.html"
        self.do("report", "--out", out, "--overwrite", *options)
        self.assertEqual(out.stat().st_mode & 0o777, 0o600, "health data are for their owner")
        text = out.read_text(encoding="utf-8")
        data = re.search(r'<script type="application/json" id="report-data">(.*?)</script>', text, re.S).group(1)
        document = json.loads(data)
        schemas.check(document)
        return document

    def test_hold_what_the_study_says(self):
        self.do("add", *self.trials[:2], "--participant", 7)
        self.do("add", self.trials[2], "--participant", 7, "--session", 2)
        self.do("add", self.trials[3], "--participant", 8)
        self.do("measure")
        self.do("exclude", 2, "--why", "</script><b>slipped")
        document = self.document()
        self.assertEqual(document["summary"], self.do("summary", "--json").json)
        self.assertEqual(document["recordings"], self.listed()["recordings"])
        own = self.document("--participant", 7, "--note", "Ward 3")
        self.assertEqual((own["participant"], own["note"], own["study_participants"]), (7, "Ward 3", 2))
        self.assertEqual({one["participant"] for one in own["recordings"]}, {7})
        self.assertNotIn(str(self.folder), json.dumps(own) + json.dumps(document), "a path may name a person")
        area = next(one for one in own["courses"] if one["outcome"] == "stiffness_area")
        change = area["participants"][0]["changes"][0]
        self.assertEqual((change["verdict"], change["mdc95"]), ("unknown", None))
        self.assertIn("1 person", area["why_unknown"])

    def test_of_nothing(self):
        document = self.document()
        self.assertEqual((document["recordings"], document["courses"], document["primary"]), ([], [], ""))
        self.do("add", self.trials[0], "--participant", 1)
        self.assertEqual(self.document()["summary"]["counts"]["not_measured"], 1)
        self.assertEqual(self.document("--participant", 1)["courses"], [])

    def test_are_refused(self):
        page = self.file("page.html", "mine")
        self.refused(WRONG_USAGE, "study", "report", "--study", self.study, says="--out")
        self.refused(WRONG_USAGE, "study", "report", "--study", self.study, "--out", page, says="--overwrite")
        self.assertEqual(page.read_text(encoding="utf-8"), "mine")
        other = self.folder / "other.html"
        self.refused(WRONG_USAGE, "study", "report", "--study", self.study, "--participant", 3, "--out", other,
                     says="participant 3")
        self.refused(WRONG_USAGE, "study", "report", "--study", self.study, "--outcome", "none", "--out", other,
                     says="outcome")
        for number in ("0", "-1", "1.5", "7a", "99999999999999999999"):
            self.refused(WRONG_USAGE, "study", "report", "--study", self.study, f"--participant={number}", "--out", other)
        self.assertFalse(other.exists())


class Interrupted(StudyCase):
    """Killed at any moment: what was said to be stored is stored, and nothing is there by half."""

    def killed(self, lot, name, *arguments):
        """Starts a command and kills it at some moment.   @returns  what it had printed"""
        process = subprocess.Popen([command.program("MBK"), "study", name, *map(str, arguments), "--study", self.study],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        time.sleep(lot.uniform(0, self.longest[name]))
        process.send_signal(signal.SIGKILL)
        said = process.communicate()[0].decode()
        in_work = process.returncode == -signal.SIGKILL
        self.kills[name] += in_work
        self.longest[name] *= 1.15 if in_work else 0.87  # so that about half of them are killed in mid-work
        return said

    def test_kill_in_mid_write(self):
        lot, self.kills, self.longest = random.Random(1), collections.Counter(), {"add": 0.1, "measure": 0.1, "forget": 0.02}
        files = [self.file(f"{k}.csv", f"# copy: {k}\n" + self.trials[k % 4].read_text(encoding="utf-8"))
                 for k in range(24)]
        added, measured = {}, set()
        for n in range(10 * KILLS):
            if sum(self.kills.values()) >= KILLS and min(self.kills[what] for what in self.longest) > KILLS // 20:
                break
            what = ("add", "measure", "forget", "add", "measure")[n % 5]
            if what == "add":
                some = lot.sample(range(24), 8)
                said = self.killed(lot, "add", *[files[k] for k in some], "--participant", 1 + n % 4)
                for line in said.splitlines():
                    number = int(line.split(":")[0].split()[1])
                    added.setdefault(number, int(line.split("participant ")[1].split(",")[0]))
            elif what == "measure":
                self.killed(lot, "measure", "--quiet")
            else:
                there = sorted({one["participant"] for one in self.listed()["recordings"]})
                if there:
                    participant = lot.choice(there)
                    said = self.killed(lot, "forget", "--participant", participant, "--why", "test")
                    if "forgotten" in said:
                        self.assertNotIn(participant, {one["participant"] for one in self.listed()["recordings"]})
            lines = self.do("log", "--json").json["lines"]
            erased = {line["recording"] for line in lines if line["action"] == "erase"}
            listed = {one["number"]: one for one in self.listed()["recordings"]}
            for number, participant in added.items():  # what was said to be added is there, or forgotten
                if number not in erased:
                    self.assertIn(number, listed)
                    self.assertEqual(listed[number]["participant"], participant)
            now = {(line["recording"], line["analysis"]) for line in lines if line["action"] == "measure"}
            self.assertLessEqual(measured, now)
            measured = now
            report = self.checked("--quick")
            self.assertEqual(report["problems"], [], f"run {n + 1}, {what}")
            self.assertEqual(report["files"], len({one["sha256"] for one in listed.values()}))
        self.assertGreaterEqual(sum(self.kills.values()), KILLS, self.kills)
        self.assertGreater(min(self.kills[what] for what in self.longest), KILLS // 20, self.kills)
        self.do("check", "--remove-leftovers")
        stored = {path.name for path in self.study.glob("recordings/*/*")}
        self.assertEqual(stored, {one["sha256"] + ".csv" for one in self.listed()["recordings"]})
        for k, file in enumerate(files):  # and all goes on as if nothing had been
            run("study", "add", file, "--participant", 1 + k % 4, "--study", self.study)
        self.do("measure")
        self.assertEqual(self.checked()["problems"], [])
        self.assertEqual({one["state"] for one in self.listed()["recordings"]}, {"usable"})

    def test_two_at_once(self):
        both = [subprocess.Popen([command.program("MBK"), "study", "add", *self.trials, "--participant", "1", "--study",
                                  self.study], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for _ in range(2)]
        for process in both:
            self.assertEqual(process.wait(), FINE, process.stderr.read())
            process.stderr.close()
        both = [subprocess.Popen([command.program("MBK"), "study", "measure", "--quiet", "--study", self.study],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(2)]
        for process in both:
            self.assertEqual(process.wait(), FINE)
        report = self.checked()
        self.assertEqual((report["recordings"], report["results"], report["problems"]), (4, 4, []))

    def test_full_disk(self):
        self.do("add", self.trials[0], "--participant", 1)
        size = self.trials[1].stat().st_size

        def limited():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size // 2, size // 2))

        process = subprocess.run([command.program("MBK"), "study", "add", self.trials[1], "--participant", "2",
                                  "--study", self.study], preexec_fn=limited, capture_output=True, text=True, check=False)
        self.assertEqual(process.returncode, BAD_DATA, process.stderr)
        self.assertIn("space", process.stderr)
        report = self.checked("--quick")
        self.assertEqual((report["recordings"], report["problems"], report["notes"]), (1, [], []))


if __name__ == "__main__":
    command.main()
