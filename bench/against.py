#!/usr/bin/env python3
"""Which of two builds of mbk is faster? Times whole commands of both in turns; tools/bench --against COMMIT builds them.

usage: against.py --before FOLDER --now FOLDER [--rounds 15] [--only NAME ...] [--short]

Each round runs the build before twice and the present one once, in an order that moves on from round to round. The
ratio now/before is taken within each round, and so is before/before, which is what this machine calls equal: a ratio
that lies within that noise says nothing. Told are processor times (of the process and the kernel for it), the median of
each and the distribution-free interval that holds the median of such ratios with at least 95 %. Times are reported and
never judged: the exit code is 0 unless a command fails in the present build.
"""

import argparse
import math
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import commands

HERE = Path(__file__).resolve().parent
FULL = commands.Load(seconds=62.1, small_files=100, small_seconds=4)
SHORT = commands.Load(seconds=20, small_files=10, small_seconds=4)


class Failed(Exception):
    """A command did not end with exit code 0."""


def cpu_seconds(command, folder):
    """Processor time of one process, in user mode and of the kernel for it."""
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            errors.seek(0)
            raise Failed(f"exit code {process.returncode}: {errors.read().decode(errors='replace').strip()[-300:]}")
    return usage.ru_utime + usage.ru_stime


def interval(values):
    """The values between which the median of all such values lies with at least 95 %, by the binomial distribution of
    ranks (Conover, Practical Nonparametric Statistics, 3rd ed., ch. 3.2); least and greatest where there are too few."""
    ordered, n = sorted(values), len(values)
    low, tail = 0, 0.5 ** n
    while low + 1 < n // 2 and 2.0 * (tail + math.comb(n, low + 1) * 0.5 ** n) <= 0.05:
        low += 1
        tail += math.comb(n, low) * 0.5 ** n
    return ordered[low], ordered[n - 1 - low]


def rounds_of(before, now, command, folder, count):
    """Seconds of each round: before, now, before again. The first round only warms up."""
    builds = {"before": before, "now": now, "again": before}
    order, found = list(builds), []
    for _ in range(count + 1):
        took = {}
        for name in order:
            commands.clear(folder, command)
            try:
                took[name] = cpu_seconds([builds[name], *command.arguments], folder)
            except Failed as failure:
                raise Failed(f"{'the present build' if name == 'now' else 'the build before'}: {failure}") from None
        found.append(took)
        order = order[1:] + order[:1]
    return found[1:]


def verdict(ratios, noise):
    """What the ratios show: the interval is on one side of 1, and the median outside the noise."""
    low, high = interval(ratios)
    least, most = interval(noise)
    if low > 1.0 and statistics.median(ratios) > most:
        return "slower"
    if high < 1.0 and statistics.median(ratios) < least:
        return "faster"
    return "no difference shown"


def line(name, found):
    ratios = [took["now"] / took["before"] for took in found]
    noise = [took["again"] / took["before"] for took in found]

    def told(values):
        low, high = interval(values)
        return f"{statistics.median(values):8.3f} [{low:.3f}, {high:.3f}]"

    milliseconds = "".join(f"{1e3 * statistics.median(took[which] for took in found):9.1f}" for which in ("before", "now"))
    return f"  {name:<32}{milliseconds}{told(ratios)}{told(noise)}  {verdict(ratios, noise)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", type=Path, required=True, help="folder of the mbk to compare with")
    parser.add_argument("--now", type=Path, default=HERE.parent / "build/release/bin", help="folder of mbk and make_log")
    parser.add_argument("--rounds", type=int, default=15, help="of each command (15)")
    parser.add_argument("--only", action="append", metavar="NAME", help="only this command; may be repeated")
    parser.add_argument("--short", action="store_true", help="recordings of 20 s and ten small files, for a first look")
    given = parser.parse_args()
    if given.rounds < 6:
        parser.error("--rounds must be at least 6: an interval of 95 % takes as many")
    load = SHORT if given.short else FULL
    everything = load.commands()
    for name in given.only or []:
        if name not in [command.name for command in everything]:
            parser.error(f"there is no command '{name}'; there are: {', '.join(command.name for command in everything)}")
    chosen = [command for command in everything if not given.only or command.name in given.only]
    before, now = given.before.resolve() / "mbk", given.now.resolve() / "mbk"
    for program in (before, now, now.with_name("make_log")):
        if not program.exists():
            sys.exit(f"against.py: {program} is not there; build first, or name its folder")
    print(f"{given.rounds} rounds; CPU time of whole processes in ms, medians; {commands.processor()}\n\n"
          f"  {'':<32}{'before':>9}{'now':>9}{'now/before, 95 %':>24}{'before/before':>22}", flush=True)
    code = 0
    with tempfile.TemporaryDirectory(prefix="mbk-against-") as name:
        folder = Path(name)
        load.make(now.parent, folder, chosen)
        for command in chosen:
            try:
                print(line(command.name, rounds_of(before, now, command, folder, given.rounds)), flush=True)
            except Failed as failure:
                print(f"  {command.name:<32}  {failure}", flush=True)
                code = max(code, 1 if "present" in str(failure) else 0)
    return code


if __name__ == "__main__":
    sys.exit(main())
