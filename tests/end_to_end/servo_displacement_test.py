#!/usr/bin/env python3
"""Reaches of which some are displaced: from recordings with a trigger to the stiffness that mbk explore reads off."""

import math
import random

import mat_file
from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main

RATE, TRIGGER = 500, 0.3  # [Hz]; [s] after the reach begins
STIFFNESS = ((150.0, -55.0), (-75.0, 330.0))  # [N/m]
ROBOT_MASS = 0.5  # [kg]
OUT, HOLD, BACK, SIZE = 0.1, 0.1, 0.1, 0.008  # [s], [m]


def minimum_jerk(s):
    s = min(max(s, 0.0), 1.0)
    return s ** 3 * (10 - 15 * s + 6 * s * s), 60 * s - 180 * s * s + 120 * s ** 3


def displacement(t):
    return minimum_jerk(t / OUT)[0] - minimum_jerk((t - OUT - HOLD) / BACK)[0]


def reach(chance, angle, seen, noise):
    """Rows of place, force and reference from 0.1 s before a reach of 25 cm in about 0.6 s to 0.6 s after it; an angle
    displaces. `seen` is the share of the true stiffness that answers, as of a force sensor that is wrong."""
    length, duration, drift = (0.25 * chance.gauss(1, 0.05), 0.6 * chance.gauss(1, 0.04), chance.gauss(0, 0.005))
    force = [chance.gauss(0, noise) for _ in range(2)]
    rows = []
    for k in range(round(1.3 * RATE)):
        t = k / RATE - 0.1
        way, bend = minimum_jerk(t / duration)
        if not 0 <= t <= duration:
            bend = 0
        away = [0.0, 0.0]
        if angle is not None:
            away = [SIZE * displacement(t - TRIGGER) * part for part in (math.cos(angle), math.sin(angle))]
        force = [0.98 * f + math.sqrt(1 - 0.98 ** 2) * chance.gauss(0, noise) for f in force]
        pull = [seen * (row[0] * away[0] + row[1] * away[1]) for row in STIFFNESS]
        rows.append([drift * way + away[0], length * way + away[1],
                     ROBOT_MASS * drift * bend / duration ** 2 - pull[0] + force[0],
                     ROBOT_MASS * length * bend / duration ** 2 - pull[1] + force[1], *away])
    return rows


class ServoDisplacement(Case):
    def recorded(self, name="reaches", undisturbed=30, displaced=40, directions=8, noise=0.05, seen=1.0, seed=1,
                 trigger="trigger"):
        """One file of all reaches, one behind the other."""
        path = self.folder / f"{name}.mat"
        chance = random.Random(seed)
        angles = [None] * undisturbed + [2 * math.pi * k / directions for k in range(displaced)]
        rows, times = [], []
        for angle in angles:
            times.append(len(rows) / RATE + 0.1 + TRIGGER)
            rows += reach(chance, angle, seen, noise)
        columns = dict(zip(("hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y"), zip(*rows)))
        variables = {"time": [[k / RATE] for k in range(len(rows))]}
        variables.update({name: [[value] for value in column] for name, column in columns.items()})
        return mat_file.write(path, variables, more=mat_file.events(times, [trigger] * len(times)))

    def test_the_stiffness_of_a_hand_that_moves_comes_back(self):
        log = self.recorded()
        found = self.fine("explore", log, "--json").json
        part = found["servo_displacement"]
        self.assertEqual((part["undisturbed"], part["left_out"]), (30, 0))
        self.assertEqual(part["window_s"], [0.14, 0.2])
        own, mean = part["own_past"], part["mean_reach"]
        self.assertGreaterEqual(own["components"], 1)
        self.assertEqual(mean["components"], 0)
        self.assertLess(own["prediction_error"], 0.5 * mean["prediction_error"])
        stiffness = own["stiffness"]
        self.assertEqual((stiffness["displacements"], stiffness["directions"]), (40, 8))
        for row, truth_row in zip(range(2), STIFFNESS):
            for column, truth in zip(range(2), truth_row):
                low, high = stiffness["interval95"][row][column]
                self.assertLess(abs(stiffness["K"][row][column] - truth), 0.75 * (high - low))  # 3 standard errors
                self.assertLess(high - low, 80)
        self.assertLess(stiffness["relative_error"], mean["stiffness"]["relative_error"])
        self.assertIn("--only", " ".join(found["notes"]))  # and nothing else was explored
        self.assertNotIn("frequency_response", found)
        text = self.fine("explore", log).out
        self.assert_lines_fit(text)
        for words in ("30 undisturbed", "40 displaced", "8 directions", "8 mm", "140 ms", "200 ms",
                      "stiffness K", "ellipse"):
            self.assertIn(words, text)

    def test_another_event_and_window_may_be_named(self):
        log = self.recorded("start", trigger="go")
        self.assertNotIn("servo_displacement", self.mbk("explore", log, "--json", code=NOT_USABLE).json)
        self.refused(BAD_DATA, "explore", log, "--only", "servo-displacement", says="'trigger'")
        part = self.fine("explore", log, "--json", "--trigger", "go", "--plateau-from", "150").json["servo_displacement"]
        self.assertEqual((part["trigger"], part["window_s"]), ("go", [0.15, 0.2]))
        self.refused(WRONG_USAGE, "explore", log, "--trigger", "go", "--plateau-to", "900", says="900 ms")

    def test_recordings_of_one_reach_each_are_pooled(self):
        first = self.recorded("first", undisturbed=20, displaced=0)
        more = self.recorded("more", undisturbed=0, displaced=24, seed=2)
        part = self.fine("explore", first, more, "--json").json["servo_displacement"]
        self.assertEqual((part["undisturbed"], part["own_past"]["stiffness"]["displacements"]), (20, 24))

    def test_what_cannot_be_told_is_not_told(self):
        self.refused(BAD_DATA, "explore", self.recorded("few", undisturbed=5), says="undisturbed")
        self.refused(BAD_DATA, "explore", self.recorded("none", displaced=0), says="reach")
        self.refused(BAD_DATA, "explore", self.recorded("line", directions=2), says="line")

    def test_a_force_that_is_lost_in_noise_is_not_usable(self):
        found = self.mbk("explore", self.recorded("noisy", noise=6.0, displaced=16), "--json", code=NOT_USABLE).json
        self.assertIs(found["usable"], False)
        self.assertIs(found["servo_displacement"]["usable"], False)
        self.assertIn("motion-too-small", [warning["code"] for warning in found["warnings"]])


if __name__ == "__main__":
    main()
