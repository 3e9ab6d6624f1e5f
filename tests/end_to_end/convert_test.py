#!/usr/bin/env python3
"""mbk convert: the same recording in every format, as mbk and as programs of others read it."""

import math
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import unittest

import mat_file
from command import BAD_DATA, FINE, WRONG_USAGE, Case, copy, is_root, main, make_log, program, run, table_of, write_csv

try:
    import h5py
    import numpy
except ImportError:
    h5py = numpy = None
try:
    import scipy.io
except ImportError:
    scipy = None

FILES = {"v5": ("log5.mat",), "v7.3": ("log73.mat", "--format", "mat73"), "HDF5": ("log.h5",), "CSV": ("log.csv",)}
ROWS = {"time": 0, "hand_x": 1, "hand_y": 2, "force_x": 9, "force_y": 10, "reference_x": 11, "acceleration_x": 17}


def simulated(folder):
    """A short trial with metadata."""
    path = folder / "trial.mat"
    ran = run("simulate", "relaxed_sinusoidal", "--out", path)
    assert ran.code == FINE, ran
    return path


class Convert(Case):
    def convert(self, source, *target):
        ran = self.mbk("convert", source, *target, folder=self.folder)
        self.assertRegex(ran.out, rf"\A{target[0]}: [^\n]+\n\Z")
        return self.folder / target[0]

    def info(self, path):
        """Everything reported of a recording except its origin."""
        said = self.fine("info", "--json", path).json
        said = said["recordings"][0] if "recordings" in said else said
        for key in ("inputs", "notes"):
            said.pop(key, None)
        said["channels"] = sorted(said["channels"], key=lambda channel: channel["name"])
        return said

    def test_every_format_holds_the_same_recording(self):
        source = simulated(self.folder)
        for target in FILES.values():
            with self.subTest(target[0]):
                self.assertEqual(self.info(self.convert(source, *target)), self.info(source))

    def test_a_fit_does_not_see_the_format(self):
        for log in (make_log(), make_log("sinusoidal", "--one-axis")):
            model = None
            for target in (*FILES.values(), ("back.mat",)):
                path = self.convert(log.path if model is None else path, *target, "--overwrite")
                result = self.fine("measure", "--json", "--quiet", path).json
                for key in ("inputs", "notes"):
                    result.pop(key, None)
                model = model or result
                self.assertEqual(result, model, target)

    def test_through_every_format_and_back_the_file_is_the_same(self):
        source = path = simulated(self.folder)
        for target in FILES.values():
            path = self.convert(path, *target)
        self.assertEqual(self.convert(path, "back.mat").read_bytes(), source.read_bytes())

    def test_equal_recordings_are_equal_files(self):
        for target in FILES.values():
            first = self.convert(make_log().path, *target).read_bytes()
            self.assertEqual(self.convert(make_log().path, *target, "--overwrite").read_bytes(), first)

    def test_the_bytes_do_not_depend_on_what_was_converted(self):
        columns = dict(zip(("time", "Fy", "y", "x", "Fx"), [[0, 0.5, 1], [5, 6, 7], [3, 4, 5], [1, 2, 3], [4, 5, 6]]))
        one_axis = dict(zip(("F", "time", "x_rad"), [[5, 6, 7], [0, 0.5, 1], [3, 4, 5]]))
        for k, table in enumerate((columns, one_axis)):
            source = write_csv(self.folder / f"source{k}.csv", table.values(), table)
            for end in (".csv", ".mat", ".h5"):
                direct = self.convert(source, f"direct{k}{end}").read_bytes()
                for between in (".csv", ".mat", ".h5"):
                    name = f"by{between[1:]}{k}"
                    path = self.convert(self.convert(source, f"{name}_1{between}", "--overwrite"), f"{name}_2{end}")
                    self.assertEqual(path.read_bytes(), direct, (between, end))

    @unittest.skipIf(h5py is None, "h5py is not there")
    def test_lines_of_metadata_become_one_and_that_is_said(self):
        with h5py.File(self.folder / "log.h5", "w") as file:
            file["time"], file["hand_x"], file.attrs["remark"] = [0.0, 0.1], [1.0, 2.0], "one\ntwo"
        ran = self.mbk("convert", self.folder / "log.h5", self.folder / "log.csv")
        self.assertIn("'remark'", ran.err)
        self.assertIn("# remark: one; two\n", (self.folder / "log.csv").read_text())

    def test_units_and_signs_are_put_right_on_the_way(self):
        columns = [[0, 1, 2], [10, 20, 30], [1.5, 2.5, -3.5]]
        source = write_csv(self.folder / "raw.csv", columns, ("clock", "pos", "torque"))
        self.mbk("convert", source, self.folder / "si.csv", "--channels", "time=clock:ms,x=pos:deg,F=-torque:Nm",
                 "--axes", "1")
        lines = (self.folder / "si.csv").read_text().splitlines()[-4:]
        self.assertEqual(lines[0], "time_s,position_rad,reaction_N.m")
        self.assertEqual([float(cell) for cell in lines[1].split(",")], [0.0, 10 * math.pi / 180, -1.5])

    def test_parts_become_one_file(self):
        columns = table_of(make_log())
        parts = [write_csv(self.folder / f"log_{k}.csv", [column[a:b] for column in columns])
                 for k, (a, b) in enumerate(((0, 20000), (20000, 40000), (40000, None)), 1)]
        whole = write_csv(self.folder / "whole.csv", columns)
        self.mbk("convert", "--parts", *parts, self.folder / "joined.mat")
        self.convert(whole, "whole.mat")
        self.assertEqual((self.folder / "joined.mat").read_bytes(), (self.folder / "whole.mat").read_bytes())

    def test_what_is_left_aside_is_said(self):
        path = copy(make_log().path, self.folder / "log.mat")
        ran = self.mbk("convert", path, self.folder / "log.h5")
        self.assertIn("4, 5, 8, 9, 16", ran.err)
        self.assertEqual(self.fine("convert", path, self.folder / "quiet.h5", "--quiet").out, "")

    def test_simulate_and_make_log_write_every_format_too(self):
        for name in ("a.h5", "a.csv", "a.mat"):
            self.fine("simulate", "relaxed_sinusoidal", "--quiet", "--out", self.folder / name)
            self.assertEqual(self.info(self.folder / name), self.info(self.folder / "a.h5"))
            subprocess.run([program("MAKE_LOG"), "--protocol", "underdamped", "--out", self.folder / f"log_{name}"],
                           check=True, capture_output=True)
            self.assertEqual(self.info(self.folder / f"log_{name}"), self.info(self.folder / "log_a.h5"))


class Unrecognised(Case):
    """Files whose channels are not recognised go over as they stand."""

    def test_every_array_under_its_own_name_and_unit(self):
        names = ("clock [ms]", "gaze_left [deg]", "pupil")
        columns = [[0, 1, 2], [10.5, 20.25, 0.1], [3, 4, 5]]
        source = write_csv(self.folder / "gaze.csv", columns, names)
        for end in ("h5", "mat", "csv"):
            target = self.folder / f"out.{end}"
            ran = self.mbk("convert", source, target)
            self.assertRegex(ran.out, rf"\A{target}: [^\n]*\b3 arrays\b[^\n]*\n\Z")
            self.assertIn(f"mbk: {source}: ", ran.err)
            listed = self.fine("info", target)
            for values in ("0.1", "20.25"):
                self.assertIn(values, listed.out)
        back = (self.folder / "out.csv").read_text().splitlines()
        self.assertEqual(back[-4:], [",".join(names), "0,10.5,3", "1,20.25,4", "2,0.1,5"])
        renamed = self.mbk("convert", source, self.folder / "again.mat").err
        for name in ("'gaze_left [deg]'", "'gaze_left__deg_'"):
            self.assertIn(name, renamed)

    @unittest.skipIf(h5py is None or scipy is None, "h5py or SciPy is not there")
    def test_others_find_the_arrays(self):
        with h5py.File(self.folder / "in.h5", "w") as file:
            file["trial/gaze"] = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
            file["trial/gaze"].attrs["unit"] = "deg"
            file["trial/lamp"] = [1, 0]
            file.attrs["participant"] = "7"
        self.mbk("convert", self.folder / "in.h5", self.folder / "out.mat", "--quiet")
        variables = scipy.io.loadmat(self.folder / "out.mat", squeeze_me=True)
        self.assertEqual(variables["trial_gaze"].tolist(), [[1, 2], [3, 4], [5, 6]])
        self.assertEqual(variables["units"]["trial_gaze"], "deg")
        self.assertEqual(variables["metadata"]["participant"], "7")
        self.mbk("convert", self.folder / "in.h5", self.folder / "out.h5")
        with h5py.File(self.folder / "out.h5") as file:
            self.assertEqual(file["trial/gaze"][:].tolist(), [[1, 2], [3, 4], [5, 6]])
            self.assertEqual(file["trial/gaze"].attrs["unit"], "deg")
            self.assertEqual(file.attrs["participant"], "7")
        self.refused(BAD_DATA, "convert", self.folder / "in.h5", self.folder / "out.csv",
                     says=["'trial/gaze'", "3 samples", "'trial/lamp'", ".mat"])
        self.assertEqual(self.names(), ["in.h5", "out.h5", "out.mat"])

    def test_what_is_wrong_with_a_map_or_a_channel_is_still_an_error(self):
        source = write_csv(self.folder / "gaze.csv", [[0, 1], [1, 2]], ("clock", "gaze"))
        self.refused(BAD_DATA, "convert", source, self.folder / "out.h5", "--channels", "x=none", says="'none'")
        source = write_csv(self.folder / "no_time.csv", [[0, 1], [1, 2]], ("x", "Fx"))
        self.refused(BAD_DATA, "convert", source, self.folder / "out.h5", says="--rate")
        self.assertEqual(self.names(), ["gaze.csv", "no_time.csv"])

    def test_a_place_for_trials_where_there_are_none(self):
        self.refused(WRONG_USAGE, "convert", make_log().path, self.folder / "out_{trial}.h5",
                     says="{trial}")


class Refusals(Case):
    def test_wrong_usage(self):
        log = copy(make_log().path, self.folder / "log.mat")
        there = self.file("there.h5", "precious")
        for arguments, says in (
                ((log,), "mbk convert IN OUT"),
                ((log, log, self.folder / "out.h5"), ["2 input files", "--parts"]),
                ((log, log), str(log)),
                ((log, log, "--overwrite"), str(log)),
                ((log, there), "--overwrite"),
                ((log, self.folder / "out.xls"), ["'.xls'", ".h5", ".csv", ".c3d"]),
                ((log, self.folder / "out"), "format"),
                ((log, self.folder / "out.mat", "--format", "mat4"), ["'mat4'", "mat73"])):
            with self.subTest(arguments[1:]):
                self.refused(WRONG_USAGE, "convert", *arguments, says=says)
        self.assertEqual(there.read_text(), "precious")
        self.assertEqual(self.names(), ["log.mat", "there.h5"])

    def test_a_file_that_is_no_recording(self):
        self.refused(BAD_DATA, "convert", self.file("log.mat", "nothing"), self.folder / "log.h5", says="log.mat")
        self.assertEqual(self.names(), ["log.mat"])

    def test_a_disk_that_is_full(self):
        def small_files_only():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

        for target in FILES.values():
            process = subprocess.run([program("MBK"), "convert", make_log().path, *target], cwd=self.folder,
                                     preexec_fn=small_files_only, capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(process.returncode, BAD_DATA, process)
            self.assertRegex(process.stderr, r"\Ambk: \S+: [^\n]+; \w[^\n]*\n\Z")
        self.assertEqual(self.names(), [])

    def test_a_folder_that_cannot_be_written(self):
        if is_root():
            raise unittest.SkipTest("root may write everywhere")
        os.chmod(self.folder, 0o500)
        self.addCleanup(os.chmod, self.folder, 0o700)
        self.refused(BAD_DATA, "convert", make_log().path, self.folder / "log.h5",
                     says=str(self.folder / "log.h5"))


class OthersRead(Case):
    """Programs that are not ours find every number where the guide says that it is."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-")
        cls.addClassCleanup(folder.cleanup)
        cls.converted = pathlib.Path(folder.name)
        cls.rows = mat_file.read(make_log().path)["logs"]
        cls.metadata = run("info", "--json", make_log().path).json["metadata"]
        for target in FILES.values():
            ran = run("convert", make_log().path, *target, folder=cls.converted)
            assert ran.code == FINE, ran

    def same(self, values, name):
        self.assertEqual([float(value) for value in values], self.rows[ROWS[name]])

    @unittest.skipIf(h5py is None, "h5py is not there")
    def test_h5py_reads_hdf5(self):
        with h5py.File(self.converted / "log.h5") as file:
            self.assertEqual(file.attrs["format"], "mbk.recording/1")
            self.assertRegex(file.attrs["software"], r"mbk \d")
            for key, value in self.metadata.items():
                self.assertEqual(file.attrs[key], value)
            self.same(file["time"], "time")
            self.assertEqual(file["time"].attrs["unit"], "s")
            for name, unit in (("hand_x", "m"), ("force_y", "N"), ("reference_x", "m"), ("acceleration_x", "m/s2")):
                channel = file["channels"][name]
                self.same(channel, name)
                self.assertEqual((channel.shape, channel.attrs["unit"], channel.attrs["frame"]),
                                 ((len(self.rows[0]),), unit, "base"))

    @unittest.skipIf(h5py is None, "h5py is not there")
    def test_h5py_reads_mat_7_3(self):
        with h5py.File(self.converted / "log73.mat") as file:
            self.assertEqual(file.userblock_size, 512)
            logs = file["logs"]
            self.assertEqual((logs.shape, logs.attrs["MATLAB_class"]), ((len(self.rows[0]), 19), b"double"))
            self.same(logs[:, 9], "force_x")
            for key, value in self.metadata.items():
                self.assertEqual("".join(map(chr, file["metadata"][key][:, 0])), value)

    @unittest.skipIf(scipy is None, "SciPy is not there")
    def test_scipy_reads_mat_5(self):
        variables = scipy.io.loadmat(self.converted / "log5.mat", squeeze_me=True)
        for name, row in ROWS.items():
            self.same(variables["logs"][row], name)
        for key, value in self.metadata.items():
            self.assertEqual(str(variables["metadata"][key]), value)

    @unittest.skipIf(numpy is None, "NumPy is not there")
    def test_numpy_reads_csv(self):
        table = numpy.genfromtxt(self.converted / "log.csv", delimiter=",", comments="#")
        self.same(table[1:, 0], "time")
        header = [line for line in (self.converted / "log.csv").read_text().splitlines()[:50] if line[0] != "#"][0]
        self.same(table[1:, header.split(",").index("force_x_N")], "force_x")

    @unittest.skipIf(shutil.which("h5dump") is None, "h5dump is not there")
    def test_h5dump_finds_nothing_wrong(self):
        for name in ("log.h5", "log73.mat"):
            process = subprocess.run(["h5dump", "--enable-error-stack", self.converted / name], capture_output=True,
                                     check=False, timeout=120)
            self.assertEqual((process.returncode, process.stderr), (0, b""))

    @unittest.skipIf(shutil.which("octave-cli") is None, "Octave is not there")
    def test_octave_reads_both_mat_files(self):  # texts of v7.3 as their codes
        for name in ("log5.mat", "log73.mat"):
            said = subprocess.run(["octave-cli", "--eval", f"a = load('{name}'); printf('%.17g %d %d\\n', a.logs(10, 7),"
                                   " size(a.logs)); printf('%s\\n', char(a.metadata.protocol))"], cwd=self.converted, capture_output=True,
                                  text=True, check=True, timeout=120).stdout.splitlines()
            self.assertEqual(said[0], f"{self.rows[9][6]:.17g} 19 {len(self.rows[0])}")
            self.assertEqual(said[1], self.metadata["protocol"])


if __name__ == "__main__":
    main()
