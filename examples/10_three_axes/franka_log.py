#!/usr/bin/env python3
"""Writes a recording of a hand with known M, B and K that a robot moves in space.

usage: franka_log.py FILE.csv    as libfranka's programs do
       franka_log.py FILE.mcap   as `ros2 bag record -s mcap` does: topics /pose and /wrench
"""

import csv
import math
import random
import struct
import sys

RATE, DURATION, PERIOD = 1000, 30, 10  # Hz, s, s
M = ((1.3, -0.4, 0.1), (-0.4, 1.8, 0.2), (0.1, 0.2, 1.1))  # kg
B = ((8.0, -2.0, 0.5), (-2.0, 11.0, 1.0), (0.5, 1.0, 7.0))  # N·s/m
K = ((90.0, -25.0, 5.0), (-25.0, 140.0, 10.0), (5.0, 10.0, 70.0))  # N/m
X0 = (0.45, 0.02, 0.40)  # m
POSE = (1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0)  # tool down: the columns of its rotation, each followed by 0


def lines(axis, chance):
    """Frequency [rad/s], amplitude [m] and phase of the sines along one axis. No two axes share a frequency."""
    for k in range(3 + axis, 60, 3):
        yield 2 * math.pi * k / PERIOD, 0.008 / (1 + k / PERIOD), chance.uniform(0, 2 * math.pi)


def ticks():
    """Position from X0 [m] and the force that the robot exerts on the hand [N], sample by sample."""
    chance = random.Random(1)
    sines = [list(lines(axis, chance)) for axis in range(3)]
    for tick in range(RATE * DURATION):
        t = tick / RATE
        x = [sum(a * math.sin(w * t + p) for w, a, p in axis) for axis in sines]
        v = [sum(a * w * math.cos(w * t + p) for w, a, p in axis) for axis in sines]
        acceleration = [sum(-a * w * w * math.sin(w * t + p) for w, a, p in axis) for axis in sines]
        # M a + B v + K (x - x0), with the noise of the robot's estimate.
        force = [sum(M[i][j] * acceleration[j] + B[i][j] * v[j] + K[i][j] * x[j] for j in range(3)) +
                 chance.gauss(0, 0.05) for i in range(3)]
        yield x, force


def write_csv(file):
    with open(file, "w", newline="", encoding="utf-8") as out:
        log = csv.writer(out)
        log.writerow(["time", *(f"O_T_EE[{k}]" for k in range(16)), *(f"O_F_ext_hat_K[{k}]" for k in range(6))])
        for tick, (x, force) in enumerate(ticks()):
            log.writerow([123456 + tick, *POSE, *(f"{X0[i] + x[i]:.8f}" for i in range(3)), 1,
                          *(f"{one:.5f}" for one in force), 0, 0, 0])


STAMP = "builtin_interfaces/Time stamp\nstring frame_id\n"
RULE = "=" * 80
TOPICS = {
    "/pose": ("geometry_msgs/msg/PointStamped", "std_msgs/Header header\ngeometry_msgs/Point point\n"
              f"{RULE}\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"),
    "/wrench": ("geometry_msgs/msg/WrenchStamped", "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n"
                f"{RULE}\nMSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"
                f"{RULE}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"),
}
HEADER = (f"{RULE}\nMSG: std_msgs/Header\n{STAMP}"
          f"{RULE}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n")


def write_mcap(file):
    """Records of MCAP one after the other, without chunks and index (mcap.dev/spec)."""
    def text(value):
        return struct.pack("<I", len(value.encode())) + value.encode()

    with open(file, "wb") as out:
        def record(kind, *parts):
            content = b"".join(parts)
            out.write(struct.pack("<BQ", kind, len(content)) + content)

        out.write(b"\x89MCAP0\r\n")
        record(1, text("ros2"), text("franka_log.py"))
        for number, (topic, (kind, definition)) in enumerate(TOPICS.items(), 1):
            record(3, struct.pack("<H", number), text(kind), text("ros2msg"), text(definition + HEADER))
            record(4, struct.pack("<HH", number, number), text(topic), text("cdr"), text(""))
        for tick, (x, force) in enumerate(ticks()):
            nanoseconds = 1_700_000_000_000_000_000 + tick * (1_000_000_000 // RATE)
            # CDR: its own header, the stamp, the frame "base" with its end, then numbers on multiples of eight.
            stamped = struct.pack("<4xII I5s 7x", *divmod(nanoseconds, 1_000_000_000), 5, b"base")
            stamped = b"\0\1" + stamped[2:]
            for number, values in ((1, [X0[i] + x[i] for i in range(3)]), (2, [*force, 0, 0, 0])):
                record(5, struct.pack("<HIQQ", number, tick, nanoseconds, nanoseconds), stamped,
                       struct.pack(f"<{len(values)}d", *values))
        record(15, bytes(4))
        record(2, bytes(20))
        out.write(b"\x89MCAP0\r\n")


def main(file):
    (write_mcap if file.endswith(".mcap") else write_csv)(file)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__))
