"""Sessions in real time that are killed from outside (SIGKILL) at moments drawn by lot, and what comes back of them.

MBK_KILLS sets how many moments there are (12), MBK_KILLS_SEED draws others.
What is lost is measured from outside: the session's first tick is dated by its status lines, on the clock by which the
kill is dated too. The first line comes up to 10 ms after the tick that it tells of, so much may be lost more than is
said; on a machine that stalls the line itself may be late.
"""

import concurrent.futures
import csv
import hashlib
import os
import random
import re
import signal
import subprocess
import sys
import threading
import time

from command import BAD_DATA, Case, FINE, program, run

KILLS = int(os.environ.get("MBK_KILLS", "12"))
SEED = int(os.environ.get("MBK_KILLS_SEED", "1"))
MOST_LOST = 0.2  # s
FIRST_PROGRESS = 1.0  # s: by then a session has said how far it is
AT_A_TIME = 4
AS_OTHERS = ("chrt", "--other", "0")  # a program begins as programs do, whatever this one goes before

EXPERIMENT = """
[robot]
d1_mm = 254
d2_mm = 266.7
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = 1.5
moving_in_s = 0.5
[participant]
kind = "arm"
number = 1
"""


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def times_of(recording, folder):
    """The sample times of a recording."""
    table = folder / (recording.stem + ".csv")
    ran = run("convert", recording, table)
    if ran.code != FINE:
        raise AssertionError(ran)
    with open(table, encoding="utf-8") as lines:
        rows = csv.reader(line for line in lines if not line.startswith("#"))
        at = next(rows).index("time_s")
        return [float(row[at]) for row in rows]


STALLS = """
import os, select, sys, time
if {priority} > 0:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param({priority}))
worst, before = 0.0, time.monotonic()
while not select.select([sys.stdin], [], [], 0.001)[0]:
    now = time.monotonic()
    worst, before = max(worst, now - before - 0.001), now
print(worst)
"""


class Stalls:
    """How long this machine lets a program wait that wants to run every millisecond, before others where it may."""

    def __init__(self, priority=0):
        self.priority = priority

    def __enter__(self):
        self.process = subprocess.Popen([sys.executable, "-c", STALLS.format(priority=self.priority)], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        return self

    def __exit__(self, *_):
        self.worst = float(self.process.communicate()[0])


class Run:
    """A session in real time: begun, dated, killed."""

    def __init__(self, folder, name, experiment="experiment.toml"):
        self.target = folder / f"{name}.h5"
        self.journal = folder / f"{name}.h5.journal"
        self.process = subprocess.Popen([*AS_OTHERS, program("MBK"), "run", folder / experiment, "--out", self.target,
                                         "--no-measure"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.first = None  # by CLOCK_MONOTONIC
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            came = time.monotonic()
            said = re.match(rb"\s*(\d+\.\d) s ", line)
            if said:  # rounded to 0.1 s, so it may have been half of that less; but not below zero
                latest = came - max(0.0, float(said[1]) - 0.05)
                self.first = latest if self.first is None else min(self.first, latest)

    def end(self):
        self.process.wait()
        self.reader.join()
        self.process.stdout.close()
        self.process.stderr.close()

    def wait_for_the_recording(self):
        """Until it is being written beside the journal, or is there."""
        part = self.target.with_name(f".{self.target.name}.{self.process.pid}.part")
        while not part.exists() and not self.target.exists() and self.process.poll() is None:
            time.sleep(0.0002)

    def wait_for_ticks(self):
        """Until the journal holds blocks of ticks, however long a busy machine takes."""
        while self.process.poll() is None and not (self.journal.exists() and self.journal.stat().st_size > 50_000):
            time.sleep(0.01)

    def kill(self):
        killed = time.monotonic()
        self.process.send_signal(signal.SIGKILL)
        self.end()
        return killed


class Killing(Case):
    """Sessions that are killed at any moment, and what comes back of them."""

    def setUp(self):
        super().setUp()
        self.file("experiment.toml", EXPERIMENT)

    def begin(self, name):
        return Run(self.folder, name)

    def whole_run(self):
        begin = time.monotonic()
        whole = self.begin("whole")
        whole.end()
        self.assertEqual(whole.process.returncode, FINE)
        return time.monotonic() - begin, whole.target

    def killed_at(self, number, moment, at_the_end):
        """A session that is killed so long after its start, or after the recording is begun to be made of its journal, and
        when; None where it was over before."""
        session = self.begin(f"killed_{number}")
        if at_the_end:
            session.wait_for_the_recording()
        time.sleep(moment)
        if session.process.poll() is None:
            return session, session.kill()
        session.end()
        return session, None

    def left_by(self, session, killed):
        """What is there of it, and how much was lost [s]."""
        if killed is None:
            self.assertEqual(session.process.returncode, FINE)
            self.assertFalse(session.journal.exists())
            return "was over", 0.0
        if not session.journal.exists():
            if session.target.exists():
                return "recording alone", 0.0
            self.assertIsNone(session.first)
            return "nothing yet", 0.0
        what = "journal and recording" if session.target.exists() else "journal"
        before = digest(session.target) if session.target.exists() else None
        ran = run("recover", session.journal)
        if ran.code == BAD_DATA and not session.target.exists():  # no block of ticks, or not even a header
            lost = 0.0 if session.first is None else killed - session.first
            return "before the first block", lost
        torn = ran.code == BAD_DATA  # the block that was being written: said, and the journal is kept
        if torn:
            self.assertRegex(ran.out, r"\d bytes?\b", ran)
        else:
            self.assertEqual(ran.code, FINE, ran)
        self.assertEqual(session.journal.exists(), torn)
        if before:
            self.assertEqual(digest(session.target), before)
        once = digest(session.target)
        again = run("recover", session.journal)
        self.assertEqual(again.code, BAD_DATA, again)
        self.assertEqual(digest(session.target), once)
        times = times_of(session.target, self.folder)
        for one, other in zip(times, times[1:]):
            self.assertLess(one, other)
        if "completed" in ran.out or "safety stop" in ran.out:  # the ending was there: the trial was over
            return what + ", with its ending", 0.0
        self.assertIn("interrupted", ran.out)
        if session.first is None:  # a block was written before the first line of progress, so nothing dates the loss
            self.assertLess(times[-1], FIRST_PROGRESS)
            return what + ", before it said anything", 0.0
        return what, killed - session.first - times[-1]

    def kill_at_moments(self, priority=0):
        """A whole recording and what it was, the kills of other sessions, and the longest stall beside them: for judge."""
        whole, kept = self.whole_run()
        unharmed = digest(kept)
        lot = random.Random(SEED)
        at_the_end = [k % 3 == 2 for k in range(KILLS)]
        moments = [lot.uniform(0.0, 0.012) if end else lot.uniform(0.02, whole) for end in at_the_end]
        with Stalls(priority) as stalls, concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
            kills = list(zip(moments, pool.map(self.killed_at, range(KILLS), moments, at_the_end)))
        return kept, unharmed, kills, stalls.worst

    def judge(self, max_lost, kept, unharmed, kills, stall):
        with concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
            results = list(pool.map(lambda kill: self.left_by(*kill[1]), kills))
        for what in sorted({what for what, _ in results}):
            lost = [1e3 * lost for one, lost in results if one == what]
            print(f"{what}: {len(lost)} times, at most {max(lost):.0f} ms lost", file=sys.stderr)
        print(f"the machine let a program wait for {1e3 * stall:.0f} ms at most", file=sys.stderr)
        for (moment, _), (what, lost) in zip(kills, results):
            self.assertLessEqual(lost, max_lost + stall, f"{what}, killed after {moment:.3f} s")
        self.assertEqual(digest(kept), unharmed)
