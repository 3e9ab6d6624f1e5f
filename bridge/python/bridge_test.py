#!/usr/bin/env python3
"""Tests the Python module against the bytes of vectors.txt and the reactions of rules.txt."""
import pathlib
import unittest

import mbk_bridge
from mbk_bridge import Bridge, Command, Drive, Refused, Sample, State

HERE = pathlib.Path(__file__).resolve().parent.parent


def lines(name):
    for number, line in enumerate((HERE / name).read_text().splitlines(), start=1):
        if line and not line.startswith("#"):
            yield f"{name}:{number}: {line}", line.split()


class Vectors(unittest.TestCase):
    def test_datagrams_are_these_bytes(self):
        counts = {"command": 0, "state": 0, "refused": 0}
        for place, (kind, *words) in lines("vectors.txt"):
            counts[kind] += 1
            data = bytes.fromhex(words[-1])
            with self.subTest(place):
                if kind == "command":
                    whole = [int(one) for one in words[:4]]
                    made = Command(*whole, tuple(map(float, words[4:6])))
                    self.assertEqual(made.pack(), data)
                    self.assertEqual(repr(Command.unpack(data)), repr(made))  # NaN is not equal to itself
                elif kind == "state":
                    whole, numbers = [int(one) for one in words[:6]], [float(one) for one in words[6:15]]
                    made = State(*whole, numbers[0], *(tuple(numbers[k:k + 2]) for k in (1, 3, 5, 7)), int(words[15]))
                    self.assertEqual(made.pack(), data)
                    self.assertEqual(repr(State.unpack(data)), repr(made))
                else:
                    with self.assertRaises(Refused) as refused:
                        (Command if words[0] == "command" else State).unpack(data)
                    self.assertEqual(refused.exception.why, words[1])
        self.assertGreater(min(counts.values()), 4)


class Rules(unittest.TestCase):
    def test_a_robot_reacts_as_in_the_rules(self):
        bridge, drive, stop, steps = None, None, False, 0
        for place, words in lines("rules.txt"):
            kind, expected = words[0], words[words.index("->") + 1:] if "->" in words else []
            steps += 1
            with self.subTest(place):
                if kind == "begin":
                    bridge, drive = Bridge(int(words[1])), Drive(False, (0.0, 0.0), 0)
                elif kind in ("take", "damaged"):
                    made = Command(*(int(one) for one in words[3:7]), tuple(map(float, words[7:9]))).pack()
                    if kind == "damaged":
                        made = made[:-1] + bytes([made[-1] ^ 0x80])
                    self.assertEqual(bridge.take(made, int(words[2]), 1e-3 * int(words[1])).value, expected[0])
                elif kind == "drive":
                    stop = words[2] == "1"
                    drive = bridge.drive(1e-3 * int(words[1]), stop)
                    self.assertEqual((drive.enabled, *drive.command, drive.sequence),
                                     (expected[0] == "1", *map(float, expected[1:3]), int(expected[3])))
                else:
                    self.check_state(bridge, drive, stop, expected)
        self.assertGreater(steps, 60)

    def check_state(self, bridge, drive, stop, expected):
        sample = Sample(time_s=1.5, encoder=(1.0, 2.0), force=(3.0, 4.0), acceleration=(5.0, 6.0), motors_on=drive.enabled,
                        obeyed=drive.sequence, drives_measure=True, measured=(7.0, 8.0), fault=9,
                        stop_pressed=stop)
        data = bridge.state(sample)
        if expected == ["none"]:
            self.assertIsNone(data)
            return
        flags, session, rejected, sequence, answered = map(int, expected)
        more = {"measured": (7.0, 8.0), "fault": 9} if bridge.version == 2 else {}
        self.assertEqual(State.unpack(data), State(bridge.version, flags, session, rejected, sequence, answered, 1.5,
                                                   (1.0, 2.0), (3.0, 4.0), (5.0, 6.0), **more))

    def test_only_the_standard_library_is_imported(self):
        import sys
        imported = {line.split()[1] for line in pathlib.Path(mbk_bridge.__file__).read_text().splitlines()
                    if line.startswith(("import ", "from "))}
        self.assertLessEqual(imported, sys.stdlib_module_names)


if __name__ == "__main__":
    unittest.main()
