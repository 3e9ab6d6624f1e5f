#!/usr/bin/env python3
"""What ends a session from outside: signals, a terminal that is closed, a program that dies. In each case the torque
comes down to zero, and what was recorded is there."""

import os
import pathlib
import pty
import resource
import select
import signal
import socket
import struct
import subprocess
import threading
import time
import zlib

from command import BAD_DATA, FINE, Case, main, program, run

SAFETY_STOP = 5
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
peak_deg = 1
duration_s = {seconds}
moving_in_s = 0.5
[participant]
kind = "arm"
number = 1
{more}
"""
# Where the machine does other things besides, nothing but what is tested may stop the trial.
DEVICE = """
[safety]
link_silence_ms = 2000
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
frozen_sensor_ms = 0
[device]
kind = "udp"
port = {port}
watchdog_ms = {watchdog}
has_force = false
has_acceleration = false
"""


class Robot:
    """Two wheels behind UDP that keep every command with the time at which it came. They obey docs/guide/own_robot.md
    and have no watchdog: only a command switches the motors off."""

    STATE, COMMAND = struct.Struct("<4sHHIIQQ7d"), struct.Struct("<4sHHIIQ2d")
    HOME = (0.2, 0.9)

    def __init__(self, case):
        self.port = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.port.bind(("127.0.0.1", 0))
        self.port.settimeout(0.001)
        self.commands = []  # time, sequence, enabled, torques
        self.over = False
        self.thread = threading.Thread(target=self.serve)
        self.thread.start()
        case.addCleanup(self.end)

    def end(self):
        self.over = True
        self.thread.join()
        self.port.close()

    def serve(self):
        angle, speed, torque = list(self.HOME), [0.0, 0.0], (0.0, 0.0)
        master, session, answered, enabled, begin, sequence = None, 0, 0, False, time.monotonic(), 0
        while not self.over:
            try:
                data, sender = self.port.recvfrom(100)
                if len(data) == 44 and struct.pack("<I", zlib.crc32(data[:40])) == data[40:]:
                    _, _, flags, its, _, number, *its_torque = self.COMMAND.unpack(data[:40])
                    if flags & 2 and not enabled and its != session:
                        master, session, answered = sender, its, 0
                    if its == session and number > answered:
                        answered, torque, enabled = number, its_torque, bool(flags & 1)
                        self.commands.append((time.monotonic(), number, enabled, its_torque))
            except socket.timeout:
                pass
            now = int(1000 * (time.monotonic() - begin))
            if master is None or now <= sequence:
                continue
            step, sequence = 1e-3 * min(now - sequence, 10), now
            for k in range(2):
                speed[k] += step * ((torque[k] if enabled else 0.0) - 0.5 * speed[k]) / 0.07
                angle[k] += step * speed[k]
            state = self.STATE.pack(b"MBKS", 1, 2 * enabled, session, 0, sequence, answered, 1e-3 * sequence, *angle,
                                    0, 0, 0, 0)
            self.port.sendto(state + struct.pack("<I", zlib.crc32(state)), master)


class Session(Case):
    def experiment(self, seconds=30, more=""):
        return self.file("experiment.toml", EXPERIMENT.format(seconds=seconds, more=more))

    def start(self, *options, seconds=30, more="", environment=None, **popen):
        self.target = self.folder / "trial.h5"
        self.process = subprocess.Popen(
            [program("MBK"), "run", self.experiment(seconds, more), "--out", self.target, "--no-measure", *options],
            cwd=self.folder, env={**os.environ, **(environment or {})},
            **{"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **popen})
        self.addCleanup(self.finish, self.process)

    @staticmethod
    def finish(process):
        if process.poll() is None:
            process.kill()
        for stream in (process.stdin, process.stdout, process.stderr):
            if stream:
                stream.close()
        process.wait()

    def journal_grows(self):
        """Until ticks have been recorded."""
        journal = pathlib.Path(f"{self.target}.journal")
        until = time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size > 80_000):
            if time.monotonic() > until or self.process.poll() is not None:
                self.fail(f"nothing was recorded: {self.process.poll()}, {self.process.communicate()}")
            time.sleep(0.005)

    def ended(self, code):
        out, err = self.process.communicate(timeout=60)
        self.assertEqual(self.process.returncode, code, (out, err))
        return (out or b"").decode("utf-8")

    def info(self):
        return self.mbk("info", self.target, "--json").json["metadata"]

    def torques(self):
        table = self.target.with_suffix(".csv")
        self.mbk("convert", self.target, table, "--overwrite")
        lines = [line.split(",") for line in table.read_text().splitlines() if not line.startswith("#")]
        at = [k for k, name in enumerate(lines[0]) if name.startswith("torque_")]
        self.assertEqual(len(at), 2, lines[0])
        return [[float(row[k]) for k in at] for row in lines[1:]]

    def assert_ramped_down(self, by="(operator|SIG[A-Z0-9]+)"):
        metadata = self.info()
        self.assertEqual(metadata["ended"], "safety stop", metadata)
        self.assertRegex(metadata["ended_detail"], rf"\b{by}\b")
        self.assertFalse(pathlib.Path(f"{self.target}.journal").exists())
        torques = self.torques()
        self.assertGreater(len(torques), 400)
        self.assertEqual(torques[-1], [0.0, 0.0])
        last = max(k for k, pair in enumerate(torques) if any(pair))
        self.assertGreater(last, len(torques) - 150)  # until then it was driven; then it was confirmed to be off


class InATrial(Session):
    def test_each_signal_that_can_be_caught_is_a_stop_by_the_operator(self):
        for name in ("INT", "TERM", "HUP", "QUIT", "TSTP", "USR1", "USR2", "ALRM", "PWR", "XCPU", "POLL"):
            with self.subTest(name):
                self.start()
                self.journal_grows()
                self.process.send_signal(getattr(signal, "SIG" + name))
                self.ended(SAFETY_STOP)
                self.assert_ramped_down("operator" if name == "INT" else f"SIG{name}")
                self.target.unlink()

    def test_signals_of_the_background_suspend_nothing(self):
        self.start(seconds=2)
        self.journal_grows()
        for one in (signal.SIGTTIN, signal.SIGTTOU, signal.SIGPIPE, signal.SIGXFSZ, signal.SIGCONT):
            self.process.send_signal(one)
        self.ended(FINE)
        self.assertEqual(self.info()["ended"], "completed")

    def test_nohup_is_respected(self):
        self.start(seconds=2, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.journal_grows()
        self.process.send_signal(signal.SIGHUP)
        self.ended(FINE)

    def test_a_request_to_end_begins_no_further_trial(self):
        self.start(more='[[trial]]\nname = "one"\n[[trial]]\nname = "two"\n')
        self.target = self.folder / "trial_one.h5"
        self.journal_grows()
        self.process.send_signal(signal.SIGTERM)
        self.ended(SAFETY_STOP)
        self.assert_ramped_down()
        self.assertEqual([name for name in self.names() if "two" in name], [])

    def test_a_file_that_may_not_grow_is_a_recorder_that_fails(self):
        """SIGXFSZ ends a program that does not expect it."""
        self.start(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000)))
        out, err = self.process.communicate(timeout=60)
        self.assertEqual(self.process.returncode, SAFETY_STOP, err)
        self.assertRegex(out, b"safety stop: .*recording")
        self.assertRegex(err, rb"\d ticks")
        recovered = run("recover", f"{self.target}.journal")
        self.assertEqual(recovered.code, BAD_DATA if " ticks" in recovered.out else FINE, recovered)
        self.assertGreater(len(self.torques()), 400)


class AtATerminal(Session):
    def begin(self, *options):
        """A session with a terminal of its own."""
        self.target = self.folder / "trial.h5"
        path = self.experiment()
        child, self.terminal = pty.fork()
        if child == 0:
            try:
                os.execv(program("MBK"), ["mbk", "run", str(path), "--out", str(self.target), "--no-console", *options])
            finally:
                os._exit(127)  # this is the child, which must not go on with the tests
        self.child = child
        self.addCleanup(self.kill)
        journal, self.shown, until = pathlib.Path(f"{self.target}.journal"), b"", time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size > 80_000):
            self.assertLess(time.monotonic(), until, self.shown)
            self.look()

    def look(self):
        """What the terminal shows meanwhile."""
        if self.terminal is None:
            time.sleep(0.02)
        elif select.select([self.terminal], [], [], 0.02)[0]:
            try:
                self.shown += os.read(self.terminal, 65536)
            except OSError:  # the terminal of a program that has ended
                self.close()

    def close(self):
        if self.terminal is not None:
            os.close(self.terminal)
        self.terminal = None

    def kill(self):
        if self.child is not None:
            os.kill(self.child, signal.SIGKILL)
            os.waitpid(self.child, 0)
        self.child = None
        self.close()

    def assert_ends(self, code):
        until = time.monotonic() + 60
        while time.monotonic() < until:
            self.look()
            pid, status = os.waitpid(self.child, os.WNOHANG)
            if pid:
                self.child = None
                self.close()
                self.assertEqual(os.waitstatus_to_exitcode(status), code, self.shown)
                return
        self.fail(f"it did not end: {self.shown}")

    def test_a_terminal_that_is_closed(self):
        self.begin()
        self.close()
        self.assert_ends(SAFETY_STOP)
        self.assert_ramped_down()

    def test_a_terminal_that_is_closed_without_a_signal(self):
        """nohup in the foreground, or a terminal that belongs to another session: the end of input says it."""
        before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
        try:
            self.begin()
        finally:
            signal.signal(signal.SIGHUP, before)
        self.close()
        self.assert_ends(SAFETY_STOP)
        self.assert_ramped_down()

    def test_keys_that_suspend_or_quit_stop_the_robot_and_end_the_program(self):
        for key in (b"\x1a", b"\x1c"):  # Ctrl-Z, Ctrl-backslash
            with self.subTest(key):
                self.begin()
                os.write(self.terminal, key)
                self.assert_ends(SAFETY_STOP)
                self.assert_ramped_down()
                self.target.unlink()

    def test_a_terminal_that_shows_nothing_holds_nobody_up(self):
        """Nobody reads what the terminal gets, until its buffer is full: the trial goes on, and the stop is obeyed."""
        self.begin()
        os.write(self.terminal, b"\x13")  # Ctrl-S
        time.sleep(1.5)
        os.kill(self.child, signal.SIGTERM)
        until = time.monotonic() + 30
        while not self.target.exists() and time.monotonic() < until:
            time.sleep(0.02)
        os.write(self.terminal, b"\x11")
        self.assert_ends(SAFETY_STOP)
        self.assert_ramped_down()


    def test_a_request_to_end_answers_the_question(self):
        """A stopped trial, and the question whether to go on."""
        self.begin()
        os.write(self.terminal, b" ")
        until = time.monotonic() + 60
        while b"[y/N]" not in self.shown:
            self.assertLess(time.monotonic(), until, self.shown)
            self.look()
        os.kill(self.child, signal.SIGTERM)
        self.assert_ends(SAFETY_STOP)
        self.assert_ramped_down()


class FatalSignals(Session):
    WATCHDOG = 10.0  # s: what comes earlier is a command

    def driven(self, environment=None):
        self.robot = Robot(self)
        self.start(more=DEVICE.format(port=self.robot.port.getsockname()[1], watchdog=int(1e3 * self.WATCHDOG)),
                   environment=environment, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CORE, (0, 0)))

    def assert_last_words(self, since):
        time.sleep(0.2)  # nothing may come after it
        enabled = [command for command in self.robot.commands if command[2]]
        self.assertGreater(len(enabled), 300)
        came, sequence, on, torque = self.robot.commands[-1]
        self.assertFalse(on)
        self.assertEqual(list(torque), [0.0, 0.0])
        self.assertGreater(sequence, 2**52)
        self.assertLess(came - since, self.WATCHDOG / 2)

    def test_the_last_command_is_motors_off(self):
        for name in ("SEGV", "BUS", "FPE", "ILL", "ABRT", "SYS", "TRAP"):
            with self.subTest(name):
                self.driven()
                self.journal_grows()
                killed = time.monotonic()
                self.process.send_signal(getattr(signal, "SIG" + name))
                self.process.communicate(timeout=60)
                self.assertEqual(self.process.returncode, -getattr(signal, "SIG" + name))
                self.assert_last_words(killed)
                journal = pathlib.Path(f"{self.target}.journal")
                self.mbk("recover", journal)
                self.assertIn("interrupted", self.info()["ended"])
                self.target.unlink()

    def test_a_program_that_crashes_by_itself(self):
        """crash.cpp makes the loop's thread, or the one that waits for the disk, do it."""
        shim = os.environ.get("MBK_CRASH_SHIM")
        if not shim:
            self.skipTest("MBK_CRASH_SHIM is not set")
        for where in ("sendto", "fdatasync"):
            for how, code in (("pointer", signal.SIGSEGV), ("stack", signal.SIGSEGV), ("abort", signal.SIGABRT),
                              ("terminate", signal.SIGABRT)):
                with self.subTest(where=where, how=how):
                    begin = time.monotonic()
                    (self.folder / "trial.h5.journal").unlink(missing_ok=True)
                    self.driven({"LD_PRELOAD": shim, "MBK_CRASH_IN": where, "MBK_CRASH": how,
                                 "MBK_CRASH_AFTER": "800" if where == "sendto" else "20"})
                    self.process.communicate(timeout=60)
                    self.assertEqual(self.process.returncode, -code)
                    self.assert_last_words(begin)

    def test_the_next_program_is_let_in_again(self):
        self.driven()
        self.journal_grows()
        self.process.send_signal(signal.SIGABRT)
        self.process.communicate(timeout=60)
        pathlib.Path(f"{self.target}.journal").unlink()
        before = len(self.robot.commands)
        self.process = subprocess.Popen([program("MBK"), "run", "experiment.toml", "--out", "again.h5", "--no-measure"],
                                        cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE)
        until = time.monotonic() + 30
        while time.monotonic() < until and not any(command[2] for command in self.robot.commands[before:]):
            time.sleep(0.02)
        self.process.send_signal(signal.SIGINT)
        self.ended(SAFETY_STOP)


if __name__ == "__main__":
    main()
