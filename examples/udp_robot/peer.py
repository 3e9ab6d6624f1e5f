"""A robot for mbk in Python: two wheels of 0.07 kg·m² behind UDP.   usage: peer.py [PORT]

What goes where in the datagrams, and what a robot has to do, stands in docs/guide/devices.md. It has no stop button.
"""
import math
import socket
import struct
import sys
import time
import zlib

STATE, COMMAND = struct.Struct("<4sHHIIQQ7d"), struct.Struct("<4sHHIIQ2d")
ENABLED, GREETING, MOTORS_ON, EXPIRED = 1, 2, 2, 16
port = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
port.bind(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 25000))
port.setblocking(False)
print("listening at UDP 127.0.0.1:%d" % port.getsockname()[1], flush=True)
angle, speed, torque = [0.2, 0.9], [0.0, 0.0], [0.0, 0.0]
master, session, answered, enabled, expired, heard, watchdog = None, 0, 0, False, False, 0.0, 0.05
begin = time.monotonic()
for sequence in range(1, sys.maxsize):
    time.sleep(max(0.0, begin + 1e-3 * sequence - time.monotonic()))
    try:
        while True:
            data, sender = port.recvfrom(100)
            if len(data) != 44 or struct.pack("<I", zlib.crc32(data[:40])) != data[40:]:
                continue
            kind, version, flags, its_session, its_watchdog, number, *its_torque = COMMAND.unpack(data[:40])
            if (kind, version) != (b"MBKC", 1) or not all(map(math.isfinite, its_torque)):
                continue
            if flags & GREETING and not enabled and (sender, its_session) != (master, session):
                master, session, answered, expired = sender, its_session, 0, False
            if (sender, its_session) == (master, session) and number > answered:
                answered, torque, enabled = number, its_torque, bool(flags & ENABLED) and not expired
                heard, watchdog = time.monotonic(), 1e-3 * its_watchdog
    except BlockingIOError:
        pass
    if enabled and time.monotonic() - heard > watchdog:
        enabled, expired = False, True
    for k in range(2):
        speed[k] += 1e-3 * ((torque[k] if enabled else 0.0) - 0.1 * speed[k]) / 0.07
        angle[k] += 1e-3 * speed[k]
    if master:
        flags = MOTORS_ON * enabled | EXPIRED * expired
        state = STATE.pack(b"MBKS", 1, flags, session, 0, sequence, answered, 1e-3 * sequence, *angle, 0, 0, 0, 0)
        port.sendto(state + struct.pack("<I", zlib.crc32(state)), master)
