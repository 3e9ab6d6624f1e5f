#!/usr/bin/env python3
"""What calling from Python costs: a call of a command beyond its work, a recording of a minute handed over, and `measure`
of arrays in memory against the same with NumPy and SciPy (numpy_measure.py), in one process, after the imports. What takes
milliseconds is told in processor time, on one core for both.

usage: python_layer.py [--bin build/bench/bin] [--turns 11]
"""

import argparse
import os
import pathlib
import statistics
import sys
import time
import warnings

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))


def times(call, turns, repeats=1, clock=time.process_time):
    """Seconds of one call, in every turn; of as many in a row as `repeats`."""
    found = []
    for _ in range(turns):
        start = clock()
        for _ in range(repeats):
            call()
        found.append((clock() - start) / repeats)
    return found


def row(name, seconds, scale, unit):
    low, middle, high = min(seconds), statistics.median(seconds), max(seconds)
    print(f"  {name:<46} {scale * low:9.2f} {scale * middle:9.2f} {scale * high:9.2f}  {unit}")
    return middle


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", default=str(HERE.parent / "build/bench/bin"))
    parser.add_argument("--turns", type=int, default=11)
    arguments = parser.parse_args()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # before NumPy comes
        os.environ[name] = "1"
    sys.path.insert(0, str(pathlib.Path(arguments.bin).resolve().parent / "python"))
    import mbk
    import numpy as np
    import numpy_measure
    import numpy_pipeline

    warnings.simplefilter("ignore", mbk.MbkWarning)
    recording = mbk.simulate("relaxed_sinusoidal")
    arrays = {name: np.ascontiguousarray(values) for name, values in recording.to_dict().items()}
    pairs = {name: np.vstack([arrays[f"{name}_x"], arrays[f"{name}_y"]]) for name in ("hand", "force", "reference")}
    window = slice(numpy_pipeline.BEGIN, numpy_pipeline.END)
    numpy_pipeline.signals_of = lambda _, names: [pairs[name][:, window] for name in names]

    def through_mbk():
        return mbk.measure(mbk.Recording(arrays), mode="reference", threads=1)

    def through_scipy():
        return numpy_measure.measure(None)

    def by_default():
        return mbk.measure(mbk.Recording(arrays), threads=1)

    found, peer = through_mbk(), through_scipy()
    for name in "MBK":
        difference = np.abs(found.model[name] - np.array(peer[name])).max() / np.abs(found.model[name]).max()
        if difference > 1e-3:
            sys.exit(f"they do not find the same: {name} differs by {difference:.1e}")
    made = mbk.Recording(arrays)
    same = made["hand_x"].__array_interface__["data"][0] == arrays["hand_x"].__array_interface__["data"][0]

    turns = arguments.turns
    print(f"{arrays['hand_x'].size} samples of {len(arrays)} channels; {turns} turns\n")
    print(f"  {'':<46} {'least':>9} {'median':>9} {'greatest':>9}")
    row("a call beyond its work, by the clock",
        times(lambda: mbk.simulate(show="free_motion"), turns, 2000, time.perf_counter), 1e6, "µs")
    row("a recording made of arrays", times(lambda: mbk.Recording(arrays), turns, 200), 1e6, "µs of CPU")
    ours, theirs, plain = [], [], []
    for _ in range(turns):
        ours += times(through_mbk, 1)
        theirs += times(through_scipy, 1)
        plain += times(by_default, 1)
    row("mbk.measure of arrays, reference mode", ours, 1e3, "ms of CPU")
    row("mbk.measure of arrays, default mode", plain, 1e3, "ms of CPU")
    row("numpy_measure.py of arrays", theirs, 1e3, "ms of CPU")
    print("\nSciPy over mbk, pair by pair\n")
    for name, seconds in (("reference mode, sample for sample", ours), ("default mode", plain)):
        ratios = sorted(b / a for a, b in zip(seconds, theirs))
        print(f"  {name:<46} {ratios[0]:9.1f} {statistics.median(ratios):9.1f} {ratios[-1]:9.1f}")
    print(f"\n  the array that comes back is {'the memory that was given' if same else 'A COPY'}")


if __name__ == "__main__":
    main()
