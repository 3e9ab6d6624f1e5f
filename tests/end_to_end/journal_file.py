"""Journals of sessions as they are described (mbk/files/journal/blocks.h), written and walked without mbk."""

import json
import math
import struct
import zlib

TICK = struct.Struct("<Q3d12dQf4B")
HEAD, HEAD1 = struct.Struct("<8sQQIIII"), struct.Struct("<IIII")
MARK = b"\x9eMbkBlk\x02"
HEADER, TICKS, ENDING = 1, 2, 3
DONE = 6  # the phase of a trial's last tick

assert TICK.size == 144 and HEAD.size == 40


def tick(number, last=False):
    """Tick 0 is at 0 s; everything is perturbed. The numbers are made up, and different in every tick."""
    t = 1e-3 * number
    waves = [math.sin((0.3 + 0.17 * k) * t * 2 * math.pi + k) for k in range(12)]
    joint = (0.9 + 0.02 * waves[0], 0.4 + 0.02 * waves[1])
    force = (2 * waves[2] + 1e-6 * number, 2 * waves[3])
    return TICK.pack(number, t, 0.0, t, *joint, *force, *waves[4:12], number, 1e-5, DONE if last else 3, 0, 1, 0)


def header(**metadata):
    return json.dumps({"metadata": {"participant": "7", "condition": "relaxed", **metadata}, "d1_m": 0.34, "d2_m": 0.375,
                       "rate_hz": 1000.0, "reference_unit": "m", "has_force": True, "has_acceleration": True,
                       "force_latency_ticks": 0, "tick_bytes": TICK.size, "events": []}).encode()


def block(kind, payload, number, next_tick, trial=0x1234_5678_9ABC_DEF0):
    head = HEAD.pack(MARK, trial, next_tick, kind, len(payload), number, 0)[:-4]
    return head + struct.pack("<I", zlib.crc32(head + payload)) + payload


def block1(kind, payload):
    head = struct.pack("<II", kind, len(payload))
    return head + struct.pack("<II", zlib.crc32(head + payload), 0) + payload


def pieces(blocks, per_block=50, second=True):
    """The beginning, and every block, of a trial that was completed."""
    count = blocks * per_block
    ticks = [b"".join(tick(n, n + 1 == count) for n in range(k * per_block, (k + 1) * per_block)) for k in range(blocks)]
    ending = {"how": "completed", "detail": "", "dropped": 0, "overruns": 0}
    if not second:
        return [b"MBKJRNL1", block1(HEADER, header()), *(block1(TICKS, payload) for payload in ticks),
                block1(ENDING, json.dumps(ending).encode())]
    ending["ticks"] = count
    return [b"MBKJRNL2", block(HEADER, header(), 0, 0),
            *(block(TICKS, payload, k + 1, k * per_block) for k, payload in enumerate(ticks)),
            block(HEADER, header(), blocks + 1, count),
            block(ENDING, json.dumps(ending).encode(), blocks + 2, count)]


def ticks_of(piece):
    """Number → tick, of one block of ticks."""
    for head, kind_at in ((HEAD, 24), (HEAD1, 0)):
        if (piece[:8] == MARK) == (head is HEAD) and struct.unpack_from("<I", piece, kind_at)[0] == TICKS:
            payload = piece[head.size:]
            ticks = [TICK.unpack_from(payload, at) for at in range(0, len(payload), TICK.size)]
            return {one[0]: one for one in ticks}
    return {}


def walk(data):
    """The blocks of an undamaged journal of format 2: kind, payload, number, next tick."""
    assert data[:8] == b"MBKJRNL2"
    at = 8
    while at < len(data):
        mark, _, next_tick, kind, size, number, checksum = HEAD.unpack_from(data, at)
        payload = data[at + HEAD.size:at + HEAD.size + size]
        assert mark == MARK and len(payload) == size
        assert checksum == zlib.crc32(data[at:at + HEAD.size - 4] + payload)
        yield kind, payload, number, next_tick
        at += HEAD.size + size
