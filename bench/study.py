#!/usr/bin/env python3
"""How long does a study take? `mbk study measure` of many trials of 62.1 s, again where nothing changed, and `summary`
of a million numbers.

Simulates a few trials and stores them again and again, each time with eight other bytes at its end, so that each has a
hash of its own; files are in the page cache when they are measured. For the summary, results are written into the
database of a study: --results of them with 32 outcomes each, of people in ten sessions (31,250 make a million rows).
Times are reported and not judged: the exit code is 0 unless a program fails.

usage: study.py [--bin build/release/bin] [--trials 1000] [--results 31250] [--threads 2]
"""

import argparse
import json
import os
import pathlib
import random
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

DISTINCT = 20  # trials that are simulated
NAN = struct.pack("<d", float("nan"))
ALIKE, OTHERS = 14, 18  # outcomes with and without a standard error
LARGEST = ("M", "B", "K")


def run(mbk, *arguments):
    """Standard output of mbk, and what it took: wall and CPU seconds."""
    start = time.perf_counter()
    with tempfile.TemporaryFile() as out:
        process = subprocess.Popen([str(mbk), *map(str, arguments)], stdout=out)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"study.py: exit code {process.returncode} of: mbk {' '.join(map(str, arguments))[:200]}")
        out.seek(0)
        return out.read().decode(), wall, usage.ru_utime + usage.ru_stime


def row(what, wall, cpu, rate=""):
    print(f"{what:<56} {wall:8.2f} s {cpu:8.2f} s CPU  {rate}", flush=True)


def added_study(mbk, folder, trials):
    """A study of so many trials of 62.1 s that were not measured yet, in the page cache."""
    study = folder / "measured"
    run(mbk, "study", "init", study)
    seeds = []
    for seed in range(1, min(trials, DISTINCT) + 1):
        file = folder / f"{seed}.h5"
        run(mbk, "simulate", "relaxed_sinusoidal", "--seed", seed, "--quiet", "--out", file)
        seeds.append(file.read_bytes())
    added = folder / "added.h5"
    files = []
    for number in range(trials):
        added = folder / f"added_{number}.h5"
        added.write_bytes(seeds[number % len(seeds)] + struct.pack("<q", number))
        files.append(added)
        if len(files) == 50 or number == trials - 1:
            run(mbk, "study", "add", *files, "--participant", number // 50 + 1, "--study", study, "--quiet")
            for file in files:
                file.unlink()
            files = []
    for file in sorted((study / "recordings").rglob("*")):  # into the page cache
        if file.is_file():
            file.read_bytes()
    return study


def measured_study(mbk, folder, trials, threads):
    study = added_study(mbk, folder, trials)
    _, wall, cpu = run(mbk, "study", "measure", "--study", study, "--quiet", "--threads", threads)
    row(f"measure {trials} trials of 62.1 s", wall, cpu,
         f"{trials / wall:.0f} trials/s; {threads * trials / cpu:.0f} by CPU time")
    out, wall, cpu = run(mbk, "study", "measure", "--study", study, "--quiet")
    assert out == "nothing new to measure\n", out
    row("measure again, nothing changed", wall, cpu)


def outcome_names():
    with_errors = [f"{m}_{e}" for m in LARGEST for e in ("xx", "xy", "yx", "yy")] + ["x0_x", "x0_y"]
    units = {"M": "kg", "B": "N·s/m", "K": "N/m", "x": "m"}
    names = [[name, units[name[0]]] for name in with_errors]
    names += [[f"{q}_{n}", u] for q in ("inertia", "damping", "stiffness")
              for n, u in (("area", ""), ("shape", ""), ("orientation", "°"))]
    names += [[n, "%"] for n in ("VAF_x", "VAF_y", "inertia_zmean", "stiffness_zmean")]
    names += [["RMSE_x", "N"], ["RMSE_y", "N"], ["absorbed_energy", "J"], ["min_passivity_index", "N·s/m"],
              ["excess_of_passivity", "N·s/m"]]
    assert len(names) == ALIKE + OTHERS
    return names


def filled_study(mbk, folder, results):
    """A study whose database holds so many results, of as many recordings, which are not there."""
    study = folder / f"filled_{results}"
    run(mbk, "study", "init", study)
    draw = random.Random(1)
    sessions = 10
    people = max(20, round((results / sessions / 10) ** 0.5 * 3))
    own = [[draw.gauss(0, 1) for _ in range(ALIKE + OTHERS)] for _ in range(people)]
    size = ALIKE + OTHERS
    noise = [struct.pack("<d", draw.gauss(0, 1)) for _ in range(4096)]
    values = [struct.unpack("<d", one)[0] for one in noise]
    errors = struct.pack(f"<{ALIKE}d", *[0.5] * ALIKE) + NAN * OTHERS
    with sqlite3.connect(study / "study.sqlite") as database:
        database.execute("PRAGMA synchronous = OFF")
        database.execute("INSERT INTO analysis VALUES (1, ?, '{}', 'bench')", ("0" * 64,))
        database.execute("INSERT INTO layout VALUES (1, ?)", (json.dumps(outcome_names(), ensure_ascii=False),))

        def rows():
            for k in range(results):
                person = k % people
                start = draw.randrange(4096 - size)
                mean = own[person]
                numbers = struct.pack(f"<{size}d", *[100 + 10 * mean[i] + 3 * values[start + i] for i in range(size)])
                yield k + 1, person + 1, k // people % sessions + 1, numbers + errors

        for number, person, session, numbers in rows():
            database.execute("INSERT INTO recording(number, sha256, part, extension, bytes, participant, session, trial, "
                             "condition, duration_s, added, origin_sha256, salt) VALUES (?, ?, 0, '.h5', 1, ?, ?, ?, "
                             "'relaxed', 62.1, '', '', '')", (number, str(number), person, session, number))
            database.execute("INSERT INTO result VALUES (?, ?, 1, 1, 0, '')", (number, number))
            database.execute("INSERT INTO packed VALUES (?, 1, ?)", (number, numbers))
    database.close()
    return study


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/release/bin"))
    options.add_argument("--trials", type=int, default=1000)
    options.add_argument("--results", type=int, default=31250)
    options.add_argument("--threads", type=int, default=2)
    options.add_argument("--folder", type=pathlib.Path, help="where files are written (a temporary folder)")
    chosen = options.parse_args()
    mbk = chosen.bin.resolve() / "mbk"
    with tempfile.TemporaryDirectory(prefix="mbk-bench-", dir=chosen.folder) as name:
        folder = pathlib.Path(name)
        if chosen.trials > 0:
            measured_study(mbk, folder, chosen.trials, chosen.threads)
        if chosen.results > 0:
            study = filled_study(mbk, folder, chosen.results)
            for what in ((), ("--json",), ("--compare", "session", "1", "2")):
                _, wall, cpu = run(mbk, "study", "summary", "--study", study, *what)
                row(f"summary of {chosen.results:,} results × 32 {' '.join(what)}", wall, cpu)


if __name__ == "__main__":
    main()
