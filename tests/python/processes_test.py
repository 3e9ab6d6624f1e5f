#!/usr/bin/env python3
"""mbk where Python ends, copies, or runs elsewhere: daemon threads, pickles, other processes, sub-interpreters."""

import copy
import multiprocessing
import os
import pickle
import subprocess
import sys
import tempfile
import unittest

import mbk

SETUP = """
import threading, time, numpy as np, mbk
t = np.arange(60000) / 1000
recording = mbk.Recording(time=t, x=0.01 * np.sin(6 * t) + 0.003 * np.sin(23 * t), F=-np.cos(6 * t) - np.cos(23 * t))
"""


def python(code):
    return subprocess.run([sys.executable, "-c", SETUP + code], capture_output=True, text=True, timeout=120, check=False)



class Processes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.file = os.path.join(folder.name, "log.h5")
        subprocess.run([os.environ["MBK"], "simulate", "relaxed_sinusoidal", "--quiet", "--out", cls.file], check=True)
        cls.read = mbk.read(cls.file)
        cls.result = mbk.measure(cls.read)

    def test_daemon_threads_do_not_abort_the_end(self):
        for k in range(5):
            ran = python("""
def work():
    while True:
        try:
            mbk.measure(recording)
        except mbk.Error:
            pass
for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
time.sleep(%f)
""" % (0.2 + 0.13 * k))
            self.assertEqual(ran.returncode, 0, ran)
            self.assertNotIn("terminate", ran.stderr)
            self.assertNotIn("FATAL", ran.stderr)

    def test_a_recording_and_a_result_can_be_pickled(self):
        given = mbk.Recording(x=[1.0, 2.0, 3.0], F=[0.0, 1.0, 0.0], rate_hz=100, units={"x": "mm"}, metadata={"a": "b"},
                              events=[(0.01, "push", 2.0)])
        for one in (given, self.read):
            again = pickle.loads(pickle.dumps(one))
            self.assertEqual((again.signals, again.metadata, again.events, again.rate_hz),
                             (one.signals, one.metadata, one.events, one.rate_hz))
            for name in one.signals:
                self.assertEqual(again._core.channel(name).tobytes(), one._core.channel(name).tobytes(), name)
        again = mbk.measure(pickle.loads(pickle.dumps(self.read)))
        self.assertEqual(again.model.K.tolist(), self.result.model.K.tolist())
        self.assertEqual(pickle.loads(pickle.dumps(self.result)), self.result)

    def test_copies_are_the_same(self):
        self.assertIs(copy.deepcopy(self.read), self.read)
        self.assertIs(copy.copy(self.read), self.read)
        self.assertEqual(copy.deepcopy(self.result), self.result)
        self.assertEqual(copy.deepcopy({"a": [self.result]})["a"][0].model.K.tolist(), self.result.model.K.tolist())

    def test_other_processes_measure(self):
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            for found in pool.map(mbk.measure, [self.read, self.read]):
                self.assertEqual(found.model.K.tolist(), self.result.model.K.tolist())

    def test_a_sub_interpreter_is_refused(self):
        try:
            import _xxsubinterpreters  # noqa: F401
        except ImportError:
            self.skipTest("this Python has no module for sub-interpreters")
        for first in ("", "import numpy"):
            ran = subprocess.run([sys.executable, "-c", f"""
{first}
import _xxsubinterpreters as other
there = other.create()
try:
    other.run_string(there, 'import mbk')
except other.RunFailedError as error:
    print(error)
"""], capture_output=True, text=True, timeout=60, check=False)
            self.assertIn("interpreter", ran.stdout + ran.stderr)


if __name__ == "__main__":
    unittest.main()
