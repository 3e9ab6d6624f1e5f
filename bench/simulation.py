#!/usr/bin/env python3
"""How long does a simulated trial take? 62.1 s at 1 kHz with controller, arm and all sensors, from starting the process
to the recording on disk. Their floor is starting the process (`mbk --version`).

Where numpy and scipy can be imported, plain_closed_loop.py moves the same robot and arm again from the recorded motor
torques, in turns with mbk (A B A B ...); it does neither controller nor sensors, energies or file. bench_plant does the
same with mbk's library, energies included. All must put the hand at the same places to 1e-9 m. Times are reported and never judged: the exit code is 0 unless a program fails or the
answers differ.

usage: simulation.py [--bin build/bench/bin] [--runs 9] [--python /usr/bin/python3]
"""

import json
import pathlib
import statistics
import sys
import tempfile

from whole_command import HERE, arguments_of, has_scipy, header, row, run

AGREEMENT = 1e-9  # [m] and [N]


def main():
    arguments = arguments_of(__doc__)
    mbk = arguments.bin / "mbk"
    if not mbk.exists():
        sys.exit(f"simulation.py: {mbk} is not there; build first, or name its folder with --bin")
    with tempfile.TemporaryDirectory() as folder:
        recording = pathlib.Path(folder) / "recording.mat"
        end = ["--out", recording, "--overwrite", "--quiet"]
        scipy = has_scipy(arguments.python)
        ready, plain, twin, plant = [], [], [], []
        starts = [run([mbk, "--version"])[1:] for _ in range(arguments.runs)]
        floor_wall, floor_cpu = (statistics.median(one[k] for one in starts) for k in (0, 1))
        for _ in range(arguments.runs + 1):  # the first one warms up
            ready.append(run([mbk, "simulate", "relaxed_sinusoidal", *end])[1:])
            plain.append(run([mbk, "simulate", HERE / "closed_loop.toml", *end])[1:])
            if scipy:
                text, *_ = run([arguments.python, HERE / "plain_closed_loop.py", recording])
                twin.append(json.loads(text))
            text, *_ = run([arguments.bin / "bench_plant", recording, "5"])
            plant.append(json.loads(text))
        print(f"62.1 s at 1 kHz, {arguments.runs} runs; whole process, in ms\n")
        header("floor")
        row("mbk simulate relaxed_sinusoidal, wall", [wall for wall, _ in ready[1:]], floor_wall)
        row("  CPU", [cpu for _, cpu in ready[1:]], floor_cpu)
        row("mbk simulate closed_loop.toml, wall", [wall for wall, _ in plain[1:]], floor_wall)
        compiled = [statistics.median(one["seconds"]) for one in plant[1:]]
        row("bench_plant, plant alone, CPU", compiled)
    if not scipy:
        print(f"\n{arguments.python} has no numpy and scipy: nothing to compare with")
        return
    plainly = [one["cpu_seconds"] for one in twin[1:]]
    row("plain_closed_loop.py, plant alone, CPU", plainly)
    ratios = [b["seconds"] / a[0] for a, b in zip(plain[1:], twin[1:])]
    print(f"\nplant alone in Python over the whole of mbk simulate, pair by pair: median {statistics.median(ratios):.2f}, "
          f"{min(ratios):.2f} to {max(ratios):.2f}")
    ratios = [b / a for a, b in zip(compiled, plainly)]
    print(f"plant alone in Python over plant alone in C++, CPU, pair by pair: median {statistics.median(ratios):.1f}, "
          f"{min(ratios):.1f} to {max(ratios):.1f}")
    place, force = (max(one[-1][what] for one in (twin, plant))
                    for what in ("largest_distance_m", "largest_force_difference_N"))
    print(f"the hand differs by at most {place:.1e} m, its force by {force:.1e} N (limit {AGREEMENT:g})")
    if not max(place, force) <= AGREEMENT:
        sys.exit("simulation.py: the two answers differ")


if __name__ == "__main__":
    main()
