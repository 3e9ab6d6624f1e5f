#!/usr/bin/env python3
"""Robots behind the bridges of bridge/: checked, run, stopped, and between mbk and the simulated robot; and what
`mbk robot check --link` and `--rt` say."""

import pathlib
import re
import shutil
import signal
import subprocess
import sys

from command import NOT_USABLE, WRONG_USAGE, Case, main, program, run

BRIDGE = pathlib.Path(__file__).resolve().parents[2] / "bridge"
NOT_ALL_TESTED = 6
TIMED = {"silence", "rate", "clock", "acknowledges", "motors-on", "motors-off", "watchdog",
         "numbering"}  # a busy machine holds robots up, and the simulated one numbers what it did not send
EXPERIMENT = """
[recording]
condition = "relaxed"
seed = 3
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 0.5
period_s = 1
duration_s = 1
moving_in_s = 1
[participant]
kind = "arm"
number = 1
[safety]
speed_mm_per_s = 5000
acceleration_m_per_s2 = 1000
"""
DEVICE = """
[device]
kind = "udp"
port = {port}
force_latency_ticks = 1
watchdog_ms = 5000
lock_step = true
"""
# A busy machine holds up both programs, and nobody sits at this robot.
WHEELS = """
[recording]
condition = "two wheels"
[robot]
d1_mm = 254
d2_mm = 266.7
[device]
kind = "udp"
port = {port}
watchdog_ms = 1000
has_force = false
has_acceleration = false
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = {seconds}
moving_in_s = 1
[safety]
link_silence_ms = 500
max_saturation_time_ms = 5000
answer_lag_ms = 0
state_age_ms = 0
torque_error_Nm = 0
motors_reply_ms = 5000
lateness_ms = 0
acceleration_m_per_s2 = 1000
encoder_jump_deg = 20
speed_mm_per_s = 5000
torque_rate_Nm_per_s = 100000
"""


def built(name):
    return pathlib.Path(program("MBK")).parents[1] / "tests" / name


def python(name):
    return [sys.executable, "-B", BRIDGE / "python" / name]


class Robot:
    """A robot's program at work; ends with the test."""

    def __init__(self, case, *command):
        self.process = subprocess.Popen([str(one) for one in command], stdout=subprocess.PIPE, text=True)
        case.addCleanup(self.process.stdout.close)
        case.addCleanup(self.end)
        line = self.process.stdout.readline()
        self.port = int(re.search(r":(\d+)\}?$", line.strip()).group(1))

    def end(self):
        self.process.kill()
        self.process.wait()


class Link(Case):
    def checked(self, port, *options):
        ran = run("robot", "check", "--link", f"127.0.0.1:{port}", "--json", "--quiet", *options)
        rules = {one["rule"]: one["verdict"] for one in ran.json["link"]["rules"]}
        return ran, {rule for rule, verdict in rules.items() if verdict == "failed"}, rules

    def assert_conforms(self, *command):
        """A busy machine holds up the robot, or who checks it: then every rule is seen to be kept in one of several runs,
        and only what takes time is broken in any."""
        robot, missing = Robot(self, *command), None
        for _ in range(8):
            ran, failed, rules = self.checked(robot.port, "--motors")
            self.assertLessEqual(failed, TIMED, ran)
            self.assertEqual(ran.json["link"]["conforms"], ran.code == 0, ran)
            kept = {rule for rule, verdict in rules.items() if verdict == "passed"}
            missing = (set(rules) if missing is None else missing) - kept
            if not missing:
                return
        self.fail((missing, ran))

    def test_the_example_in_c_conforms(self):
        self.assert_conforms(built("bridge_robot"), "0")

    def test_the_example_in_python_conforms(self):
        self.assert_conforms(*python("example_robot.py"), "0")

    def test_the_simulated_robot_conforms(self):
        self.assert_conforms(program("MBK_UDP_ROBOT"), "relaxed_sinusoidal", "--port", "0")

    def test_a_robot_that_breaks_a_rule_is_told_it(self):
        misbehaving = pathlib.Path(program("MBK")).parent / "mbk_misbehaving_robot"
        for breaker, rule in (("believes-strangers", "stranger"), ("no-watchdog", "watchdog"), ("on-again", "latched")):
            with self.subTest(breaker):
                robot = Robot(self, misbehaving, "relaxed_sinusoidal", "--breaks", breaker, "--port", "0")
                for _ in range(5):  # on a busy machine a rule may not be reached
                    ran, failed, _ = self.checked(robot.port, "--motors")
                    self.assertFalse(ran.json["link"]["conforms"])
                    self.assertNotEqual(ran.code, 0, ran)
                    if rule in failed:
                        break
                self.assertIn(rule, failed, ran)
                self.assertEqual(ran.code, NOT_USABLE, ran)
                robot.end()
        refused = subprocess.run([misbehaving, "relaxed_sinusoidal", "--breaks", "nothing"], capture_output=True,
                                 text=True, check=False)
        self.assertIn("--list", refused.stderr)
        self.assertEqual(refused.returncode, 1)

    def test_without_motors_nothing_conforms_and_the_text_says_so(self):
        robot = Robot(self, built("bridge_robot"), "0")
        ran = run("robot", "check", "--link", f"127.0.0.1:{robot.port}")
        self.assertIn(ran.code, (NOT_ALL_TESTED, NOT_USABLE), ran)  # a busy machine
        self.assertNotIn("it conforms", ran.out)
        self.assertIn("--motors tests it", ran.out)
        self.assert_lines_fit(ran.out, 80)

    def test_where_no_robot_is_nothing_is_passed(self):
        robot = Robot(self, built("bridge_robot"), "0")
        robot.end()
        ran, failed, rules = self.checked(robot.port)
        self.assertEqual((ran.code, failed), (NOT_USABLE, {"answers"}), ran)
        self.assertNotIn("passed", rules.values())

    def test_what_is_asked_wrongly(self):
        self.refused(WRONG_USAGE, "robot", "check", says="nothing to check")
        self.refused(WRONG_USAGE, "robot", "check", "--motors", "--rt", "1", says="--link")
        self.refused(WRONG_USAGE, "robot", "check", "--live", "1", says="FILE")
        self.refused(WRONG_USAGE, "robot", "check", "--link", "127.0.0.1:0", says="127.0.0.1:0")
        self.refused(WRONG_USAGE, "robot", "check", "--link", "127.0.0.1:port", says="127.0.0.1:port")
        self.refused(WRONG_USAGE, "robot", "check", "--rt", "-1", says="--rt")


class Timing(Case):
    def test_says_what_it_measured(self):
        ran = run("robot", "check", "--rt", "0.5", "--json", "--quiet")
        self.assertIn(ran.code, (0, NOT_USABLE), ran)
        timing = ran.json["timing"]
        lateness = timing["lateness"]
        self.assertEqual(sum(one["count"] for one in lateness["histogram"]), lateness["wake_ups"])
        self.assertAlmostEqual(lateness["wake_ups"] + lateness["missed"], 500, delta=5)
        self.assertLessEqual(lateness["median_s"], lateness["p99_9_s"])
        self.assertLessEqual(lateness["p99_9_s"], lateness["longest_s"])
        said = " ".join(one["text"] for one in timing["findings"])
        self.assertEqual("virtual machine" in said, timing["machine"]["virtual_machine"] is True)

    def test_fits_a_terminal(self):
        ran = run("robot", "check", "--rt", "0.2", "--quiet")
        self.assert_lines_fit(ran.out, 80)


class Experiments(Case):
    def channels(self, recording):
        csv = recording.with_suffix(".csv")
        self.fine("convert", recording, csv)
        return [line for line in csv.read_text().splitlines() if not line.startswith("#")]

    def test_between_mbk_and_the_simulated_robot_no_bridge_changes_a_bit(self):
        """All four directions of each language's datagrams, in lock-step."""
        simulated = self.file("simulated.toml", EXPERIMENT)
        self.fine("run", simulated, "--fast", "--quiet", "--no-measure", "--out", self.folder / "simulated.h5")
        expected = self.channels(self.folder / "simulated.h5")
        self.assertGreater(len(expected), 2000)
        relays = {"c": [built("bridge_relay")], "python": python("relay_test.py")}
        octave = shutil.which("octave-cli")
        for name in ("c", "python", "octave"):
            robot = Robot(self, program("MBK_UDP_ROBOT"), simulated, "--port", "0")
            if name == "octave":
                if octave is None:
                    continue
                relay = Robot(self, *python("relay_test.py"), robot.port, octave, "--no-gui", "--quiet",
                              "--no-init-file", BRIDGE / "matlab" / "relay_test.m")
            else:
                relay = Robot(self, *relays[name], robot.port)
            with self.subTest(name):
                experiment = self.file(f"{name}.toml", EXPERIMENT + DEVICE.format(port=relay.port))
                self.mbk("run", experiment, "--fast", "--quiet", "--no-measure", "--out", self.folder / f"{name}.h5")
                self.assertEqual(self.channels(self.folder / f"{name}.h5"), expected)

    def test_an_experiment_runs_on_the_examples(self):
        for name, command in (("c", [built("bridge_robot")]), ("python", python("example_robot.py"))):
            robot = Robot(self, *command, "0")
            with self.subTest(name):
                experiment = self.file(f"{name}.toml", WHEELS.format(port=robot.port, seconds=2))
                ran = self.mbk("run", experiment, "--quiet", "--no-measure", "--out", self.folder / f"{name}.h5")
                self.assertIn("confirmed off by the robot", ran.out)
                self.assertIn("completed", self.fine("info", self.folder / f"{name}.h5").out)

    def test_the_stop_button_of_the_example_stops_a_trial(self):
        robot = Robot(self, built("bridge_robot"), "0")
        process = subprocess.Popen(
            [program("MBK"), "run", self.file("long.toml", WHEELS.format(port=robot.port, seconds=60)), "--no-measure",
             "--out", self.folder / "long.h5"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if "perturb" in line:
                break
        robot.process.send_signal(signal.SIGUSR1)
        out, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 5, out)
        self.assertIn("stop button", out)
        self.assertIn("confirmed off by the robot", out)


if __name__ == "__main__":
    main()
