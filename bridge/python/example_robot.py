"""Loop of a robot connected to mbk: two simulated wheels of 0.07 kg·m², each with a motor.

usage: example_robot.py [PORT]
Replace the class Wheels with your own hardware; keep the loop unchanged. SIGUSR1 presses and releases the stop button;
Ctrl-C switches the motors off and ends the program. Python sometimes pauses for longer than a watchdog time, and the
motors then switch off: use it for slow robots and for trials.
"""
import signal
import socket
import sys
import time

from mbk_bridge import Bridge, Drive, Event, Sample

PERIOD_S = 1e-3


class Wheels:
    """The hardware."""

    def __init__(self):
        self.angle, self.speed, self.button = [0.2, 0.9], [0.0, 0.0], False
        self.drive = Drive(False, (0.0, 0.0), 0)

    def press(self, *_):
        self.button = not self.button

    def drive_motors(self, drive):
        """Motor torque in N·m; the power stage is off unless `enabled` is set."""
        self.drive = drive

    def read(self, time_s):
        """Reads every field from the hardware; motors_on must come from the drives."""
        return Sample(time_s=time_s, encoder=tuple(self.angle), stop_pressed=self.button, motors_on=self.drive.enabled,
                      obeyed=self.drive.sequence, drives_measure=True, measured=self.drive.command)

    def move(self):
        """Needed only by the simulation: one period of J q̈ = τ − b q̇."""
        for k in range(2):
            self.speed[k] += PERIOD_S * (self.drive.command[k] - 0.1 * self.speed[k]) / 0.07
            self.angle[k] += PERIOD_S * self.speed[k]


def serve(robot, network):
    bridge, master, tick = Bridge(state_version=2), None, time.monotonic()
    while True:
        tick += PERIOD_S
        time.sleep(max(0.0, tick - time.monotonic()))
        now = time.monotonic()
        try:  # 1. received datagrams
            while True:
                data, sender = network.recvfrom(200)
                if bridge.take(data, sender, now) is Event.GREETED:
                    master = sender
        except BlockingIOError:
            pass
        # 2. motors, at every tick: here the watchdog and the stop button switch them off
        robot.drive_motors(bridge.drive(now, robot.button))
        robot.move()
        # 3. current state
        data = bridge.state(robot.read(now))
        if data is not None:
            network.sendto(data, master)


def main():
    robot, network = Wheels(), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    network.bind(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 25000))  # "" if mbk runs on another computer
    network.setblocking(False)
    signal.signal(signal.SIGUSR1, robot.press)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    print("listening at UDP 127.0.0.1:%d" % network.getsockname()[1], flush=True)
    try:
        serve(robot, network)
    except KeyboardInterrupt:
        pass
    finally:
        robot.drive_motors(Drive(False, (0.0, 0.0), 0))


if __name__ == "__main__":
    main()
