#!/usr/bin/env python3
"""mbk.live: a script watches a simulated trial through the console, on loopback."""

import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import mbk
import numpy as np

EXPERIMENT = """
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 20
moving_in_s = 1
[participant]
kind = "arm"
number = 1
"""
WITHOUT_PAGES = "MBK_WEB"


class Run:
    """mbk with its console, five times as fast as the clock."""

    def __init__(self, folder):
        (folder / "experiment.toml").write_text(EXPERIMENT, encoding="utf-8")
        self.process = subprocess.Popen(
            [os.environ["MBK"], "run", "experiment.toml", "--out", "watched.h5", "--console", "--quiet", "--speed", "5"],
            cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.said = ""
        while self.said.count("token=") < 3:
            line = self.process.stderr.readline()
            if not line:
                raise RuntimeError(self.said)
            self.said += line
        threading.Thread(target=self.process.stderr.read, daemon=True).start()
        self.address = re.search(r"127\.0\.0\.1:\d+", self.said)[0]
        self.token, _, self.viewing = re.findall(r"token=(\w+)", self.said)

    def end(self):
        self.process.kill()
        self.process.wait()


class Watched(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-live-")
        cls.addClassCleanup(folder.cleanup)
        cls.run_ = Run(pathlib.Path(folder.name))
        cls.addClassCleanup(cls.run_.end)

    def test_samples_state_and_estimate_come(self):
        with mbk.live(self.run_.address, self.run_.viewing) as trial:
            self.assertTrue(trial.wait(lambda now: now.state.get("perturbing"), 60), trial)
            self.assertTrue(trial.wait(lambda now: now.estimate is not None, 90), trial)
            self.assertEqual(trial.estimate.model.K.shape, (2, 2))
            self.assertEqual(trial.estimate.schema, "mbk.result/2")
            samples = trial.samples()
            self.assertEqual(trial.trial, 0)
            time_s = samples["time"]
            self.assertGreater(time_s.size, 1000)
            # Samples may be lost on the way to a viewer that is slow, but none comes twice or late.
            self.assertGreater(np.diff(time_s).min(), 0.0)
            self.assertAlmostEqual(np.median(np.diff(time_s)), 1e-3, delta=2e-4)
            for name in ("hand_x", "force_x"):
                self.assertTrue(np.isfinite(samples[name]).all())
            self.assertGreater(np.ptp(samples["force_x"]), 0.0)
            short = trial.samples(last_s=0.5)["time"]
            self.assertLessEqual(short[-1] - short[0], 0.5)
            labels = [axes.get_ylabel() for axes in trial.plot().axes]
            self.assertEqual(labels, ["hand position [m]", "force of the hand [N]"])
            self.assertIn("phase", trial.state)
        self.assertFalse(trial.open)

    def test_an_address_with_its_token_is_enough_and_iterating_sees_time_pass(self):
        with mbk.live(f"http://{self.run_.address}/?token={self.run_.viewing}") as trial:
            seen = []
            for now in trial:
                seen.append(now.state.get("time_s", 0.0))
                if len(seen) > 20:
                    break
            self.assertEqual(seen, sorted(seen))

    def test_a_wrong_token_is_refused(self):
        with self.assertRaisesRegex(mbk.UsageError, "token") as caught:
            mbk.live(self.run_.address, "0" * len(self.run_.token))
        self.assertTrue(caught.exception.hint)


class Nobody(unittest.TestCase):
    def test_where_nothing_listens(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        with self.assertRaisesRegex(mbk.DataError, "console"):
            mbk.live(f"127.0.0.1:{port}", "abc")

    def test_where_something_else_listens(self):
        for answer in (b"SSH-2.0-x\r\n\r\n", b"HTTP/1.1 200 OK\r\n\r\n", b"",
                       b"HTTP/1.1 101 Switching Protocols\r\nSec-WebSocket-Accept: no\r\n\r\n"):
            with self.subTest(answer), socket.create_server(("127.0.0.1", 0)) as server:

                def serve(answer=answer, server=server):
                    stream, _ = server.accept()
                    with stream:
                        stream.recv(4096)
                        stream.sendall(answer)

                threading.Thread(target=serve, daemon=True).start()
                with self.assertRaises(mbk.Error):
                    mbk.live(f"127.0.0.1:{server.getsockname()[1]}", "abc", timeout=5)

    def test_messages_that_are_none_end_the_stream_and_not_the_script(self):
        good = b"".join([b"\x81\x13", b'{"type":"estimate"}'])
        for bad in (b"\x82\x03abc", b"\x82\x7f" + b"\xff" * 8, b"\x81\x02{]", b"\x81\x0e" + b'{"type":"you"}' + b"\x88\x00"):
            with self.subTest(bad), socket.create_server(("127.0.0.1", 0)) as server:

                def serve(bad=bad, server=server):
                    import base64
                    import hashlib
                    stream, _ = server.accept()
                    with stream:
                        key = re.search(rb"Sec-WebSocket-Key: (\S+)", stream.recv(4096))[1]
                        accept = base64.b64encode(hashlib.sha1(key + mbk._live._GUID).digest())
                        stream.sendall(b"HTTP/1.1 101 x\r\nSec-WebSocket-Accept: " + accept + b"\r\n\r\n" + good + bad)
                        time.sleep(0.2)

                threading.Thread(target=serve, daemon=True).start()
                with mbk.live(f"127.0.0.1:{server.getsockname()[1]}", "abc", timeout=5) as trial:
                    self.assertFalse(trial.wait(lambda now: False, 10))
                    self.assertFalse(trial.open)
                    self.assertEqual(trial.samples()["time"].shape, (0,))

    def test_what_is_no_address(self):
        for address, token in (("nowhere", "abc"), ("127.0.0.1:99999", "abc"), ("127.0.0.1:80", None),
                               ("127.0.0.1:80", "a b\r\nX: y")):
            with self.subTest(address), self.assertRaises(mbk.UsageError):
                mbk.live(address, token)


if __name__ == "__main__":
    if sys.platform != "linux":
        sys.exit(77)
    try:
        unittest.main()
    except RuntimeError as error:
        if WITHOUT_PAGES in str(error):
            sys.exit(77)
        raise
