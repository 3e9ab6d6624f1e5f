#!/usr/bin/env python3
"""BIDS data sets (Motion): recordings are added to them and come back to the last bit; those of others are read.

Where MBK_BIDS_VALIDATOR names the program bids-validator (npm, 1.15), what is written must be without an error for it.
"""

import json
import os
import subprocess

from command import WRONG_USAGE, Case, main, make_log

RECORDING = """# mbk.recording/1
# age: 92
# condition: relaxed
# handedness: left
# name: Erika Mustermann
# participant: P07
# event 0.1003 1 onset
# event 0.30000000000000004 -2.5 target left
time_s,hand_x_m,hand_y_m,joint_1_rad,force_x_N,force_y_N,reference_x_N
0.1,0.30000000000000004,1e-300,1.5707963267948966,0.1,-0,2
0.2003,0.3,NaN,0.1,5e-324,1.7976931348623157e+308,2
0.3,0.2,0.1,0.2,Inf,-Inf,3
"""


class DataSet(Case):
    def setUp(self):
        super().setUp()
        self.set = self.folder / "set"

    def convert(self, source, name, *options):
        return self.mbk("convert", source, self.set, "--bids", name, *options)

    def texts(self):
        return {str(path.relative_to(self.set)): path.read_text(encoding="utf-8")
                for path in sorted(self.set.rglob("*")) if path.is_file()}

    def table(self, name):
        lines = (self.set / name).read_text(encoding="utf-8").splitlines()
        return [line.split("\t") for line in lines]

    def validate(self):
        validator = os.environ.get("MBK_BIDS_VALIDATOR")
        if not validator:
            return
        ran = subprocess.run([validator, "--json", str(self.set)], capture_output=True, text=True, check=False)
        issues = json.loads(ran.stdout)["issues"]
        self.assertEqual(issues["errors"], [], json.dumps(issues["errors"], indent=1)[:3000])


class Written(DataSet):
    def test_a_recording_comes_back_to_the_last_bit(self):
        log = make_log().path
        self.fine("convert", log, self.folder / "log.h5", "--quiet")
        self.fine("convert", self.folder / "log.h5", self.set, "--bids", "sub-07_ses-2_task-relaxed_run-1")
        self.fine("convert", self.set, self.folder / "back.h5", "--quiet")
        self.assertEqual((self.folder / "back.h5").read_bytes(), (self.folder / "log.h5").read_bytes())
        first = self.fine("measure", "--json", self.folder / "log.h5").json
        again = self.fine("measure", "--json", self.set, "--trial", "sub-07_ses-2_task-relaxed_run-1").json
        self.assertEqual(first["model"], again["model"])
        self.validate()

    def test_every_number_event_and_entry(self):
        source = self.file("trial.csv", RECORDING)
        self.convert(source, "sub-07_task-reach")
        self.mbk("convert", self.set, self.folder / "back.csv", "--quiet")
        back = (self.folder / "back.csv").read_text(encoding="utf-8").splitlines()
        expected = [line for line in RECORDING.replace("# age: 92", "# age: 89+").splitlines() if "Erika" not in line]
        self.assertEqual(back[1:], expected[1:])
        self.validate()

    def test_what_stands_where(self):
        ran = self.convert(self.file("trial.csv", RECORDING), "sub-07_task-reach_acq-fast_ses-2_run-01")
        self.assertIn("'name'", ran.err)
        self.assertIn("89+", ran.err)
        stem = "sub-07/ses-2/motion/sub-07_ses-2_task-reach_tracksys-robot_acq-fast_run-01"
        self.assertEqual(sorted(self.texts()), sorted([
            "README", "dataset_description.json", "participants.json", "participants.tsv",
            "sub-07/ses-2/sub-07_ses-2_scans.tsv", f"{stem}_channels.json", f"{stem}_channels.tsv",
            f"{stem}_motion.json", f"{stem}_motion.tsv", f"{stem.replace('_tracksys-robot', '')}_events.json",
            f"{stem.replace('_tracksys-robot', '')}_events.tsv"]))
        self.assertFalse([name for name, text in self.texts().items() if "Erika" in text or "92" in text.split()])
        self.assertEqual(self.table("participants.tsv"), [["participant_id", "age", "handedness"],
                                                          ["sub-07", "89+", "left"]])
        channels = self.table(f"{stem}_channels.tsv")
        self.assertEqual(channels[0][:5], ["name", "component", "type", "tracked_point", "units"])
        self.assertEqual([(row[0], row[2], row[4]) for row in channels[1:]],
                         [("time", "LATENCY", "s"), ("hand_x", "POS", "m"), ("hand_y", "POS", "m"),
                          ("joint_1", "JNTANG", "rad"), ("force_x", "MISC", "N"), ("force_y", "MISC", "N"),
                          ("reference_x", "MISC", "N")])
        motion = self.table(f"{stem}_motion.tsv")
        self.assertEqual((len(motion), motion[1][2]), (3, "n/a"))
        sidecar = json.loads(self.texts()[f"{stem}_motion.json"])
        self.assertEqual((sidecar["TaskName"], sidecar["MotionChannelCount"], sidecar["MISCChannelCount"]),
                         ("reach", 7, 3))
        self.validate()

    def test_what_is_there_stays(self):
        source = self.file("trial.csv", RECORDING)
        self.convert(source, "sub-07_task-reach_run-1")
        (self.set / "README").write_text("mine\n", encoding="utf-8")
        (self.set / "participants.tsv").write_text("participant_id\tgroup\nsub-07\tcontrol", encoding="utf-8")
        before = self.texts()
        self.refused(WRONG_USAGE, "convert", source, self.set, "--bids", "sub-07_task-reach_run-1",
                     says=["run-1_motion.tsv", "--overwrite"])
        self.assertEqual(self.texts(), before)
        self.convert(source, "sub-08_task-reach_run-1")
        self.convert(source, "sub-07_task-reach_run-10")
        self.convert(source, "sub-07_task-reach_run-2")
        after = self.texts()
        self.assertEqual(after["README"], "mine\n")
        self.assertEqual(after["participants.tsv"], "participant_id\tgroup\nsub-07\tcontrol\nsub-08\tn/a\n")
        self.assertEqual(len(self.table("sub-07/sub-07_scans.tsv")), 4)
        for name, text in before.items():
            if name not in ("participants.tsv", "sub-07/sub-07_scans.tsv"):
                self.assertEqual(after[name], text)
        self.refused(WRONG_USAGE, "convert", self.set, self.folder / "one.h5", says=["4 trials", "--trial"])
        ran = self.refused(WRONG_USAGE, "info", self.set, "--trial", "sub-09_task-reach",
                           says=["4 trials", "sub-07_task-reach_run-1", "sub-08_task-reach_run-1"])
        self.assertIn("mbk info", ran.err)
        self.convert(source, "sub-07_task-reach_run-1", "--overwrite")
        self.assertEqual(len(self.table("sub-07/sub-07_scans.tsv")), 4)
        self.validate()

    def test_names_that_are_none(self):
        source = self.file("trial.csv", RECORDING)
        for name, says in (("sub-07", "task"), ("task-reach", "participant"),
                           ("sub-07_task-re-ach", "'re-ach'"), ("sub-07_task-a_run-b", "number"),
                           ("sub-07_task-a_task-b", "'sub-07_task-a_task-b'"), ("sub-07_job-a", "'job-a'"),
                           ("../sub-07_task-a", "'../sub-07'")):
            with self.subTest(name):
                self.refused(WRONG_USAGE, "convert", source, self.set, "--bids", name, says=says)
                self.assertFalse(self.set.exists())
        (self.folder / "other").mkdir()
        (self.folder / "other" / "thesis.txt").write_text("mine", encoding="utf-8")
        self.refused(WRONG_USAGE, "convert", source, self.folder / "other", "--bids", "sub-07_task-a",
                     says="BIDS")
        self.refused(WRONG_USAGE, "convert", source, self.folder / "other", says="--bids")


class Read(DataSet):
    CHANNELS = ("name\tcomponent\ttype\ttracked_point\tunits\n"
                "hand_x\tx\tPOS\thand\tmm\nelbow\tn/a\tJNTANG\telbow\tdeg\nFz\tz\tMISC\thand\tN\n")
    NUMBERS = "1\t90\t-1\n2\tn/a\t-2\n3\t45\t-3\n"

    def write(self, name, text):
        path = self.set / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def data_set(self, numbers=NUMBERS, channels=CHANNELS, system="imu"):
        stem = f"sub-a/motion/sub-a_task-walk_tracksys-{system}"
        self.write("dataset_description.json", '{"Name": "x", "BIDSVersion": "1.11.0"}')
        self.write("task-walk_motion.json", '{"TaskName": "walk", "SamplingFrequency": 50}')
        self.write(f"{stem}_channels.tsv", channels)
        self.write(f"{stem}_motion.tsv", numbers)
        return self.set / f"{stem}_motion.tsv"

    def test_a_data_set_of_others(self):
        motion = self.data_set()
        self.write("sub-a/motion/sub-a_task-walk_events.tsv", "onset\tduration\ttrial_type\n0.02\t0\tstep\n")
        options = ("--channels", "x=hand_x,q1=elbow,Fx=-Fz")
        for path, more in ((self.set, ()), (self.set, ("--trial", "sub-a_task-walk")), (motion, ())):
            facts = self.fine("info", "--json", *options, path, *more).json
            self.assertEqual((facts["samples"], facts["rate_hz"]), (3, 50.0))
            self.assertEqual(facts["inputs"][0]["file"], str(motion))
            ranges = {one["name"]: (one["minimum"], one["maximum"]) for one in facts["channels"]}
            self.assertEqual(ranges["hand_x"], (0.001, 0.003))
            self.assertAlmostEqual(ranges["joint_1"][1], 1.5707963267948966)
            self.assertEqual(ranges["force_x"], (1.0, 3.0))
            self.assertEqual(facts["metadata"], {"participant": "a", "task": "walk"})
        self.mbk("convert", *options, motion, self.folder / "one.csv", "--quiet")
        self.assertIn("# event 0.02 0 step\n", (self.folder / "one.csv").read_text())

    def test_time_stamps_in_a_channel(self):
        channels = self.CHANNELS + "stamp\tn/a\tLATENCY\tn/a\tms\n"
        motion = self.data_set("".join(f"{row}\t{stamp}\n" for row, stamp in
                                       zip(self.NUMBERS.splitlines(), (100, 110, 121))), channels)
        self.mbk("convert", motion, self.folder / "one.csv", "--quiet")
        rows = [line.split(",")[0] for line in (self.folder / "one.csv").read_text().splitlines()[-3:]]
        self.assertEqual(rows, ["0.1", "0.11", "0.121"])

    def test_two_systems_are_two_recordings(self):
        self.data_set()
        self.data_set(system="optical")
        self.fine("info", self.set, "--trial", "sub-a_task-walk_tracksys-optical")
        self.refused(WRONG_USAGE, "info", self.set, "--trial", "sub-a_task-walk", says="2 trials")

    def test_what_does_not_fit_is_refused(self):
        wide = "".join(line + "\t7\n" for line in self.NUMBERS.splitlines())
        for numbers, channels, says in (
                (wide, self.CHANNELS, ["motion.tsv", "line 1", "4 columns"]),
                (self.NUMBERS.replace("90", "much"), self.CHANNELS, ["line 1", "column 2", "'much'", "n/a"]),
                (self.NUMBERS, self.CHANNELS.replace("units", "unit"), ["'units'"]),
                ("", self.CHANNELS, ["empty"])):
            self.bad_data(self.data_set(numbers, channels), says=says, command="info")
        motion = self.data_set()
        self.write("task-walk_motion.json", '{"TaskName": "walk"}')
        self.bad_data(motion, says=["SamplingFrequency"], command="info")
        self.write("task-walk_motion.json", '{"TaskName": "walk"')
        self.bad_data(motion, says=["motion.json", "JSON"], command="info")
        (self.set / "sub-a/motion/sub-a_task-walk_tracksys-imu_channels.tsv").unlink()
        self.bad_data(motion, says=["_channels.tsv"], command="info")
        (self.folder / "nothing").mkdir()
        self.bad_data(self.folder / "nothing", says=["BIDS"], command="info")


if __name__ == "__main__":
    main()
