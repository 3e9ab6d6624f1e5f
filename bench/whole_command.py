#!/usr/bin/env python3
"""How long does the whole command take? From starting the process to its end, on a 62.1 s log at 1 kHz.

Makes the log with make_log, runs `mbk measure` on it and prints the least, median and greatest wall and CPU time.
Where numpy and scipy can be imported, bench/numpy_pipeline.py does the same job in turns with mbk (A B A B ...), so
that both meet the same state of the machine; the ratio is taken pair by pair. Both must give the same M, B and K to
1e-6 of each matrix's largest element. Beside each figure of mbk stands its floor: what starting the process, reading and
inflating the file and its hash take by themselves (`mbk --version`, bench_floor). Times are reported and never judged: the exit code is 0 unless a program fails
or the two answers differ.

usage: whole_command.py [--bin build/bench/bin] [--runs 9] [--python /usr/bin/python3]
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
AGREEMENT = 1e-6  # relative to the largest element of each matrix


def run(command):
    """Standard output, wall seconds and CPU seconds of one process, from its start to its end."""
    with tempfile.TemporaryFile() as out:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=out)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"whole_command.py: exit code {process.returncode} of: {' '.join(map(str, command))}")
        out.seek(0)
        return out.read().decode(), wall, usage.ru_utime + usage.ru_stime


def header(*more):
    print(f"  {'':<40}" + "".join(f"{name:>10}" for name in ("least", "median", "greatest", *more)))


def row(name, seconds, *more):
    """A row of the table [ms]."""
    values = [min(seconds), statistics.median(seconds), max(seconds), *more]
    print(f"  {name:<40}" + "".join(f"{1e3 * value:10.1f}" for value in values))


def largest_difference(a, b):
    """Over M, B and K, relative to the largest element of each."""
    worst = 0.0
    for name in "MBK":
        pairs = [(x, y) for one, other in zip(a[name], b[name]) for x, y in zip(one, other)]
        worst = max(worst, max(abs(x - y) for x, y in pairs) / max(abs(y) for _, y in pairs))
    return worst


class Floor:
    """Processor time that no program that measures this file can do without [s]."""

    def __init__(self, programs, log, turns):
        starts = [run([programs / "mbk", "--version"]) for _ in range(turns)]
        self.wall, self.start = (statistics.median(one[k] for one in starts) for k in (1, 2))
        text, *_ = run([programs / "bench_floor", log, str(turns)])
        found = json.loads(text)
        self.reading, self.inflating, self.hashing = (found[key] for key in ("read_s", "inflate_s", "sha256_s"))
        self.work = self.reading + self.inflating + self.hashing


def has_scipy(python):
    check = [python, "-c", "import numpy, scipy.signal, scipy.io; print(numpy.__version__, scipy.__version__)"]
    found = subprocess.run(check, capture_output=True, text=True, check=False)
    return found.stdout.split() if found.returncode == 0 else None


def arguments_of(description):
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=HERE.parent / "build/bench/bin", help="folder of the programs")
    parser.add_argument("--runs", type=int, default=9, help="timed runs of each program (9)")
    parser.add_argument("--python", default=sys.executable, help="the Python that has numpy and scipy, if any")
    arguments = parser.parse_args()
    if arguments.runs < 1:
        parser.error("--runs must be at least 1")
    return arguments


def main():
    arguments = arguments_of(__doc__)
    mbk, make_log = arguments.bin / "mbk", arguments.bin / "make_log"
    for program in (mbk, make_log, arguments.bin / "bench_floor"):
        if not program.exists():
            sys.exit(f"whole_command.py: {program} is not there; build first, or name its folder with --bin")

    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "log.mat"
        run([make_log, "--protocol", "sinusoidal", "--seed", "1", "--out", log])
        published = [mbk, "measure", "--mode", "reference", "--json", log]
        pipeline = [arguments.python, HERE / "numpy_pipeline.py", log]
        scipy = has_scipy(arguments.python)

        print(f"62.1 s at 1 kHz, {log.stat().st_size / 1e6:.1f} MB, {arguments.runs} runs; whole process, in ms\n")
        header("floor")
        floor = Floor(arguments.bin, log, arguments.runs)
        least_wall, least_cpu = floor.wall + floor.work, floor.start + floor.work
        default = [run([mbk, "measure", log])[1:] for _ in range(arguments.runs + 1)][1:]  # the first one warms up
        row("mbk measure, wall", [wall for wall, _ in default], least_wall)
        row("mbk measure, CPU", [cpu for _, cpu in default], least_cpu)
        run(published)
        if scipy:
            run(pipeline)
        ours, theirs, own_time = [], [], []
        for _ in range(arguments.runs):
            text, *times = run(published)
            ours.append(times)
            model = json.loads(text)["model"]
            if scipy:
                text, *times = run(pipeline)
                theirs.append(times)
                other = json.loads(text)
                own_time.append(other["seconds_after_imports"])
        row("mbk measure --mode reference, wall", [wall for wall, _ in ours], least_wall)
        row("mbk measure --mode reference, CPU", [cpu for _, cpu in ours], least_cpu)
        if scipy:
            row("numpy_pipeline.py, wall", [wall for wall, _ in theirs])
            row("numpy_pipeline.py, CPU", [cpu for _, cpu in theirs])
            row("  of this after the imports, wall", own_time)
        print(f"\n  floor, CPU: starting the process {1e3 * floor.start:.1f}, reading {1e3 * floor.reading:.1f} and inflating "
              f"the file {1e3 * floor.inflating:.1f}, its SHA-256 {1e3 * floor.hashing:.1f}")
        if not scipy:
            print(f"\n{arguments.python} has no numpy and scipy: nothing to compare with")
            return

    def ratios(name, pairs):
        values = [b / a for a, b in pairs]
        print(
            f"  {name:<34}{min(values):10.2f}{statistics.median(values):10.2f}{max(values):10.2f}"
            f"   {' '.join(f'{value:.1f}' for value in values)}"
        )

    print(f"\nnumpy_pipeline.py over mbk --mode reference, pair by pair (NumPy {scipy[0]}, SciPy {scipy[1]})\n")
    ratios("whole process, wall", [(a[0], b[0]) for a, b in zip(ours, theirs)])
    ratios("whole process, CPU", [(a[1], b[1]) for a, b in zip(ours, theirs)])
    ratios("without Python's imports, wall", [(a[0], b) for a, b in zip(ours, own_time)])
    difference = largest_difference(other, model)
    print(f"\nM, B and K differ by at most {difference:.1e} of each matrix's largest element (limit {AGREEMENT:g})")
    if not difference <= AGREEMENT:
        sys.exit("whole_command.py: the two answers differ")


if __name__ == "__main__":
    main()
