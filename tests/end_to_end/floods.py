#!/usr/bin/env python3
"""How soon does STOP stop while the console is flooded, and does the page still load for the token's holder?

Runs `mbk run` on a simulated robot in real time with its console, and against it, from another process, one flood after
the other. During each: trials are begun over the operator's WebSocket, stopped, reset, begun again. Told are, from the
press to the message that says the trip and to the message that says that the trial is over, median, 95th percentile and
largest [ms]; how many stops were obeyed; how long the operator's page and a new stream took to open, and how often they
did; and what the console wrote to its log. Times are reported and never judged: the exit code is 0 unless a stop was
not obeyed or a page did not load.

usage: floods.py [--mbk build/release/bin/mbk] [--stops 20] [--flood NAME ...]
"""

import argparse
import base64
import itertools
import json
import multiprocessing
import os
import pathlib
import random
import re
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time

HERE = pathlib.Path(__file__).resolve().parent
PATIENCE = 60.0  # for what is to happen at all [s]
MOST = 300  # connections that a flood holds open at once
LONGEST = 600.0  # of a flood, however long its stops take [s]

EXPERIMENT = """
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 8
moving_in_s = 1
[participant]
kind = "arm"
number = 1
"""


class Refused(Exception):
    """The server did not do what was asked of it."""


def connected(port, timeout=PATIENCE):
    return socket.create_connection(("127.0.0.1", port), timeout)


def request(port, target, more=""):
    return f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{more}\r\n".encode()


def upgrade(port, token):
    key = base64.b64encode(os.urandom(16)).decode()
    return request(port, f"/stream?token={token}",
                   f"Origin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                   f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n")


def framed(payload, opcode=1):
    """A frame as a browser sends it: final and masked (RFC 6455, §5.2); the mask is zero."""
    size = len(payload)
    length = (struct.pack("!B", 0x80 | size) if size < 126 else struct.pack("!BH", 0x80 | 126, size) if size < 1 << 16
              else struct.pack("!BQ", 0x80 | 127, size))
    return bytes([0x80 | opcode]) + length + bytes(4) + payload


def status_and_body(port, target, timeout=PATIENCE):
    """What GET brings."""
    with connected(port, timeout) as stream:
        stream.sendall(request(port, target))
        answer = b""
        while part := stream.recv(1 << 16):
            answer += part
    head, _, body = answer.partition(b"\r\n\r\n")
    length = re.search(rb"content-length: (\d+)", head, re.I)
    if not length or len(body) != int(length[1]):
        raise Refused(f"{len(body)} bytes of a page")
    return int(head.split()[1]), body


class Stream:
    """The WebSocket of a page; its messages come with the time at which they were here."""

    def __init__(self, port, token, timeout=PATIENCE):
        self.socket = connected(port, timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.sendall(upgrade(port, token))
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            self.fill()
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        if b" 101 " not in head.splitlines()[0]:
            raise Refused(head.splitlines()[0].decode())

    def fill(self):
        part = self.socket.recv(1 << 18)
        if not part:
            raise Refused("the stream ended")
        self.buffer += part

    def take(self, count):
        while len(self.buffer) < count:
            self.fill()
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def messages(self):
        """Each text message, put together from its frames; pings are answered."""
        whole, text = b"", False
        while True:
            first, second = self.take(2)
            size = second & 0x7F
            size = struct.unpack("!H", self.take(2))[0] if size == 126 else (
                struct.unpack("!Q", self.take(8))[0] if size == 127 else size)
            payload, opcode = self.take(size), first & 0x0F
            if opcode == 9:
                self.socket.sendall(framed(payload, 10))
            elif opcode == 8:
                raise Refused("the stream was closed")
            elif opcode <= 2:
                text = text if opcode == 0 else opcode == 1
                whole += payload
                if first & 0x80:
                    if text:
                        yield time.monotonic(), json.loads(whole)
                    whole = b""

    def tell(self, command, **more):
        self.socket.sendall(framed(json.dumps({"command": command, **more}).encode()))

    def close(self):
        self.socket.close()


class Operator:
    """The operator's page: its newest state, and waiting for one."""

    def __init__(self, port, token):
        self.stream = Stream(port, token)
        self.changed = threading.Condition()
        self.states = []  # since the last wait, with their times
        self.lost = None
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        try:
            for came, message in self.stream.messages():
                if message["type"] != "state":
                    continue
                with self.changed:
                    self.states.append((came, message))
                    self.changed.notify_all()
        except (OSError, Refused) as error:
            with self.changed:
                self.lost = error
                self.changed.notify_all()

    def wait(self, what, condition):
        """The first state from now on that is so, and when it came."""
        end = time.monotonic() + PATIENCE
        with self.changed:
            while True:
                while self.states:
                    came, state = self.states.pop(0)
                    if condition(state):
                        return came, state
                if self.lost or time.monotonic() > end:
                    raise Refused(f"{what}: {self.lost or 'never'}")
                self.changed.wait(0.1)

    def tell(self, command, **more):
        with self.changed:
            self.states.clear()
        self.stream.tell(command, **more)


class Run:
    """mbk with its console, and how much it writes to its log."""

    def __init__(self, mbk, folder, *options, **more):
        (folder / "experiment.toml").write_text(EXPERIMENT, encoding="utf-8")
        command = [mbk, "run", "experiment.toml", "--out", "flooded.h5", "--wait", "--quiet", "--no-measure"]
        self.process = subprocess.Popen([*command, *options], cwd=folder, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, **more)
        said = b""
        while said.count(b"token=") < 3:
            line = self.process.stderr.readline()
            if not line:
                raise Refused(f"mbk ended: {said.decode()}")
            said += line
        self.port = int(re.search(rb"127\.0\.0\.1:(\d+)/", said)[1])
        self.token, _, self.viewing = re.findall(r"token=(\w+)", said.decode())
        self.logged = b""
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            self.logged += line

    def cpu(self):
        """Seconds of the processor up to now."""
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def end(self):
        self.process.kill()
        self.process.wait()
        self.reader.join()
        self.process.stderr.close()


# ---------------------------------------------------------------- the floods, each in a process of its own


def pool(make, feed, over, count=MOST):
    """Keeps so many connections, and does something with each again and again; one that ends is made anew."""
    held = []
    while not over.is_set():
        while len(held) < count and not over.is_set():
            try:
                held.append(make())
            except (OSError, Refused):
                break
        for one in list(held):
            try:
                feed(one)
            except (OSError, Refused):
                held.remove(one)
                one.close()
        time.sleep(0.01)


def gone(stream):
    """Whether the server has closed it."""
    stream.setblocking(False)
    try:
        if stream.recv(1 << 16) == b"":
            raise Refused("closed")
    except BlockingIOError:
        pass


def half_open(run, over):
    """Connections that say nothing."""
    pool(lambda: connected(run["port"], 1.0), gone, over)


def slow_headers(run, over):
    """Requests that come byte by byte and never end."""
    def drip(stream):
        gone(stream)
        stream.send(b"x")

    def begin():
        stream = connected(run["port"], 1.0)
        stream.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        return stream

    pool(begin, drip, over)


def again_and_again(asked, over):
    """Asks on new connections, as fast as it can, and reads what comes."""
    while not over.is_set():
        try:
            port, words = asked()
            with connected(port, 1.0) as stream:
                stream.sendall(words)
                while stream.recv(1 << 16):
                    pass
        except OSError:
            time.sleep(0.001)


def wrong_tokens(run, over):
    """Pages asked for with a wrong token."""
    again_and_again(lambda: (run["port"], request(run["port"], f"/?token={os.urandom(16).hex()}")), over)


def upgrades_without_token(run, over):
    """Streams asked for without a token."""
    again_and_again(lambda: (run["port"], upgrade(run["port"], "")), over)


def huge_messages(run, over):
    """A page that may watch sends messages of 1 MB, on as many streams as it gets."""
    message = framed(b" " * (1 << 20))

    def feed(stream):
        stream.socket.settimeout(0.01)
        stream.socket.sendall(message)

    pool(lambda: Stream(run["port"], run["viewing"], 1.0), feed, over, 32)


def pings_and_notes(run, over):
    """A page that may watch sends pings and notes without end, and never reads."""
    note = framed(json.dumps({"command": "note", "text": "n" * 1900}).encode())
    burst = framed(b"?", 9) * 500 + note * 20

    def feed(stream):
        stream.socket.settimeout(0.01)
        try:
            stream.socket.sendall(burst)
        except TimeoutError:
            pass

    pool(lambda: Stream(run["port"], run["viewing"], 1.0), feed, over, 16)


def connect_and_close(run, over):
    """Bursts of 10,000 connections that are closed at once."""
    for k in itertools.count():
        if over.is_set():
            return
        try:
            connected(run["port"], 1.0).close()
        except OSError:
            time.sleep(0.001)
        if k % 10_000 == 9_999:
            time.sleep(0.2)


FLOODS = [half_open, slow_headers, wrong_tokens, upgrades_without_token, huge_messages, pings_and_notes,
          connect_and_close]


def flooding(flood, run, over):
    """Begins a flood in a process of its own, which ends by itself too."""
    def work():
        threading.Timer(LONGEST, over.set).start()
        flood(run, over)
        os._exit(0)

    process = multiprocessing.get_context("fork").Process(target=work, daemon=True)
    process.start()
    return process


# ---------------------------------------------------------------- what is measured meanwhile


class Measured:
    def __init__(self):
        self.asked = self.obeyed = self.loads = self.loaded = 0
        self.tripped, self.ended, self.opened = [], [], []  # [s]
        self.failures = []
        self.log_bytes_per_s = self.cpu = 0.0

    def load(self, run):
        """The operator's page and a new stream, as a browser that is opened now."""
        self.loads += 1
        begin = time.monotonic()
        try:
            status, body = status_and_body(run.port, f"/?token={run.token}")
            if status != 200 or b"mbk console" not in body:
                raise Refused(f"the page is {status}")
            stream = Stream(run.port, run.token)
            next(message for _, message in stream.messages() if message["type"] == "state")
            stream.close()
            self.loaded += 1
        except (OSError, Refused) as error:
            self.failures.append(f"load: {error!r}")
        self.opened.append(time.monotonic() - begin)

    def stop(self, run, operator, lot):
        """One trial that is stopped in its middle; begun before, reset after it."""
        operator.wait("running", lambda state: state["running"] and state["time_s"] > 0.2)
        time.sleep(lot.uniform(0.0, 0.3))
        self.asked += 1
        pressed = time.monotonic()
        operator.tell("stop")
        tripped, state = operator.wait("the trip", lambda state: state["safety"]["tripped"])
        if state["safety"]["reason"] == "operator-stop":
            self.tripped.append(tripped - pressed)
        else:  # the machine stalled just then, and the gate was there first
            print(f"  tripped by itself: {state['safety']['reason']}", file=sys.stderr)
        ended, state = operator.wait("the end", lambda state: state["question"] == "reset" and not state["running"])
        self.ended.append(ended - pressed)
        self.obeyed += 1
        self.load(run)
        operator.tell("reset")
        _, state = operator.wait("the code", lambda state: state["reset_code"] != "")
        operator.tell("reset", code=state["reset_code"])
        operator.wait("the reset", lambda state: state["question"] == "after")

    def line(self, name):
        def times(values):
            if not values:
                return f"{'none':>24}"
            high = sorted(values)[max(0, -(-95 * len(values) // 100) - 1)]
            return "".join(f"{1e3 * value:8.1f}" for value in (statistics.median(values), high, max(values)))

        return (f"{name:<24}{self.obeyed:4}/{self.asked:<4}{times(self.tripped)} {times(self.ended)}"
                f"{self.loaded:5}/{self.loads:<4}{times(self.opened)}{self.log_bytes_per_s:9.0f}{100 * self.cpu:6.0f}")


HEADER = (f"{'':<24}{'':>9}{'to the trip [ms]':>24} {'to the end [ms]':>24}{'':>10}{'page and stream [ms]':>24}"
          f"{'log':>9}{'CPU':>6}\n{'flood':<24}{'obeyed':>9}" + f"{'median':>8}{'p95':>8}{'most':>8} " * 2 +
          f"{'loaded':>9}{'median':>8}{'p95':>8}{'most':>8}{'B/s':>9}{'%':>6}")


def measure(mbk, flood, stops, seed=1):
    """A run of its own, flooded; so many stops."""
    measured = Measured()
    with tempfile.TemporaryDirectory(prefix="mbk-floods-") as folder:
        run = Run(mbk, pathlib.Path(folder))
        over = multiprocessing.get_context("fork").Event()
        attacker = None
        try:
            operator = Operator(run.port, run.token)
            operator.wait("the question", lambda state: state["question"] == "begin")
            begin, cpu, logged = time.monotonic(), run.cpu(), len(run.logged)
            if flood:
                attacker = flooding(flood, {"port": run.port, "viewing": run.viewing}, over)
                time.sleep(1.0)
            lot = random.Random(seed)
            for k in range(stops):
                operator.tell("start" if k == 0 else "repeat")
                measured.stop(run, operator, lot)
            operator.tell("abort")
            took = time.monotonic() - begin
            measured.cpu = (run.cpu() - cpu) / took
            measured.log_bytes_per_s = (len(run.logged) - logged) / took
        except (OSError, Refused) as error:
            measured.failures.append(f"{error!r}")
        finally:
            over.set()
            if attacker:
                attacker.join(5.0)
                if attacker.is_alive():
                    attacker.kill()
                    attacker.join()
            run.end()
    return measured


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mbk", type=pathlib.Path, default=HERE.parents[1] / "build/release/bin/mbk")
    parser.add_argument("--stops", type=int, default=20, help="during each flood (20)")
    parser.add_argument("--flood", choices=["none"] + [flood.__name__ for flood in FLOODS], action="append",
                        help="only this one; may be repeated")
    arguments = parser.parse_args()
    if arguments.stops < 1:
        parser.error("--stops must be at least 1")
    print(HEADER, flush=True)
    failed = False
    for flood in [None, *FLOODS]:
        name = flood.__name__ if flood else "none"
        if arguments.flood and name not in arguments.flood:
            continue
        measured = measure(arguments.mbk.resolve(), flood, arguments.stops)
        print(measured.line(name), flush=True)
        for failure in measured.failures:
            print(f"  {failure}")
        failed = failed or bool(measured.failures) or measured.obeyed < arguments.stops
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
