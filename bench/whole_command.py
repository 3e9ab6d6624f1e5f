#!/usr/bin/env python3
"""How long does a whole command take? From starting the process to its end, on a recording of 62.1 s at 1 kHz.

`mbk identify`, also with --mode reference, and `mbk measure` take turns (A B A B ...) with SciPy scripts for the same
job: numpy_pipeline.py finds M, B and K, numpy_measure.py does the parts of `mbk measure`. Ratios are taken pair by pair.
In reference mode both must give the same M, B and K to 1e-6 of each matrix's largest element. Times are reported and not
judged: the exit code is 0 unless a program fails or the answers differ.

usage: whole_command.py [--bin build/release/bin] [--runs 21] [--python /usr/bin/python3]
"""

import os

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # waiting threads would count as processor time

import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
BIN = HERE.parent / "build/release/bin"
AGREEMENT = 1e-6  # relative to the largest element of each matrix


def run(*command):
    """Standard output of one process, and its wall and CPU seconds from start to end."""
    with tempfile.TemporaryFile() as out:
        start = time.perf_counter()
        process = subprocess.Popen(list(map(str, command)), stdout=out)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 4):  # 4: the result is not usable
            sys.exit(f"exit code {process.returncode} of: {' '.join(map(str, command))[:200]}")
        out.seek(0)
        return out.read().decode(), wall, usage.ru_utime + usage.ru_stime


def largest_difference(a, b):
    """Over M, B and K, relative to the largest element of each."""
    worst = 0.0
    for name in "MBK":
        pairs = [(x, y) for one, other in zip(a[name], b[name]) for x, y in zip(one, other)]
        worst = max(worst, max(abs(x - y) for x, y in pairs) / max(abs(y) for _, y in pairs))
    return worst


def spread(values, scale=1.0):
    return "".join(f"{scale * one:10.2f}" for one in (min(values), statistics.median(values), max(values)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=BIN, help="folder of the programs")
    parser.add_argument("--runs", type=int, default=21, help="timed runs of each program (21)")
    parser.add_argument("--python", default=sys.executable, help="a Python with NumPy and SciPy")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "log.mat"
        run(given.bin / "make_log", "--protocol", "sinusoidal", "--seed", "1", "--out", log)
        identify, measure = "numpy_pipeline.py", "numpy_measure.py"
        rows = (("identify", ("identify",), identify),
                ("identify --mode reference", ("identify", "--mode", "reference"), identify),
                ("measure", ("measure",), measure))
        print(f"62.1 s at 1 kHz, {given.runs} runs{'':<24}{'least':>10}{'median':>10}{'greatest':>10}")
        for title, command, script in rows:
            ours, theirs = [], []
            for _ in range(given.runs + 1):  # the first one warms up
                ours.append(run(given.bin / "mbk", *command, "--json", log))
                theirs.append(run(given.python, HERE / script, log))
            ours, theirs = ours[1:], theirs[1:]
            own = [json.loads(text)["cpu_seconds_after_imports"] for text, *_ in theirs]
            print(f"\n{'mbk ' + title + ', wall [ms]':<46}{spread([wall for _, wall, _ in ours], 1e3)}")
            print(f"{'  CPU [ms]':<46}{spread([cpu for *_, cpu in ours], 1e3)}")
            print(f"{script + ', CPU [ms]':<46}{spread([cpu for *_, cpu in theirs], 1e3)}")
            print(f"{'SciPy over mbk, CPU':<46}{spread([b[2] / a[2] for a, b in zip(ours, theirs)])}")
            print(f"{'  without the imports of Python':<46}{spread([b / a[2] for a, b in zip(ours, own)])}")
            if "reference" in command:
                difference = largest_difference(json.loads(theirs[-1][0]), json.loads(ours[-1][0])["model"])
                print(f"M, B and K differ by at most {difference:.1e} (limit {AGREEMENT:g})")
                if not difference <= AGREEMENT:
                    sys.exit("whole_command.py: the two answers differ")


if __name__ == "__main__":
    main()
