#!/usr/bin/env python3
"""KINARM exams through the program: what a trial is, whose hand, which sign, and that a person stays in the exam."""

import math
import random
import struct
import zipfile

from command import Case, main

LINK = (0.30, 0.26)


def text(value):
    wide = value.encode("utf-16-le")
    return struct.pack("<i", len(wide) // 2) + wide


def group(name):
    return struct.pack("<i", 1) + text(name) + text("")


def parameter(name, value):
    head = struct.pack("<i", 2) + text(name) + text("")
    if isinstance(value, str):
        return head + struct.pack("<ii", 0, 1) + text(value)
    if isinstance(value, int):
        return head + struct.pack("<iii", 2, 1, value)
    return head + struct.pack("<iif", 3, 1, value)


def signal(label, unit, values):
    return (struct.pack("<i", 1) + text(label) + text("") + text(unit) +
            struct.pack(f"<i{len(values)}f", len(values), *values))


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def arm(frames, seed, mass=(1.8, 1.5), damping=9.0, stiffness=160.0, sign=-1.0, shown_links=LINK):
    """Signals of an arm that a robot of 1.1 kg moves; the sensor reads sign times the force of the hand on the robot."""
    random.seed(seed)
    tones = [(random.uniform(0, 7), random.uniform(0, 7)) for _ in range(8)]
    base = (0.6, 2.0)
    names = {"L1Ang": "rad", "L2Ang": "rad", "L1Vel": "rad/s", "L2Vel": "rad/s", "L1Acc": "rad/s^2",
             "L2Acc": "rad/s^2", "M1TorCMD": "Nm", "M2TorCMD": "Nm", "FS_ForceX": "N", "FS_ForceY": "N"}
    rows, hand = [], []
    l1, l2 = LINK
    rest = (l1 * math.cos(base[0]) + l2 * math.cos(base[1]), l1 * math.sin(base[0]) + l2 * math.sin(base[1]))
    for i in range(frames):
        t = i / 1000
        q, v, a = [], [], []
        for j in (0, 1):
            w = [2 * math.pi * (0.3 + 0.55 * k + 0.17 * j) for k in range(8)]
            size = 0.012
            q.append(single(base[j] + sum(size * math.sin(w[k] * t + tones[k][j]) for k in range(8))))
            v.append(single(sum(size * w[k] * math.cos(w[k] * t + tones[k][j]) for k in range(8))))
            a.append(single(sum(-size * w[k] ** 2 * math.sin(w[k] * t + tones[k][j]) for k in range(8))))
        s, c = [math.sin(x) for x in q], [math.cos(x) for x in q]
        x = (l1 * c[0] + l2 * c[1], l1 * s[0] + l2 * s[1])
        dx = (-l1 * s[0] * v[0] - l2 * s[1] * v[1], l1 * c[0] * v[0] + l2 * c[1] * v[1])
        ddx = (-l1 * (c[0] * v[0] ** 2 + s[0] * a[0]) - l2 * (c[1] * v[1] ** 2 + s[1] * a[1]),
               l1 * (-s[0] * v[0] ** 2 + c[0] * a[0]) + l2 * (-s[1] * v[1] ** 2 + c[1] * a[1]))
        force = [-(mass[k] * ddx[k] + damping * dx[k] + stiffness * (x[k] - rest[k])) for k in (0, 1)]
        motor = [1.1 * ddx[k] - force[k] for k in (0, 1)]
        torque = (-l1 * s[0] * motor[0] + l1 * c[0] * motor[1], -l2 * s[1] * motor[0] + l2 * c[1] * motor[1])
        rows.append((*q, *v, *a, *torque, sign * force[0], sign * force[1]))
        hand.append(x)
    columns = list(zip(*rows))
    return {name: (unit, columns[k]) for k, (name, unit) in enumerate(names.items())}, hand


def write_exam(path, trials, sides=("Right",), frames=8000, links=LINK, sign=-1.0, deflated=True):
    common = b""
    for side in sides:
        common += group(side.upper() + "_KINARM") + parameter("VERSION", "KINARM_EP_2.2") + parameter("IS_PRESENT", 1)
        common += parameter("L1_L", links[0]) + parameter("L2_L", links[1])
    common += group("EXPERIMENT") + parameter("TASK_PROTOCOL", "Multisine, relaxed") + parameter("TASK_PROGRAM_BUILD_TDK", "3.5.0")
    common += group("SUBJECT") + parameter("FIRST_NAME", "Erika") + parameter("DATE_OF_BIRTH", "1961-02-03")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED if deflated else zipfile.ZIP_STORED) as archive:
        archive.writestr("raw/common/parameters.bin", struct.pack("<i", 3) + common)
        for number in trials:
            folder = f"raw/03_{number:02}_01/"
            labels, positions = [], []
            for side in sides:
                signals, hand = arm(frames, number + len(side), sign=sign)
                for name, (unit, values) in signals.items():
                    labels.append(f"{side}_{name}")
                    archive.writestr(f"{folder}{side}_{name}.kinematics", signal(f"{side}_{name}", unit, values))
                positions.append(f"{side}_Hand")
                flat_hand = [part for place in hand for part in place]
                archive.writestr(f"{folder}{side}_Hand.position",
                                 struct.pack("<i", 1) + text(f"{side}_Hand") + text("") +
                                 struct.pack(f"<i{len(flat_hand)}f", frames, *flat_hand))
            header = struct.pack("<iiiiiif", 3, frames, len(labels), len(positions), 1, 0, 1000.0) + text("Musterfrau_Erika")
            header += b"".join(text(label) for label in labels + positions)
            archive.writestr(folder + "header.bin", header)
            archive.writestr(folder + "parameters.bin",
                             struct.pack("<i", 3) + group("TRIAL") + parameter("TRIAL_NUM", number) + parameter("TP", 3))
            archive.writestr(folder + "examevents.bin",
                             struct.pack("<ii", 3, 1) + text("Überraschung") + text("") + struct.pack("<f", 0.25))
    return path


class Kinarm(Case):
    def exam(self, trials=(1, 2, 3), **how):
        return write_exam(self.folder / "exam.kinarm", trials, **how)

    def test_info_lists_the_trials_and_shows_the_first(self):
        shown = self.mbk("info", self.exam()).out
        self.assertIn("3 trials", shown)
        for number in (1, 2, 3):
            self.assertRegex(shown, rf"{number} +TP 3\b.*\btrial {number}\b.*8\.000 s.*8000 frames")
        self.assertIn("Multisine, relaxed", shown)
        self.assertIn("Überraschung 0.25 s", shown)
        self.assertRegex(shown, r"hand_x +m ")
        self.assertRegex(" ".join(shown.split()), "sign .*force_x")
        for personal in ("Erika", "Musterfrau", "1961-02"):
            self.assertNotIn(personal, shown)

    def test_info_shows_one_trial(self):
        facts = self.mbk("info", "--json", "--trial", "2", self.exam()).json
        self.assertEqual(facts["inputs"][0]["trial"], "2")
        self.assertEqual(facts["metadata"]["TRIAL_TRIAL_NUM"], "2")
        self.assertEqual(facts["events"], [{"name": "Überraschung", "time_s": 0.25, "value": 0.0}])
        self.assertLessEqual({"hand_x", "hand_y", "force_x", "force_y", "acceleration_x", "joint_1", "torque_2"},
                             {channel["name"] for channel in facts["channels"]})

    def test_info_gives_every_trial_as_json(self):
        facts = self.mbk("info", "--json", self.exam()).json
        self.assertEqual([one["inputs"][0]["trial"] for one in facts["results"]], ["1", "2", "3"])

    def test_measure_takes_one_trial_or_all(self):
        exam = self.exam()
        one = self.mbk("measure", "--json", "--trial", "2", exam).json
        self.assertEqual(one["inputs"][0]["trial"], "2")
        self.assert_relative(one["model"]["M"], [[1.8, 0], [0, 1.5]], 0.01)
        self.assert_relative(one["model"]["B"], [[9, 0], [0, 9]], 0.01)
        self.assert_relative(one["model"]["K"], [[160, 0], [0, 160]], 0.01)
        all_of_them = self.mbk("measure", "--json", exam).json
        self.assertEqual(len(all_of_them["results"]), 3)
        self.assertEqual(all_of_them["summary"]["trials"], 3)
        self.assert_relative(all_of_them["summary"]["model"]["K"], [[160, 0], [0, 160]], 0.01)

    def test_the_sign_can_be_turned(self):
        exam = self.exam(trials=(1,), sign=1.0)
        facts = self.mbk("info", "--json", exam).json
        self.assertTrue(any("force_x" in note for note in facts["notes"]), facts["notes"])
        turned = self.mbk("info", "--json", "--channels", "x=hand_x,y=hand_y,Fx=-force_x,Fy=-force_y", exam).json
        ranges = [{c["name"]: c for c in doc["channels"]}["force_x"] for doc in (facts, turned)]
        self.assertEqual(ranges[0]["maximum"], -ranges[1]["minimum"])

    def test_both_arms_need_a_choice(self):
        exam = self.exam(trials=(1, 2), sides=("Right", "Left"), frames=2000)
        refused = self.mbk("measure", "--trial", "1", exam, code=2)
        for side in ("--side right", "--side left"):
            self.assertIn(side, refused.err)
            self.assertIn(side, " ".join(self.mbk("info", exam).out.split()))
        self.assertIn("2 trials", self.mbk("info", exam).out)
        left = self.mbk("info", "--json", "--trial", "1", "--side", "left", exam).json
        self.assertTrue(any("left" in note for note in left["notes"]))

    def test_an_arm_of_any_other_file_is_refused(self):
        table = self.file("table.csv", "time,x,F\n0,1,2\n0.001,1,2\n")
        self.assertIn("--side left", self.mbk("info", "--side", "left", table, code=2).err)

    def test_wrong_lengths_do_not_look_right(self):
        exam = self.exam(trials=(1,), links=(0.29, 0.26))
        self.assertIn("! ", self.mbk("info", exam).out)
        self.assertIn("hand_x", self.mbk("measure", exam, code=3).err)

    def test_convert_takes_one_trial_and_leaves_the_person_behind(self):
        exam = self.exam(trials=(1, 2))
        self.assertIn("--trial", self.mbk("convert", exam, self.folder / "all.csv", code=2).err)
        for name in ("one.csv", "one.h5", "one.mat"):
            out = self.folder / name
            self.mbk("convert", "--trial", "2", exam, out)
            for personal in (b"Erika", b"Musterfrau", b"1961-02"):
                self.assertFalse(personal in out.read_bytes(), name)
        signals, hand = arm(8000, 2 + len("Right"))
        lines = (self.folder / "one.csv").read_text().splitlines()
        head = next(k for k, line in enumerate(lines) if line.startswith("time"))
        names = lines[head].split(",")
        row = lines[head + 1 + 1234].split(",")
        place = next(k for k, name in enumerate(names) if name.startswith("joint_1"))
        self.assertEqual(float(row[place]), single(signals["L1Ang"][1][1234]))
        place = next(k for k, name in enumerate(names) if name.startswith("force_x"))
        self.assertEqual(float(row[place]), -single(signals["FS_ForceX"][1][1234]))

    def test_damage_is_an_error(self):
        whole = self.exam(trials=(1,), frames=500).read_bytes()
        for cut in (30, len(whole) // 2, len(whole) - 10):
            self.assertTrue(self.mbk("info", self.file("cut.kinarm", whole[:cut]), code=3).err)


if __name__ == "__main__":
    main()
