#!/usr/bin/env python3
"""SRIVC of 50,000 samples and 4 poles: mbk, and the same with scipy.signal.lfilter; both take turns."""

import argparse
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy
from scipy import signal

STEP, POLES, ZEROS = 0.01, 4, 1
TRUTH = ([-6400.0, 1600.0], [1.0, 5.0, 408.0, 416.0, 1600.0])  # Rao & Garnier 2002


def filters(numerators, denominator):
    """First-order-hold filters with one denominator, at STEP."""
    made = [signal.cont2discrete((numerator, denominator), STEP, "foh")[:2] for numerator in numerators]
    return [numpy.ravel(b) for b, _ in made], made[0][1]


def derivatives(x, highest, denominator):
    """s^k/A x, k = highest … 0, with one lfilter each."""
    numerators, a = filters([[1.0] + k * [0.0] for k in range(highest, -1, -1)], denominator)
    return [signal.lfilter(b, a, x) for b in numerators]


def srivc(u, y, pole=20.0, tolerance=1e-4):
    """As a skilled user would write it; the numerator and denominator, and how many passes."""
    denominator, theta = numpy.poly([-pole] * POLES), None
    for passes in range(1, 100):
        of_y = derivatives(y, POLES, denominator)
        of_u = derivatives(u, ZEROS, denominator)
        regressors = numpy.column_stack([-one for one in of_y[1:]] + of_u)
        instruments = regressors
        if theta is not None:
            (b,), a = filters([theta[POLES:]], denominator)
            clean = derivatives(signal.lfilter(b, a, u), POLES - 1, denominator)
            instruments = numpy.column_stack([-one for one in clean] + of_u)
        old, theta = theta, numpy.linalg.solve(instruments.T @ regressors, instruments.T @ of_y[0])
        roots = numpy.roots(numpy.r_[1.0, theta[:POLES]])
        denominator = numpy.real(numpy.poly(-numpy.abs(roots.real) + 1j * roots.imag))
        theta[:POLES] = denominator[1:]
        if old is not None and numpy.max(numpy.abs(theta - old) / numpy.abs(theta)) < tolerance:
            return theta, passes
    raise SystemExit("SciPy: did not settle")


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
    ours, theirs, ratios = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "signals"
        numpy.concatenate([u, y]).tofile(file)
        for _ in range(arguments.turns):
            words = subprocess.run([arguments.bin / "bench_transfer_function", file, str(STEP), "1"], check=True,
                                   capture_output=True, text=True).stdout.split()
            begin = time.perf_counter()
            theta, passes = srivc(u, y)
            theirs.append(1e3 * (time.perf_counter() - begin))
            ours.append(float(words[0]))
            ratios.append(theirs[-1] / ours[-1])
    found = numpy.array([float(word) for word in words[2:]])
    found = numpy.r_[found[3::-1], found[:3:-1]]
    print(f"{arguments.samples} samples, 4 poles, {arguments.turns} turns, one thread; ms: least, median, greatest")
    for name, times, count in (("mbk", ours, int(words[1])), ("SciPy", theirs, passes)):
        print(f"  {name:6} {min(times):8.2f} {statistics.median(times):8.2f} {max(times):8.2f}   {count} passes")
    print(f"SciPy over mbk, pair by pair: median {statistics.median(ratios):.1f}, "
          f"{min(ratios):.1f} to {max(ratios):.1f}")
    print(f"coefficients differ by at most {numpy.max(numpy.abs(found / theta - 1)):.1e} of themselves")


if __name__ == "__main__":
    main()
