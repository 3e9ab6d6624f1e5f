#!/usr/bin/env python3
"""The module _mbk on libmbk.so: what it gives is what the program gives, to the bit; arrays without a copy; whatever is thrown at it."""

import gc
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy

import _mbk

MBK = os.environ["MBK"]
ROOT = pathlib.Path(__file__).resolve().parents[2]


def program(*arguments, folder):
    """What the program prints, and its exit code."""
    done = subprocess.run([MBK, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False)
    return done.stdout, done.returncode


def resident_kb():
    for line in pathlib.Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise AssertionError("no VmRSS")


class ModuleTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.before = os.getcwd()
        os.chdir(cls.folder)
        for scenario, name in (("relaxed_sinusoidal", "log.mat"), ("free_motion", "free.h5")):
            assert program("simulate", scenario, "--out", name, folder=cls.folder)[1] == 0
        assert program("simulate", "rig_table_5_1", "--trial", "K1_M1", "--out", "rig.h5", folder=cls.folder)[1] == 0
        out = program("measure", "log.mat", "--json", folder=cls.folder)[0]
        (cls.folder / "result.json").write_text(out)
        cls.recording = _mbk.read_all(["log.mat"])[0]
        cls.arrays = {name: cls.recording.channel(name) for name, _ in cls.recording.signals}

    @classmethod
    def tearDownClass(cls):
        os.chdir(cls.before)
        cls.temporary.cleanup()

    def assert_error(self, work, *words, code=None):
        with self.assertRaises(_mbk.Error) as caught:
            work()
        for word in words:
            self.assertIn(word, str(caught.exception))
        if code is not None:
            self.assertEqual(caught.exception.exit_code, code)
        return caught.exception

    # ---- the same as the program ----

    def test_every_command_answers_as_the_program(self):
        examples = [
            ("measure", {}, ["log.mat"]),
            ("measure", {"mode": "reference", "procedure": "chapter5"}, ["log.mat"]),
            ("measure", {"sg_window": 151, "cutoff": 4.5, "ignore_range": ["stiffness", "motion"]}, ["log.mat"]),
            ("measure", {}, ["log.mat", "log.mat"]),
            ("measure", {"domain": "joint", "arm": "0.30,-0.57,0.31,0.34"}, ["log.mat"]),
            ("identify", {"to": 30.0}, ["log.mat"]),
            ("passivity", {"band": "0.5:3"}, ["log.mat"]),
            ("passivity", {}, ["result.json"]),
            ("compare", {}, ["result.json", "result.json"]),
            ("ellipse", {}, ["result.json"]),
            ("info", {}, ["log.mat"]),
            ("explore", {}, ["log.mat"]),
            ("tf", {"input": "reference_x", "output": "hand_x", "poles": 2, "zeros": 1}, ["log.mat"]),
            ("robot identify", {}, ["free.h5"]),
            ("robot workspace", {"at": "300,-200"}, []),
            ("springs field", {"trial": "config_1"}, [str(ROOT / "examples/scenarios/rig_springs_table_3_1.toml")]),
            ("teleop", {}, [str(ROOT / "examples/teleop/telerehabilitation.toml")]),
            ("teleop", {"operator": "result.json"}, [str(ROOT / "examples/teleop/telerehabilitation.toml")]),
            ("validate", {"runs": 2, "seed": 3}, ["frequency-response"]),
        ]
        for command, options, words in examples:
            with self.subTest(command=command, options=options):
                typed = command.split() + ["--json"]
                for name, value in options.items():
                    name = "--" + name.replace("_", "-")
                    for one in value if isinstance(value, list) else [value]:
                        typed += [name] if one is True else [f"{name}={one}"]
                expected, code = program(*typed, "--", *words, folder=self.folder)
                try:
                    answer = _mbk.call(command, options, [], words)
                except _mbk.Error as error:
                    self.assertEqual(expected, "", f"{command}: {error}")
                    self.fail(f"{command}: {error}")
                self.assertTrue(answer.json)
                self.assertEqual(answer.json, expected)
                self.assertEqual(answer.exit_code, code)

    def test_text_and_commands_without_json(self):
        expected, _ = program("measure", "log.mat", folder=self.folder)
        answer = _mbk.call("measure", {"json": False}, [], ["log.mat"])
        self.assertEqual(answer.text, expected)
        self.assertEqual(answer.json, "")
        answer = _mbk.call("convert", {}, [self.recording], ["copy.h5"])
        for fact in ("copy.h5", "HDF5"):
            self.assertIn(fact, answer.text)
        again = _mbk.read_all(["copy.h5"])[0]
        self.assertTrue(numpy.array_equal(again.channel("force_y"), self.arrays["force_y"]))
        answer = _mbk.call("simulate", {"out": "s.mat", "seed": 4}, [], ["relaxed_underdamped"])
        self.assertIn("s.mat", answer.text)

    def test_a_study(self):
        _mbk.call("study init", {"title": "Arms"}, [], ["arms"])
        options = {"study": "arms", "participant": 7, "session": 1, "condition": "relaxed", "strip": True}
        _mbk.call("study add", options, [], ["log.mat"])
        _mbk.call("study measure", {"study": "arms"})
        listed = _mbk.call("study list", {"study": "arms"})
        self.assertEqual(listed.json, program("study", "list", "--study", "arms", "--json", folder=self.folder)[0])

    def test_a_recording_is_as_good_as_its_file(self):
        document = (self.folder / "result.json").read_text()
        self.assertEqual(_mbk.call("measure", {}, [self.recording]).json, document)
        made = _mbk.Recording(self.arrays, metadata=self.recording.metadata, events=self.recording.events)
        of_arrays = json.loads(_mbk.call("measure", {}, [made]).json)
        of_file = json.loads(document)
        (source,) = of_arrays["inputs"]
        self.assertEqual((source["file"], source["format"]), ("<recording 1>", "arrays in memory"))
        self.assertEqual(source["duration_s"], of_file["inputs"][0]["duration_s"])
        for one in (of_arrays, of_file):
            for key in ("inputs", "notes"):
                one.pop(key, None)
        self.assertEqual(of_arrays, of_file)

    def test_results_in_memory_stand_for_files(self):
        document = (self.folder / "result.json").read_text()
        design = str(ROOT / "examples/teleop/telerehabilitation.toml")
        of_memory = _mbk.call("teleop", {"operator": _mbk.document_word(0)}, [], [design], [document]).json
        of_file = _mbk.call("teleop", {"operator": "result.json"}, [], [design]).json
        self.assertEqual(of_memory.replace("<result 1>.json", "result.json"), of_file)
        both = _mbk.call("compare", {}, [self.recording], [_mbk.document_word(0), _mbk.recording_word(0)], [document])
        self.assertEqual(json.loads(both.json)["schema"], "mbk.compare/1")

    def test_warnings_have_codes_and_failures_beside_answers_are_errors(self):
        answer = _mbk.call("measure", {}, [], ["log.mat", "none.mat"])
        self.assertEqual(answer.exit_code, 3)
        self.assertEqual([error.file for error in answer.errors], ["none.mat"])
        self.assertEqual(json.loads(answer.json)["schema"], "mbk.results/1")
        random = numpy.random.default_rng(1)
        noise = dict(self.arrays, force_x=random.normal(size=self.recording.samples))
        poor = _mbk.call("measure", {}, [_mbk.Recording(noise)])
        codes = {warning["code"] for warning in json.loads(poor.json)["warnings"]}
        self.assertTrue(codes)
        self.assertLessEqual(codes, {code for code, _ in poor.warnings})

    def test_the_table_of_options(self):
        self.assertEqual(_mbk.describe(), subprocess.run([MBK, "manual", "--json"], check=True, capture_output=True,
                                                         text=True).stdout)
        commands = {" ".join(one["path"]): one for one in json.loads(_mbk.describe())["commands"]}
        self.assertTrue(commands["study measure"]["callable"])
        self.assertFalse(commands["study"]["callable"] or commands["run"]["callable"])
        for name, one in commands.items():
            if not one["callable"]:
                with self.assertRaises(_mbk.Error, msg=name) as caught:
                    _mbk.call(name)
                self.assertIn(f"'{name}'", caught.exception.what)
        cutoff = next(one for one in commands["measure"]["options"] if "--cutoff" in one["names"])
        self.assertEqual(cutoff["value"], "HZ|none")
        self.assertEqual(cutoff["words"], ["none"])

    # ---- arrays ----

    def test_arrays_are_not_copied(self):
        x = numpy.sin(numpy.arange(62_000) / 50.0)
        recording = _mbk.Recording({"x": x, "F": numpy.cos(x)}, rate_hz=1000.0)
        there = recording.channel("x")
        self.assertEqual(there.ctypes.data, x.ctypes.data)
        self.assertEqual(recording.channel("position").ctypes.data, x.ctypes.data)
        self.assertFalse(there.flags.writeable)
        del recording, x
        gc.collect()
        self.assertAlmostEqual(there[50], numpy.sin(1.0))  # kept alive by whoever looks at it
        of_file = self.recording.channel("hand_x")
        self.assertEqual(of_file.ctypes.data, self.recording.channel("hand_x").ctypes.data)
        held = _mbk.Recording({"time": self.recording.channel("time"), "x": of_file, "F": of_file})
        self.assertEqual(held.channel("x").ctypes.data, of_file.ctypes.data)

    def test_other_arrays_give_the_same_answer(self):
        count = 8000
        plain = {name: self.arrays[name][:count] for name in ("time", "hand_x", "force_x")}
        plain["x"], plain["F"] = plain.pop("hand_x"), plain.pop("force_x")
        expected = _mbk.call("identify", {}, [_mbk.Recording(plain)]).json
        frozen = plain["x"].copy()
        frozen.setflags(write=False)
        unaligned = numpy.frombuffer(b"\0" + plain["x"].tobytes(), dtype=numpy.uint8)[1:].view("<f8")
        forms = {
            "strided": numpy.repeat(plain["x"], 2)[::2],
            "column": numpy.column_stack([plain["x"], plain["F"]])[:, 0],
            "backward": plain["x"][::-1].copy()[::-1],
            "big-endian": plain["x"].astype(">f8"),
            "unaligned": unaligned,
            "read-only": frozen,
            "masked": numpy.ma.array(plain["x"]),
            "list": list(plain["x"]),
            "wider": plain["x"].astype(numpy.longdouble),
        }
        for name, form in forms.items():
            with self.subTest(name):
                made = _mbk.Recording(dict(plain, x=form))
                self.assertEqual(_mbk.call("identify", {}, [made]).json, expected)
        whole = _mbk.Recording(dict(plain, x=numpy.arange(count, dtype=numpy.int16)))
        self.assertEqual(list(whole.channel("x")[:3]), [0.0, 1.0, 2.0])
        single = _mbk.Recording(dict(plain, x=plain["x"].astype(numpy.float32)))
        self.assertTrue(numpy.array_equal(single.channel("x"), plain["x"].astype(numpy.float32)))
        hidden = numpy.ma.array(plain["x"], mask=numpy.arange(count) == 5)
        self.assertTrue(numpy.isnan(_mbk.Recording(dict(plain, x=hidden)).channel("x")[5]))

    def test_whole_numbers_above_2_53(self):
        """Clocks in nanoseconds since 1970: what doubles leave of them is not lost."""
        for kind in (numpy.int64, numpy.uint64):
            clock = numpy.arange(1000, dtype=kind) * kind(1_000_001) + kind(1_700_000_000_123_456_789)
            x = numpy.sin(numpy.arange(1000) / 50.0)
            made = _mbk.Recording({"time": clock, "x": x, "F": x}, units={"time": "ns"})
            _mbk.call("convert", {"overwrite": True}, [made], ["whole.h5"])
            time = _mbk.read_all(["whole.h5"])[0].channel("time")
            self.assertTrue(numpy.allclose(time - time[0], numpy.arange(1000) * 1.000001e-3, rtol=0, atol=1e-12))
        for value in (2**63 - 1, -2**63, 2**53 + 1, -(2**53) - 1, 0):
            ints = numpy.array([value, 1, -1], dtype=numpy.int64)
            rests = _mbk._rests(ints, ints.astype(numpy.float64))
            self.assertEqual(0 if rests is None else rests[0], value - int(float(value)))
        ints = numpy.array([[2**64 - 1, 2**63 + 1, 2**53 + 1], [1, 2, 3]], dtype=numpy.uint64)
        expected = [int(one) - int(float(int(one))) for one in ints.ravel(order="F")]
        self.assertEqual(list(_mbk._rests(ints, ints.astype(numpy.float64))), expected)

    def test_units_names_and_maps(self):
        x, force, time = (self.arrays[name] for name in ("hand_x", "force_x", "time"))
        expected = _mbk.call("identify", {}, [_mbk.Recording({"time": time, "x": x, "F": force})]).json
        named = _mbk.Recording({"clock": time, "angle of knee": x, "load": force})
        answer = _mbk.call("identify", {"channels": "time=clock,x=angle of knee,F=load", "axes": 1}, [named])
        self.assertEqual(json.loads(answer.json)["model"], json.loads(expected)["model"])
        millimetres = _mbk.Recording({"time": time, "x": x, "F": force}, units={"x": "mm"})
        self.assertEqual([c for c in millimetres.channels if c[0] == "position"], [("position", "m", "")])
        factor = json.loads(_mbk.call("identify", {}, [millimetres]).json)["model"]["K"][0][0]
        self.assertAlmostEqual(factor / json.loads(expected)["model"]["K"][0][0], 1000.0, places=3)

    def test_a_matrix_of_signals(self):
        logs = numpy.full((19, self.recording.samples), numpy.nan)
        rows = {0: "time", 1: "hand_x", 2: "hand_y", 9: "force_x", 10: "force_y", 11: "reference_x", 12: "reference_y"}
        for row, name in rows.items():
            logs[row] = self.arrays[name]
        made = _mbk.Recording({"logs": logs}, metadata=self.recording.metadata)
        options = {"acceleration": "derivative"}
        of_logs = json.loads(_mbk.call("identify", options, [made]).json)["model"]
        self.assertEqual(of_logs, json.loads(_mbk.call("identify", options, [], ["log.mat"]).json)["model"])
        same = _mbk.Recording({"logs": numpy.asfortranarray(logs)}, metadata=self.recording.metadata)
        self.assertEqual(json.loads(_mbk.call("identify", options, [same]).json)["model"], of_logs)

    def test_what_is_no_recording_is_one_clear_error(self):
        t = numpy.arange(1000) / 1000.0
        x = numpy.sin(t)
        good = {"time": t, "x": x, "F": x}
        self.assert_error(lambda: _mbk.Recording({}), "no signal", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=x[:-1])), "'x'", "999", "1000", code=3)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=x[:0])), "'x' is empty", code=3)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=x + 1j)), "'x'", "complex", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=["a"] * 1000)), "'x'", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=numpy.array([object()] * 1000))), "'x'", "object", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=t.astype("datetime64[s]"))), "'x'", "datetime", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=1.0)), "'x'", "0 dimensions", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=numpy.zeros((2, 2, 2)))), "3 dimensions", code=2)
        self.assert_error(lambda: _mbk.Recording(dict(good, x=[[1.0], [1.0, 2.0]])), "'x'", code=2)
        self.assert_error(lambda: _mbk.Recording(good, rate_hz=-5.0), "-5", code=2)
        self.assert_error(lambda: _mbk.Recording(good, units={"y": "mm"}), "'y'", code=2)
        self.assert_error(lambda: _mbk.Recording({"": t}), "name", code=2)
        self.assert_error(lambda: _mbk.call("measure", {}, [_mbk.Recording({"x": x, "F": x})]), "<recording 1>", "rate")
        self.assert_error(lambda: _mbk.call("measure", {}, [_mbk.Recording({"u": x, "v": x})]), "channel")
        for bad in (numpy.nan, numpy.inf):
            broken = x.copy()
            broken[500] = bad
            with self.subTest(bad):
                self.assert_error(lambda: _mbk.call("measure", {}, [_mbk.Recording(dict(good, x=broken))]), "position")
        self.assert_error(lambda: _mbk.call("measure", {}, [_mbk.Recording(dict(good, time=t[::-1]))]), "<recording 1>")
        with self.assertRaises(KeyError):
            _mbk.Recording(good).channel("Fx")
        with self.assertRaises(TypeError):
            _mbk.Recording([x])

    def test_wrong_calls(self):
        self.assert_error(lambda: _mbk.call("measure", {"cutof": 5}, [], ["log.mat"]), "cutof", "cutoff", code=2)
        self.assert_error(lambda: _mbk.call("measure", {"cutoff": "high"}, [], ["log.mat"]), "cutoff: ", code=2)
        self.assert_error(lambda: _mbk.call("measure", {"help": True}, [], ["log.mat"]), code=2)
        self.assert_error(lambda: _mbk.call("measure", {"--cutoff": 5}, [], ["log.mat"]), code=2)
        self.assert_error(lambda: _mbk.call("measure"), "FILE", code=2)
        self.assert_error(lambda: _mbk.call("measure", {}, [], ["none.mat"]), "none.mat: ", code=3)
        self.assert_error(lambda: _mbk.call("measure", {"trial": "3"}, [self.recording]), "trial=…", code=2)
        self.assert_error(lambda: _mbk.call("measure", {"parts": True}, [self.recording]), "parts=True", code=2)
        for command in ("", "run", "measures", "robot", "manual", "measure --json", "robot identify x"):
            self.assert_error(lambda name=command: _mbk.call(name, {}, [], ["log.mat"]), "command", code=2)
        self.assert_error(lambda: _mbk.call("measure", {}, [], ["log.mat\0.txt"]), "byte", code=2)
        self.assert_error(lambda: _mbk.call("measure", {"": 1}, [], ["log.mat"]), "option", code=2)
        x = numpy.zeros(3)
        self.assert_error(lambda: _mbk.Recording({"x\0y": x}), "byte", code=2)
        self.assert_error(lambda: _mbk.Recording({"x": x}, metadata={"a": "b\0c"}), "byte", code=2)
        self.assert_error(lambda: _mbk.read_all(["log.mat"], {"cutoff": 5}), "cutoff", code=2)
        os.link("log.mat", b"\xff.mat")
        self.assertTrue(_mbk.call("info", {"json": False}, [], [b"\xff.mat"]).exit_code == 0)
        self.assertEqual(_mbk.read_all([os.fsdecode(b"\xff.mat")])[0].samples, self.recording.samples)
        error = self.assert_error(lambda: _mbk.call("measure", {}, [], ["-none.mat"]), "-none.mat", code=3)
        self.assertEqual(error.file, "-none.mat")
        self.assertTrue(error.what)
        self.assertTrue(error.hint)
        self.assertIsInstance(error, ValueError)

    # ---- the process ----

    def test_a_library_that_is_missing_or_too_old_is_one_clear_error(self):
        source = pathlib.Path(_mbk.__file__)
        for name, library in (("missing", None), ("broken", b"no library"), ("old", "old")):
            folder = self.folder / name
            folder.mkdir()
            (folder / "_mbk.py").write_bytes(source.read_bytes())
            if library == "old":
                if shutil.which("cc") is None:
                    continue
                subprocess.run(["cc", "-shared", "-x", "c", "-", "-o", folder / "libmbk.so.1"], check=True,
                               input=b"int mbk_api_version(void) { return 1; }")
            elif library is not None:
                (folder / "libmbk.so.1").write_bytes(library)
            done = subprocess.run([sys.executable, "-B", "-c", "import _mbk"], capture_output=True, text=True, check=False,
                                  env={**os.environ, "PYTHONPATH": str(folder), "LD_LIBRARY_PATH": ""})
            last = done.stderr.splitlines()[-1]
            if name == "missing" and done.returncode == 0:
                continue  # the system has one
            self.assertRegex(last, r"\AImportError: .*libmbk\.so\.1.*; install ")

    def test_nothing_is_printed(self):
        code = ("import _mbk, os\n"
                "_mbk.call('measure', {}, [], ['log.mat'])\n"
                "_mbk.call('validate', {'runs': 2}, [], ['reliability'])\n"
                "try:\n    _mbk.call('measure', {}, [], ['none.mat'])\nexcept _mbk.Error:\n    pass\n")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, cwd=self.folder)
        self.assertEqual((done.stdout, done.stderr), (b"", b""))

    def test_threads(self):
        expected = (self.folder / "result.json").read_text()
        failures = []

        def work(k):
            for _ in range(3):
                if _mbk.call("measure", {}, [self.recording]).json != expected:
                    failures.append("another answer")
                made = _mbk.Recording({"time": self.arrays["time"], "x": self.arrays["hand_x"] * (k + 1),
                                       "F": self.arrays["force_x"]})
                _mbk.call("info", {}, [made])
                try:
                    _mbk.call("measure", {"cutoff": k + 1000.0}, [self.recording])
                    failures.append("no error")
                except _mbk.Error as error:
                    if str(k + 1000) not in str(error):
                        failures.append(str(error))

        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])

    def test_the_interpreter_goes_on_meanwhile(self):
        seen = []
        thread = threading.Thread(target=lambda: _mbk.call("measure", {"threads": 1}, [self.recording] * 5))
        thread.start()
        while thread.is_alive():
            seen.append(time.monotonic())
            time.sleep(0.001)
        thread.join()
        self.assertGreater(len(seen), 5)

    def test_ctrl_c_and_progress(self):
        steps = []
        _mbk.call("measure", {}, [self.recording] * 4, progress=lambda what, done: steps.append((what, done)))
        self.assertEqual(len(steps), 4)
        self.assertEqual(steps[-1][1], 1.0)
        self.assertEqual([done for _, done in steps], sorted(done for _, done in steps))

        def slow(_what, _done):
            time.sleep(0.06)  # longer than the pause between two questions whether to stop
        self.assertEqual(_mbk.call("measure", {}, [self.recording] * 3, progress=slow).exit_code, 0)

        def ends(_what, _done):
            raise LookupError("enough")
        with self.assertRaisesRegex(LookupError, "enough"):
            _mbk.call("measure", {}, [self.recording] * 100, progress=ends)

        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            _mbk.call("validate", {"runs": 100_000, "threads": 1}, [], ["coverage"])
        self.assertLess(time.monotonic() - begin, 30.0)
        self.assertEqual(_mbk.call("info", {}, [self.recording]).exit_code, 0)  # and it goes on

    def test_calls_leak_nothing(self):
        t = numpy.arange(300) / 1000.0
        made = {"time": t, "x": numpy.sin(20 * t), "F": numpy.cos(20 * t)}

        def calls(count):
            for k in range(count):
                recording = _mbk.Recording(made)
                recording.channel("x")
                _mbk.call("info", {}, [recording])
                try:
                    _mbk.call("info", {"axes": 3 + k}, [recording])
                except _mbk.Error:
                    pass

        calls(1500)
        gc.collect()
        references, before = sys.getrefcount(t), resident_kb()
        calls(10_000)
        gc.collect()
        self.assertEqual(sys.getrefcount(t), references)
        self.assertLess(resident_kb() - before, 1024)

    def test_a_call_costs_little(self):
        t = numpy.arange(300) / 1000.0
        recording = _mbk.Recording({"time": t, "x": numpy.sin(20 * t), "F": numpy.cos(20 * t)})

        def shortest(work):
            best = float("inf")
            for _ in range(2000):
                begin = time.perf_counter()
                work()
                best = min(best, time.perf_counter() - begin)
            return best

        whole = shortest(lambda: _mbk.call("info", {}, [recording]))  # with its work, and the document of 300 samples
        self.assertLess(whole, 100e-6, "far more than the 20 µs that a quiet machine shows")


if __name__ == "__main__":
    unittest.main()
