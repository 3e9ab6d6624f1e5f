#!/usr/bin/env python3
"""How does the time grow with recordings and processors? N recordings of 62.1 s at 1 kHz, on one thread and on all.

Links a few logs under N names, so that the work is timed and not the disk. `mbk identify` and `mbk measure` take turns
with numpy_pipeline.py and numpy_measure.py in as many processes, which are started and have imported everything before
their clock runs. M, B and K of the reference mode must agree to 1e-6 of each matrix's largest element. Times are
reported and not judged: the exit code is 0 unless a program fails or the answers differ.

usage: scaling.py [--bin build/release/bin] [--files 100] [--threads 1 2] [--runs 3]     with a Python that has SciPy
"""

import os

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import argparse
import concurrent.futures
import json
import pathlib
import statistics
import sys
import tempfile
import time

import numpy_measure
import numpy_pipeline
from whole_command import AGREEMENT, BIN, largest_difference, run

DISTINCT = 10  # logs that are made


def by_scipy(find, files, processes):
    """The models of all files, and the wall seconds without starting the processes."""
    with concurrent.futures.ProcessPoolExecutor(processes) as pool:
        list(pool.map(find, files[:1] * 4 * processes))  # warms them up
        start = time.perf_counter()
        models = list(pool.map(find, files))
        return models, time.perf_counter() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=BIN, help="folder of the programs")
    parser.add_argument("--files", type=int, default=100, help="recordings (100)")
    parser.add_argument("--threads", type=int, nargs="+", default=sorted({1, os.cpu_count()}), help="1 and all processors")
    parser.add_argument("--runs", type=int, default=3, help="timed runs of each (3)")
    given = parser.parse_args()
    commands = (("identify --mode reference", numpy_pipeline.measure), ("identify", numpy_pipeline.measure),
                ("measure", numpy_measure.measure))
    print(f"{given.files} recordings of 62.1 s; medians of {given.runs} runs, wall seconds\n")
    print(f"{'':<30}{'threads':>8}{'mbk':>9}{'files/s':>9}{'SciPy':>9}{'SciPy over mbk':>17}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        made = [folder / f"made_{k}.mat" for k in range(min(DISTINCT, given.files))]
        for k, log in enumerate(made):
            run(given.bin / "make_log", "--protocol", "sinusoidal", "--seed", k + 1, "--out", log)
        files = [folder / f"log_{k:04}.mat" for k in range(given.files)]
        for k, file in enumerate(files):
            os.link(made[k % len(made)], file)
        for threads in given.threads:
            for title, find in commands:
                ours, theirs = [], []
                for _ in range(given.runs):
                    text, wall, _ = run(given.bin / "mbk", *title.split(), "--threads", threads, "--quiet", "--json", *files)
                    ours.append(wall)
                    models, wall = by_scipy(find, files, threads)
                    theirs.append(wall)
                ratio = statistics.median(b / a for a, b in zip(ours, theirs))
                wall, other = statistics.median(ours), statistics.median(theirs)
                print(f"{'mbk ' + title:<30}{threads:>8}{wall:>9.2f}{given.files / wall:>9.0f}{other:>9.2f}{ratio:>17.2f}",
                      flush=True)
                if "reference" in title:
                    results = json.loads(text)
                    results = results["results"] if given.files > 1 else [results]
                    if not max(largest_difference(a, b["model"]) for a, b in zip(models, results)) <= AGREEMENT:
                        sys.exit("scaling.py: the answers differ")


if __name__ == "__main__":
    main()
