"""Commands of mbk under the shim failing_calls.c: what they need, what they have to leave behind, and who says so.

The programs are named by the environment, as CTest sets it: MBK, and FAILING_CALLS for the shim.
"""

import csv
import dataclasses
import json
import os
import pathlib
import re
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import zlib

GROUPS = ("write", "sync", "open", "name", "read", "status", "socket", "sleep", "clock", "memory", "thread")
FINE, SAFETY_STOP, NOT_CONFIRMED = 0, 5, 7
LONGEST = 60  # [s] of one command: what takes longer hangs
COUNTS = struct.Struct("=12Q")

EXPERIMENT = """
[session]
soft_start_s = 0.2
move_speed_mm_per_s = 400
shortest_move_s = 0.2
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 0.4
period_s = 0.5
duration_s = 0.6
moving_in_s = 0.2
[recording]
condition = "two wheels"
[robot]
d1_mm = 254
d2_mm = 266.7
"""
DEVICE = """
[device]
kind = "udp"
port = {port}
lock_step = true
answer_within_s = 5
has_force = false
has_acceleration = false
"""
SCENARIO = """
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
period_s = 2
duration_s = {seconds}
moving_in_s = 1
[participant]
kind = "arm"
number = 1
"""


def program(variable):
    path = os.environ.get(variable)
    if not path:
        sys.exit(f"set {variable} to the path of that program; ctest does so by itself")
    return os.path.abspath(path)


@dataclasses.dataclass
class Fault:
    """Which call of a group fails, how, and whether all later ones do as well."""
    group: str = ""
    nth: int = 0
    errno: int = 0  # 0: the call succeeds with half of the bytes
    sticky: bool = False

    def __str__(self):
        how = os.strerror(self.errno) if self.errno else "half of the bytes"
        return f"{self.group} {self.nth}{' and all later ones' if self.sticky else ''}: {how}"


class Robot(threading.Thread):
    """Two wheels behind UDP that wait for each command (docs/guide/own_robot.md), and remember all that came and went."""

    STATE, COMMAND = struct.Struct("<4sHHIIQQ7d"), struct.Struct("<4sHHIIQ2d")
    ENABLED, GREETING, MOTORS_ON = 1, 2, 2

    def __init__(self):
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.over = False
        self.commands = []  # (motors on, torque 1, torque 2), each once
        self.joints = []  # that the robot said before each of them
        self.start()

    def run(self):
        angle, speed, obeyed, session, answer = [0.2, 0.9], [0.0, 0.0], 0, None, b""
        while not self.over:
            if not select.select([self.socket], [], [], 0.05)[0]:
                continue
            data, sender = self.socket.recvfrom(100)
            if len(data) != 44 or struct.pack("<I", zlib.crc32(data[:40])) != data[40:]:
                continue
            _, _, flags, its_session, _, number, *torque = self.COMMAND.unpack(data[:40])
            if flags & self.GREETING and its_session != session:
                session, obeyed = its_session, 0
            if its_session != session:
                continue  # meant for a robot that had this port before
            if number > obeyed:
                enabled = bool(flags & self.ENABLED)
                if not flags & self.GREETING:
                    self.commands.append((enabled, *torque))
                    self.joints.append(tuple(angle))
                    for k in range(2):
                        speed[k] += 1e-3 * ((torque[k] if enabled else 0.0) - 0.1 * speed[k]) / 0.07
                        angle[k] += 1e-3 * speed[k]
                obeyed = number
                state = self.STATE.pack(b"MBKS", 1, self.MOTORS_ON * enabled, session, 0, number, number,
                                        1e-3 * number, *angle, 0, 0, 0, 0)
                answer = state + struct.pack("<I", zlib.crc32(state))
            self.socket.sendto(answer, sender)

    def end(self):
        self.over = True
        self.join()
        self.socket.close()


@dataclasses.dataclass
class Ran:
    code: int
    out: str
    err: str
    calls: dict
    failed: int
    robot: object = None

    @property
    def message(self):
        """The one line that says what is wrong; empty where there is none."""
        lines = [line for line in self.err.splitlines() if line.strip()]
        return lines[-1] if lines and lines[-1].startswith("mbk: ") else ""


def run(arguments, folder, fault=None, extra=None):
    """A command of mbk in a folder, under the shim where there is a fault or something to write down."""
    environment = dict(os.environ)
    counts = folder / ".counts"
    if fault is not None or extra:
        environment |= {"LD_PRELOAD": program("FAILING_CALLS"), "MBK_FAULT_COUNTS": str(counts), **(extra or {})}
    if fault is not None and fault.nth:
        environment |= {"MBK_FAULT_GROUP": fault.group, "MBK_FAULT_NTH": str(fault.nth),
                        "MBK_FAULT_ERRNO": str(fault.errno), "MBK_FAULT_STICKY": str(int(fault.sticky))}
    process = subprocess.Popen([program("MBK"), *map(str, arguments)], cwd=folder, env=environment,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        out, err = process.communicate(timeout=LONGEST)
        code = process.returncode
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        code = None
    numbers = COUNTS.unpack(counts.read_bytes()) if counts.exists() else (0,) * 12
    counts.unlink(missing_ok=True)
    return Ran(code, out.decode(errors="replace"), err.decode(errors="replace"), dict(zip(GROUPS, numbers)), numbers[-1])


def rows(recording, folder):
    """The samples of a recording by column; None where it does not open."""
    table = folder / ".rows.csv"
    ran = run(["convert", recording, table, "--overwrite", "--quiet"], folder)
    if ran.code != FINE:
        return None
    with open(table, encoding="utf-8") as file:
        lines = list(csv.reader(line for line in file if not line.startswith("#")))
    table.unlink()
    return {name: [float(row[k]) for row in lines[1:]] for k, name in enumerate(lines[0])}


def contents(folder):
    """Every file by its name."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


class Task:
    """A command, its files, and what it has to leave behind."""

    name = ""
    arguments = ()
    outputs = ()  # files that it makes

    def __init__(self, folder):
        """@param folder  for what every run of it begins with"""
        self.inputs = folder / self.name
        self.inputs.mkdir()
        self.prepare()

    def prepare(self):
        """Fills self.inputs."""

    def perform(self, folder, fault=None, extra=None):
        """In a folder of its own, which is empty."""
        shutil.copytree(self.inputs, folder, dirs_exist_ok=True)
        return run(self.arguments, folder, fault, extra)

    def refer(self, folder):
        """A run without a fault: what all others are compared with."""
        ran = self.perform(folder, Fault())
        if ran.code != FINE:
            raise AssertionError(f"{self.name} without a fault: exit {ran.code}\n{ran.out}{ran.err}")
        self.reference, self.whole = ran, contents(folder)
        self.take_reference(folder)
        return ran

    def take_reference(self, folder):
        """What is kept of that run besides."""

    def judge(self, ran, folder, fault):
        """What is wrong with a run; empty where nothing is."""
        if ran.code is None:
            return f"hangs for {LONGEST} s"
        if ran.code < 0:
            return f"death by {signal.Signals(-ran.code).name}"
        told = self.was_told(ran, fault)
        return told or self.judge_files(ran, folder, fault) or ""

    def was_told(self, ran, fault):
        if ran.code == FINE and self.shown(ran.out) != self.shown(self.reference.out):
            return "exit 0, and what is printed is not whole"
        if ran.code != FINE and not ran.message and not self.speechless(fault):
            return f"exit {ran.code} without a line that says why"
        return ""

    @staticmethod
    def speechless(fault):
        """Nothing can be written any more: the exit code has to say it alone."""
        return fault.group == "write" and fault.sticky

    def shown(self, out):
        """What two runs without a fault print alike."""
        return out

    def judge_files(self, ran, folder, fault):
        left = contents(folder)
        for name, before in contents(self.inputs).items():
            if name not in self.outputs and left.get(name) != before and not self.may_go(name, left):
                return f"{name}, which it reads, is no longer there or another"
        for name in self.outputs:
            old = self.inputs / name
            if ran.code == FINE and left.get(name) != self.whole[name]:
                return f"exit 0, and {name} is {'another' if name in left else 'missing'}"
            allowed = [self.whole[name], old.read_bytes() if old.exists() else None]
            if left.get(name) not in allowed:
                return f"{name} is neither whole nor what it was"
        return ""

    def may_go(self, name, left):
        """Whether a file that is read may be gone after the run."""
        return False


class Simulate(Task):
    name = "simulate"
    arguments = ("simulate", "scenario.toml", "--out", "x.h5")
    outputs = ("x.h5",)

    def prepare(self):
        (self.inputs / "scenario.toml").write_text(SCENARIO.format(seconds=2))


class Measured(Task):
    """Begins with a recording."""

    def prepare(self):
        (self.inputs / "scenario.toml").write_text(SCENARIO.format(seconds=6))
        if run(["simulate", "scenario.toml", "--out", "x.h5", "--quiet"], self.inputs).code != FINE:
            raise AssertionError("no recording could be simulated")


class Report(Measured):
    name = "report"
    arguments = ("measure", "x.h5", "--report", "x.html", "--overwrite", "--threads", "1")
    outputs = ("x.html",)

    def prepare(self):
        super().prepare()
        (self.inputs / "x.html").write_text("an older report\n")


class Json(Measured):
    name = "json"
    arguments = ("measure", "x.h5", "--json", "--threads", "1")


class Convert(Measured):
    name = "convert"
    arguments = ("convert", "x.h5", "y.mat", "--overwrite")
    outputs = ("y.mat",)

    def prepare(self):
        super().prepare()
        (self.inputs / "y.mat").write_text("what was there\n")


def session(folder, fault, extra, arguments=()):
    """A short session with the robot in lock-step, and who saw it."""
    robot = Robot()
    (folder / "experiment.toml").write_text(EXPERIMENT + DEVICE.format(port=robot.port))
    ran = run(["run", "experiment.toml", "--fast", "--quiet", "--no-measure", "--out", "x.h5", *arguments], folder,
              fault, extra)
    robot.end()
    ran.robot = robot
    return ran


class Session(Task):
    name = "session"
    outputs = ("x.h5",)

    def perform(self, folder, fault=None, extra=None):
        return session(folder, fault, extra)

    def take_reference(self, folder):
        self.truth = self.reference.robot
        self.kept = len(rows(folder / "x.h5", folder)["time_s"])
        problem = self.judge_rows(self.reference, folder, Fault())
        if problem:
            raise AssertionError(f"session without a fault: {problem}")

    def shown(self, out):
        return re.sub(r"compute per tick: .*", "", out)

    def was_told(self, ran, fault):
        if ran.code == SAFETY_STOP and "safety stop" in ran.out:
            return ""
        if ran.code == NOT_CONFIRMED and "NOT CONFIRMED OFF" in ran.err:
            return ""
        return super().was_told(ran, fault)

    def judge_files(self, ran, folder, fault):
        return self.judge_robot(ran, fault) or self.judge_rows(ran, folder, fault)

    def judge_robot(self, ran, fault):
        """The motors end without torque: off, and before that on a ramp."""
        commands = ran.robot.commands
        driven = [k for k, (enabled, *_) in enumerate(commands) if enabled]
        if not driven:
            return ""
        if fault.group == "socket" and fault.sticky:
            return ""  # nothing reaches it any more: its own watchdog has to switch off
        if driven[-1] == len(commands) - 1:
            return "the robot's last command leaves the motors on"
        size = [max(abs(one), abs(other)) for _, one, other in commands]
        before = max(size[max(0, driven[-1] - 25):driven[-1] + 1])
        if size[driven[-1]] > 0.06 * before + 1e-3:
            return f"the torque ends at {size[driven[-1]]:.3g} of {before:.3g} N·m, without a ramp"
        return ""

    def judge_rows(self, ran, folder, fault):
        """Every tick that the robot saw is in the recording or in the journal, as the robot saw it."""
        target, journals = folder / "x.h5", sorted(folder.glob("*.journal"))
        commands = ran.robot.commands
        # What comes behind the last torque says goodbye, as often as it takes.
        ticks = max((k + 1 for k, (enabled, *_) in enumerate(commands) if enabled), default=0)
        if ran.code == FINE and not target.exists():
            return "exit 0, and there is no recording"
        made = target
        if not target.exists():
            if not journals:
                return f"{ticks} ticks are gone" if ticks else ""
            made = folder / "recovered.h5"
            recovered = run(["recover", journals[-1], "--out", made, "--keep"], folder)
            if recovered.code != FINE:
                if not recovered.message:
                    return f"the journal cannot be recovered: {recovered}"
                return "" if self.said_loss(ran, fault) or not ticks else f"the journal has no ticks: {recovered.message}"
        found = rows(made, folder)
        if found is None:
            return f"{made.name} does not open"
        kept = len(found["time_s"])
        for k in range(kept):
            if k >= len(commands) and fault.group == "socket":
                break  # commanded, and never sent
            if k >= len(commands):
                return f"row {k} was never commanded"
            seen = (*commands[k][1:], *ran.robot.joints[k])
            if tuple(found[name][k] for name in ("torque_1_N.m", "torque_2_N.m", "joint_1_rad", "joint_2_rad")) != seen:
                return f"row {k} is not what the robot saw"
        if ran.code == FINE and (commands[:ticks] != self.truth.commands[:ticks] or kept != self.kept):
            return f"exit 0, and {kept} ticks are there, of {self.kept} in a whole run"
        if kept < ticks and not self.said_loss(ran, fault):
            return f"{ticks - kept} of {ticks} ticks are missing, and nobody says so"
        return ""

    def said_loss(self, ran, fault):
        if self.speechless(fault) and ran.code != FINE:
            return True
        return re.search(r"not written|dropped|lost|missing|cannot be created|no space", ran.err + ran.out) is not None


class Recover(Task):
    name = "recover"
    arguments = ("recover", "x.h5.journal")
    outputs = ("x.h5",)

    def prepare(self):
        # The journal stays where it cannot be removed: the call that does that is found by trying.
        for call in range(1, 30):
            ran = session(self.inputs, Fault("name", call, 5, True), None)
            made = (self.inputs / "x.h5").exists()
            for left in (self.inputs / "x.h5", *self.inputs.glob(".*.part")):
                left.unlink(missing_ok=True)
            if made and (self.inputs / "x.h5.journal").exists():
                return
            (self.inputs / "x.h5.journal").unlink(missing_ok=True)
        raise AssertionError(f"no journal was left: {ran}")

    def may_go(self, name, left):
        return name == "x.h5.journal" and name not in left and left.get("x.h5") == self.whole["x.h5"]


class Study(Measured):
    """Begins with a study of two recordings, of participants 7 and 8."""

    def prepare(self):
        (self.inputs / "scenario.toml").write_text(SCENARIO.format(seconds=6))
        for seed in (1, 2, 3):
            self.done("simulate", "scenario.toml", "--seed", seed, "--out", f"x{seed}.h5", "--quiet")
        self.done("study", "init", "s")
        self.done("study", "add", "x1.h5", "--study", "s", "--participant", 7, "--quiet")
        self.done("study", "add", "x2.h5", "--study", "s", "--participant", 8, "--quiet")
        self.before = self.state(self.inputs)[0]

    def done(self, *arguments):
        ran = run(list(map(str, arguments)), self.inputs)
        if ran.code != FINE:
            raise AssertionError(f"{arguments}: exit {ran.code}: {ran.err}")

    @staticmethod
    def state(folder):
        """What of a study can be listed, sorted; and what is wrong with it."""
        ran = run(["study", "check", "--study", "s", "--json", "--quick"], folder)
        problems = json.loads(ran.out)["problems"] if ran.out else []
        # A clock that fails gives a line of the log another time, and the check reports that, as it should.
        clock_alone = problems and all(re.match(r"line \d+ of the log is dated ", one) for one in problems)
        if ran.code != FINE and not clock_alone:
            return [], f"check: exit {ran.code}: {' '.join((ran.out + ran.err).split())[-300:]}"
        left = [path for path in (folder / "s").rglob("*.part*")]
        if left:
            return [], f"left half-written after check: {left}"
        ran = run(["study", "list", "--study", "s", "--json"], folder)
        if ran.code != FINE:
            return [], f"list: exit {ran.code}: {ran.err[-300:]}"
        return sorted((one["participant"], one["sha256"], one["state"], one.get("reason", ""))
                      for one in json.loads(ran.out)["recordings"]), ""

    def take_reference(self, folder):
        self.after, problem = self.state(folder)
        if problem or self.after == self.before:
            raise AssertionError(f"{self.name} without a fault: {problem or 'nothing was done'}")

    @staticmethod
    def progress(state):
        """How far the command has come; only whole steps are steps."""
        raise NotImplementedError

    def judge_files(self, ran, folder, fault):
        for name, before in contents(self.inputs).items():
            if contents(folder).get(name) != before:
                return f"{name}, which it reads, is no longer there or another"
        state, problem = self.state(folder)
        if problem:
            return problem
        if ran.code == FINE and state != self.after:
            return f"exit 0, and the study is {state}"
        if self.progress(state) < 0:
            return f"the study is neither as it was nor as it should be: {state}"
        return ""


class StudyAdd(Study):
    name = "study_add"
    arguments = ("study", "add", "x3.h5", "--study", "s", "--participant", "9", "--quiet")

    def progress(self, state):
        return (self.before, self.after).index(state) if state in (self.before, self.after) else -1


class StudyMeasure(Study):
    name = "study_measure"
    arguments = ("study", "measure", "--study", "s", "--threads", "1", "--quiet")

    def progress(self, state):
        """Results that are stored; each recording is as it was or as it is to be."""
        if len(state) != len(self.before):
            return -1
        steps = [(one in self.before, one in self.after) for one in state]
        return sum(after for _, after in steps) if all(map(any, steps)) else -1


class StudyForget(Study):
    name = "study_forget"
    arguments = ("study", "forget", "--study", "s", "--participant", "7", "--why", "consent withdrawn")

    def prepare(self):
        super().prepare()
        self.done("study", "measure", "--study", "s", "--threads", 1, "--quiet")
        self.before = self.state(self.inputs)[0]

    def progress(self, state):
        return (self.before, self.after).index(state) if state in (self.before, self.after) else -1

    def judge_files(self, ran, folder, fault):
        problem = super().judge_files(ran, folder, fault)
        if problem or ran.code != FINE:
            return problem
        for _, hash_of_file, *_ in [one for one in self.before if one not in self.after]:
            left = [path.name for path in (folder / "s").rglob("*") if path.is_file() and
                    (hash_of_file in path.name or hash_of_file.encode() in path.read_bytes())]
            if left:
                return f"exit 0, and what was to be forgotten stands in {left}"
        return ""


TASKS = (Session, Recover, Convert, Report, Json, Simulate, StudyAdd, StudyMeasure, StudyForget)
