#!/usr/bin/env python3
"""What the Python package costs: importing it, beside importing NumPy alone, and calls that compute next to nothing.

Imports take turns, each in a new process. Times are reported and not judged.

usage: python_package.py [--package build/release/python] [--runs 20]     with a Python that has NumPy
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


def import_ms(module, package):
    """Wall time of an import as Python measures it."""
    ran = subprocess.run([sys.executable, "-X", "importtime", "-c", f"import {module}"], capture_output=True, text=True,
                         check=True, env={**os.environ, "PYTHONPATH": str(package)})
    rows = [line.split("|") for line in ran.stderr.splitlines() if line.startswith("import time:")]
    return next(int(row[1]) for row in rows if row[2].strip() == module) / 1000


def call_us(work, count=5000):
    """Median and least wall time."""
    times = []
    for _ in range(count):
        begin = time.perf_counter()
        work()
        times.append((time.perf_counter() - begin) * 1e6)
    return statistics.median(times), min(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--package", type=pathlib.Path, default=ROOT / "build/release/python", help="folder of the package")
    parser.add_argument("--runs", type=int, default=20, help="imports of each (20)")
    given = parser.parse_args()
    times = {"numpy": [], "mbk": []}
    for _ in range(given.runs):
        for module, known in times.items():
            known.append(import_ms(module, given.package))
    print(f"{'import':<44}{'median':>10}{'least':>10}")
    for module, known in times.items():
        print(f"{module:<44}{statistics.median(known):>7.0f} ms{min(known):>7.0f} ms")

    sys.path.insert(0, str(given.package))
    import numpy
    from mbk import _mbk

    t = numpy.arange(300) / 1000.0
    recording = _mbk.Recording({"time": t, "x": numpy.sin(20 * t), "F": numpy.cos(20 * t)})
    calls = {
        "a text in the words of Python": lambda: _mbk.in_python("pass --rate HZ"),
        "an array of a recording": lambda: recording.channel("x"),
        "a recording of three arrays": lambda: _mbk.Recording({"time": t, "x": t, "F": t}),
        "info of a recording of 300 samples": lambda: _mbk.call("info", {}, [recording]),
    }
    print(f"\n{'call':<44}{'median':>10}{'least':>10}")
    for name, work in calls.items():
        median, least = call_us(work)
        print(f"{name:<44}{median:>7.1f} µs{least:>7.1f} µs")


if __name__ == "__main__":
    main()
