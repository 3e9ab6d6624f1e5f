#!/usr/bin/env python3
"""Streams that cannot be written: a session goes on, what was lost is counted, and nothing gets into another file."""

import http.client
import os
import pathlib
import re
import signal
import subprocess
import threading
import time

from command import BAD_DATA, FINE, WRONG_USAGE, Case, main, program, run

SAFETY_STOP = 5
EXPERIMENT = """
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 1
duration_s = {seconds}
moving_in_s = 0.5
[participant]
kind = "arm"
number = 1
"""


class Streams(Case):
    def command(self, *options, seconds=2):
        self.target = self.folder / "trial.h5"
        return [program("MBK"), "run", self.file("experiment.toml", EXPERIMENT.format(seconds=seconds)), "--out",
                self.target, "--no-measure", *options]

    def assert_whole(self):
        """The trial is completed, and its journal held nothing but its ticks."""
        metadata = self.mbk("info", self.target, "--json").json["metadata"]
        self.assertEqual(metadata["ended"], "completed")
        self.assertEqual(metadata.get("ticks_dropped", "0"), "0")
        self.assertFalse(pathlib.Path(f"{self.target}.journal").exists())
        return metadata

    def assert_lost(self, out, why):
        said = re.search(r"(\d+) messages [^\n:]*: (.*)", out)
        self.assertTrue(said, out)
        self.assertIn(why, said[2])
        self.assertGreaterEqual(int(said[1]), 3)  # one status line a second
        self.assertIn(said[0], self.assert_whole()["notes"])

    def test_a_full_disk_behind_standard_error(self):
        with open("/dev/full", "wb") as full:
            ran = subprocess.run(self.command(seconds=4), stdout=subprocess.PIPE, stderr=full, timeout=60, check=False)
        self.assertEqual(ran.returncode, FINE, ran)
        self.assert_lost(ran.stdout.decode(), "No space left on device")

    def test_a_reader_of_standard_error_that_goes_away(self):
        process = subprocess.Popen(self.command(seconds=4), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        process.stderr.close()
        out, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, FINE, out)
        self.assert_lost(out.decode(), "Broken pipe")

    def test_a_reader_that_does_not_read(self):
        """The pipe is full before the session begins."""
        reading, writing = os.pipe()
        os.set_blocking(writing, False)
        try:
            while os.write(writing, bytes(4096)):
                pass
        except BlockingIOError:
            pass
        os.set_blocking(writing, True)
        try:
            ran = subprocess.run(self.command(seconds=4), stdout=subprocess.PIPE, stderr=writing, timeout=60, check=False)
        finally:
            os.close(reading)
            os.close(writing)
        self.assertEqual(ran.returncode, FINE, ran)
        self.assert_lost(ran.stdout.decode(), "reader")

    def shell(self, command, redirection):
        quoted = " ".join(f"'{word}'" for word in command)
        return subprocess.run(["/bin/sh", "-c", f"{quoted} {redirection}"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=60, check=False)

    def test_standard_error_closed(self):
        ran = self.shell(self.command(seconds=4), "2>&-")
        self.assertEqual(ran.returncode, FINE, ran)
        self.assert_lost(ran.stdout.decode(), "Bad file descriptor")

    def test_every_stream_closed(self):
        ran = self.shell(self.command(), "<&- >&- 2>&-")
        self.assertEqual(ran.returncode, BAD_DATA, ran)  # what was measured could not be printed
        self.assert_whole()

    def test_standard_input_closed(self):
        ran = self.shell(self.command(), "<&-")
        self.assertEqual(ran.returncode, FINE, ran)
        self.assert_whole()

    def test_standard_output_closed(self):
        ran = self.shell(self.command(), ">&-")
        self.assertEqual(ran.returncode, BAD_DATA, ran)
        self.assertIn(b"Bad file descriptor", ran.stderr)
        self.assert_whole()

    def test_standard_output_full_or_gone(self):
        with open("/dev/full", "wb") as full:
            for options in (["--version"], ["--help"], ["simulate", "--list"]):
                ran = subprocess.run([program("MBK"), *options], stdout=full, stderr=subprocess.PIPE, timeout=60,
                                     check=False)
                self.assertEqual(ran.returncode, BAD_DATA, options)
                self.assertIn(b"No space left on device", ran.stderr)
        process = subprocess.Popen([program("MBK"), "--help"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        process.stdout.close()
        _, err = process.communicate(timeout=60)
        self.assertIn(process.returncode, (FINE, -signal.SIGPIPE))  # FINE: it was written before it was closed
        self.assertEqual(err, b"")

    def test_a_reader_that_ends_early_ends_a_command_silently(self):
        reading, writing = os.pipe()
        os.close(reading)
        try:
            ran = subprocess.run([program("MBK"), "simulate", "--list"], stdout=writing, stderr=subprocess.PIPE,
                                 timeout=60, check=False)
            self.assertEqual((ran.returncode, ran.stderr), (-signal.SIGPIPE, b""))
            ran = subprocess.run(self.command(seconds=2) + ["--quiet"], stdout=writing, stderr=subprocess.PIPE,
                                 timeout=60, check=False)
            self.assertEqual(ran.returncode, -signal.SIGPIPE, ran)
            self.assert_whole()  # of a session only the text is lost
        finally:
            os.close(writing)

    def test_errors_nobody_can_be_told_keep_their_exit_code(self):
        with open("/dev/full", "wb") as full:
            for options, code in ((["run"], WRONG_USAGE), (["info", "nothing.h5"], BAD_DATA)):
                ran = subprocess.run([program("MBK"), *options], stdout=subprocess.PIPE, stderr=full, cwd=self.folder,
                                     timeout=60, check=False)
                self.assertEqual(ran.returncode, code, options)


class Console(Case):
    """The console's thread says what it refuses."""

    def setUp(self):
        super().setUp()
        path = self.file("experiment.toml", EXPERIMENT.format(seconds=2))
        ran = run("run", path, "--dry-run", "--wait")
        self.assertEqual(ran.code, FINE, ran)
        self.path = path

    def begin(self, *options):
        self.target = self.folder / "trial.h5"
        process = subprocess.Popen([program("MBK"), "run", self.path, "--out", self.target, "--no-measure", *options],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        first = process.stderr.readline()
        if "MBK_WEB" in first or process.poll() is not None:
            self.skipTest("built without the console's page")
        return process, int(re.search(r"127\.0\.0\.1:(\d+)/", first)[1])

    def test_wrong_tokens_with_nobody_to_tell(self):
        process, port = self.begin("--console", "--quiet")
        for _ in range(2):
            process.stderr.readline()
        process.stderr.close()
        for _ in range(20):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
            connection.request("GET", "/?token=wrong")
            self.assertGreaterEqual(connection.getresponse().status, 400)
            connection.close()
        out = process.stdout.read()
        self.assertEqual(process.wait(timeout=60), FINE, out)
        self.assertRegex(out, r"\d messages [^\n]*Broken pipe")

    def test_a_signal_ends_what_waits_for_the_page(self):
        for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process, _ = self.begin("--wait")
            threading.Thread(target=process.stderr.read).start()
            time.sleep(0.3)
            process.send_signal(one)
            self.assertEqual(process.wait(timeout=20), -one)
            self.assertFalse(self.target.exists())


if __name__ == "__main__":
    main()
