#!/usr/bin/env python3
"""The pipeline alone, from arrays in memory to M, B and K, on one core: mbk against NumPy and SciPy.

Eight signals (x, its two derivatives and the force, two axes) of 50 s at 1 kHz through Savitzky-Golay (6, 101) and a
zero-phase Butterworth low-pass of order 5 at 5 Hz, then least squares on the first 40,000 samples: the published
procedure (Dyck 2013, appendix C). mbk does it sample for sample, and as in its default mode, where the low-pass goes
first and only every 20th row is evaluated. SciPy does it sample for sample.

For SciPy every way that a skilled user would try is timed (savgol_filter, convolve1d, oaconvolve and numpy.convolve
with weights of our own) and the fastest one counts. Programs take turns (A B A B ...), so that both meet the same
state of the machine, and ratios are taken pair by pair. Both must agree on M, B and K. Times are reported and never
judged.

usage: pipeline.py [--bin build/release/bin] [--turns 21]     with a Python that has NumPy and SciPy
"""

import os

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # one core for everyone, before NumPy starts

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

try:
    import numpy as np
    import scipy
    from scipy.io import loadmat
    from scipy.ndimage import convolve1d
    from scipy.signal import butter, oaconvolve, savgol_filter, sosfiltfilt
except ImportError:
    sys.exit("pipeline.py: this Python has no NumPy and SciPy, so there is nothing to compare with")

HERE = pathlib.Path(__file__).resolve().parent
RATE, BEGIN, END, IDENTIFY, ORDER, WINDOW, CUTOFF = 1000.0, 11999, 62000, 40000, 6, 101, 5.0
HALF = WINDOW // 2
AGREEMENT = 1e-9  # of M, B and K, relative to the largest element of each matrix


def weights(derivative):
    t = np.arange(-HALF, HALF + 1) / HALF
    fit = np.linalg.pinv(np.vander(t, ORDER + 1, increasing=True))
    return fit[derivative] * math.factorial(derivative) * (RATE / HALF) ** derivative


WEIGHTS = [weights(derivative)[::-1] for derivative in range(3)]
LOWPASS = butter(5, CUTOFF, fs=RATE, output="sos")


def by_savgol_filter(signals, derivative):
    return savgol_filter(signals, WINDOW, ORDER, deriv=derivative, delta=1.0 / RATE)[:, HALF:-HALF]


def by_convolve1d(signals, derivative):
    return convolve1d(signals, WEIGHTS[derivative])[:, HALF:-HALF]


def by_oaconvolve(signals, derivative):
    return oaconvolve(signals, WEIGHTS[derivative][None, :], mode="valid", axes=1)


def by_numpy_convolve(signals, derivative):
    return np.vstack([np.convolve(signal, WEIGHTS[derivative], "valid") for signal in signals])


def scipy_pipeline(position, force, smooth):
    start = time.process_time()
    signals = np.vstack([smooth(position, 2), smooth(position, 1), smooth(position, 0), smooth(force, 0)])
    signals = sosfiltfilt(LOWPASS, signals, padlen=15)
    filtered = time.process_time()
    Z = np.vstack([signals[:6, :IDENTIFY], np.ones(IDENTIFY)]).T
    P = np.linalg.lstsq(Z, -signals[6:, :IDENTIFY].T, rcond=None)[0]
    done = time.process_time()
    return {"filters_s": filtered - start, "all_s": done - start,
            "M": P[0:2].T.tolist(), "B": P[2:4].T.tolist(), "K": P[4:6].T.tolist()}


def largest_difference(a, b):
    return max(np.abs(np.subtract(a[k], b[k])).max() / np.abs(b[k]).max() for k in "MBK")


class Mbk:
    """bench_pipeline, which does one turn for each line that it is sent."""

    def __init__(self, program, log):
        self.process = subprocess.Popen([program, log], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def turn(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            sys.exit("pipeline.py: bench_pipeline ended")
        return json.loads(answer)

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def row(name, seconds):
    print(f"  {name:<44}" + "".join(f"{1e3 * f(seconds):10.2f}" for f in (min, statistics.median, max)))


def ratios(name, pairs):
    values = [b / a for a, b in pairs]
    print(f"  {name:<44}{min(values):10.1f}{statistics.median(values):10.1f}{max(values):10.1f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=HERE.parent / "build/release/bin", help="folder of the programs")
    parser.add_argument("--turns", type=int, default=21, help="of each (21)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "log.mat"
        subprocess.run([arguments.bin / "make_log", "--protocol", "sinusoidal", "--out", log], check=True,
                       stdout=subprocess.DEVNULL)
        logs = loadmat(log, variable_names=["logs"])["logs"][:, BEGIN + 1:END - 1]
        position, force = np.ascontiguousarray(logs[1:3]), np.ascontiguousarray(logs[9:11])
        ways = [by_savgol_filter, by_convolve1d, by_oaconvolve, by_numpy_convolve]
        trial = {way: min(scipy_pipeline(position, force, way)["filters_s"] for _ in range(4)) for way in ways}
        fastest = min(trial, key=trial.get)
        print(f"{END - BEGIN - 2} samples, {arguments.turns} turns, one core; ms of CPU\n")
        print("  filters of SciPy, least of 4: " +
              ", ".join(f"{way.__name__[3:]} {1e3 * seconds:.1f}" for way, seconds in trial.items()))
        print(f"  {fastest.__name__[3:]} goes on (NumPy {np.__version__}, SciPy {scipy.__version__})\n")

        mbk = Mbk(arguments.bin / "bench_pipeline", log)
        mbk.turn()
        ours, theirs = [], []
        for _ in range(arguments.turns):
            ours.append(mbk.turn())
            theirs.append(scipy_pipeline(position, force, fastest))
        mbk.end()

    print(f"  {'':<44}{'least':>10}{'median':>10}{'greatest':>10}")
    for name, of in (("mbk, sample for sample", "exact"), ("mbk, every 20th row", "default")):
        row(f"{name}: filters", [one[of]["filters_s"] for one in ours])
        row("  and least squares", [one[of]["all_s"] for one in ours])
    row("SciPy: filters", [one["filters_s"] for one in theirs])
    row("  and least squares", [one["all_s"] for one in theirs])
    print("\nSciPy over mbk, pair by pair\n")
    for part in ("filters", "all"):
        for name, of in (("sample for sample", "exact"), ("every 20th row", "default")):
            ratios(f"{part}, {name}", [(a[of][f"{part}_s"], b[f"{part}_s"]) for a, b in zip(ours, theirs)])

    difference = largest_difference(ours[-1]["exact"], theirs[-1])
    print(f"\nM, B and K of mbk, sample for sample, and of SciPy differ by at most {difference:.1e} of the largest element")
    print(f"every 20th row against every row: {largest_difference(ours[-1]['default'], ours[-1]['exact']):.1e}")
    if difference > (AGREEMENT if fastest is not by_savgol_filter else 1e-4):
        sys.exit("pipeline.py: the answers differ")


if __name__ == "__main__":
    main()
