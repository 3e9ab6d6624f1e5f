#!/usr/bin/env python3
"""What make_exam.py writes has the structure of an exam, holds the numbers that it says, and keeps to its physics."""

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

try:
    import numpy as np
except ImportError:
    print("NumPy is not installed", file=sys.stderr)
    sys.exit(77)

import make_exam


class Bytes:
    """A file that is read from its beginning."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    def string(self):
        units = self.take("i")
        self.at += 2 * units
        return self.data[self.at - 2 * units:self.at].decode("utf-16-le")

    def bits(self, count):
        """float32 by their bits."""
        self.at += 4 * count
        return np.frombuffer(self.data[self.at - 4 * count:self.at], dtype="<u4")

    def ended(self):
        return self.at == len(self.data)


def parameters_of(data):
    """{group: {name: [values]}} of a parameters.bin."""
    file, groups, group = Bytes(data), {}, None
    file.take("i")
    while not file.ended():
        kind = file.take("i")
        if kind == 0:
            break
        name, _ = file.string(), file.string()
        if kind == 1:
            group = groups.setdefault(name, {})
            continue
        datatype, count = file.take("2i")
        read = {0: file.string, 1: lambda: file.take("B"), 2: lambda: file.take("i"), 3: lambda: file.take("f")}[datatype]
        group[name] = [read() for _ in range(count)]
    assert file.ended()
    return groups


def c3d_of(data):
    """({group: {name: array or texts}}, header, data as bits of float32) of a C3D file of Intel reals."""
    header = struct.unpack_from("<BBHHHHHfHHf", data)
    at, names, groups = 512 * (header[0] - 1) + 4, {}, {}
    records = []
    while data[at]:
        length, group = struct.unpack_from("bb", data, at)
        name = data[at + 2:at + 2 + length].decode()
        place = at + 2 + length
        step = struct.unpack_from("<h", data, place)[0]
        records.append((group, name, place + 2))
        at = place + step
    for group, name, _ in records:
        if group < 0:
            names[-group] = groups.setdefault(name, {})
    for group, name, place in records:
        if group < 0:
            continue
        kind, rank = struct.unpack_from("bB", data, place)
        dimensions = list(data[place + 2:place + 2 + rank])
        count = int(np.prod(dimensions)) if dimensions else 1
        form = {-1: "S1", 1: "u1", 2: "<i2", 4: "<f4"}[kind]
        values = np.frombuffer(data, form, count, place + 2 + rank)
        if kind == -1:
            raw = values.tobytes()
            names[group][name] = [raw[i:i + dimensions[0]].rstrip().decode() for i in range(0, len(raw), dimensions[0])]
        else:
            names[group][name] = values.reshape(dimensions, order="F")
    start = 512 * (header[8] - 1)
    return groups, header, np.frombuffer(data[start:], "<u4")


class Exam:
    """Files of an exam by their names, and what is expected of them."""

    def __init__(self, ending, **options):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "exam" + ending)
            make_exam.make_exam(path, **options)
            with zipfile.ZipFile(path) as archive:
                self.files = {name: archive.read(name) for name in archive.namelist()}
            with np.load(str(path) + ".expected.npz", allow_pickle=False) as expected:
                self.expected = dict(expected)
        self.folders = sorted({name.split("/")[1] for name in self.files if name.startswith("raw/")} - {"common"})


class Kinarm(unittest.TestCase):
    def test_every_part_says_what_it_holds_and_its_samples_are_those_expected_to_the_bit(self):
        exam = Exam(".kinarm", split={2: 3}, frames=700)
        parts = {}
        for folder in exam.folders:
            parameters = parameters_of(exam.files[f"raw/{folder}/parameters.bin"])
            parts[parameters["TRIAL"]["TRIAL_NUM"][0]] = folder, parameters["TRIAL"]["BREAK_ID"][0]
        self.assertEqual([parts[number][1] for number in sorted(parts)], [0, 1, 2, 3, 0])
        groups = [[1], [2, 3, 4], [5]]
        for k, numbers in enumerate(groups):
            start = 0
            for number, frames_expected in zip(numbers, exam.expected[f"{k}/parts"]):
                folder = f"raw/{parts[number][0]}/"
                header = Bytes(exam.files[folder + "header.bin"])
                version, frames, kinematics, positions, events, acks = header.take("6i")
                self.assertEqual((version, frames), (3, frames_expected))
                self.assertEqual(header.take("f"), 1000.0)
                header.string()
                labels = [header.string() for _ in range(kinematics)]
                hands = [header.string() for _ in range(positions)]
                self.assertTrue(header.ended())
                self.assertEqual(hands, ["Right_Hand", "Left_Hand"])
                for label in labels + hands:
                    width = 2 if label in hands else 1
                    file = Bytes(exam.files[folder + label + (".position" if width == 2 else ".kinematics")])
                    self.assertEqual(file.take("i"), 1)
                    self.assertEqual(file.string(), label)
                    for _ in range(1 if width == 2 else 2):
                        file.string()
                    self.assertEqual(file.take("i"), frames)
                    bits = file.bits(width * frames)
                    self.assertTrue(file.ended())
                    cut = exam.expected[f"{k}/{label}"][start:start + frames].astype("<f4").tobytes()
                    self.assertEqual(bits.tobytes(), cut, label)
                self.assertEqual(struct.unpack_from("<2i", exam.files[folder + "videoack.bin"]), (3, acks))
                self.assertEqual(struct.unpack_from("<2i", exam.files[folder + "examevents.bin"]), (3, events))
                start += frames
            self.assertEqual(start, 700)

    def test_events_of_split_trials_are_moved_by_the_frames_before(self):
        exam, whole = Exam(".kinarm", split={1: 3}), Exam(".kinarm")
        self.assertEqual(list(exam.expected["0/event_labels"]), list(make_exam.EVENTS))
        np.testing.assert_allclose(exam.expected["0/event_times"], whole.expected["0/event_times"], atol=1e-6)
        found = {}
        for folder in exam.folders:
            parameters = parameters_of(exam.files[f"raw/{folder}/parameters.bin"])
            file = Bytes(exam.files[f"raw/{folder}/examevents.bin"])
            _, count = file.take("2i")
            for _ in range(count):
                label, _ = file.string(), file.string()
                found.setdefault(label, []).append((parameters["TRIAL"]["TRIAL_NUM"][0], file.take("f")))
            self.assertTrue(file.ended())
        self.assertEqual(set(found), set(make_exam.EVENTS))
        starts = np.concatenate([[0], np.cumsum(exam.expected["0/parts"])]) / 1000.0
        for label, at in zip(exam.expected["0/event_labels"], exam.expected["0/event_times"]):
            part, time = min(found[label])
            self.assertAlmostEqual(starts[part - 1] + time, at, places=12)

    def test_the_exam_has_its_groups_and_the_person(self):
        groups = parameters_of(Exam(".kinarm").files["raw/common/parameters.bin"])
        self.assertLess({"EXPERIMENT", "CALIBRATION", "RIGHT_KINARM", "LEFT_KINARM", "SUBJECT", "TARGET_TABLE"}, set(groups))
        self.assertEqual(groups["SUBJECT"]["NAME"], ["Erika Mustermann"])
        self.assertEqual(groups["RIGHT_KINARM"]["FLAGS"], [1, 0, 255])
        self.assertEqual(groups["LOAD_TABLE"]["USED"], [0])

    def test_without_a_right_robot_the_left_hand_has_the_name_of_the_right(self):
        exam = Exam(".kinarm", arm="left", other="absent")
        self.assertEqual(parameters_of(exam.files["raw/common/parameters.bin"])["RIGHT_KINARM"]["IS_PRESENT"], [0])
        self.assertIn(f"raw/{exam.folders[0]}/Right_Hand.position", exam.files)
        self.assertNotIn("right/M", exam.expected)
        np.testing.assert_allclose(exam.expected["0/Right_Hand"], exam.expected["0/left/position"], atol=1e-7)

    def test_an_old_build_has_a_wrong_torque(self):
        old, new = Exam(".kinarm", tdk=None), Exam(".kinarm")
        self.assertNotIn("TASK_PROGRAM_BUILD_TDK", parameters_of(old.files["raw/common/parameters.bin"])["EXPERIMENT"])
        self.assertGreater(np.abs(old.expected["0/Right_FS_TorqueX"] - new.expected["0/Right_FS_TorqueX"]).max(), 1e-3)
        np.testing.assert_array_equal(old.expected["0/Right_FS_TorqueY"], new.expected["0/Right_FS_TorqueY"])


class C3d(unittest.TestCase):
    def test_its_samples_are_those_expected_to_the_bit(self):
        exam = Exam(".zip", trials=2, robot="exoskeleton", split={2: 2})
        self.assertIn("raw/common.c3d", exam.files)
        parts = {}
        for name in exam.folders:
            if name != "common.c3d":
                groups, header, data = c3d_of(exam.files["raw/" + name])
                parts[int(groups["TRIAL"]["TRIAL_NUM"][0])] = groups, header, data
        self.assertEqual([int(parts[number][0]["TRIAL"]["BREAK_ID"][0]) for number in (1, 2, 3)], [0, 1, 2])
        start = 0
        for k, number in ((0, 1), (1, 2), (1, 3)):
            groups, header, data = parts[number]
            frames, hands, channels = header[5], groups["POINT"]["LABELS"], groups["ANALOG"]["LABELS"]
            start = 0 if number < 3 else start
            self.assertEqual((header[2], header[3]), (len(hands), len(channels)))
            self.assertEqual(int(groups["POINT"]["DATA_START"][0]), header[8])
            table = data.reshape(frames, 4 * len(hands) + len(channels))
            for h, hand in enumerate(hands):
                expected = exam.expected[f"{k}/{hand}"][start:start + frames]
                self.assertEqual(table[:, 4 * h:4 * h + 2].tobytes(), expected.tobytes())
            for c, channel in enumerate(channels):
                expected = exam.expected[f"{k}/{channel}"][start:start + frames]
                self.assertEqual(table[:, 4 * len(hands) + c].tobytes(), expected.tobytes(), channel)
            start += frames

    def test_events_have_times_in_the_second_of_two_rows_or_in_one(self):
        for two_rows in (True, False):
            exam = Exam(".zip", trials=1, two_rows=two_rows)
            groups, _, _ = c3d_of(exam.files["raw/" + [name for name in exam.folders if name != "common.c3d"][0]])
            times = groups["EVENTS"]["TIMES"]
            self.assertEqual(groups["EVENTS"]["LABELS"], list(make_exam.EVENTS))
            np.testing.assert_array_equal(times[1] if two_rows else times, exam.expected["0/event_times"].astype("<f4"))

    def test_the_common_file_has_groups_and_no_data(self):
        groups, header, data = c3d_of(Exam(".zip").files["raw/common.c3d"])
        self.assertEqual((header[2], header[3], header[5], len(data)), (0, 0, 0, 0))
        self.assertEqual(groups["SUBJECT"]["NAME"], ["Erika Mustermann"])
        self.assertAlmostEqual(float(groups["CALIBRATION"]["LEFT_L1"][0]), 0.21, places=6)

    def test_more_than_65535_frames_are_told_by_a_parameter(self):
        exam = Exam(".zip", trials=1, frames=70000, other="absent")
        groups, header, data = c3d_of(exam.files["raw/" + [name for name in exam.folders if name != "common.c3d"][0]])
        self.assertEqual((header[5], float(groups["POINT"]["LONG_FRAMES"][0])), (65535, 70000.0))
        self.assertEqual(len(data), 70000 * (4 + len(groups["ANALOG"]["LABELS"])))


class Physics(unittest.TestCase):
    def test_derivatives_are_those_of_the_angles_and_of_the_hand(self):
        for robot in ("endpoint", "exoskeleton"):
            exam = Exam(".kinarm", robot=robot, trials=1, frames=2000)
            of = lambda name: exam.expected["0/" + name].astype(float)
            for arm in make_exam.ARMS:
                for pair in (("L1Ang", "L1Vel"), ("L2Ang", "L2Vel"), ("L1Vel", "L1Acc"), ("L2Vel", "L2Acc")):
                    slope = np.gradient(of(f"{arm}_{pair[0]}"), 1e-3)[1:-1]
                    # central differences are off by ω²h²/6 of the slope, and by the rounding of float32 over 2h
                    np.testing.assert_allclose(slope, of(f"{arm}_{pair[1]}")[1:-1], atol=1e-3)
                side = arm.lower() + "/"
                for low, high in (("position", "velocity"), ("velocity", "acceleration")):
                    np.testing.assert_allclose(np.gradient(of(side + low), 1e-3, axis=0)[1:-1], of(side + high)[1:-1],
                                               atol=2e-4)
                L1, L2, p = (float(exam.expected[side + name]) for name in ("link1", "link2", "pointer"))
                q1, q2, w1, w2 = (of(f"{arm}_{name}") for name in ("L1Ang", "L2Ang", "L1Vel", "L2Vel"))
                s, c = np.cos(q2), -np.sin(q2)
                by_joints = np.stack([-L1 * np.sin(q1) * w1 - L2 * np.sin(q2) * w2 - p * s * w2,
                                      L1 * np.cos(q1) * w1 + L2 * np.cos(q2) * w2 + p * c * w2], axis=1)
                np.testing.assert_allclose(by_joints, of(side + "velocity"), atol=1e-6)

    def test_the_pointer_turns_to_the_other_side_on_the_left(self):
        expected = Exam(".kinarm", robot="exoskeleton", trials=1).expected
        self.assertGreater(expected["right/pointer"], 0.0)
        self.assertEqual(expected["left/pointer"], -expected["right/pointer"])

    def test_least_squares_finds_the_impedance_in_force_and_motion(self):
        for sign in (1, -1):
            expected = Exam(".kinarm", trials=1, frames=20000, force_sign=sign).expected
            columns = [expected["0/right/" + name] for name in ("acceleration", "velocity", "position")]
            rows = np.hstack([*columns, np.ones((20000, 1))])
            force = np.stack([expected["0/Right_FS_Force" + axis].astype(float) for axis in "XY"], axis=1)
            found = np.linalg.lstsq(rows, -sign * force, rcond=None)[0]
            for k, name in enumerate("MBK"):
                np.testing.assert_allclose(found[2 * k:2 * k + 2].T, expected["right/" + name], rtol=1e-3, atol=1e-3)

    def test_motor_torques_do_the_work_that_arm_friction_and_inertia_take(self):
        expected = Exam(".kinarm", trials=1, frames=5000).expected
        of = lambda name: expected["0/Right_" + name].astype(float)
        robot = make_exam.Robot("endpoint", "Right")
        kinetic = (0.5 * robot.inertia1 * of("L1Vel")**2 + 0.5 * robot.inertia2 * of("L2Vel")**2 +
                   robot.coupling * np.cos(of("L2Ang") - of("L1Ang")) * of("L1Vel") * of("L2Vel"))
        force = np.stack([of("FS_ForceX"), of("FS_ForceY")], axis=1)
        power = (of("M1TorCMD") * of("L1Vel") + of("M2TorCMD") * of("L2Vel") +
                 (force * expected["0/right/velocity"]).sum(axis=1) -
                 robot.friction * (of("L1Vel")**2 + of("L2Vel")**2))
        work = 1e-3 * np.concatenate([[0], np.cumsum(0.5 * (power[1:] + power[:-1]))])
        np.testing.assert_allclose(work, kinetic - kinetic[0], atol=1e-5)
        self.assertGreater(kinetic.max(), 1e-3)


class CommandLine(unittest.TestCase):
    def test_equal_seeds_give_equal_exams(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, seed in (("a.kinarm", "4"), ("b.kinarm", "4"), ("c.kinarm", "5")):
                subprocess.run([sys.executable, "-B", make_exam.__file__, pathlib.Path(folder, name), "--seed", seed,
                                "--split", "1:2", "--trials", "1"], check=True)
            files = []
            for name in ("a.kinarm", "b.kinarm", "c.kinarm"):
                with zipfile.ZipFile(pathlib.Path(folder, name)) as archive:
                    files.append({one: archive.read(one) for one in archive.namelist()})
        self.assertEqual(files[0], files[1])
        self.assertNotEqual(files[0], files[2])


if __name__ == "__main__":
    unittest.main()
