#!/usr/bin/env python3
"""SRIVC of 50,000 samples and 4 poles: mbk, and the same with scipy.signal.lfilter; both take turns."""

import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before NumPy is loaded
import numpy
from scipy import signal

STEP, POLES, ZEROS = 0.01, 4, 1
TRUTH = ([-6400.0, 1600.0], [1.0, 5.0, 408.0, 416.0, 1600.0])  # Rao & Garnier 2002


def srivc(u, y, pole=20.0, tolerance=1e-4):
    """As a skilled user would write it: one discretisation for the whole bank of filters s^k/A and B/A, one lfilter for
    each signal and derivative, regressors as contiguous rows in memory that is there before. The numerator and
    denominator, and how many passes."""
    numerators = numpy.eye(POLES + 1)  # s^n … 1
    denominator, theta = numpy.poly([-pole] * POLES), None
    regressors, instruments = numpy.empty((2, POLES + ZEROS + 1, u.size))
    for passes in range(1, 100):
        if theta is not None:
            numerators = numpy.vstack([numerators[:POLES + 1], numpy.r_[numpy.zeros(POLES - ZEROS), theta[POLES:]]])
        bank, a, _ = signal.cont2discrete((numerators, denominator), STEP, "foh")
        highest = signal.lfilter(bank[0], a, y)
        for k in range(POLES):
            regressors[k] = signal.lfilter(bank[k + 1], a, y)
        regressors[:POLES] *= -1.0
        for k in range(ZEROS + 1):
            regressors[POLES + k] = signal.lfilter(bank[POLES - ZEROS + k], a, u)
        chosen = regressors
        if theta is not None:
            clean = signal.lfilter(bank[POLES + 1], a, u)
            for k in range(POLES):
                instruments[k] = signal.lfilter(bank[k + 1], a, clean)
            instruments[:POLES] *= -1.0
            instruments[POLES:] = regressors[POLES:]
            chosen = instruments
        old, theta = theta, numpy.linalg.solve(chosen @ regressors.T, chosen @ highest)
        roots = numpy.roots(numpy.r_[1.0, theta[:POLES]])
        if numpy.any(roots.real > 0.0):
            theta[:POLES] = numpy.real(numpy.poly(-numpy.abs(roots.real) + 1j * roots.imag))[1:]
        denominator = numpy.r_[1.0, theta[:POLES]]
        if old is not None and numpy.max(numpy.abs(theta - old) / numpy.abs(theta)) < tolerance:
            return theta, passes
    raise SystemExit("SciPy: did not settle")


def row(name, times, passes):
    print(f"  {name:6} {min(times):8.2f} {statistics.median(times):8.2f} {max(times):8.2f}   {passes} passes")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="where bench_transfer_function is")
    parser.add_argument("--samples", type=int, default=50000)
    parser.add_argument("--turns", type=int, default=11)
    arguments = parser.parse_args()
    random = numpy.random.default_rng(1)
    u = numpy.repeat(random.choice([-1.0, 1.0], arguments.samples // 7 + 1), 7)[:arguments.samples]
    y = signal.lsim(TRUTH, u, STEP * numpy.arange(arguments.samples))[1]
    y = y + numpy.sqrt(y.var() / 10) * random.standard_normal(arguments.samples)
    u[0] = y[0] = 0.0  # lfilter has the input rise from 0 before the first sample; mbk begins there
    ours, theirs, ratios = [], [], []
    srivc(u, y)  # as mbk, once before
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "signals"
        numpy.concatenate([u, y]).tofile(file)
        for _ in range(arguments.turns):
            lines = subprocess.run([arguments.bin / "bench_transfer_function", file, str(STEP), "11"], check=True,
                                   capture_output=True, text=True).stdout.splitlines()[1:]
            begin = time.process_time()
            theta, passes = srivc(u, y)
            theirs.append(1e3 * (time.process_time() - begin))
            ours.append(statistics.median(float(line.split()[0]) for line in lines))
            ratios.append(theirs[-1] / ours[-1])
    words = lines[-1].split()
    found = numpy.array([float(word) for word in words[2:]])
    found = numpy.r_[found[3::-1], found[:3:-1]]
    print(f"{arguments.samples} samples, 4 poles, {arguments.turns} turns, one thread; ms of CPU: least, median, greatest")
    row("mbk", ours, int(words[1]))
    row("SciPy", theirs, passes)
    print(f"SciPy over mbk, pair by pair: median {statistics.median(ratios):.1f}, "
          f"{min(ratios):.1f} to {max(ratios):.1f}")
    print(f"coefficients differ by at most {numpy.max(numpy.abs(found / theta - 1)):.1e} of themselves")


if __name__ == "__main__":
    main()
