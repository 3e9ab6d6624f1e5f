#!/usr/bin/env python3
"""Whole commands on a 62.1 s log at 1 kHz, against SciPy scripts that find the same, from starting the process to its end.

`mbk identify` from a MAT v7 file and from an uncompressed HDF5 file, and `mbk identify --mode reference`, against
numpy_pipeline.py, which finds M, B and K alone; `mbk measure` against numpy_measure.py, which does the parts of that
command. Programs take turns (A B A B ...), and ratios are taken pair by pair. Where the two must agree, M, B and K do so
to 1e-6 of each matrix's largest element. Times are reported and never judged: the exit code is 0 unless a program fails
or the answers differ. It needs a Python with NumPy, SciPy and h5py.

usage: identify_command.py [--bin build/bench/bin] [--runs 9] [--python /usr/bin/python3]
"""

import os

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # threads that wait for each other take time, too

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

import against
import many_files
import whole_command
from whole_command import AGREEMENT, HERE, header, largest_difference, row, run

UNPACK = """
import sys, h5py
with h5py.File(sys.argv[1], "r") as source, h5py.File(sys.argv[2], "w") as target:
    for name, value in source.attrs.items():
        target.attrs[name] = value
    def copy(name, one):
        if isinstance(one, h5py.Dataset):
            made = target.create_dataset(name, data=one[()], dtype=one.dtype)
            for key, value in one.attrs.items():
                made.attrs[key] = value
    source.visititems(copy)
"""


def peak(command, runs=9):
    """Greatest memory of a process [MB], the median of several: where memory begins differs from run to run."""
    return statistics.median(many_files.run(command)[-1] for _ in range(runs))


def ratios(name, values):
    low, high = against.interval(values)
    print(f"  {name:<52}{statistics.median(values):8.2f}   {low:5.2f} to {high:5.2f}   {min(values):7.2f}{max(values):9.2f}")


def pairs_of(ours, theirs, turns):
    """CPU seconds of both, those of the other one after its imports, and the last answers."""
    run(ours)
    run(theirs)
    cpu, other, own = [], [], []
    for _ in range(turns):
        text, _, taken = run(ours)
        cpu.append(taken)
        answer, _, taken = run(theirs)
        other.append(taken)
        own.append(json.loads(answer)["cpu_seconds_after_imports"])
    return cpu, other, own, json.loads(text), json.loads(answer)


def main():
    arguments = whole_command.arguments_of(__doc__)
    mbk, python = arguments.bin / "mbk", arguments.python
    check = [python, "-c", "import numpy, scipy.signal, scipy.io, h5py"]
    if subprocess.run(check, capture_output=True, check=False).returncode != 0:
        sys.exit(f"identify_command.py: {python} has no NumPy, SciPy and h5py")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log, packed, plain = folder / "log.mat", folder / "packed.h5", folder / "log.h5"
        run([arguments.bin / "make_log", "--protocol", "sinusoidal", "--seed", "1", "--out", log])
        run([mbk, "convert", log, packed, "--quiet"])
        run([python, "-c", UNPACK, packed, plain])
        identify, reference = [mbk, "identify", "--json"], [mbk, "identify", "--mode", "reference", "--json"]
        pipeline = [python, HERE / "numpy_pipeline.py"]
        v7 = pairs_of([*identify, log], [*pipeline, log], arguments.runs)
        hdf5 = pairs_of([*identify, plain], [*pipeline, plain], arguments.runs)
        exact = pairs_of([*reference, log], [*pipeline, log], arguments.runs)
        whole = pairs_of([mbk, "measure", "--json", log], [python, HERE / "numpy_measure.py", log], arguments.runs)
        memory = [(title, peak([*command, file])) for title, command, file in (
            ("mbk identify, MAT v7", identify, log), ("mbk identify, HDF5", identify, plain),
            ("mbk measure, MAT v7", [mbk, "measure", "--json"], log))]

    print(f"{arguments.runs} runs; whole process, ms of CPU\n")
    header()
    row("mbk identify, MAT v7", v7[0])
    row("  numpy_pipeline.py", v7[1])
    row("mbk identify, HDF5 uncompressed", hdf5[0])
    row("  numpy_pipeline.py by h5py", hdf5[1])
    row("mbk identify --mode reference, MAT v7", exact[0])
    row("  numpy_pipeline.py after its imports", exact[2])
    row("mbk measure, MAT v7", whole[0])
    row("  numpy_measure.py", whole[1])
    row("  numpy_measure.py after its imports", whole[2])

    def over(pairs, which=1):
        return [b / a for a, b in zip(pairs[0], pairs[which])]

    print(f"\nSciPy over mbk, pair by pair{'median':>33}   its 95 % interval   least greatest\n")
    ratios("identify, MAT v7", over(v7))
    ratios("identify, HDF5 uncompressed", over(hdf5))
    ratios("identify --mode reference, without Python's imports", over(exact, 2))
    ratios("measure, the same parts", over(whole))
    print("\ngreatest memory: " + ", ".join(f"{title} {value:.1f} MB" for title, value in memory))
    difference = largest_difference(exact[4], exact[3]["model"])
    print(f"M, B and K of the reference mode differ by at most {difference:.1e} (limit {AGREEMENT:g})")
    if not difference <= AGREEMENT:
        sys.exit("identify_command.py: the two answers differ")


if __name__ == "__main__":
    main()
