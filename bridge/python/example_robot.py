"""The loop of a robot behind mbk: two wheels of 0.07 kg·m², each with a motor, here simulated.

usage: example_robot.py [PORT]
Put your hardware into the class Wheels; the loop stays as it is. SIGUSR1 presses the stop button and releases it again;
Ctrl-C ends the program, with the motors off. Python's pauses are now and then longer than a watchdog: it is for slow
robots and to try things, and where it lags behind, the motors go off.
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
        """Torque of the motors in N·m; without `enabled` their power stage is off."""
        self.drive = drive

    def read(self, time_s):
        """Every field from the hardware as it is now: whether the motors are on is what the drives say."""
        return Sample(time_s=time_s, encoder=tuple(self.angle), stop_pressed=self.button, motors_on=self.drive.enabled,
                      obeyed=self.drive.sequence, drives_measure=True, measured=self.drive.command)

    def move(self):
        """Only a simulation needs it: one period of J q̈ = τ − b q̇."""
        for k in range(2):
            self.speed[k] += PERIOD_S * (self.drive.command[k] - 0.1 * self.speed[k]) / 0.07
            self.angle[k] += PERIOD_S * self.speed[k]


def serve(robot, network):
    bridge, master, tick = Bridge(state_version=2), None, time.monotonic()
    while True:
        tick += PERIOD_S
        time.sleep(max(0.0, tick - time.monotonic()))
        now = time.monotonic()
        try:  # 1. whatever has come
            while True:
                data, sender = network.recvfrom(200)
                if bridge.take(data, sender, now) is Event.GREETED:
                    master = sender
        except BlockingIOError:
            pass
        # 2. the motors, at every tick: this is where the watchdog and the stop button switch them off
        robot.drive_motors(bridge.drive(now, robot.button))
        robot.move()
        # 3. what is true now
        data = bridge.state(robot.read(now))
        if data is not None:
            network.sendto(data, master)


def main():
    robot, network = Wheels(), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    network.bind(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 25000))  # "" where mbk runs elsewhere
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
