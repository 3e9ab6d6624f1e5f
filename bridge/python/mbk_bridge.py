"""A robot of your own behind mbk, in Python: the two datagrams, and the rules that a robot keeps.

Copy this file; it needs the standard library alone. `Bridge.take` judges what has come from the network, `Bridge.drive`
says what the motors shall do now, `Bridge.state` gives the bytes that the robot sends. example_robot.py calls them in
the loop of a robot; docs/guide/own_robot.md describes the next steps and lists the bytes.
"""
import dataclasses
import enum
import math
import struct
import zlib

COMMAND_VERSION, NEWEST_STATE_VERSION = 1, 2
COMMAND_BYTES, STATE_BYTES = 44, {1: 92, 2: 112}
FORGET_S = 10.0  # so long after the last command the robot stops sending

_COMMAND = struct.Struct("<4sHHIIQ2d")
_STATE = {1: struct.Struct("<4sHHIIQQd2d2d2d"), 2: struct.Struct("<4sHHIIQQd2d2d2d2dI")}
_CHECKSUM = struct.Struct("<I")


class CommandFlag(enum.IntFlag):
    ENABLED = 1  # motors on
    GREETING = 2  # a session begins: motors off, an answer is awaited
    LOCK_STEP = 4  # in a greeting: a simulation shall wait for each command


class StateFlag(enum.IntFlag):
    STOP_PRESSED = 1
    MOTORS_ON = 2
    HAS_FORCE = 4  # a force sensor is fitted
    HAS_ACCELERATION = 8  # an accelerometer is fitted
    WATCHDOG_EXPIRED = 16
    DRIVES_MEASURE = 32  # version 2: `measured` is meant


class Refused(ValueError):
    """A datagram is not believed; `why` is "length", "magic", "version" or "checksum"."""

    def __init__(self, why):
        super().__init__(f"not believed: {why}")
        self.why = why


@dataclasses.dataclass
class Command:
    """From mbk."""

    flags: int = 0
    session: int = 0  # chosen by mbk at each start, not 0
    watchdog_ms: int = 0  # without a command for so long the motors have to go off
    sequence: int = 0  # from 1, the greeting's
    command: tuple = (0.0, 0.0)  # to motors 1 and 2, in the robot's unit

    def pack(self):
        return _sealed(_COMMAND.pack(b"MBKC", COMMAND_VERSION, self.flags, self.session, self.watchdog_ms,
                                     self.sequence, *self.command))

    @staticmethod
    def unpack(data):
        """@raises Refused. The numbers need not be finite."""
        _look_at(data, b"MBKC", {1: COMMAND_BYTES})
        _, _, flags, session, watchdog_ms, sequence, *command = _COMMAND.unpack(data[:-4])
        return Command(flags, session, watchdog_ms, sequence, tuple(command))


@dataclasses.dataclass
class State:
    """To mbk."""

    version: int = 1  # 1 or 2
    flags: int = 0
    session: int = 0  # of the last greeting
    rejected: int = 0  # datagrams that the robot has not believed
    sequence: int = 0  # of this sample, one more with each
    answered: int = 0  # sequence of the command that the drives obey
    time_s: float = 0.0  # of this sample, on the robot's clock
    encoder: tuple = (0.0, 0.0)  # counts, or angles in rad
    force: tuple = (0.0, 0.0)  # reading of the force sensor; 0 without one
    acceleration: tuple = (0.0, 0.0)  # reading of the accelerometer; 0 without one
    measured: tuple = (0.0, 0.0)  # version 2: what the drives exert, in the unit of the command
    fault: int = 0  # version 2: the robot's own fault code; 0: none

    def pack(self):
        version = 2 if self.version >= 2 else 1
        flags = self.flags & ~StateFlag.DRIVES_MEASURE if version == 1 else self.flags
        more = (*self.measured, self.fault) if version == 2 else ()
        return _sealed(_STATE[version].pack(b"MBKS", version, flags, self.session, self.rejected, self.sequence,
                                            self.answered, self.time_s, *self.encoder, *self.force,
                                            *self.acceleration, *more))

    @staticmethod
    def unpack(data):
        """@raises Refused. The numbers need not be finite."""
        version = _look_at(data, b"MBKS", STATE_BYTES)
        _, _, flags, session, rejected, sequence, answered, time_s, *rest = _STATE[version].unpack(data[:-4])
        measured, fault = (tuple(rest[6:8]), rest[8]) if version == 2 else ((0.0, 0.0), 0)
        return State(version, flags, session, rejected, sequence, answered, time_s, tuple(rest[0:2]), tuple(rest[2:4]),
                     tuple(rest[4:6]), measured, fault)


def _sealed(body):
    return body + _CHECKSUM.pack(zlib.crc32(body))


def _look_at(data, magic, lengths):
    """The version of a datagram.   @raises Refused"""
    if len(data) < 6:
        raise Refused("length")
    if data[:4] != magic:
        raise Refused("magic")
    version = int.from_bytes(data[4:6], "little")
    if version not in lengths:
        raise Refused("version")
    if len(data) != lengths[version]:
        raise Refused("length")
    if _CHECKSUM.unpack(data[-4:])[0] != zlib.crc32(data[:-4]):
        raise Refused("checksum")
    return version


class Event(enum.Enum):
    """What has come."""

    REJECTED = "rejected"  # not believed, and counted
    GREETED = "greeted"  # a session begins: send states to the sender from now on; motors off
    COMMANDED = "commanded"  # a new command
    REPEATED = "repeated"  # the newest command or the greeting once more: changes nothing; in lock-step, answer again


@dataclasses.dataclass
class Drive:
    """What the motors shall do now."""

    enabled: bool  # False: motors off
    command: tuple  # 0 where they are off
    sequence: int  # of the command that this is: goes back in Sample.obeyed once the drives obey it


@dataclasses.dataclass
class Sample:
    """What the robot measures and knows of itself, read from the hardware: the truth, not what was commanded."""

    time_s: float = 0.0  # of this sample; runs on with each
    encoder: tuple = (0.0, 0.0)  # counts, or angles in rad
    force: tuple = (0.0, 0.0)
    acceleration: tuple = (0.0, 0.0)
    has_force: bool = False  # the sensors are there now
    has_acceleration: bool = False
    stop_pressed: bool = False
    motors_on: bool = False  # as the drives say
    obeyed: int = 0  # Drive.sequence of what the drives do now
    drives_measure: bool = False
    measured: tuple = (0.0, 0.0)  # version 2: from the currents, in the unit of the command
    fault: int = 0  # version 2: a code of your own; 0: none


class Bridge:
    """The rules of a robot. Times are seconds of a clock that only runs forward (time.monotonic).

    To be read: `awake` (somebody is there to send states to), `master` (who greeted last), `lock_step` (asked for in
    the greeting; only a simulation can wait), `watchdog_expired` (the motors stay off until the next greeting).
    """

    def __init__(self, state_version=1):
        self.version = state_version
        self.awake = self.watchdog_expired = self.lock_step = False
        self.master, self.rejected = None, 0
        self._asked = Command()  # the newest command
        self._sequence, self._heard_s = 0, 0.0

    def take(self, data, sender, now_s):
        """A datagram has come from `sender`, what socket.recvfrom gives."""
        try:
            came = Command.unpack(data)
        except Refused:
            return self._reject()
        if not all(map(math.isfinite, came.command)):
            return self._reject()
        if came.flags & CommandFlag.GREETING:
            return self._greet(came, sender, now_s)
        newest = self._asked
        if not self.awake or sender != self.master or came.session != newest.session or \
                came.sequence < newest.sequence:
            return self._reject()
        if came.sequence == newest.sequence:
            return Event.REPEATED
        self._asked, self._heard_s = came, now_s
        return Event.COMMANDED

    def drive(self, now_s, stop_pressed=False):
        """What the motors shall do now: call it at each tick, whether or not anything has come."""
        enabled, silent_s = bool(self._asked.flags & CommandFlag.ENABLED), now_s - self._heard_s
        if enabled and silent_s > 1e-3 * self._asked.watchdog_ms:
            self.watchdog_expired = True
        if silent_s > FORGET_S:
            self.awake = False
        enabled = self.awake and enabled and not self.watchdog_expired and not stop_pressed
        return Drive(enabled, self._asked.command if enabled else (0.0, 0.0), self._asked.sequence)

    def state(self, sample):
        """The bytes to send to `master`; None: nobody listens."""
        if not self.awake:
            return None
        self._sequence += 1
        flags = (StateFlag.STOP_PRESSED * sample.stop_pressed | StateFlag.MOTORS_ON * sample.motors_on |
                 StateFlag.HAS_FORCE * sample.has_force | StateFlag.HAS_ACCELERATION * sample.has_acceleration |
                 StateFlag.WATCHDOG_EXPIRED * self.watchdog_expired | StateFlag.DRIVES_MEASURE * sample.drives_measure)
        return State(self.version, flags, self._asked.session, self.rejected, self._sequence, sample.obeyed,
                     sample.time_s, sample.encoder, sample.force, sample.acceleration, sample.measured,
                     sample.fault).pack()

    def _greet(self, came, sender, now_s):
        """From anyone while the motors are off; while they are on it is refused."""
        if self.awake and sender == self.master and came.session == self._asked.session:
            return Event.REPEATED
        if (self._asked.flags & CommandFlag.ENABLED and not self.watchdog_expired) or came.session == 0:
            return self._reject()
        self.awake, self.watchdog_expired, self.master = True, False, sender
        self.lock_step = bool(came.flags & CommandFlag.LOCK_STEP)
        self._asked = Command(0, came.session, came.watchdog_ms, came.sequence)
        self._heard_s = now_s
        return Event.GREETED

    def _reject(self):
        self.rejected = (self.rejected + 1) & 0xFFFFFFFF
        return Event.REJECTED
