#!/usr/bin/env python3
"""Sessions with a robot behind UDP that are killed (SIGKILL) beside programs that go before all that is not in real time.

While it runs next to nothing else comes to run, so it runs alone. The full form (killing.py has the variables):
  MBK_KILLS=100 MBK=build/release/bin/mbk MBK_UDP_ROBOT=build/release/bin/mbk_udp_robot \\
    python3 tests/end_to_end/kill_beside_load_test.py
"""

import os
import re
import subprocess
import sys

from command import main, program
from killing import AS_OTHERS, EXPERIMENT, Killing, Run

FIFO_LOAD = """
import os, time
os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param({priority}))
while os.getppid() == {parent}:  # by one clock, so that no processor is left
    if (into := time.monotonic() % {period}) > {busy}:
        time.sleep({period} - into)
"""
PERIOD, BUSY = 0.25, 0.18  # s: who does not go before it loses more than MOST_LOST
LOAD_PRIORITY, TEST_PRIORITY, RECORDER_PRIORITY = 50, 60, 70  # what kills and dates is not held up


class Load:
    """Programs, one for each core, that go before all that is not in real time; none where that is not allowed. This
    thread, and those that it begins meanwhile, go before them."""

    def __enter__(self):
        asked = subprocess.run(["chrt", "--fifo", str(RECORDER_PRIORITY), "true"], capture_output=True, check=False)
        may = asked.returncode == 0
        code = FIFO_LOAD.format(priority=LOAD_PRIORITY, parent=os.getpid(), period=PERIOD, busy=BUSY)
        self.busy = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(os.cpu_count() if may else 0)]
        if may:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(TEST_PRIORITY))
        return self

    def __exit__(self, *_):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        for one in self.busy:
            one.kill()
            one.wait()


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
max_saturation_time_ms = 10000
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
        robot = subprocess.Popen([*AS_OTHERS, program("MBK_UDP_ROBOT"), self.folder / "experiment.toml", "--port", "0"],
                                 stdout=subprocess.PIPE, text=True)
        self.addCleanup(robot.stdout.close)
        self.addCleanup(robot.wait)
        self.addCleanup(robot.kill)
        port = re.search(r":(\d+)$", robot.stdout.readline())[1]
        self.file(f"{name}.toml", EXPERIMENT + self.DEVICE.format(port=port))
        return Run(self.folder, name, f"{name}.toml")

    def test_the_recorder_keeps_up_beside_a_load_in_real_time(self):
        with Load() as load:
            done = self.kill_at_moments(RECORDER_PRIORITY if load.busy else 0)
        self.judge(self.MOST_LOST, *done)


if __name__ == "__main__":
    if sys.platform != "linux":
        sys.exit(77)
    main()
