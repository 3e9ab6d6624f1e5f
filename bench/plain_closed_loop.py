#!/usr/bin/env python3
"""The robot with an arm at its handle, as plainly as it can be written down: Dyck (2013), eqs. 3.2, 5.1, A.1, A.3, A.6
(with the corrected sign), classical Runge-Kutta at 1 kHz, the motor torque held over each tick.

Reads the motor torques from a recording that `mbk simulate bench/closed_loop.toml` made, moves robot and arm by them
from rest, and compares where the hand goes and what it exerts with the recording: a second implementation of the
plant, without the controller, the noise and the energies. Prints JSON: the largest differences and the seconds.

usage: plain_closed_loop.py RECORDING.mat
"""

import json
import math
import sys
import time

import scipy.io

D1, D2 = 0.254, 0.2667
A1, A2, A3, A4, A5 = 0.06929, 0.04217, 0.04416, 0.06510, 0.07389
M = ((1.326 + 0.194, -0.935), (-0.935, 1.883 + 0.194))  # with the handle
B = ((5.76, -2.14), (-2.14, 10.56))
K = ((42.4, -28.6), (-28.6, 125.3))
HOME = (0.3, -0.05)
STEP = 0.001


def hand(q1, q2):
    return D1 * math.cos(q1) + D2 * math.sin(q2), D1 * math.sin(q1) - D2 * math.cos(q2)


def motion(state, torque):
    """Change of (q1, q2, w1, w2), and the force of the hand on the robot."""
    q1, q2, w1, w2 = state
    s1, c1, s2, c2 = math.sin(q1), math.cos(q1), math.sin(q2), math.cos(q2)
    j = ((-D1 * s1, D2 * c2), (D1 * c1, D2 * s2))
    x, y = D1 * c1 + D2 * s2 - HOME[0], D1 * s1 - D2 * c2 - HOME[1]
    vx, vy = j[0][0] * w1 + j[0][1] * w2, j[1][0] * w1 + j[1][1] * w2
    px, py = -D1 * c1 * w1 * w1 - D2 * s2 * w2 * w2, -D1 * s1 * w1 * w1 + D2 * c2 * w2 * w2  # J' w
    hx = B[0][0] * vx + B[0][1] * vy + K[0][0] * x + K[0][1] * y + M[0][0] * px + M[0][1] * py
    hy = B[1][0] * vx + B[1][1] * vy + K[1][0] * x + K[1][1] * y + M[1][0] * px + M[1][1] * py
    mj = [[sum(M[i][k] * j[k][n] for k in (0, 1)) for n in (0, 1)] for i in (0, 1)]
    coupling = -0.5 * A2 * math.sin(q1 - q2)
    i11 = A1 + j[0][0] * mj[0][0] + j[1][0] * mj[1][0]
    i12 = coupling + j[0][0] * mj[0][1] + j[1][0] * mj[1][1]
    i22 = A3 + j[0][1] * mj[0][1] + j[1][1] * mj[1][1]
    turn = 0.5 * A2 * math.cos(q1 - q2)
    t1 = torque[0] - A4 * w1 - turn * w2 * w2 - j[0][0] * hx - j[1][0] * hy
    t2 = torque[1] - A5 * w2 + turn * w1 * w1 - j[0][1] * hx - j[1][1] * hy
    det = i11 * i22 - i12 * i12
    a1, a2 = (i22 * t1 - i12 * t2) / det, (i11 * t2 - i12 * t1) / det
    force = (-(hx + mj[0][0] * a1 + mj[0][1] * a2), -(hy + mj[1][0] * a1 + mj[1][1] * a2))
    return (w1, w2, a1, a2), force


def main():
    logs = scipy.io.loadmat(sys.argv[1])["logs"]
    places, forces, torques = logs[1:3].T.tolist(), logs[9:11].T.tolist(), logs[13:15].T.tolist()
    state, held = (*logs[5:7, 0].tolist(), 0.0, 0.0), (0.0, 0.0)
    away = wrong = 0.0
    start, cpu = time.perf_counter(), time.process_time()
    for place, measured, torque in zip(places, forces, torques):
        _, before = motion(state, held)
        k1, after = motion(state, torque)
        force = [0.5 * (a + b) for a, b in zip(before, after)]  # as it is between two torques
        held = torque
        away = max(away, math.dist(hand(state[0], state[1]), place))
        wrong = max(wrong, math.dist(force, measured))
        k2, _ = motion([s + 0.5 * STEP * k for s, k in zip(state, k1)], torque)
        k3, _ = motion([s + 0.5 * STEP * k for s, k in zip(state, k2)], torque)
        k4, _ = motion([s + STEP * k for s, k in zip(state, k3)], torque)
        state = [s + STEP / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
    seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu
    print(json.dumps({"largest_distance_m": away, "largest_force_difference_N": wrong, "seconds": seconds,
                      "cpu_seconds": cpu_seconds}))


if __name__ == "__main__":
    main()
