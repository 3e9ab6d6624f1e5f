#!/usr/bin/env python3
"""Every nth call fails: commands of mbk are run again and again, each time with another call that the system refuses.

First each command runs without a fault, and its calls are counted by group: write, sync, open, name (rename, unlink, …),
read, status (stat, …), socket, sleep, clock, memory (malloc), thread. Then it runs for n = 1, 2, 3, … with the nth call of
a group failing, once or from then on. After each run: no death by a signal, exit 0 only where the output is whole and
what it is without a fault, otherwise a line that says why; what was there is not destroyed; the robot's torque ends on a
ramp with the motors off; and every tick that the robot saw is in the recording or the journal.

Without options it tries what 40 s allow, taken evenly from all. --all tries every n (of allocations the first of each
chain of calls that leads to one, and of what is called more than 3000 times as many, taken evenly):
  MBK=build/release/bin/mbk FAILING_CALLS=build/release/tests/faults/failing_calls.so tests/faults/nth_call.py --all
"""

import argparse
import collections
import concurrent.futures
import errno
import multiprocessing
import os
import pathlib
import random
import shutil
import struct
import sys
import tempfile
import time

import programs
from programs import Fault

#   how the calls of a group fail: error (0: half of the bytes), and whether all later ones do
WAYS = {
    "write": ((errno.ENOSPC, False), (errno.ENOSPC, True), (errno.EIO, False), (errno.EINTR, False), (0, False)),
    "sync": ((errno.EIO, False), (errno.ENOSPC, True), (errno.EINTR, False)),
    "open": ((errno.EMFILE, False), (errno.EMFILE, True), (errno.EACCES, False)),
    "name": ((errno.EIO, False), (errno.ENOSPC, True)),
    "read": ((errno.EIO, False), (errno.EIO, True), (errno.EINTR, False), (0, False)),
    "status": ((errno.EIO, False), (errno.EIO, True)),
    "socket": ((errno.ENOBUFS, False), (errno.ENOBUFS, True), (errno.EINTR, False)),
    "sleep": ((errno.EINTR, False), (errno.EINVAL, True)),
    "clock": ((errno.EINVAL, False), (errno.EINVAL, True)),
    "memory": ((errno.ENOMEM, False), (errno.ENOMEM, True)),
    "thread": ((errno.EAGAIN, False), (errno.EAGAIN, True)),
}
MOST = 3000  # n tried of one group and way
BETWEEN_LINES = 10  # s between two lines that say how far it is
tasks = {}  # by name; the processes that try them inherit it


def attempt(name, fault):
    """One run with a fault.   @returns  whether a call failed, and what is wrong"""
    with tempfile.TemporaryDirectory(prefix="mbk-fault-") as folder:
        folder = pathlib.Path(folder)
        ran = tasks[name].perform(folder, fault)
        problem = tasks[name].judge(ran, folder, fault)
        said = (ran.message or ran.err.strip())[-300:]
        return ran.failed > 0, ran.code, problem, said


def stacks(task, count):
    """The first allocation of each chain of calls, in order."""
    with tempfile.TemporaryDirectory(prefix="mbk-fault-") as folder:
        file = pathlib.Path(folder) / ".stacks"
        task.perform(pathlib.Path(folder), Fault(), {"MBK_FAULT_STACKS": str(file)})
        with open(file, "rb") as opened:
            sums = struct.unpack(f"={count}Q", opened.read(8 * count))
    first = {}
    for n, chain in enumerate(sums, 1):
        first.setdefault(chain, n)
    return sorted(first.values())


def evenly(numbers, most):
    numbers = list(numbers)
    if len(numbers) <= most:
        return numbers
    return [numbers[k * len(numbers) // most] for k in range(most)]


def faults_of(task, groups):
    """All that can be tried with a command, by group and way."""
    for group in groups:
        calls = task.reference.calls[group]
        if calls == 0:
            continue
        numbers = stacks(task, calls) if group == "memory" else range(1, calls + 1)
        for error, sticky in WAYS[group]:
            yield [Fault(group, n, error, sticky) for n in evenly(numbers, MOST)]


def shuffled(lists, lot):
    """One of each list in turn, from anywhere in it, until all are used up."""
    lists = lot.sample([lot.sample(one, len(one)) for one in lists], len(lists))
    while any(lists):
        for one in lists:
            if one:
                yield one.pop()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="every n, however long it takes")
    parser.add_argument("--seconds", type=float, default=40, help="without --all: as many runs as fit in (40)")
    parser.add_argument("--command", action="append", choices=[task.name for task in programs.TASKS])
    parser.add_argument("--group", action="append", choices=programs.GROUPS)
    parser.add_argument("--nth", type=int, help="only this n")
    parser.add_argument("--last", type=float, default=1.0,
                        help="only the last calls, 0.1: the last tenth, in which the output is written")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=min(4, os.cpu_count() or 1))
    arguments = parser.parse_args()
    begin = time.monotonic()
    lists, counted = [], {}
    with tempfile.TemporaryDirectory(prefix="mbk-faults-") as folder:
        folder = pathlib.Path(folder)
        for kind in programs.TASKS:
            if arguments.command and kind.name not in arguments.command:
                continue
            task = tasks[kind.name] = kind(folder)
            (folder / "reference").mkdir()
            counted[kind.name] = task.refer(folder / "reference").calls
            shutil.rmtree(folder / "reference")
            for one in faults_of(task, arguments.group or programs.GROUPS):
                first = (1 - arguments.last) * counted[kind.name][one[0].group] if one else 0
                lists.append([(kind.name, fault) for fault in one
                              if arguments.nth in (None, fault.nth) and fault.nth > first])
        wrong, runs, failed = [], collections.Counter(), collections.Counter()
        context = multiprocessing.get_context("fork")
        with concurrent.futures.ProcessPoolExecutor(arguments.jobs, mp_context=context) as pool:
            waiting, left = {}, shuffled(lists, random.Random(arguments.seed))
            whole, next_line = sum(map(len, lists)), begin + BETWEEN_LINES
            while True:
                if time.monotonic() >= next_line:
                    next_line = time.monotonic() + BETWEEN_LINES
                    print(f"{sum(runs.values())} of {whole} runs in {time.monotonic() - begin:.0f} s, {len(wrong)} wrong",
                          file=sys.stderr, flush=True)
                over = not arguments.all and time.monotonic() - begin > arguments.seconds
                while not over and len(waiting) < 2 * arguments.jobs:
                    case = next(left, None)
                    if case is None:
                        break
                    waiting[pool.submit(attempt, *case)] = case
                if not waiting:
                    break
                done, _ = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
                for one in done:
                    name, fault = waiting.pop(one)
                    did_fail, code, problem, said = one.result()
                    runs[name, fault.group] += 1
                    failed[name, fault.group] += did_fail
                    if problem:
                        wrong.append((name, fault, problem))
                        print(f"{name}, {fault}: {problem}\n    exit {code}; {said}", flush=True)
    print("command       group     calls    runs with a failed call")
    for (name, group), number in sorted(runs.items()):
        print(f"{name:<14}{group:<8}{counted[name][group]:>7}{failed[name, group]:>8}")
    print(f"{sum(runs.values())} runs in {time.monotonic() - begin:.0f} s, a call failed in {sum(failed.values())}; "
          f"{len(wrong)} wrong")
    for problem, number in collections.Counter(problem for *_, problem in wrong).most_common():
        print(f"{number:>6} × {problem}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
