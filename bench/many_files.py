#!/usr/bin/env python3
"""How long do many recordings take? `mbk identify` on N logs of 62.1 s at 1 kHz, several at a time.

Makes a few logs with make_log and links them under N names, so that what is timed is the work and not the disk; once
as make_log writes them (MAT v7, compressed) and once uncompressed (MAT v5). `mbk identify`, in its default mode and in
--mode reference, and `mbk measure` take turns with bench/joblib_pipeline.py where numpy, scipy and joblib can be
imported; of the latter the imports do not count, of mbk the whole process does. It finds M, B and K alone, to compare
with `mbk identify`, and with --measure the parts of `mbk measure`. In reference mode both must give the same M, B and K
to 1e-6 of each matrix's largest element. Page faults and the greatest memory are those that the system counts. Times are reported and never judged: the exit code is 0 unless a program fails or the answers differ.

usage: many_files.py [--bin build/release/bin] [--files 100] [--threads 2] [--runs 3] [--python /usr/bin/python3]
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
DISTINCT = 10  # logs that are made
UNCOMPRESS = """
import sys
from scipy.io import loadmat, savemat
for source, target in zip(sys.argv[1::2], sys.argv[2::2]):
    savemat(target, {"logs": loadmat(source)["logs"]}, do_compression=False)
"""


def run(command):
    """Standard output of one process, and what it took: wall and CPU seconds, page faults, greatest memory [MB]."""
    with tempfile.TemporaryFile() as out:
        start = time.perf_counter()
        process = subprocess.Popen([str(word) for word in command], stdout=out)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 4):  # 4: a result that is not usable is a result
            sys.exit(f"many_files.py: exit code {process.returncode} of: {' '.join(map(str, command[:6]))} ...")
        out.seek(0)
        cpu = usage.ru_utime + usage.ru_stime
        return out.read().decode(), wall, cpu, usage.ru_minflt, usage.ru_maxrss * 1024 / 1e6


def largest_difference(models, others):
    """Over M, B and K of all files, relative to the largest element of each."""
    worst = 0.0
    for a, b in zip(models, others):
        for name in "MBK":
            pairs = [(x, y) for one, other in zip(a[name], b[name]) for x, y in zip(one, other)]
            worst = max(worst, max(abs(x - y) for x, y in pairs) / max(abs(y) for _, y in pairs))
    return worst


def has(python, *modules):
    check = [python, "-c", f"import {', '.join(modules)}"]
    return subprocess.run(check, capture_output=True, check=False).returncode == 0


def linked(folder, logs, count):
    """So many names for a few files."""
    folder.mkdir()
    names = []
    for k in range(count):
        names.append(folder / f"log_{k:04}.mat")
        os.link(logs[k % len(logs)], names[-1])
    return names


def row(name, runs, count):
    walls, cpus = [one[0] for one in runs], [one[1] for one in runs]
    text = f"  {name:<46}{statistics.median(walls):9.2f}{statistics.median(cpus):9.2f}"
    text += f"{1e3 * statistics.median(cpus) / count:12.1f}"
    if len(runs[0]) > 2:
        text += f"{statistics.median(one[2] for one in runs) / count:14.0f}{max(one[3] for one in runs):10.0f}"
    print(text)


def compare(title, names, arguments, joblib):
    mbk = arguments.bin / "mbk"
    threads = ["--threads", str(arguments.threads), "--quiet", "--json"]
    peer = [arguments.python, HERE / "joblib_pipeline.py", "--workers", str(arguments.threads)]
    reference = [mbk, "identify", "--mode", "reference", *threads, *names]
    commands = {
        "reference": reference,
        "identify": [mbk, "identify", *threads, *names],
        "measure": [mbk, "measure", *threads, *names],
    }
    peers = {"identify": [*peer, *names], "measure": [*peer, "--measure", *names]} if joblib else {}
    ours, theirs = {name: [] for name in commands}, {name: [] for name in peers}
    run(reference)  # warms up
    for _ in range(arguments.runs):
        for name, command in commands.items():
            text, *took = run(command)
            ours[name].append(took)
            if name == "reference":
                models = [one["model"] for one in json.loads(text)["results"]]
        for name, command in peers.items():
            other = json.loads(run(command)[0])
            theirs[name].append((other["wall_s"], other["cpu_s"]))
            if name == "identify":
                other_models = other["models"]
    print(f"\n{title}, {names[0].stat().st_size / 1e6:.1f} MB each")
    print(f"  {'':<46}{'wall s':>9}{'CPU s':>9}{'ms a file':>12}{'faults a file':>14}{'most MB':>10}")
    row("mbk identify --mode reference", ours["reference"], len(names))
    row("mbk identify", ours["identify"], len(names))
    row("mbk measure", ours["measure"], len(names))
    if not joblib:
        return
    row("joblib_pipeline.py, without imports", theirs["identify"], len(names))
    row("joblib_pipeline.py --measure, without imports", theirs["measure"], len(names))
    if (arguments.bin / "bench_floor").exists():
        floor = json.loads(run([arguments.bin / "bench_floor", names[0], "11"])[0])
        parts = [1e3 * floor[part] for part in ("read_s", "inflate_s", "sha256_s")]
        alone = 1e3 * statistics.median(cpu for _, cpu in theirs["identify"]) / len(names) / sum(parts)
        print(f"  ms a file to read, unpack and hash it, by themselves: {parts[0]:.1f}, {parts[1]:.1f} and {parts[2]:.1f}; "
              f"joblib over these alone: {alone:.1f}")
    for title, one, other in (("identify --mode reference", "reference", "identify"),
                              ("identify", "identify", "identify"), ("measure", "measure", "measure")):
        for what, which in (("wall", 0), ("CPU", 1)):
            ratios = [b[which] / a[which] for a, b in zip(ours[one], theirs[other])]
            print(f"  joblib over mbk {title}, {what}: {' '.join(f'{ratio:.2f}' for ratio in ratios)}")
    difference = largest_difference(other_models, models)
    print(f"  M, B and K of the reference mode differ by at most {difference:.1e} (limit {AGREEMENT:g})")
    if not difference <= AGREEMENT:
        sys.exit("many_files.py: the two answers differ")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=HERE.parent / "build/release/bin", help="folder of mbk")
    parser.add_argument("--files", type=int, default=100, help="recordings (100; the full form has 1000)")
    parser.add_argument("--threads", type=int, default=2, help="recordings at a time, on either side (2)")
    parser.add_argument("--runs", type=int, default=3, help="timed runs of each program (3)")
    parser.add_argument("--python", default=sys.executable, help="the Python that has numpy, scipy and joblib, if any")
    arguments = parser.parse_args()
    if min(arguments.files, arguments.threads, arguments.runs) < 1:
        parser.error("--files, --threads and --runs must be at least 1")
    for program in ("mbk", "make_log"):
        if not (arguments.bin / program).exists():
            sys.exit(f"many_files.py: {arguments.bin / program} is not there; build first, or name its folder with --bin")

    joblib = has(arguments.python, "numpy", "scipy.signal", "scipy.io", "joblib")
    print(f"{arguments.files} logs of 62.1 s at 1 kHz, {arguments.threads} at a time, {arguments.runs} runs; medians")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        logs = [folder / f"made_{k}.mat" for k in range(min(DISTINCT, arguments.files))]
        for k, log in enumerate(logs):
            run([arguments.bin / "make_log", "--protocol", "sinusoidal", "--seed", str(k + 1), "--out", log])
        compare("MAT v7", linked(folder / "v7", logs, arguments.files), arguments, joblib)
        if not joblib:
            print(f"\n{arguments.python} has no numpy, scipy and joblib: nothing to compare with, no MAT v5 made")
            return
        plain = [folder / f"plain_{k}.mat" for k in range(len(logs))]
        run([arguments.python, "-c", UNCOMPRESS, *[path for pair in zip(logs, plain) for path in pair]])
        compare("MAT v5, uncompressed", linked(folder / "v5", plain, arguments.files), arguments, joblib)


if __name__ == "__main__":
    main()
