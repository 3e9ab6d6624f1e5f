#!/usr/bin/env python3
"""Writes a KINARM exam of known truth: a .kinarm (binary files in a zip) or a .zip (C3D files in a zip).

  make_exam.py OUT.kinarm|OUT.zip [--arm right|left] [--robot endpoint|exoskeleton] [--trials 3] [--split 2:3] ...

Beside OUT stands OUT.expected.npz with what a reader has to find, to the bit: the trials in the order of their numbers,
split ones joined. Its keys, K counting the joined trials from 0:
  trials                how many
  K/number, K/tp        TRIAL:TRIAL_NUM and TRIAL:TP of the first part
  K/parts               frames of each part
  K/<label>             samples of a channel, float32; of <Right|Left>_Hand frames×2 [m]
  K/event_labels, K/event_times [s from the start of the joined trial]
  K/<right|left>/position, velocity, acceleration   of the hand, frames×2, SI, float64, before they were rounded
  <right|left>/M, B, K, x0   of the arm, at the hand
  <right|left>/link1, link2, pointer   lengths of the robot's links and the signed offset of the pointer [m]

Physics. The angles are those of the links from the x axis of the base, both global, sums of sines in time with analytic
derivatives; the hand is at
  x = base + L1 (cos q1, sin q1) + L2 (cos q2, sin q2) + p (−sin q2, cos q2)
with p = 0 of an End-Point robot, RIGHT_PTR_ANTERIOR or −LEFT_PTR_ANTERIOR of an exoskeleton. The arm pushes the robot by
  F = −(M ẍ + B ẋ + K (x − x0))
which the force sensor shows times `force_sign`, and the motors, which act on the links from the base, give
  τ = H(q) q̈ + h(q, q̇) + D q̇ − Jᵀ F.
The robot's own inertia H stands in the groups RIGHT_KINARM and LEFT_KINARM.

Not told by any document, and so a choice: the names in the group SUBJECT; the axes of the force sensor (those of the
base); whether parts of a split trial have numbers of their own (`split_numbers`).
"""

import argparse
import io
import pathlib
import struct
import zipfile

import numpy as np

ARMS = ("Right", "Left")
#: Who the participant is; nothing of it may be found anywhere else.
PERSONAL = ("MUSTERMANN-1970", "Erika Mustermann", "1970-08-12")
EVENTS = ("TASK_START", "Öffnen", "到達", "TRIAL_END")
#: N·s²/m, N·s/m, N/m of the arm that is moved and of the other one
IMPEDANCES = {
    True: ([[1.6, 0.25], [0.25, 1.1]], [[14.0, 2.5], [2.5, 11.0]], [[220.0, 35.0], [15.0, 160.0]]),
    False: ([[1.9, -0.2], [-0.2, 1.3]], [[18.0, -1.5], [-1.5, 12.0]], [[310.0, -20.0], [-30.0, 240.0]]),
}
#: What a status word of the force sensor may hold, as a number of 32 bits: nothing, two flags, and one which as a float
#: is not a number.
STATUS = (0x00000000, 0x00000001, 0x80000040, 0x7FC00101, 0xFF800001)


class Robot:
    """Geometry and inertia of one arm's robot, in SI."""

    def __init__(self, kind, arm):
        mirror = 1.0 if arm == "Right" else -1.0
        self.kind, self.arm = kind, arm
        endpoint = kind == "endpoint"
        self.link1, self.link2 = (0.21, 0.30) if endpoint else (0.305, 0.345)
        self.anterior = 0.0 if endpoint else 0.021
        self.base = np.array([mirror * 0.16, 0.05 if endpoint else -0.12])
        self.rest = np.array([1.25, 2.35]) if arm == "Right" else np.array([np.pi - 1.25, np.pi - 2.35])
        self.inertia1, self.inertia2, self.coupling = 0.085, 0.062, 0.031  # kg·m²
        self.friction = 0.012  # N·m·s
        # parameters in files are float32, and what is computed is computed of them
        for name in ("link1", "link2", "anterior", "inertia1", "inertia2", "coupling", "friction"):
            setattr(self, name, float(np.float32(getattr(self, name))))
        self.base = self.base.astype(np.float32).astype(float)
        self.pointer = mirror * self.anterior if kind != "endpoint" else 0.0

    def version(self):
        return "KINARM_EP 1.3" if self.kind == "endpoint" else "KINARM_H 2.1"

    def hand(self, q, dq, ddq):
        """Position, velocity and acceleration of the hand, frames×2."""
        c, s = np.cos(q), np.sin(q)
        lengths = np.array([self.link1, self.link2])
        along = np.stack([c, s], axis=-1) * lengths[:, None]  # frames×link×axis
        along[:, 1] += self.pointer * np.stack([-s[:, 1], c[:, 1]], axis=-1)
        across = np.stack([-along[..., 1], along[..., 0]], axis=-1)  # d/dq
        position = self.base + along.sum(axis=1)
        velocity = (across * dq[..., None]).sum(axis=1)
        acceleration = (across * ddq[..., None] - along * (dq**2)[..., None]).sum(axis=1)
        return position, velocity, acceleration, across

    def torque(self, q, dq, ddq, force, across):
        """Torques of the motors on the links, frames×2 [N·m]."""
        turned = q[:, 1] - q[:, 0]
        cosine, sine = self.coupling * np.cos(turned), self.coupling * np.sin(turned)
        first = self.inertia1 * ddq[:, 0] + cosine * ddq[:, 1] - sine * dq[:, 1]**2
        second = self.inertia2 * ddq[:, 1] + cosine * ddq[:, 0] + sine * dq[:, 0]**2
        return np.stack([first, second], axis=-1) + self.friction * dq - (across * force[:, None, :]).sum(axis=-1)


def motion(random, frames, rate, rest, amplitude):
    """Angles of both links and their derivatives, frames×2: sums of sines at 0.3 to 4.1 Hz."""
    time = np.arange(frames)[:, None, None] / rate
    frequency = 2 * np.pi * np.array([[0.31, 0.83, 1.57, 2.71, 4.09], [0.43, 1.03, 1.97, 3.19, 3.83]])
    phase = random.uniform(0, 2 * np.pi, frequency.shape)
    size = amplitude / np.sqrt(frequency)
    angle = rest + (size * np.sin(frequency * time + phase)).sum(axis=-1)
    velocity = (size * frequency * np.cos(frequency * time + phase)).sum(axis=-1)
    acceleration = (-size * frequency**2 * np.sin(frequency * time + phase)).sum(axis=-1)
    return angle, velocity, acceleration


class Trial:
    """What a whole trial holds before it is split: channels {label: (unit, description, float32)}, hands {label: n×2}."""

    def __init__(self, number, tp, parts):
        self.number, self.tp, self.parts = number, tp, parts
        self.channels, self.hands, self.events, self.truth = {}, {}, [], {}


def add_arm(trial, arm, robot, impedance, random, options):
    frames, rate = options["frames"], options["rate"]
    moved = arm.lower() == options["arm"]
    q, dq, ddq = motion(random, frames, rate, robot.rest, 0.03 if moved else 0.002)
    position, velocity, acceleration, across = robot.hand(q, dq, ddq)
    M, B, K, x0 = impedance
    force = -(acceleration @ M.T + velocity @ B.T + (position - x0) @ K.T)
    torque = robot.torque(q, dq, ddq, force, across)
    add = lambda name, unit, description, values: trial.channels.__setitem__(
        f"{arm}_{name}", (unit, description, np.asarray(values, dtype=np.float32)))
    for link in (0, 1):
        add(f"L{link + 1}Ang", "rad", "angle of the link, global", q[:, link])
        add(f"L{link + 1}Vel", "rad/s", "its velocity", dq[:, link])
        add(f"L{link + 1}Acc", "rad/s^2", "its acceleration", ddq[:, link])
        add(f"M{link + 1}TorCMD", "Nm", "commanded torque", torque[:, link])
    if options["force_sensor"]:
        sensed = options["force_sign"] * force
        if options["noise"]:
            sensed = sensed + random.normal(0, options["noise"], sensed.shape)
        lift, lever = 0.4 * np.sin(2 * np.pi * 0.2 * np.arange(frames) / rate), 0.03
        for axis, values in zip("XYZ", (sensed[:, 0], sensed[:, 1], lift)):
            add(f"FS_Force{axis}", "N", "force sensor", values)
        right_x = -lever * sensed[:, 1]
        # before TDK 3.4.2 TorqueX is wrong: here it repeats TorqueY
        add("FS_TorqueX", "Nm", "force sensor", right_x if options["right_torque_x"] else lever * sensed[:, 0])
        add("FS_TorqueY", "Nm", "force sensor", lever * sensed[:, 0])
        add("FS_TorqueZ", "Nm", "force sensor", 0.001 * lift)
        add("FS_TimeStamp", "s", "clock of the force sensor", 12.5 + np.arange(frames) / rate)
        words = np.array(STATUS, dtype="<u4")[(np.arange(frames) // 97) % len(STATUS)]
        trial.channels[f"{arm}_FS_Status"] = ("", "bits", words.view("<f4"))
    # where there is no right robot the left hand stands under the right one's name
    label = "Right_Hand" if options["other"] == "absent" else f"{arm}_Hand"
    trial.hands[label] = position.astype(np.float32)
    for name, values in (("position", position), ("velocity", velocity), ("acceleration", acceleration)):
        trial.truth[f"{arm.lower()}/{name}"] = values


def parts_of(frames, count):
    """Frames of each part; they differ where they can."""
    ends = np.round(frames * (np.arange(1, count + 1) / count)**1.3).astype(int)
    sizes = np.diff(np.concatenate([[0], ends]))
    if count < 1 or sizes.min() < 1 or sizes.sum() != frames:
        raise ValueError(f"{frames} frames cannot be split into {count} parts")
    return [int(size) for size in sizes]


def make_trials(options, robots, impedances):
    random = np.random.default_rng(options["seed"])
    trials, number = [], 1
    for k in range(options["trials"]):
        parts = parts_of(options["frames"], options["split"].get(k + 1, 1))
        trial = Trial(number, 1 + k % 2, parts)
        number += len(parts) if options["split_numbers"] == "own" else 1
        for arm, robot in robots.items():
            add_arm(trial, arm, robot, impedances[arm], random, options)
        noise = random.normal(0, 1e-3, options["frames"])
        burst = 1 + 20 * (np.arange(options["frames"]) % 400 < 120)
        trial.channels["EMG_Biceps"] = ("V", "surface EMG", (noise * burst).astype(np.float32))
        trial.channels["EMG_Triceps"] = ("V", "surface EMG", random.normal(0, 1e-3, options["frames"]).astype(np.float32))
        length = options["frames"] / options["rate"]
        places = np.sort(random.uniform(0.02, 0.98, len(EVENTS)))
        trial.events = [(label, place * length) for label, place in zip(EVENTS, places)]
        trials.append(trial)
    return trials


def common_groups(options, robots):
    """Groups of the whole exam: {name: (description, {parameter: (description, value)})}."""
    experiment = {
        "START_DATE_TIME": ("", "2024-02-29 14:31:07"),
        "TASK_PROTOCOL": ("", "impedance at rest"),
        "TASK_PROGRAM": ("", "Impedance"),
        "SUBJECT_ID": ("personal", PERSONAL[0]),
    }
    if options["tdk"]:
        experiment["TASK_PROGRAM_BUILD_TDK"] = ("", options["tdk"])
    calibration = {}
    for arm, robot in robots.items():
        upper = arm.upper()
        calibration[f"{upper}_L1"] = ("m", [robot.link1])
        calibration[f"{upper}_L2"] = ("m", [robot.link2])
        calibration[f"{upper}_PTR_ANTERIOR"] = ("m", [robot.anterior])
        calibration[f"{upper}_SHO_X"] = ("m", [robot.base[0]])
        calibration[f"{upper}_SHO_Y"] = ("m", [robot.base[1]])
    groups = {
        "EXPERIMENT": ("what was done", experiment),
        "CALIBRATION": ("lengths", calibration),
        "SUBJECT": ("the person", {
            "NAME": ("personal", PERSONAL[1]),
            "DATE_OF_BIRTH": ("personal", PERSONAL[2]),
            "SEX": ("personal", "F"),
            "HANDEDNESS": ("personal", "R"),
            "HEIGHT": ("personal", [1.71]),
            "WEIGHT": ("personal", [64.5]),
        }),
        "TARGET_TABLE": ("cm", {
            "USED": ("", np.array([2], dtype=np.int32)),
            "X": ("cm", [-4.0, 4.0]),
            "Y": ("cm", [30.0, 34.0]),
            "LABELS": ("", ["links", "rechts"]),
        }),
        "LOAD_TABLE": ("no load was used", {"USED": ("", np.array([0], dtype=np.int32)), "X_STIFF": ("N/m", [77.0])}),
    }
    for arm in ARMS:
        present = arm in robots
        description = {"IS_PRESENT": ("", np.array([int(present)], dtype=np.int32))}
        if present:
            robot = robots[arm]
            description.update({
                "VERSION": ("", robot.version()),
                "L1_L": ("m", [robot.link1]), "L2_L": ("m", [robot.link2]),
                "L1_I": ("kg m^2, on the diagonal of the first link", [robot.inertia1]),
                "L2_I": ("kg m^2, on the diagonal of the second link", [robot.inertia2]),
                "L12_I": ("kg m^2, times the cosine of the angle between them", [robot.coupling]),
                "FRICTION": ("N m s", [robot.friction]),
                "FLAGS": ("", bytes([1, 0, 255])),
            })
        groups[f"{arm.upper()}_KINARM"] = ("the robot of that arm", description)
    return groups


def trial_groups(number, tp, break_id, rate, channels):
    whole = lambda value: np.array([value], dtype=np.int32)
    return {
        "TRIAL": ("", {"TRIAL_NUM": ("", whole(number)), "TP": ("", whole(tp)), "BREAK_ID": ("", whole(break_id))}),
        "ANALOG": ("", {"RATE": ("Hz", [rate]), "USED": ("", whole(channels))}),
    }


class Part:
    """One folder or C3D file of the exam."""

    def __init__(self, name, groups, channels, hands, events):
        self.name, self.groups, self.channels, self.hands, self.events = name, groups, channels, hands, events


def parts_to_write(trials, options):
    """In an order that is not that of the trials' numbers."""
    parts, repeats = [], {}
    for trial in trials:
        start = 0
        for k, frames in enumerate(trial.parts):
            cut = slice(start, start + frames)
            number = trial.number + (k if options["split_numbers"] == "own" else 0)
            begin, end = start / options["rate"], (start + frames) / options["rate"]
            last = k + 1 == len(trial.parts)
            events = [(label, np.float32(at - begin)) for label, at in trial.events
                      if at >= begin and (at < end or last)]
            repeats[trial.tp] = repeats.get(trial.tp, 0) + 1
            parts.append(Part(f"{trial.tp:02d}_{number:02d}_{repeats[trial.tp]:02d}",
                              trial_groups(number, trial.tp, 0 if len(trial.parts) == 1 else k + 1, options["rate"],
                                           len(trial.channels)),
                              {label: (unit, about, values[cut]) for label, (unit, about, values) in trial.channels.items()},
                              {label: values[cut] for label, values in trial.hands.items()}, events))
            start += frames
    if options["split_numbers"] == "own":
        np.random.default_rng(options["seed"] + 1).shuffle(parts)
    return parts


# -- .kinarm: binary files -------------------------------------------------------------------------------------------


def string(text):
    units = text.encode("utf-16-le")
    return struct.pack("<i", len(units) // 2) + units


def binary_header(version, part, rate, name):
    frames = len(next(iter(part.channels.values()))[2]) if part.channels else 0
    numbers = (version, frames, len(part.channels), len(part.hands), len(part.events), acknowledgements(part))
    return struct.pack("<6if", *numbers, rate) + b"".join(map(string, [name, *part.channels, *part.hands]))


def acknowledgements(part):
    return 2 if part.channels else 0


def binary_parameters(version, groups):
    data = struct.pack("<i", version)
    for group, (description, parameters) in groups.items():
        data += struct.pack("<i", 1) + string(group) + string(description)
        for name, (about, value) in parameters.items():
            if isinstance(value, str):
                value = [value]
            if isinstance(value, bytes):
                kind, count, content = 1, len(value), value
            elif isinstance(value, np.ndarray) and value.dtype == np.int32:
                kind, count, content = 2, len(value), value.astype("<i4").tobytes()
            elif isinstance(value[0], str):
                kind, count, content = 0, len(value), b"".join(map(string, value))
            else:
                kind, count, content = 3, len(value), np.asarray(value, dtype="<f4").tobytes()
            data += struct.pack("<i", 2) + string(name) + string(about) + struct.pack("<2i", kind, count) + content
    return data


def write_kinarm(archive, common, parts, options):
    version, rate = options["version"], options["rate"]
    archive.writestr("description.txt", "Erika Mustermann, 2024-02-29\n")
    whole = Part("common", common, {}, {}, [])
    for part in [*parts, whole]:
        folder = f"raw/{part.name}"
        put = lambda name, data: archive.writestr(f"{folder}/{name}", data)
        put("header.bin", binary_header(version, part, rate, "MUSTERMANN_ERIKA_" + part.name))
        # the exam's parameters end with the file, a trial's with a record of type 0
        put("parameters.bin", binary_parameters(version, part.groups) + (b"" if part is whole else struct.pack("<i", 0)))
        if part is whole:
            continue
        for label, (unit, about, values) in part.channels.items():
            put(f"{label}.kinematics", struct.pack("<i", 1) + string(label) + string(about) + string(unit) +
                struct.pack("<i", len(values)) + values.astype("<f4").tobytes())
        for label, values in part.hands.items():
            put(f"{label}.position", struct.pack("<i", 1) + string(label) + string("hand") +
                struct.pack("<i", len(values)) + values.astype("<f4").tobytes())
        put("examevents.bin", struct.pack("<2i", version, len(part.events)) + b"".join(
            string(label) + string("") + struct.pack("<f", at) for label, at in part.events))
        put("videoack.bin", struct.pack("<2i", version, acknowledgements(part)) + struct.pack("<4f", 0.1, 0.14, 0.5, 0.54))
    archive.writestr("analysis/analysis.bin", b"\0" * 16)


# -- .zip: C3D files -------------------------------------------------------------------------------------------------


def c3d_record(group, name, kind, dimensions, data, description):
    about = description.encode()
    content = struct.pack("bB", kind, len(dimensions)) + bytes(dimensions) + data + bytes([len(about)]) + about
    return struct.pack("bb", len(name), group) + name.encode() + struct.pack("<h", 2 + len(content)) + content


def c3d_parameter(group, name, value, description):
    if isinstance(value, str):
        value = [value]
    if isinstance(value, bytes):
        return c3d_record(group, name, 1, [len(value)], value, description)
    if isinstance(value, np.ndarray) and value.dtype == np.int32:
        return c3d_record(group, name, 2, [len(value)], value.astype("<i2").tobytes(), description)
    if len(value) and isinstance(value[0], str):
        texts = [one.encode() for one in value]
        longest = max(map(len, texts))
        return c3d_record(group, name, -1, [longest, len(texts)], b"".join(one.ljust(longest) for one in texts), description)
    values = np.asarray(value, dtype="<f4")
    return c3d_record(group, name, 4, list(values.shape), values.tobytes(order="F"), description)


def c3d_file(groups, channels, hands, rate):
    """Intel, reals. Points hold the hands with z = 0, analog channels one sample a frame."""
    frames = len(next(iter(channels.values()))[2]) if channels else 0
    whole = lambda value: np.array([value], dtype=np.int32)
    point = {"USED": whole(len(hands)), "SCALE": [-1.0], "RATE": [rate],
             "FRAMES": np.array([min(frames, 65535)]).astype(np.uint16).view(np.int16).astype(np.int32)}
    if hands:
        point.update({"LABELS": list(hands), "UNITS": ["m"]})
    if frames > 65535:
        point["LONG_FRAMES"] = [float(frames)]
    analog = {"USED": whole(len(channels)), "RATE": [rate], "GEN_SCALE": [1.0]}
    if channels:
        analog.update({"LABELS": list(channels), "UNITS": [unit or "-" for unit, _, _ in channels.values()],
                       "DESCRIPTIONS": [about for _, about, _ in channels.values()],
                       "SCALE": [1.0] * len(channels), "OFFSET": np.zeros(len(channels), dtype=np.int32)})
    undescribed = lambda parameters: {name: ("", value) for name, value in parameters.items()}
    all_groups = {"POINT": ("", undescribed(point)), "ANALOG": ("", undescribed(analog))}
    for group, content in groups.items():
        if group not in all_groups:
            all_groups[group] = content

    def section(data_start):
        records = b""
        for index, (group, (description, parameters)) in enumerate(all_groups.items(), start=1):
            about = description.encode()
            records += struct.pack("bb", len(group), -index) + group.encode() + struct.pack("<h", 3 + len(about))
            records += bytes([len(about)]) + about
            if group == "POINT":
                records += c3d_parameter(index, "DATA_START", whole(data_start), "")
            for name, (text, value) in parameters.items():
                records += c3d_parameter(index, name, value, text)
        records += b"\0\0"
        blocks = -(-(len(records) + 4) // 512)
        return (bytes([1, 0x50, blocks, 84]) + records).ljust(512 * blocks, b"\0"), blocks

    parameters, blocks = section(0)
    parameters, blocks = section(2 + blocks)
    header = struct.pack("<BBHHHHHfHHf", 2, 0x50, len(hands), len(channels), 1, min(frames, 65535), 0, -1.0, 2 + blocks, 1,
                         rate)
    columns = []
    for values in hands.values():
        columns += [values[:, 0], values[:, 1], np.zeros(frames, dtype=np.float32), np.zeros(frames, dtype=np.float32)]
    columns += [values for _, _, values in channels.values()]
    # by their bits: a status may be a signalling NaN, which an assignment of floats could change
    data = np.stack([one.astype("<f4").view("<u4") for one in columns], axis=1).tobytes() if columns else b""
    return header.ljust(512, b"\0") + parameters + data


def write_c3d(archive, common, parts, options):
    rate = options["rate"]
    archive.writestr("raw/common.c3d", c3d_file(common, {}, {}, rate))
    for part in parts:
        groups = dict(part.groups)
        labels, times = [label for label, _ in part.events], np.array([at for _, at in part.events], dtype=np.float32)
        events = {"USED": ("", np.array([len(labels)], dtype=np.int32))}
        if labels:
            two_rows = np.stack([np.zeros_like(times), times])
            events.update({"LABELS": ("", labels), "TIMES": ("s", two_rows if options["two_rows"] else times)})
        groups["EVENTS"] = ("", events)
        archive.writestr(f"raw/{part.name}.c3d", c3d_file(groups, part.channels, part.hands, rate))
    archive.writestr("analysis/analysis.c3d", c3d_file({"ANALYSIS": ("", {"USED": ("", np.array([1], dtype=np.int32))})}, {},
                                                       {}, rate))


# -- both ------------------------------------------------------------------------------------------------------------


def expected_of(trials, robots, impedances, parts, options):
    expected = {"trials": np.array(len(trials))}
    by_number = {}
    for part in parts:
        trial_number = int(part.groups["TRIAL"][1]["TRIAL_NUM"][1][0])
        by_number.setdefault(trial_number, []).append(part)
    for k, trial in enumerate(trials):
        expected[f"{k}/number"], expected[f"{k}/tp"] = np.array(trial.number), np.array(trial.tp)
        expected[f"{k}/parts"] = np.array(trial.parts)
        for label, (_, _, values) in trial.channels.items():
            expected[f"{k}/{label}"] = values
        for label, values in trial.hands.items():
            expected[f"{k}/{label}"] = values
        labels, times, start = [], [], 0
        own = [part for j in range(len(trial.parts)) for part in by_number.get(trial.number + j, [])] \
            if options["split_numbers"] == "own" else by_number[trial.number]
        for part, frames in zip(own, trial.parts):
            for label, at in part.events:
                labels.append(label)
                times.append(float(at) + start / float(np.float32(options["rate"])))
            start += frames
        expected[f"{k}/event_labels"], expected[f"{k}/event_times"] = np.array(labels), np.array(times)
        for name, values in trial.truth.items():
            expected[f"{k}/{name}"] = values
    for arm, robot in robots.items():
        for name, value in zip(("M", "B", "K", "x0"), impedances[arm]):
            expected[f"{arm.lower()}/{name}"] = value
        for name in ("link1", "link2", "pointer"):
            expected[f"{arm.lower()}/{name}"] = np.array(getattr(robot, name))
    expected["force_sign"] = np.array(options["force_sign"])
    return expected


def make_exam(path, arm="right", robot="endpoint", trials=3, frames=1000, seed=1, rate=1000.0, split=None, other="still",
              split_numbers="own", version=3, tdk="3.5.0", force_sign=1, force_sensor=None, two_rows=True, noise=0.0):
    """Writes the exam and its .expected.npz, and returns what is in the latter. The kind follows the name's ending.

    split: {trial from 1: parts}; other: the other arm holds still or is absent; split_numbers: parts have TRIAL_NUMs of
    their own, or all the "same"; version: of the binary files; tdk: TASK_PROGRAM_BUILD_TDK, None for none;
    force_sign: −1 shows the force of the robot on the hand; force_sensor: None for an End-Point robot only; two_rows:
    EVENTS:TIMES of C3D files are 2×n; noise: standard deviation of the measured force [N].
    """
    path = pathlib.Path(path)
    old = tdk is None or tuple(int(one) for one in tdk.split(".")) < (3, 4, 2)
    options = {"arm": arm, "trials": trials, "frames": frames, "seed": seed, "rate": float(rate), "split": dict(split or {}),
               "other": other, "split_numbers": split_numbers, "version": version, "tdk": tdk, "force_sign": force_sign,
               "force_sensor": robot == "endpoint" if force_sensor is None else force_sensor, "two_rows": two_rows,
               "right_torque_x": not old, "noise": noise}
    if arm == "right" and other == "absent":
        robots = {"Right": Robot(robot, "Right")}
    elif other == "absent":
        robots = {"Left": Robot(robot, "Left")}
    else:
        robots = {one: Robot(robot, one) for one in ARMS}
    impedances = {}
    for one, its_robot in robots.items():
        M, B, K = map(np.array, IMPEDANCES[one.lower() == arm])
        at_rest = its_robot.hand(its_robot.rest[None], np.zeros((1, 2)), np.zeros((1, 2)))[0][0]
        impedances[one] = (M, B, K, at_rest + [0.012, -0.008])
    made = make_trials(options, robots, impedances)
    parts = parts_to_write(made, options)
    common = common_groups(options, robots)
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as archive:
        if path.suffix == ".kinarm":
            write_kinarm(archive, common, parts, options)
        elif path.suffix == ".zip":
            write_c3d(archive, common, parts, options)
        else:
            raise ValueError(f"{path}: an exam ends in .kinarm or .zip")
    path.write_bytes(memory.getvalue())
    expected = expected_of(made, robots, impedances, parts, options)
    np.savez(path.with_name(path.name + ".expected.npz"), **expected)
    return expected


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out")
    parser.add_argument("--arm", choices=["right", "left"], default="right", help="the arm that is moved")
    parser.add_argument("--other", choices=["still", "absent"], default="still", help="the other arm")
    parser.add_argument("--robot", choices=["endpoint", "exoskeleton"], default="endpoint")
    parser.add_argument("--trials", type=int, default=3)
    parser.add_argument("--frames", type=int, default=1000, help="of each whole trial")
    parser.add_argument("--rate", type=float, default=1000.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--split", action="append", default=[], metavar="TRIAL:PARTS", help="may be repeated")
    parser.add_argument("--split-numbers", choices=["own", "same"], default="own", help="TRIAL_NUM of the parts")
    parser.add_argument("--version", type=int, choices=[2, 3], default=3, help="of the binary files")
    parser.add_argument("--tdk", default="3.5.0", help="TASK_PROGRAM_BUILD_TDK; none: it is absent")
    parser.add_argument("--force-sign", type=int, choices=[1, -1], default=1, help="1: the hand's force on the robot")
    parser.add_argument("--force-sensor", choices=["yes", "no"], help="usually of an End-Point robot only")
    parser.add_argument("--noise", type=float, default=0.0, help="standard deviation of the measured force in N")
    parser.add_argument("--one-row", action="store_true", help="EVENTS:TIMES of C3D files are n numbers, not 2 x n")
    arguments = parser.parse_args()
    split = dict(tuple(map(int, one.split(":"))) for one in arguments.split)
    make_exam(arguments.out, arm=arguments.arm, robot=arguments.robot, trials=arguments.trials, frames=arguments.frames,
              seed=arguments.seed, rate=arguments.rate, split=split, other=arguments.other,
              split_numbers=arguments.split_numbers, version=arguments.version,
              tdk=None if arguments.tdk == "none" else arguments.tdk, force_sign=arguments.force_sign,
              force_sensor=None if arguments.force_sensor is None else arguments.force_sensor == "yes",
              two_rows=not arguments.one_row, noise=arguments.noise)


if __name__ == "__main__":
    main()
