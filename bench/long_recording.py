#!/usr/bin/env python3
"""What does a long recording take? `mbk measure` of CSV files at 1 kHz, of a minute to five hours, in the page cache.

The files have seven columns (time, and hand, force and reference of two axes), numbers as Python writes them, and what
moves is known: a multisine with a period of 20 s against an inertia, a damping and a stiffness, with noise on the
force. Greatest memory is that which the system counts. Times are reported and never judged: the exit code is 0 unless
mbk fails or its M, B and K are not near the known ones.

usage: long_recording.py [--bin build/release/bin] [--runs 3] [--longest 300]
"""

import argparse
import json
import math
import multiprocessing
import pathlib
import random
import statistics
import sys
import tempfile

from many_files import HERE, run

RATE, PERIOD = 1000, 20  # [Hz], [s]
HARMONICS = (2, 4, 7, 10, 15, 19, 25, 31, 39, 47, 52, 60)  # of 1/PERIOD
AMPLITUDE, NOISE, QUANTUM = 0.001, 0.02, 2e-6  # [m] of each, [N], [m]
M = ((1.3, -0.9), (-0.9, 1.9))
B = ((5.8, -2.0), (-2.0, 10.6))
K = ((42.0, -20.0), (-30.0, 124.0))
HOME = (0.28, 0.02)  # [m]
NEAR = 0.02  # of each matrix's largest element


def motion():
    """One period of x, ẋ and ẍ along both axes."""
    random.seed(1)
    angles = [2 * math.pi * i / (RATE * PERIOD) for i in range(RATE * PERIOD)]
    moved = [[[0.0, 0.0] for _ in angles] for _ in range(3)]
    for axis in range(2):
        for harmonic in HARMONICS:
            phase, omega = random.uniform(0, 2 * math.pi), 2 * math.pi * harmonic / PERIOD
            for i, angle in enumerate(angles):
                c, s = math.cos(harmonic * angle + phase), math.sin(harmonic * angle + phase)
                moved[0][i][axis] += AMPLITUDE * c
                moved[1][i][axis] -= AMPLITUDE * omega * s
                moved[2][i][axis] -= AMPLITUDE * omega * omega * c
    return moved


def rows_without_time(periods):
    """So many periods, each with noise of its own, as text from the second column on."""
    times = lambda matrix, v: [row[0] * v[0] + row[1] * v[1] for row in matrix]
    rows = []
    x, v, a = motion()
    still = [[-m - b - k for m, b, k in zip(times(M, a[i]), times(B, v[i]), times(K, x[i]))] for i in range(len(x))]
    for _ in range(periods):
        for i, place in enumerate(x):
            reference = [HOME[k] + place[k] for k in range(2)]
            hand = [round(value / QUANTUM) * QUANTUM for value in reference]
            force = [value + random.gauss(0.0, NOISE) for value in still[i]]
            rows.append(",".join(map(repr, (*hand, *force, *reference))))
    return rows


def write(folder, lengths):
    """A file for each of these lengths [minutes], by a process of its own: what the system counts as the greatest memory
    of mbk begins with the memory of the process that starts it."""
    rows = rows_without_time(15)
    for minutes in lengths:
        with open(file_of(folder, minutes), "w", encoding="ascii") as out:
            out.write("time_s,hand_x_m,hand_y_m,force_x_N,force_y_N,reference_x_m,reference_y_m\n")
            for begin in range(0, minutes * 60 * RATE, len(rows)):
                here = range(begin, min(begin + len(rows), minutes * 60 * RATE))
                out.write("".join(f"{k / RATE!r},{rows[k - begin]}\n" for k in here))


def file_of(folder, minutes):
    return pathlib.Path(folder) / f"{minutes}.csv"


def largest_difference(model):
    worst = 0.0
    for name, true in (("M", M), ("B", B), ("K", K)):
        largest = max(abs(value) for row in true for value in row)
        worst = max(worst, max(abs(x - y) / largest for one, other in zip(model[name], true)
                               for x, y in zip(one, other)))
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=HERE.parent / "build/release/bin", help="folder of mbk")
    parser.add_argument("--runs", type=int, default=3, help="of each file (3)")
    parser.add_argument("--longest", type=int, default=300, help="minutes of the longest file (300)")
    arguments = parser.parse_args()
    mbk = arguments.bin / "mbk"
    if not mbk.exists():
        sys.exit(f"long_recording.py: {mbk} is not there; build first, or name its folder with --bin")
    worst = 0.0
    print(f"mbk measure, CSV of seven columns at {RATE} Hz; {arguments.runs} runs, medians\n")
    print(f"  {'':<14}{'MB':>8}{'wall s':>10}{'CPU s':>10}{'most MB':>10}")
    with tempfile.TemporaryDirectory() as name:
        writer = multiprocessing.Process(
            target=write, args=(name, [one for one in (1, 10, 60, 300) if one <= arguments.longest]))
        writer.start()
        writer.join()

        def row(title, minutes):
            nonlocal worst
            if minutes > arguments.longest:
                return
            path = file_of(name, minutes)
            runs = [run([mbk, "measure", path, "--json", "--quiet"]) for _ in range(arguments.runs)]
            worst = max(worst, largest_difference(json.loads(runs[0][0])["model"]))
            wall, cpu, most = (statistics.median(one[which] for one in runs) for which in (1, 2, 4))
            print(f"  {title:<14}{path.stat().st_size / 1e6:8.0f}{wall:10.2f}{cpu:10.2f}{most:10.0f}", flush=True)

        row("1 minute", 1)
        row("10 minutes", 10)
        row("60 minutes", 60)
        row("300 minutes", 300)
    print(f"\nM, B and K are right to {worst:.1e} of each matrix's largest element (limit {NEAR:g})")
    if not worst <= NEAR:
        sys.exit("long_recording.py: the answers are not near the known ones")


if __name__ == "__main__":
    main()
