#!/usr/bin/env python3
"""mbk tf: from a file to a transfer function, and what it refuses."""

import math
import random

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main

W, ZETA, GAIN = 2 * math.pi * 1.5, 0.2, 4.0  # GAIN W²/(s² + 2 ZETA W s + W²)
STEP = 0.01


def oscillator(noise=0.02, seed=1, samples=3000):
    """Rows time, u, y: u is held, and between its jumps the answer is that of the differential equation."""
    chance = random.Random(seed)
    y = v = u = 0.0
    rows = []
    fine = 20
    for i in range(samples):
        last, u = u, (chance.choice((-1.0, 1.0)) if i % 12 == 0 else u)
        for k in range(fine if i else 0):  # a straight line from the last u to this one
            at = last + (u - last) * (k + 0.5) / fine
            v += STEP / fine * (GAIN * W * W * at - 2 * ZETA * W * v - W * W * y)
            y += STEP / fine * v
        rows.append((i * STEP, u, y + noise * chance.gauss(0, 1)))
    return rows


class TransferFunction(Case):
    def csv(self, rows, header="time,force,motion"):
        lines = [header] + [",".join(f"{value:.12g}" for value in row) for row in rows]
        return self.file("signals.csv", "\n".join(lines) + "\n")

    def test_comes_back_with_intervals_by_names_and_by_numbers(self):
        file = self.csv(oscillator())
        found = self.fine("tf", file, "--input", "force", "--output", "motion", "--poles", "2", "--zeros", "0",
                          "--json").json
        self.assertEqual((found["schema"], found["method"]), ("mbk.tf/1", "srivc"))
        pole, = found["poles"]
        self.assertAlmostEqual(pole["frequency_hz"], 1.5, delta=0.02)
        self.assertAlmostEqual(pole["damping"], ZETA, delta=0.02)
        self.assertAlmostEqual(found["gain"], GAIN, delta=0.1)
        self.assertGreater(found["fit"]["R2_held_back"], 0.99)
        self.assertEqual(len(found["numerator"]), 1)
        self.assertEqual(found["denominator"][0], 1)
        by_number = self.fine("tf", file, "--input", "2", "--output", "3", "--poles", "2", "--zeros", "0", "--json")
        self.assertEqual(by_number.json["poles"], found["poles"])

    def test_text_says_what_was_found(self):
        ran = self.fine("tf", self.csv(oscillator()), "--input", "force", "--output", "motion", "--orders", "1:3")
        for words in ("G(s) =", "pole pair", "chosen", "held back", "YIC"):
            self.assertIn(words, ran.out)

    def test_the_truth_is_chosen_from_a_table_of_orders(self):
        found = self.fine("tf", self.csv(oscillator(0.2)), "--input", "force", "--output", "motion", "--orders",
                          "1/0,2/0,2/1,3/1", "--json").json
        chosen, = [order for order in found["orders"] if order["chosen"]]
        self.assertEqual((chosen["poles"], chosen["zeros"]), (2, 0))

    def test_discrete_models_come_back_in_hertz_too(self):
        file = self.csv(oscillator(0.2))
        signals = ("--input", "force", "--output", "motion", "--poles", "2", "--zeros", "2")
        for method in ("oe", "bj"):
            with self.subTest(method=method):
                found = self.fine("tf", file, *signals, "--method", method, "--json").json
                self.assertEqual((found["schema"], found["method"], found["variable"]), ("mbk.tf/1", method, "q^-1"))
                self.assertAlmostEqual(found["sample_time"], STEP)
                self.assertEqual(found["denominator"][0], 1)
                pole, = found["poles"]
                self.assertAlmostEqual(pole["frequency_hz"], 1.5, delta=0.02)
                self.assertAlmostEqual(pole["damping"], ZETA, delta=0.02)
                self.assertAlmostEqual(found["gain"], GAIN, delta=0.1)
                self.assertGreater(len({start["made_by"] for start in found["starts"]}), 3)
        text = self.fine("tf", file, *signals, "--method", "oe", "--sample-rate", "50").out
        for words in ("G(q) =", "q^-1", "from 100 to 50 Hz", "output error"):
            self.assertIn(words, text)
        every = self.fine("tf", file, *signals, "--method", "oe", "--sample-rate", "recorded", "--json").json
        self.assertNotIn("recorded_rate_hz", every)

    def test_a_discrete_model_needs_an_even_clock(self):
        rows = [(t + (0.004 if i % 7 == 0 else 0.0), u, y) for i, (t, u, y) in enumerate(oscillator(samples=400))]
        self.refused(WRONG_USAGE, "tf", self.csv(rows), "--input", "force", "--output", "motion", "--poles", "2",
                     "--method", "oe", says="even clock")

    def test_an_unstable_system_is_refused(self):
        rows, y = [], 0.0
        for t, u, _ in oscillator(0.0):
            y += STEP * (0.3 * y + u)
            rows.append((t, u, y))
        for method in ("srivc", "oe"):
            self.refused(NOT_USABLE, "tf", self.csv(rows), "--input", "force", "--output", "motion", "--poles", "1",
                         "--zeros", "0", "--method", method, says="unstable")

    def test_wrong_words_are_refused_in_one_line(self):
        file = self.csv(oscillator(samples=200))
        signals = ("--input", "force", "--output", "motion")
        for options, says in ((("--poles", "2", "--zeros", "3"), "3 zeros"), ((), "--poles"),
                              (("--orders", "3-4"), "--orders"), (("--orders", "5:2"), "--orders"),
                              (("--orders", "1:2", "--poles", "2"), "--orders"),
                              (("--poles", "2", "--method", "clsrivc"), "--reference"),
                              (("--poles", "2", "--delay", "soon"), "'soon'"),
                              (("--poles", "2", "--delay", "-1"), "--delay"),
                              (("--poles", "2", "--method", "oe", "--delay", "0.013"), "whole number"),
                              (("--poles", "2", "--sample-rate", "fast"), "'fast'"),
                              (("--poles", "2", "--sample-rate", "0"), "--sample-rate"),
                              (("--poles", "2", "--sample-rate", "400"), "400 Hz")):
            with self.subTest(options=options):
                self.refused(WRONG_USAGE, "tf", file, *signals, *options, says=says)
        self.refused(BAD_DATA, "tf", file, "--input", "nothing", "--output", "motion", "--poles", "1", says="nothing")
        self.refused(BAD_DATA, "tf", file, *signals, "--poles", "1", "--from", "50", says="--from")

    def test_a_constant_input_is_refused(self):
        rows = [(t, 1.0, y) for t, _, y in oscillator(samples=300)]
        self.refused(BAD_DATA, "tf", self.csv(rows), "--input", "force", "--output", "motion", "--poles", "1",
                     says="constant")


if __name__ == "__main__":
    main()
