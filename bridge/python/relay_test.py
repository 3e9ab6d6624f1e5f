#!/usr/bin/env python3
"""A robot whose hardware is another robot behind UDP, in lock-step: uses all four pack and unpack functions.

usage: relay_test.py PORT [COMMAND...]
With a COMMAND the bridge is that program: it receives each datagram on its standard input as u32 length, u32 sender and
the bytes, and replies with u32 length and the bytes to send; 'robot' datagrams pass through it in the same way
(matlab/relay_test.m).
"""
import socket
import struct
import subprocess
import sys
import time

from mbk_bridge import Bridge, Command, CommandFlag, Event, Refused, Sample, State, StateFlag

LONGEST_S = 0.2


class Robot:
    """The other robot, as bytes."""

    def __init__(self, port):
        self.network = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.network.connect(("127.0.0.1", port))
        self.network.settimeout(LONGEST_S)

    def ask(self, data):
        """The reply of the robot; repeats the command if it is lost."""
        command = Command.unpack(data)
        for _ in range(20):
            self.network.send(data)
            try:
                while True:
                    answer = self.network.recv(200)
                    state = State.unpack(answer)
                    if (state.session, state.answered) == (command.session, command.sequence):
                        return answer
            except (TimeoutError, socket.timeout, Refused):
                continue
        sys.exit("relay_test: the other robot does not answer")


class PythonRelay:
    def __init__(self, robot):
        self.robot, self.bridge, self.answer, self.sequence = robot, Bridge(), b"", 0

    def take(self, data, sender):
        """The bytes to send back."""
        event = self.bridge.take(data, sender, time.monotonic())
        if event in (Event.GREETED, Event.COMMANDED):
            drive = self.bridge.drive(time.monotonic())
            greeted = event is Event.GREETED
            self.sequence = 1 if greeted else self.sequence + 1
            flags = CommandFlag.GREETING | CommandFlag.LOCK_STEP if greeted else \
                CommandFlag.ENABLED * drive.enabled
            session = Command.unpack(data).session
            state = State.unpack(self.robot.ask(Command(flags, session, 10000, self.sequence, drive.command).pack()))
            self.answer = self.bridge.state(Sample(
                state.time_s, state.encoder, state.force, state.acceleration, bool(state.flags & StateFlag.HAS_FORCE),
                bool(state.flags & StateFlag.HAS_ACCELERATION), bool(state.flags & StateFlag.STOP_PRESSED),
                bool(state.flags & StateFlag.MOTORS_ON), drive.sequence))
        return b"" if event is Event.REJECTED else self.answer


class ProgramRelay:
    """Between two messages for mbk the program may query the robot: a length with the highest bit set."""

    def __init__(self, robot, command):
        self.robot, self.senders = robot, {}
        self.program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def read(self, count):
        data = self.program.stdout.read(count)
        if len(data) != count:
            sys.exit("relay_test: the bridge has ended")
        return data

    def write(self, *head, data):
        self.program.stdin.write(struct.pack(f"<{len(head)}I", *head) + data)
        self.program.stdin.flush()

    def take(self, data, sender):
        number = self.senders.setdefault(sender, len(self.senders) + 1)
        self.write(len(data), number, data=data)
        while True:
            size, = struct.unpack("<I", self.read(4))
            answer = self.read(size & 0x7FFFFFFF)
            if not size & 0x80000000:
                return answer
            state = self.robot.ask(answer)
            self.write(len(state), 0, data=state)


def main():
    robot = Robot(int(sys.argv[1]))
    relay = ProgramRelay(robot, sys.argv[2:]) if len(sys.argv) > 2 else PythonRelay(robot)
    network = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    network.bind(("127.0.0.1", 0))
    print("listening at UDP 127.0.0.1:%d" % network.getsockname()[1], flush=True)
    while True:
        data, sender = network.recvfrom(200)
        answer = relay.take(data, sender)
        if answer:
            network.sendto(answer, sender)


if __name__ == "__main__":
    main()
