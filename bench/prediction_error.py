#!/usr/bin/env python3
"""Output error and Box-Jenkins of 70,000 samples: all that mbk does, and one search by mbk and by
scipy.optimize.least_squares."""

import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before NumPy is loaded
import numpy
from scipy import optimize, signal

STEP = 0.01
FOUR = ([-6400.0, 1600.0], [1.0, 5.0, 408.0, 416.0, 1600.0])  # Rao & Garnier 2002
TWO = ([400.0], [1.0, 4.0, 400.0])
NOISE = ([1.0, 0.5], [1.0, -0.9])  # D and C of the noise of Box-Jenkins


class Model:
    """y = B/F u + D/C e, as a skilled user would write it: exact derivatives, one lfilter for each kind, the residual
    with the input from rest."""

    def __init__(self, u, y, poles, zeros, c, d):
        self.u, self.y, self.counts = u, y, (poles, zeros + 1, c, d)
        self.evaluations = 0

    def parts(self, theta):
        f, b, c, d = numpy.split(theta, numpy.cumsum(self.counts)[:3])
        return numpy.r_[1.0, f], b, numpy.r_[1.0, c], numpy.r_[1.0, d]

    def residual(self, theta):
        self.evaluations += 1
        f, b, c, d = self.parts(theta)
        return signal.lfilter(c, d, self.y - signal.lfilter(b, f, self.u))

    def slopes(self, theta):
        f, b, c, d = self.parts(theta)
        whitened = (lambda x: signal.lfilter(c, d, x)) if c.size + d.size > 2 else (lambda x: x)
        response = signal.lfilter(b, f, self.u)
        left = self.y - response
        columns = numpy.zeros((theta.size, self.y.size))
        kinds = [(whitened(signal.lfilter([1.0], f, response)), 1, 1.0),
                 (whitened(signal.lfilter([1.0], f, self.u)), 0, -1.0)]
        if c.size + d.size > 2:
            kinds += [(signal.lfilter([1.0], d, left), 1, 1.0),
                      (signal.lfilter([1.0], d, signal.lfilter(c, d, left)), 1, -1.0)]
        row = 0
        for (x, first, sign), count in zip(kinds, self.counts):
            for lag in range(first, first + count):
                columns[row, lag:] = sign * x[:x.size - lag]
                row += 1
        return columns.T

    def fitted(self, start):
        found = optimize.least_squares(self.residual, start, self.slopes, method="lm", x_scale="jac",
                                       xtol=1e-10, ftol=1e-12, gtol=1e-12)
        if not found.success:
            raise SystemExit("SciPy: did not settle")
        return found


def sampled(system):
    """F and B of the system between samples on a straight line."""
    numerator, denominator, _ = signal.cont2discrete(system, STEP, "foh")
    return denominator[1:], numerator[0]


def row(name, times, what):
    print(f"  {name:9} {min(times):9.0f} {statistics.median(times):9.0f} {max(times):9.0f}   {what}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="where bench_transfer_function is")
    parser.add_argument("--samples", type=int, default=70000)
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    random = numpy.random.default_rng(1)
    u = numpy.repeat(random.choice([-1.0, 1.0], arguments.samples // 7 + 1), 7)[:arguments.samples]
    u[0] = 0.0
    white = random.standard_normal(arguments.samples)
    print(f"{arguments.samples} samples, {arguments.turns} turns, one thread; ms of CPU: least, median, greatest")

    def compared(method, system, noise, poles, zeros, orders):
        """Times, SciPy's search, and how far both minima are apart."""
        f, b = sampled(system)
        clean = signal.lfilter(b, numpy.r_[1.0, f], u)
        y = clean + numpy.sqrt(clean.var() / noise.var() / 10) * noise
        c, d = (numpy.array(NOISE[1][1:]), numpy.array(NOISE[0][1:])) if sum(orders) else (numpy.empty(0),) * 2
        beside = numpy.real(numpy.poly(0.998 * numpy.roots(numpy.r_[1.0, f])))[1:]  # and stable
        start = numpy.r_[beside, 0.9 * b[:zeros + 1], 0.9 * c, 0.9 * d]
        ours, alone, theirs = [], [], []
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "signals"
            numpy.concatenate([u, y]).tofile(file)

            def mbk(*start):
                return subprocess.run([arguments.bin / "bench_transfer_function", file, str(STEP), "1", method,
                                       str(poles), str(zeros), *map(str, start)], check=True, capture_output=True,
                                      text=True).stdout.split()

            for _ in range(arguments.turns):
                words = mbk()
                ours.append(float(words[0]))
                if method == "oe":
                    alone.append(float(mbk(*beside)[0]))
                model = Model(u, y, poles, zeros, *orders)
                begin = time.process_time()
                found = model.fitted(start)
                theirs.append(1e3 * (time.process_time() - begin))
        variance = 2.0 * found.cost / (y.size - found.x.size)
        return ours, alone, theirs, words, f"{model.evaluations} residuals", float(words[2]) / variance - 1.0

    def ratio(ours, theirs):
        return statistics.median(b / a for a, b in zip(ours, theirs))

    ours, alone, theirs, _, passes, apart = compared("oe", FOUR, white, 4, 4, (0, 0))
    row("mbk OE", ours, "4 poles, 4 zeros; every start")
    row("", alone, "one start, beside the truth")
    row("SciPy OE", theirs, f"one start, beside the truth, {passes}")
    print(f"SciPy over mbk, pair by pair: median {ratio(alone, theirs):.2f} from one start, {ratio(ours, theirs):.2f} from "
          f"every start; variances differ by {apart:.1e}")
    ours, _, theirs, words, passes, apart = compared("bj", TWO, signal.lfilter(*NOISE, white), 2, 2, (1, 1))
    row("mbk BJ", ours, f"2 poles, 2 zeros; every start, order of the noise found: {words[3]} and {words[4]}")
    row("SciPy BJ", theirs, f"one start, beside the truth, noise of order 1 and 1 given, {passes}")
    print(f"SciPy over mbk, pair by pair: median {ratio(ours, theirs):.2f}; variances differ by {apart:.1e}")


if __name__ == "__main__":
    main()
