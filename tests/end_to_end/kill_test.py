#!/usr/bin/env python3
"""Sessions in real time that are killed from outside (SIGKILL) at moments drawn by lot, and disks that refuse.

The full form (killing.py has the variables):
  MBK_KILLS=100 MBK=build/release/bin/mbk MAKE_LOG=build/release/bin/make_log python3 tests/end_to_end/kill_test.py
"""

import concurrent.futures
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys

from command import BAD_DATA, Case, FINE, WRONG_USAGE, main, program, run
from killing import AT_A_TIME, EXPERIMENT, KILLS, Killing, MOST_LOST, Run, SEED, Stalls, digest, times_of

SAFETY_STOP = 5


class Kill(Killing):
    def test_every_recording_opens_and_at_most_0_2_s_are_lost(self):
        self.judge(MOST_LOST, *self.kill_at_moments())

    def test_recording_and_journal_both_there(self):
        """Killed after the recording had its name and before the journal was removed."""
        _, target = self.whole_run()
        session = Run(self.folder, "cut")
        session.wait_for_ticks()
        session.kill()
        self.mbk("recover", session.journal, "--keep")
        made = digest(session.target)
        self.mbk("recover", session.journal, "--keep")  # as often as one likes
        self.assertEqual(digest(session.target), made)
        # another recording of that name is not replaced
        other = pathlib.Path(str(target) + ".journal")
        session.journal.rename(other)
        before = digest(target)
        ran = self.refused(WRONG_USAGE, "recover", other, says="--overwrite")
        self.assertIn(target.name, ran.err)
        self.assertEqual(digest(target), before)
        self.assertTrue(other.exists())

    def test_a_journal_that_is_there_is_not_overwritten(self):
        session = Run(self.folder, "cut")
        session.wait_for_ticks()
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
        self.assertIn("space", process.stderr)
        self.assertFalse(target.exists())

    def test_a_disk_that_refuses_stops_the_robot_and_what_it_took_is_there(self):
        lot = random.Random(SEED)
        seconds = [lot.uniform(0.2, 2.0) for _ in range(max(3, KILLS // 4))]
        with Stalls() as stalls, concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
            results = list(pool.map(lambda s: self.limited(int(4000 + 1000 * s * self.TICK)), seconds))
        for second, (target, process) in zip(seconds, results):
            self.assertEqual(process.returncode, SAFETY_STOP, process)
            self.assertRegex(process.stderr, r"ticks were not written", process)
            self.assertRegex(process.stdout, r"safety stop: the recording failed", process)
            self.assertRegex(process.stdout, r"motors: confirmed off", process)
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
