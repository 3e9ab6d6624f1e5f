#!/usr/bin/env python3
"""A robot behind UDP, in a process of its own: checked, run, lost; and one behind a plug-in."""

import pathlib
import re
import signal
import subprocess

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main, program, run

SAFETY_STOP, MOTORS_NOT_OFF = 5, 7
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
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
peak_deg = 1.5
period_s = 5
duration_s = {seconds}
moving_in_s = 2
[participant]
kind = "arm"
number = 1
# Where the machine does other things besides, ticks are late or missing, and what is compared from one to the next
# jumps. Nobody sits at this robot.
[safety]
link_silence_ms = 500
answer_lag_ms = 0
state_age_ms = 0
torque_error_Nm = 0
motors_reply_ms = 5000
lateness_ms = 0
accelerometer_m_per_s2 = 0
acceleration_m_per_s2 = 1000
encoder_jump_deg = 20
force_jump_N = 100
speed_mm_per_s = 5000
torque_rate_Nm_per_s = 100000
"""
DEVICE = """
[device]
kind = "udp"
port = {port}
force_latency_ticks = 1
watchdog_ms = 1000
{more}
"""


class Peer:
    """A robot's program at work; ends with the test."""

    def __init__(self, case, *command):
        self.process = subprocess.Popen([str(one) for one in command], stdout=subprocess.PIPE, text=True)
        case.addCleanup(self.process.stdout.close)
        case.addCleanup(self.end)
        self.port = int(re.search(r":(\d+)$", self.process.stdout.readline()).group(1))

    def end(self):
        self.process.kill()
        self.process.wait()


class Udp(Case):
    def experiment(self, name, port=None, more="", seconds=12):
        device = DEVICE.format(port=port, more=more) if port else ""
        return self.file(name, EXPERIMENT.format(seconds=seconds) + device)

    def peer(self, seconds=12):
        return Peer(self, program("MBK_UDP_ROBOT"), self.experiment("robot.toml", seconds=seconds), "--port", "0")

    def channels(self, recording):
        """Every sample as text, without what belongs to one run."""
        csv = recording.with_suffix(".csv")
        self.fine("convert", recording, csv)
        return [line for line in csv.read_text().splitlines() if not line.startswith("#")]

    def metadata(self, recording):
        """The metadata of the recording."""
        return "".join(self.fine("info", recording, "--json").json.get("metadata", {}))

    def test_in_lock_step_it_gives_the_recording_of_the_simulated_robot(self):
        peer = self.peer()
        udp = self.experiment("udp.toml", peer.port, "lock_step = true")
        one, other = self.folder / "udp.h5", self.folder / "simulated.h5"
        self.mbk("run", udp, "--fast", "--quiet", "--out", one)
        self.fine("run", self.folder / "robot.toml", "--fast", "--quiet", "--out", other)
        self.assertEqual(self.channels(one), self.channels(other))
        self.assertNotIn("truth", self.metadata(one))  # mbk knows nothing of who is at that handle
        self.assertIn("truth", self.metadata(other))

    def test_at_its_own_clock_it_is_measured_as_the_simulated_robot_is(self):
        peer = self.peer(seconds=22)
        udp, simulated = self.experiment("udp.toml", peer.port, seconds=22), self.folder / "robot.toml"
        results = []
        for experiment, options in ((udp, ()), (simulated, ("--fast",))):
            recording = self.folder / f"{experiment.stem}.h5"
            self.mbk("run", experiment, *options, "--quiet", "--no-measure", "--out", recording)
            # A busy machine misses ticks, which only an even clock bridges.
            results.append(self.fine("measure", recording, "--resample", "1000", "--json").json)
        for matrix in "MBK":
            for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
                one, other = (result["model"][matrix][i][j] for result in results)
                errors = [result["standard_error"][matrix][i][j] for result in results]
                # Twelve numbers that differ by chance from run to run: five standard errors of the difference.
                self.assertLess(abs(one - other), 5 * (errors[0] ** 2 + errors[1] ** 2) ** 0.5, (matrix, i, j, results))

    def started(self, experiment, recording):
        """`mbk run` once it perturbs."""
        process = subprocess.Popen([program("MBK"), "run", experiment, "--no-measure", "--out", recording],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if "perturb" in line:
                return process
        raise AssertionError(process.communicate())

    def assert_stopped(self, process, recording, words, code=SAFETY_STOP, motors="confirmed off by the robot"):
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, code, out)
        self.assertIn("motors: " + motors, out)
        self.assertEqual(code == MOTORS_NOT_OFF, "MOTORS NOT CONFIRMED OFF" in err, err)
        self.assertIn(words, out)
        info = self.fine("info", recording).out
        self.assertIn("safety stop", info)
        self.assertFalse((self.folder / (recording.name + ".journal")).exists())
        self.assertGreater(len(self.channels(recording)), 1000)

    def test_a_robot_that_dies_is_a_lost_link(self):
        peer = self.peer(seconds=60)
        recording = self.folder / "lost.h5"
        process = self.started(self.experiment("udp.toml", peer.port, seconds=60), recording)
        peer.end()
        self.assert_stopped(process, recording, "the robot was silent", MOTORS_NOT_OFF, "NOT CONFIRMED OFF")

    def test_the_stop_button(self):
        peer = self.peer(seconds=60)
        recording = self.folder / "stopped.h5"
        process = self.started(self.experiment("udp.toml", peer.port, seconds=60), recording)
        peer.process.send_signal(signal.SIGUSR1)
        self.assert_stopped(process, recording, "stop button")

    def test_a_second_mbk_at_the_same_robot_is_refused(self):
        peer = self.peer(seconds=60)
        experiment = self.experiment("udp.toml", peer.port, seconds=60)
        first = self.started(experiment, self.folder / "first.h5")
        self.refused(BAD_DATA, "run", experiment, "--quiet", "--out", self.folder / "second.h5",
                     says=str(peer.port))
        self.assertIsNone(first.poll())
        first.send_signal(signal.SIGINT)
        self.assert_stopped(first, self.folder / "first.h5", "operator")

    def test_no_robot_there(self):
        peer = self.peer()
        experiment = self.experiment("udp.toml", peer.port, "answer_within_s = 0.2")
        peer.end()
        ran = self.refused(BAD_DATA, "run", experiment, "--quiet", "--out", self.folder / "none.h5",
                           says=["0.2 s", "firewall"])
        self.assertIn(str(peer.port), ran.err)
        self.assertEqual(self.names(), ["robot.toml", "udp.toml"])

    def test_a_virtual_clock_hurries_no_robot(self):
        peer = self.peer()
        self.refused(WRONG_USAGE, "run", self.experiment("udp.toml", peer.port), "--fast", "--quiet", "--out",
                     self.folder / "fast.h5", says="clock")


class Check(Case):
    def check(self, text, *options, code=0):
        return self.mbk("robot", "check", self.file("mine.toml", text), *options, code=code).out

    def test_what_is_understood(self):
        text = self.check(EXPERIMENT.format(seconds=5) + DEVICE.format(port=4000, more="[device.wiring]\n"
                          "counts_per_turn = [80000, 80000]\nencoder_sign = [1, -1]\nforce_step = 0.01"))
        for words in ("127.0.0.1:4000", "+0.0045", "-0.0045°", " 1 tick", "µm", "10 mN", "1000 ms"):
            self.assertIn(words, text)
        self.assert_lines_fit(text, 140)

    def test_what_cannot_be_meant(self):
        base = EXPERIMENT.format(seconds=5)
        self.assertRegex(self.check(base + DEVICE.format(port=4000, more="[device.wiring]\n"
                      "counts_per_turn = [400, 400]"), code=NOT_USABLE), "WRONG .*count")
        home = base.replace("[robot]\n", "[robot]\nhome_mm = [900, 0]\n")
        self.assertRegex(self.check(home, code=NOT_USABLE), "WRONG .*home")
        self.assertIn("alpha_kg_m2", self.check("[robot]\nalpha_kg_m2 = [69.29, 42.17, 44.16]\n"
                                                             "kind = \"planar\"\n"))

    def test_descriptions(self):
        text = self.fine("robot", "check", EXAMPLES / "robots" / "thesis.toml").out
        self.assertRegex(text, r"(?m)^device +\w")
        self.refused(WRONG_USAGE, "robot", "check", EXAMPLES / "robots" / "thesis.toml", "--live", "1")
        self.refused(BAD_DATA, "robot", "check", EXAMPLES / "robots" / "double_pendulum.toml", says="mbk robot describe")
        self.refused(BAD_DATA, "robot", "check", self.folder / "gone.toml", says="gone.toml")
        for wrong in ("0", "-1", "soon"):
            self.refused(WRONG_USAGE, "robot", "check", "relaxed_sinusoidal", f"--live={wrong}", says="--live")

    def test_live(self):
        path = self.file("robot.toml", EXPERIMENT.format(seconds=5))
        peer = Peer(self, program("MBK_UDP_ROBOT"), path, "--port", "0")
        mine = EXPERIMENT.format(seconds=5) + DEVICE.format(port=peer.port, more="")
        text = run("robot", "check", self.file("mine.toml", mine), "--live", "1").out
        for words in ("link", "states", "stop button", "force 1"):
            self.assertIn(words, text)
        peer.process.send_signal(signal.SIGUSR1)
        self.assertRegex(self.check(mine, "--live", "0.5", code=NOT_USABLE), "WRONG .*stop button")
        peer.process.send_signal(signal.SIGUSR1)
        swapped = mine.replace("[device]", "[device.wiring]\nencoder_sign = [-1, 1]\n[device]")
        self.assertIn("encoder_sign", self.check(swapped, "--live", "0.5", code=NOT_USABLE))
        peer.end()
        hasty = mine.replace("watchdog_ms", "answer_within_s = 0.2\nwatchdog_ms")
        self.assertIn("no answer", self.mbk("robot", "check", self.file("mine.toml", hasty), "--live",
                                            code=BAD_DATA).err)


class Plugin(Case):
    def experiment(self):
        text = (EXAMPLES / "device_plugin" / "experiment.toml").read_text()
        return self.file("wheels.toml", text.replace("build/my_robot.so", program("MBK_MY_ROBOT")))

    def test_the_example_runs(self):
        self.mbk("run", self.experiment(), "--fast", "--quiet", "--no-measure", "--out", self.folder / "wheels.h5")
        self.assertIn("completed", self.fine("info", self.folder / "wheels.h5").out)

    def test_the_example_is_checked_live(self):
        text = run("robot", "check", self.experiment(), "--live", "0.3").out
        self.assertIn("two wheels", text)
        self.assertIn("joint 1             11.4592", text)

    def stalling(self, how, *options):
        """`mbk run` of a robot whose driver goes wrong, begun."""
        text = (EXAMPLES / "device_plugin" / "experiment.toml").read_text()
        text = text.replace("build/my_robot.so", program("MBK_STALLING_ROBOT")).replace("0.2 0.9", how)
        process = subprocess.Popen([program("MBK"), "run", self.file("stalls.toml", text), "--no-measure", "--out",
                                    self.folder / "stalls.h5", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def until(self, stream, words):
        for line in stream:
            if re.search(words, line):
                return
        raise AssertionError(f"no '{words}'")

    def test_a_driver_that_does_not_return_is_seen_and_can_be_left(self):
        process = self.stalling("forever")
        self.until(process.stderr, "MOTORS NOT CONFIRMED OFF")
        process.send_signal(signal.SIGTERM)
        self.until(process.stderr, "mbk: .*SIGTERM")
        info = self.fine("info", self.folder / "stalls.h5").out
        self.assertIn("driver", info)
        self.assertIn("NOT CONFIRMED OFF", info)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        out, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, MOTORS_NOT_OFF)
        self.assertRegex(out, "safety stop: .*driver")

    def test_on_a_virtual_clock_too(self):
        process = self.stalling("forever", "--fast", "--quiet")
        self.until(process.stderr, "MOTORS NOT CONFIRMED OFF")
        process.send_signal(signal.SIGTERM)
        self.until(process.stderr, "mbk: .*SIGTERM")
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, MOTORS_NOT_OFF)

    def test_a_driver_that_returns_late_is_told_of(self):
        process = self.stalling("briefly")
        self.until(process.stderr, "MOTORS NOT CONFIRMED OFF")
        self.until(process.stderr, r"mbk: .*driver.*\d s\b")

    def test_a_driver_that_ends_the_program_leaves_no_success(self):
        process = self.stalling("exit")
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, MOTORS_NOT_OFF, err)
        self.assertIn("MOTORS NOT CONFIRMED OFF: the robot's driver ended the program", err)
        self.assertIn(f"mbk recover {self.folder / 'stalls.h5.journal'}", err)
        self.fine("recover", self.folder / "stalls.h5.journal")

    def test_a_library_that_is_not_there(self):
        path = self.file("gone.toml", self.experiment().read_text().replace(program("MBK_MY_ROBOT"), "gone.so"))
        self.refused(BAD_DATA, "run", path, "--fast", "--quiet", says="gone.so")


if __name__ == "__main__":
    main()
