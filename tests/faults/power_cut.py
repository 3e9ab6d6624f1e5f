#!/usr/bin/env python3
"""Power cuts: what was on its way to the disk is torn, lost and reordered, and what is left is recovered.

A command runs once, and each write, sync, rename, … of it is written down (failing_calls.c). Then the power goes at a
moment drawn by lot. What was written before the last sync of a file that had ended is there. Of what came later each
sector of 512 bytes is there or not, and a file may be as long as it was to be without its bytes. New names, renames and
removals since the last sync of the folder have happened or not, each by itself. On that disk it is asked for what was
promised: everything that had been synced is recovered, no row is another than was recorded, and a file under its final
name is whole, or what it was before.

Without options it tries what 20 s allow; --cuts 1000 so many of each command:
  MBK=build/release/bin/mbk FAILING_CALLS=build/release/tests/faults/failing_calls.so tests/faults/power_cut.py --cuts 1000
"""

import argparse
import collections
import math
import os
import pathlib
import random
import shutil
import struct
import sys
import tempfile
import time

import programs
from programs import FINE, Fault

RECORD = struct.Struct("=c3xIQQQ")
SECTOR = 512
MIN_CUTS = 5  # of each command, where the machine is slow
KEEP_SIZE = 1  # of fallocate


class File:
    """Contents: what is on the disk, and what is on its way."""

    def __init__(self, data=b""):
        self.durable, self.pending, self.syncing = bytearray(data), [], []

    @staticmethod
    def write(data, offset, what):
        if len(data) < offset:
            data.extend(bytes(offset - len(data)))
        data[offset:offset + len(what)] = what

    @staticmethod
    def resize(data, size):
        del data[size:]
        data.extend(bytes(size - len(data)))

    def apply(self, data, operation):
        if operation[0] == "W":
            self.write(data, *operation[1:])
        else:
            self.resize(data, operation[1])

    def end_sync(self):
        done = self.syncing.pop(0) if self.syncing else 0
        for operation in self.pending[:done]:
            self.apply(self.durable, operation)
        self.pending = self.pending[done:]
        self.syncing = [max(0, mark - done) for mark in self.syncing]

    def after_the_cut(self, lot):
        """One of the contents that the disk may have."""
        data = bytearray(self.durable)
        way = lot.choice(("none", "all", "first", "sectors", "sectors", "reordered"))
        if way in ("none", "all", "first"):
            count = {"none": 0, "all": len(self.pending)}.get(way, lot.randint(0, len(self.pending)))
            for operation in self.pending[:count]:
                self.apply(data, operation)
            return bytes(data)
        share, pieces = lot.random(), []
        for operation in self.pending:
            if operation[0] != "W":
                pieces.append(operation)
                continue
            _, offset, what = operation
            begin = offset
            while begin < offset + len(what):
                end = min((begin // SECTOR + 1) * SECTOR, offset + len(what))
                pieces.append(("W", begin, what[begin - offset:end - offset]))
                begin = end
        if way == "reordered":
            lot.shuffle(pieces)
        for piece in pieces:
            if lot.random() < share:
                self.apply(data, piece)
        longest = max([len(data)] + [piece[1] + len(piece[2]) for piece in pieces if piece[0] == "W"])
        if lot.random() < 0.5:
            self.resize(data, longest)
        return bytes(data)


class Disk:
    """A folder, and those in it, as the events of a trace leave them."""

    def __init__(self, before, root):
        """@param before  by its name what was there: inode and contents, None of a folder   @param root  path, inode"""
        self.folder, inode = root
        self.folders = {inode: "."}  # by inode
        self.folders |= {inode: name for name, (inode, data) in before.items() if data is None}
        self.files = {inode: File(data) for inode, data in before.values() if data is not None}
        self.names = {name: self.files.get(inode) for name, (inode, _) in before.items()}  # on the disk; None: a folder
        self.now = dict(self.names)
        self.pending, self.syncing = [], collections.defaultdict(list)

    def name(self, path):
        path = path.decode()
        if os.path.isabs(path):
            path = os.path.relpath(path, self.folder)
        path = os.path.normpath(path)
        return None if path.startswith("..") or path == "." else path

    @staticmethod
    def link(names, operation):
        kind, first, second = operation
        if kind == "create":
            names[first] = second
        elif kind == "rename":
            for name in [name for name, file in names.items() if file is second[1]]:
                del names[name]
            names[second[0]] = second[1]
        else:
            names.pop(first, None)

    def change(self, operation):
        self.pending.append(operation)
        self.link(self.now, operation)

    @staticmethod
    def where(operation):
        """The folder whose sync makes it last."""
        kind, first, second = operation
        return os.path.dirname(second[0] if kind == "rename" else first) or "."

    def take(self, event):
        kind, flags, inode, offset, data = event
        if kind == "O":
            name = self.name(data)
            if name is not None and flags & os.O_CREAT and name not in self.now:
                self.files[inode] = File()
                self.change(("create", name, self.files[inode]))
            elif name in self.now and flags & os.O_TRUNC:
                self.files[inode].pending.append(("T", 0))
        elif kind == "M":
            if self.name(data) is not None:
                self.folders[inode] = self.name(data)
                self.change(("create", self.name(data), None))
        elif kind == "R":
            first, second = map(self.name, data.split(b"\0"))
            self.change(("rename", first, (second, self.now[first])))
        elif kind == "U":
            if self.name(data) in self.now:
                self.change(("remove", self.name(data), None))
        elif inode in self.folders:
            folder = self.folders[inode]
            if kind == "B":
                self.syncing[folder].append([one for one in self.pending if self.where(one) == folder])
            elif kind == "E":
                done = self.syncing[folder].pop(0) if self.syncing[folder] else []
                for operation in done:
                    if any(one is operation for one in self.pending):
                        self.link(self.names, operation)
                        self.pending = [one for one in self.pending if one is not operation]
        elif inode in self.files:
            file = self.files[inode]
            if kind == "W":
                file.pending.append(("W", offset, data))
            elif kind == "T" or (kind == "A" and not flags & KEEP_SIZE):
                file.pending.append(("T", offset))
            elif kind == "B":
                file.syncing.append(len(file.pending))
            elif kind == "E":
                file.end_sync()

    @staticmethod
    def reached(names, of_file):
        """Contents of the files that a path leads to; None of folders."""
        def leads(name):
            parent = os.path.dirname(name)
            return not parent or (parent in names and names[parent] is None and leads(parent))
        return {name: None if file is None else of_file(file) for name, file in names.items() if leads(name)}

    def synced(self):
        """What is surely on the disk."""
        return self.reached(self.names, lambda file: bytes(file.durable))

    def after_the_cut(self, lot):
        names = dict(self.names)
        for operation in self.pending:
            if lot.random() < 0.5:
                self.link(names, operation)
        return self.reached(names, lambda file: file.after_the_cut(lot))


def put(folder, contents):
    """Writes what is left of a disk."""
    for name, data in sorted(contents.items()):
        if data is None:
            (folder / name).mkdir(mode=0o700)
        else:
            (folder / name).write_bytes(data)


def events_of(file):
    data, at = file.read_bytes(), 0
    while at < len(data):
        kind, flags, inode, offset, length = RECORD.unpack_from(data, at)
        at += RECORD.size
        yield kind.decode(), flags, inode, offset, data[at:at + length]
        at += length


class Traced:
    """A command whose traces are looked at."""

    def __init__(self, task, folder):
        self.task = task
        (folder / "reference").mkdir()
        task.refer(folder / "reference")
        self.truth = programs.rows(folder / "reference" / "x.h5", folder) if task.name in ("session", "recover") else None
        self.counted = {}  # rows in what was surely there

    def trace(self, folder):
        """The folder before, and all that happened to it."""
        with tempfile.TemporaryDirectory(prefix="mbk-trace-", dir=folder) as run:
            run = pathlib.Path(run)
            file = folder / "trace"
            file.unlink(missing_ok=True)
            shutil.copytree(self.task.inputs, run, dirs_exist_ok=True)
            before = {str(path.relative_to(run)): (path.stat().st_ino, None if path.is_dir() else path.read_bytes())
                      for path in run.rglob("*")}
            root = (str(run), run.stat().st_ino)
            ran = self.task.perform(run, Fault(), {"MBK_FAULT_TRACE": str(file)})
            if ran.code != FINE:
                raise AssertionError(f"{self.task.name}: exit {ran.code}: {ran.err}")
            if self.task.name == "session":
                self.truth = programs.rows(run / "x.h5", run)
        return before, root, list(events_of(file))

    def found(self, contents):
        """What commands make of a disk: rows of the recording and of the journal, or why there are none."""
        with tempfile.TemporaryDirectory(prefix="mbk-cut-") as folder:
            folder = pathlib.Path(folder)
            put(folder, contents)
            recording = journal = None
            problem = ""
            if "x.h5" in contents:
                recording = programs.rows(folder / "x.h5", folder)
                if recording is None:
                    problem = "x.h5 does not open"
            if "x.h5.journal" in contents:
                for command in (["info", "x.h5.journal"], ["recover", "x.h5.journal", "--keep", "--out", "r.h5"]):
                    ran = programs.run(command, folder)
                    if ran.code is None or ran.code < 0 or (ran.code != FINE and not ran.message):
                        problem = f"{command[0]} of the journal: exit {ran.code} {ran.err[-200:]}"
                if (folder / "r.h5").exists():
                    journal = programs.rows(folder / "r.h5", folder)
                if (folder / "x.h5.journal").read_bytes() != contents["x.h5.journal"]:
                    problem = "the journal was changed, and --keep was asked for"
            return recording, journal, problem

    def wrong_row(self, rows):
        """Each row is that of the truth at its time, or NaN."""
        times, columns = self.truth["time_s"], [name for name in self.truth if name != "time_s"]
        at = {round(time * 1000): k for k, time in enumerate(times)}
        for k, moment in enumerate(rows["time_s"]):
            truth = at.get(round(moment * 1000))
            for name in columns:
                value = rows[name][k]
                if math.isnan(value):
                    continue
                if truth is None or value != self.truth[name][truth]:
                    return f"{name} in row {k}, {moment} s"
        return ""

    @staticmethod
    def whole_rows(rows):
        """Rows that hold a joint's angle."""
        return 0 if rows is None else sum(not math.isnan(value) for value in rows["joint_1_rad"])

    def judge(self, disk, contents):
        if self.task.name == "convert":
            allowed = (self.task.whole["y.mat"], (self.task.inputs / "y.mat").read_bytes())
            if contents.get("y.mat") not in allowed:
                return "y.mat is neither the old one nor the new one"
            return "" if contents.get("x.h5") == self.task.whole["x.h5"] else "x.h5, which it reads, is another"
        recording, journal, problem = self.found(contents)
        if problem:
            return problem
        for rows in (recording, journal):
            if rows is not None and (wrong := self.wrong_row(rows)):
                return f"a wrong row: {wrong}"
        if recording is not None and len(recording["time_s"]) != len(self.truth["time_s"]):
            return f"the recording has {len(recording['time_s'])} of {len(self.truth['time_s'])} rows"
        surely = disk.synced()
        key = tuple(sorted((name, hash(data)) for name, data in surely.items()))
        if key not in self.counted:
            there = self.found(surely)
            self.counted[key] = max(self.whole_rows(there[0]), self.whole_rows(there[1]))
        kept = max(self.whole_rows(recording), self.whole_rows(journal))
        if kept < self.counted[key]:
            return f"{kept} rows are left of {self.counted[key]} that were synced"
        return ""


class TracedStudy(Traced):
    """A command of mbk study."""

    def state(self, contents):
        """What the study is on that disk, and what is wrong with it."""
        with tempfile.TemporaryDirectory(prefix="mbk-cut-") as folder:
            folder = pathlib.Path(folder)
            put(folder, contents)
            return self.task.state(folder)

    def judge(self, disk, contents):
        state, problem = self.state(contents)
        if problem:
            return problem
        surely = disk.synced()
        key = tuple(sorted((name, hash(data)) for name, data in surely.items()))
        if key not in self.counted:
            there, problem = self.state(surely)
            if problem:
                return f"of what was synced: {problem}"
            self.counted[key] = self.task.progress(there)
        if self.task.progress(state) < self.counted[key]:
            return "what had been stored is no longer there"
        return ""


def traced(kind, folder):
    return (TracedStudy if issubclass(kind, programs.Study) else Traced)(kind(folder), folder)


KINDS = (programs.Session, programs.Recover, programs.Convert, programs.StudyAdd, programs.StudyMeasure,
         programs.StudyForget)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cuts", type=int, help="of each command, however long that takes")
    parser.add_argument("--seconds", type=float, default=20, help="without --cuts: as many as fit in (20)")
    parser.add_argument("--command", action="append", choices=[kind.name for kind in KINDS])
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    lot, begin = random.Random(arguments.seed), time.monotonic()
    tried, wrong, synced = collections.Counter(), [], collections.Counter()
    kinds = [kind for kind in KINDS if not arguments.command or kind.name in arguments.command]
    for kind in kinds:
        with tempfile.TemporaryDirectory(prefix="mbk-power-") as folder:
            folder = pathlib.Path(folder)
            looked_at = traced(kind, folder)
            before, root, events = looked_at.trace(folder)
            until = time.monotonic() + arguments.seconds / len(kinds)
            synced[kind.name] = sum(event[0] == "E" for event in events)
            while tried[kind.name] < (arguments.cuts or MIN_CUTS) or (not arguments.cuts and time.monotonic() < until):
                moment = lot.randint(0, len(events))
                disk = Disk(before, root)
                for event in events[:moment]:
                    disk.take(event)
                problem = looked_at.judge(disk, disk.after_the_cut(lot))
                tried[kind.name] += 1
                if problem:
                    wrong.append(problem)
                    print(f"{kind.name}, cut {tried[kind.name]}, after {moment} of {len(events)} events: {problem}",
                          flush=True)
    for name, number in tried.items():
        print(f"{name:<14}{number:>6} power cuts, among {synced[name]} syncs")
    for problem, number in collections.Counter(wrong).most_common(5):
        print(f"{number:>6} × {problem}")
    print(f"{sum(tried.values())} power cuts in {time.monotonic() - begin:.0f} s; {len(wrong)} wrong")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
