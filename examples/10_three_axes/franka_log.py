#!/usr/bin/env python3
"""Writes a log as libfranka's programs do, of a hand with known M, B and K that the robot moves in space.

usage: franka_log.py FILE
"""

import csv
import math
import random
import sys

RATE, DURATION, PERIOD = 1000, 30, 10  # Hz, s, s
M = ((1.3, -0.4, 0.1), (-0.4, 1.8, 0.2), (0.1, 0.2, 1.1))  # kg
B = ((8.0, -2.0, 0.5), (-2.0, 11.0, 1.0), (0.5, 1.0, 7.0))  # N·s/m
K = ((90.0, -25.0, 5.0), (-25.0, 140.0, 10.0), (5.0, 10.0, 70.0))  # N/m
X0 = (0.45, 0.02, 0.40)  # m
POSE = (1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0)  # tool down: the columns of its rotation, each followed by 0


def lines(axis, chance):
    """Frequency [rad/s], amplitude [m] and phase of the sines along one axis. No two axes share a frequency."""
    for k in range(3 + axis, 60, 3):
        yield 2 * math.pi * k / PERIOD, 0.008 / (1 + k / PERIOD), chance.uniform(0, 2 * math.pi)


def main(file):
    chance = random.Random(1)
    sines = [list(lines(axis, chance)) for axis in range(3)]
    with open(file, "w", newline="", encoding="utf-8") as out:
        log = csv.writer(out)
        log.writerow(["time", *(f"O_T_EE[{k}]" for k in range(16)), *(f"O_F_ext_hat_K[{k}]" for k in range(6))])
        for tick in range(RATE * DURATION):
            t = tick / RATE
            x = [sum(a * math.sin(w * t + p) for w, a, p in axis) for axis in sines]  # from X0
            v = [sum(a * w * math.cos(w * t + p) for w, a, p in axis) for axis in sines]
            acceleration = [sum(-a * w * w * math.sin(w * t + p) for w, a, p in axis) for axis in sines]
            # What the robot exerts on the hand: M a + B v + K (x - x0), with the noise of its estimate.
            force = [sum(M[i][j] * acceleration[j] + B[i][j] * v[j] + K[i][j] * x[j] for j in range(3)) +
                     chance.gauss(0, 0.05) for i in range(3)]
            log.writerow([123456 + tick, *POSE, *(f"{X0[i] + x[i]:.8f}" for i in range(3)), 1,
                          *(f"{one:.5f}" for one in force), 0, 0, 0])


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__))
