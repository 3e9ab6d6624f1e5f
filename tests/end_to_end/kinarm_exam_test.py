#!/usr/bin/env python3
"""Exams of known truth (tests/kinarm/make_exam.py, which knows no reader) through mbk: every sample to the bit, events,
trials, the arm that was put in, and which way the force counts."""

import pathlib
import sys
import unittest

from command import Case, main

try:
    import h5py
    import numpy
    sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "kinarm"))
    import make_exam
except ImportError:
    h5py = numpy = make_exam = None

#: What one of its numbers may differ by where it is not stored, but computed from others that were rounded to 24 bits.
ROUNDED = 2e-6


@unittest.skipIf(make_exam is None, "NumPy or h5py is not there")
class Exams(Case):
    def exam(self, name, **options):
        path = self.folder / name
        return path, make_exam.make_exam(path, **options)

    def convert(self, path, side, trial, **channels):
        """Two arrays of the exam, as the channels `input` and `output`, which may be anything."""
        out = self.folder / "two.h5"
        entries = ",".join(f"{channel}={name}" for channel, name in channels.items())
        self.mbk("convert", path, out, "--side", side, "--trial", trial, "--channels", entries, "--overwrite", "--quiet")
        with h5py.File(out) as file:
            return {name: file["channels"][channel][:] for channel, name in channels.items()}

    def check_samples(self, path, expected, k, side, without):
        """Every channel of trial k, two at a time; not those that end in `without`."""
        stored = {}
        for key in expected:
            trial, _, label = key.partition("/")
            values = expected[key]
            if trial != str(k) or values.dtype != numpy.float32 or (without and label.endswith(without)):
                continue
            if values.ndim == 1:
                stored[label] = values
            else:
                if side == "left" and f"{k}/Left_Hand" not in expected:  # without a right arm that is whose hand it is
                    label = "Left_Hand"
                stored[f"{label}.x"], stored[f"{label}.y"] = values[:, 0], values[:, 1]
        labels = sorted(stored)
        self.assertGreaterEqual(len(labels), 20)
        number = int(expected[f"{k}/number"])
        for pair in zip(labels[::2], labels[1::2] + labels[:1]):
            read = self.convert(path, side, number, **dict(zip(("input", "output"), pair)))
            for label in pair:
                with self.subTest(label):
                    want = stored[label]
                    if label.endswith("FS_Status"):
                        # Where they are no number as a float, a C3D file does not keep which.
                        words = want.view(numpy.uint32).astype(float)
                        kept = numpy.isnan(want) if path.suffix == ".zip" else numpy.zeros(len(want), bool)
                        self.assertTrue((read[label][~kept] == words[~kept]).all())
                    else:
                        self.assertEqual(read[label].astype(numpy.float32).tobytes(), want.tobytes())
                        self.assertTrue((read[label] == want.astype(float)).all())

    def check_events(self, path, expected, k, side):
        document = self.mbk("info", "--json", path, "--side", side, "--trial", int(expected[f"{k}/number"])).json
        events = [(event["name"], event["time_s"]) for event in document["events"]]
        want = list(zip(map(str, expected[f"{k}/event_labels"]), map(float, expected[f"{k}/event_times"])))
        self.assertEqual([name for name, _ in events], [name for name, _ in want])
        for (_, time), (_, right) in zip(events, want):
            self.assertAlmostEqual(time, right, delta=1e-6)
        self.assertEqual(document["samples"], int(sum(expected[f"{k}/parts"])))

    def check_hand(self, path, expected, k, side):
        """The hand by the geometry; where it counts from is the robot's own."""
        out = self.folder / "hand.h5"
        self.mbk("convert", path, out, "--side", side, "--trial", int(expected[f"{k}/number"]), "--overwrite", "--quiet")
        with h5py.File(out) as file:
            hand = numpy.column_stack([file["channels/hand_x"][:], file["channels/hand_y"][:]])
        want = expected[f"{k}/{side}/position"]
        self.assertLess(abs((hand - hand[0]) - (want - want[0])).max(), ROUNDED)

    def check(self, name, side, without="", **options):
        path, expected = self.exam(name, arm=side, frames=1000, **options)
        trials = int(expected["trials"])
        for k in range(trials):
            self.check_events(path, expected, k, side)
            self.check_hand(path, expected, k, side)
        self.check_samples(path, expected, trials - 1, side, without)
        return path, expected

    def test_binary_exam_of_an_end_point_robot(self):
        self.check("a.kinarm", "right", robot="endpoint", seed=1, split={2: 3})

    def test_c3d_exam_of_an_exoskeleton(self):
        self.check("b.zip", "left", robot="exoskeleton", seed=2, split={3: 2})

    def test_binary_exam_of_the_left_arm_alone(self):
        self.check("c.kinarm", "left", robot="endpoint", seed=3, trials=2, other="absent", split_numbers="same")

    def test_c3d_exam_of_before_the_torque_was_mended(self):
        path, _ = self.check("d.zip", "right", without="FS_TorqueX", robot="endpoint", seed=4, trials=2, tdk="3.4.1", two_rows=False)
        self.assertIn("TorqueX", self.mbk("info", path, "--side", "right").out)

    def test_the_arm_is_found_whichever_way_the_sensor_counts(self):
        for sign in (1, -1):
            for name in ("e.kinarm", "e.zip"):
                path, expected = self.exam(name, seed=5, frames=3000, trials=2, force_sign=sign)
                for result in self.mbk("measure", "--json", "--quiet", path, "--side", "right").json["results"]:
                    for symbol in "MBK":
                        self.assert_relative(result["model"][symbol], expected[f"right/{symbol}"].tolist(), 1e-3)

    def test_who_the_person_is_stays_in_the_exam(self):
        path, _ = self.exam("f.kinarm", seed=6, trials=1)
        out = self.folder / "f.h5"
        said = self.mbk("convert", path, out, "--side", "right").err
        self.assertIn("participant", said)
        written = out.read_bytes()
        for text in make_exam.PERSONAL:
            self.assertNotIn(text.encode(), written)
            self.assertNotIn(text, said)


if __name__ == "__main__":
    main()
