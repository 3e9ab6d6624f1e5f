#!/usr/bin/env python3
"""Dynamic stiffness and coherence of a trial of two axes: mbk explore beside SciPy."""

import argparse
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before NumPy is loaded

ONLY = ("--only", "frequency-response", "--method", "welch")


def script(path):
    """As a skilled user would write it: all cross spectra, the response by the reference, multiple coherence."""
    began = time.process_time()
    import h5py
    import numpy
    from scipy import signal
    imported = time.process_time() - began
    with h5py.File(path) as file:
        get = lambda name: file["channels"][name][:]
        x = numpy.array([get("hand_x"), get("hand_y")])
        y = -numpy.array([get("force_x"), get("force_y")])
        r = numpy.array([get("reference_x"), get("reference_y")])
    options = dict(fs=1000.0, window="hann", nperseg=2000, detrend="constant")
    everything = numpy.vstack([x, y, r])
    frequency, _ = signal.welch(x[0], **options)
    S = numpy.empty((frequency.size, 6, 6), complex)
    for j in range(6):
        for k in range(j, 6):
            _, one = signal.csd(everything[k], everything[j], **options)
            S[:, j, k], S[:, k, j] = one, one.conj()
    kept = slice(1, 101)
    S = S[kept]
    D = S[:, 2:4, 4:6] @ numpy.linalg.inv(S[:, :2, 4:6])
    Syx, Sxx = S[:, 2:4, :2], S[:, :2, :2]
    explained = Syx @ numpy.linalg.solve(Sxx, Syx.conj().transpose(0, 2, 1))
    coherence = (numpy.diagonal(explained, axis1=1, axis2=2) / numpy.diagonal(S[:, 2:4, 2:4], axis1=1, axis2=2)).real
    print(imported, time.process_time() - began - imported, abs(D[9, 0, 0]), coherence[9, 0])


def processor_time(command):
    """What a process took [ms], and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = subprocess.run(command, check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime), ran.stdout


def row(name, values, unit="ms"):
    print(f"  {name:52}{statistics.median(values):9.1f} {unit}   {min(values):.1f} to {max(values):.1f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, help="where mbk is")
    parser.add_argument("--turns", type=int, default=11)
    parser.add_argument("--script", help=argparse.SUPPRESS)  # this file as the script that is timed
    arguments = parser.parse_args()
    if arguments.script:
        script(arguments.script)
        return
    mbk = arguments.bin / "mbk"
    with tempfile.TemporaryDirectory(prefix="mbk-explore-") as name:
        recording = pathlib.Path(name) / "trial.h5"
        subprocess.run([mbk, "simulate", "relaxed_sinusoidal", "--out", recording, "--quiet"], check=True)
        ours, whole, theirs, work, ratios, inner = [], [], [], [], [], []
        for _ in range(arguments.turns):
            mine, _ = processor_time([mbk, "explore", *ONLY, "--json", recording])
            all_parts, _ = processor_time([mbk, "explore", "--json", recording])
            other, said = processor_time([sys.executable, "-B", __file__, "--script", recording])
            without_imports = 1e3 * float(said.split()[1])
            for values, value in ((ours, mine), (whole, all_parts), (theirs, other), (work, without_imports),
                                  (ratios, other / mine), (inner, without_imports / mine)):
                values.append(value)
        print("CPU time of whole processes; a trial of 62 s, two axes, HDF5\n")
        row("mbk explore --only frequency-response", ours)
        row("mbk explore, every part", whole)
        row("SciPy, the same response and coherence", theirs)
        row("SciPy without its imports", work)
        row("SciPy over mbk, frequency response", ratios, "times")
        row("SciPy without imports over mbk, frequency response", inner, "times")


if __name__ == "__main__":
    main()
