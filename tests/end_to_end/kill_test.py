#!/usr/bin/env python3
"""Sessions in real time that are killed from outside (SIGKILL) at moments drawn by lot, and disks that refuse.

MBK_KILLS sets how many moments there are (12), MBK_KILLS_SEED draws others; the full form is
  MBK_KILLS=100 MBK=build/test/bin/mbk MAKE_LOG=build/test/bin/make_log python3 tests/end_to_end/kill_test.py
What is lost is measured from outside: the session's first tick is dated by its status lines, on the clock by which the
kill is dated too. The first line comes up to 10 ms after the tick that it tells of, so much may be lost more than is
said; on a machine that stalls the line itself may be late.
"""

import concurrent.futures
import csv
import hashlib
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import threading
import time

from command import BAD_DATA, Case, FINE, WRONG_USAGE, main, program, run

KILLS = int(os.environ.get("MBK_KILLS", "12"))
SEED = int(os.environ.get("MBK_KILLS_SEED", "1"))
MOST_LOST = 0.2  # s
FIRST_PROGRESS = 1.0  # s: by then a session has said how far it is
AT_A_TIME = 4

EXPERIMENT = """
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


class Stalls:
    """How long this machine lets a thread wait that wants to run every millisecond, before others where it may."""

    def __init__(self, priority=0):
        self.priority = priority

    def __enter__(self):
        self.worst, self.over = 0.0, False
        self.thread = threading.Thread(target=self.watch)
        self.thread.start()
        return self

    def watch(self):
        if self.priority > 0:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(self.priority))
        before = time.monotonic()
        while not self.over:
            time.sleep(0.001)
            now = time.monotonic()
            self.worst, before = max(self.worst, now - before - 0.001), now

    def __exit__(self, *_):
        self.over = True
        self.thread.join()


FIFO_LOAD = """
import os, time
os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param({priority}))
while True:
    until = time.monotonic() + 0.02
    while time.monotonic() < until:
        pass
    time.sleep(0.005)
"""
LOAD_PRIORITY, RECORDER_PRIORITY = 50, 70


class Load:
    """Programs, one for each core, that go before all that is not in real time; none where that is not allowed."""

    def __enter__(self):
        may = subprocess.run([sys.executable, "-c", "import os; os.sched_setscheduler(0, os.SCHED_FIFO, "
                              "os.sched_param(1))"], capture_output=True, check=False).returncode == 0
        code = FIFO_LOAD.format(priority=LOAD_PRIORITY)
        self.busy = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(os.cpu_count() if may else 0)]
        return self

    def __exit__(self, *_):
        for one in self.busy:
            one.kill()
            one.wait()


class Run:
    """A session in real time: begun, dated, killed."""

    def __init__(self, folder, name, experiment="experiment.toml"):
        self.target = folder / f"{name}.h5"
        self.journal = folder / f"{name}.h5.journal"
        self.process = subprocess.Popen([program("MBK"), "run", folder / experiment, "--out", self.target,
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
            self.assertRegex(ran.err, "holds no ticks|header is not whole|is no journal", ran)
            lost = 0.0 if session.first is None else killed - session.first
            return "before the first block", lost
        torn = ran.code == BAD_DATA  # the block that was being written: said, and the journal is kept
        if torn:
            self.assertRegex(ran.out, r"bytes? belongs? to no whole block", ran)
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

    def kill_at_moments(self, at_a_time, priority=0):
        """A whole recording and what it was, the kills of other sessions, and the longest stall beside them: for judge."""
        whole, kept = self.whole_run()
        unharmed = digest(kept)
        lot = random.Random(SEED)
        at_the_end = [k % 3 == 2 for k in range(KILLS)]
        moments = [lot.uniform(0.0, 0.012) if end else lot.uniform(0.02, whole) for end in at_the_end]
        with Stalls(priority) as stalls, concurrent.futures.ThreadPoolExecutor(at_a_time) as pool:
            kills = list(zip(moments, pool.map(self.killed_at, range(KILLS), moments, at_the_end)))
        return kept, unharmed, kills, stalls.worst

    def judge(self, max_lost, kept, unharmed, kills, stall):
        with concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
            results = list(pool.map(lambda kill: self.left_by(*kill[1]), kills))
        for what in sorted({what for what, _ in results}):
            lost = [1e3 * lost for one, lost in results if one == what]
            print(f"{what}: {len(lost)} times, at most {max(lost):.0f} ms lost", file=sys.stderr)
        print(f"the machine let a thread wait for {1e3 * stall:.0f} ms at most", file=sys.stderr)
        for (moment, _), (what, lost) in zip(kills, results):
            self.assertLessEqual(lost, max_lost + stall, f"{what}, killed after {moment:.3f} s")
        self.assertEqual(digest(kept), unharmed)


class KillUdp(Killing):
    """The robot behind UDP, and programs beside that go before all that is not in real time."""

    MOST_LOST = 0.1  # s, beyond the stalls that a thread like the recorder's has to bear
    DEVICE = """
[safety]
link_silence_ms = 5000
lateness_ms = 0
answer_lag_ms = 0
state_age_ms = 0
torque_error_Nm = 0
accelerometer_m_per_s2 = 0
acceleration_m_per_s2 = 1000
encoder_jump_deg = 30
force_jump_N = 500
measured_force_N = 500
tracking_deg = 90
speed_mm_per_s = 9000
excursion_mm = 0
max_saturation_time_ms = 60000
frozen_sensor_ms = 0
motors_reply_ms = 5000
motors_off_ms = 5000
[device]
kind = "udp"
port = {port}
force_latency_ticks = 1
watchdog_ms = 5000
"""

    def begin(self, name):
        robot = subprocess.Popen([program("MBK_UDP_ROBOT"), self.folder / "experiment.toml", "--port", "0"],
                                 stdout=subprocess.PIPE, text=True)
        self.addCleanup(robot.stdout.close)
        self.addCleanup(robot.wait)
        self.addCleanup(robot.kill)
        port = re.search(r":(\d+)$", robot.stdout.readline())[1]
        self.file(f"{name}.toml", EXPERIMENT + self.DEVICE.format(port=port))
        return Run(self.folder, name, f"{name}.toml")

    def test_the_recorder_keeps_up_beside_a_load_in_real_time(self):
        with Load() as load:
            done = self.kill_at_moments(2, RECORDER_PRIORITY if load.busy else 0)
        self.judge(self.MOST_LOST, *done)


class Kill(Killing):
    def test_every_recording_opens_and_at_most_0_2_s_are_lost(self):
        self.judge(MOST_LOST, *self.kill_at_moments(AT_A_TIME))

    def test_recording_and_journal_both_there(self):
        """Killed after the recording had its name and before the journal was removed."""
        _, target = self.whole_run()
        session = Run(self.folder, "cut")
        time.sleep(1.0)
        session.kill()
        self.mbk("recover", session.journal, "--keep")
        made = digest(session.target)
        self.mbk("recover", session.journal, "--keep")  # as often as one likes
        self.assertEqual(digest(session.target), made)
        # another recording of that name is not replaced
        other = pathlib.Path(str(target) + ".journal")
        session.journal.rename(other)
        before = digest(target)
        ran = self.refused(WRONG_USAGE, "recover", other, says=("is there already", "--overwrite"))
        self.assertIn(target.name, ran.err)
        self.assertEqual(digest(target), before)
        self.assertTrue(other.exists())

    def test_a_journal_that_is_there_is_not_overwritten(self):
        session = Run(self.folder, "cut")
        time.sleep(1.0)
        session.kill()
        before = digest(session.journal)
        self.refused(WRONG_USAGE, "run", "experiment.toml", "--fast", "--out", session.target, folder=self.folder,
                     says=("journal", "recover"))
        self.assertEqual(digest(session.journal), before)


class FullDisk(Case):
    """A limit on the size of files refuses as a full disk does, from a byte on that can be chosen."""

    TICK = 144  # bytes in the journal

    def setUp(self):
        super().setUp()
        self.file("experiment.toml", EXPERIMENT)

    def limited(self, size, *options):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        target = self.folder / f"full_{size}.h5"
        process = subprocess.run([program("MBK"), "run", "experiment.toml", "--out", target, "--no-measure", "--quiet",
                                  *options], cwd=self.folder, capture_output=True, text=True, timeout=120,
                                 preexec_fn=limit, check=False)
        return target, process

    def test_nothing_begins_where_the_journal_cannot_be_begun(self):
        target, process = self.limited(100)
        self.assertEqual(process.returncode, BAD_DATA, process)
        self.assertRegex(process.stderr, "free space")
        self.assertFalse(target.exists())

    def test_a_disk_that_refuses_stops_the_robot_and_what_it_took_is_there(self):
        lot = random.Random(SEED)
        seconds = [lot.uniform(0.2, 2.0) for _ in range(max(3, KILLS // 4))]
        with Stalls() as stalls, concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
            results = list(pool.map(lambda s: self.limited(int(4000 + 1000 * s * self.TICK)), seconds))
        for second, (target, process) in zip(seconds, results):
            self.assertEqual(process.returncode, BAD_DATA, process)
            self.assertRegex(process.stderr, r"ticks were not written", process)
            self.assertRegex(process.stderr, r"recording could not be kept up", process)
            self.assertFalse(target.exists())
            ran = run("recover", f"{target}.journal")
            times = times_of(target, self.folder)
            lost = re.search(r"but (\d+) of \d+ ticks were lost", ran.out)  # where the ending still found room
            self.assertEqual(ran.code, BAD_DATA if lost else FINE, ran)
            if lost:
                times = times[:len(times) - int(lost[1])]
            self.assertLess(abs(times[-1] - second), MOST_LOST + stalls.worst)


if __name__ == "__main__":
    if sys.platform != "linux":
        sys.exit(77)
    main()
