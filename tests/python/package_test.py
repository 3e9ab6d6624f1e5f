#!/usr/bin/env python3
"""The package mbk as scripts use it: arrays without a copy, options of the command's table, results with units, tables
and plots, errors and warnings. What both say is compared in twins_test.py."""

import copy
import datetime
import gc
import inspect
import json
import math
import os
import pathlib
import pickle
import re
import signal
import subprocess
import tempfile
import threading
import time
import unittest
import warnings

import mbk
import numpy as np
import pandas

MBK = os.environ["MBK"]


def resident():
    """Memory of this process [bytes]."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def joint(samples=20000, seed=1):
    """A joint of 0.01 kg·m², 0.1 N·m·s/rad and 5 N·m/rad, moved by three sines: time, position, reaction."""
    t = np.arange(samples) / 1000.0
    x = sum(0.02 / (k + 1) * np.sin(2 * np.pi * f * t + k) for k, f in enumerate((0.7, 1.9, 4.3)))
    v = sum(0.02 / (k + 1) * 2 * np.pi * f * np.cos(2 * np.pi * f * t + k) for k, f in enumerate((0.7, 1.9, 4.3)))
    a = sum(-0.02 / (k + 1) * (2 * np.pi * f) ** 2 * np.sin(2 * np.pi * f * t + k) for k, f in enumerate((0.7, 1.9, 4.3)))
    noise = np.random.default_rng(seed).normal(0, 1e-3, samples)
    return t, x, -(0.01 * a + 0.1 * v + 5.0 * x) + noise


def silent(call, *arguments, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mbk.MbkWarning)
        return call(*arguments, **options)


class Package(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-python-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.log = cls.folder / "log.h5"
        cls.relaxed = mbk.simulate("relaxed_sinusoidal")
        cls.relaxed.save(cls.log)
        cls.result = mbk.measure(cls.log)

    def command(self, *words):
        return subprocess.run([MBK, *map(str, words)], cwd=self.folder, capture_output=True, text=True, check=False,
                              timeout=120)

    # ---- recordings

    def test_a_long_recording_crosses_without_a_copy_both_ways(self):
        t, x, reaction = joint(62100)
        before = resident()
        recording = mbk.Recording(time=t, x=x, F=reaction)
        self.assertEqual(recording["x"].__array_interface__["data"][0], x.__array_interface__["data"][0])
        self.assertEqual(recording.time.__array_interface__["data"][0], t.__array_interface__["data"][0])
        self.assertLess(resident() - before, 4 * x.nbytes)
        self.assertFalse(recording["x"].flags.writeable)
        again = mbk.Recording(recording)
        self.assertTrue(np.shares_memory(again["x"], x))
        # The array outlives the recording, and the recording the name of the array.
        kept = recording["x"]
        del recording, again
        gc.collect()
        self.assertEqual(kept[7], x[7])

    def test_every_kind_of_array_gives_the_right_answer(self):
        t, x, reaction = joint(6000)
        want = silent(mbk.measure, mbk.Recording(time=t, x=x, F=reaction)).model.K[0, 0]
        wide = np.zeros((6000, 3))
        wide[:, 1] = x
        backwards = x[::-1].copy()
        frozen = x.copy()
        frozen.setflags(write=False)
        swapped = x.astype(">f8")
        for name, same in (("strided", wide[:, 1]), ("backwards", backwards[::-1]), ("read-only", frozen),
                           ("other byte order", swapped), ("list", x.tolist()), ("tuple", tuple(x)),
                           ("memoryview", memoryview(x)), ("subclass", x.view(np.recarray)), ("masked", np.ma.array(x)),
                           ("Series", pandas.Series(x, index=t[::-1])), ("nullable", pandas.Series(x).astype("Float64")),
                           ("column", x[:, None]), ("row", x[None, :]), ("wider", x.astype(np.longdouble))):
            with self.subTest(name):
                got = silent(mbk.measure, mbk.Recording(time=t, x=same, F=reaction))
                self.assertEqual(got.model.K[0, 0], want)
        single = silent(mbk.measure, {"time": t, "x": x.astype(np.float32), "F": reaction})
        self.assertAlmostEqual(single.model.K[0, 0], want, delta=0.01 * abs(want))
        counts = silent(mbk.measure, {"time": t, "x": np.round(x * 1e6).astype(np.int32), "F": reaction},
                        channels={"x": "x*1e-6", "F": "F", "time": "time"})
        self.assertAlmostEqual(counts.model.K[0, 0], want, delta=0.01 * abs(want))

    def test_what_cannot_be_a_recording_is_one_clear_exception(self):
        t, x, reaction = joint(3000)
        other = {
            "another length": dict(time=t, x=x[:-1], F=reaction), "complex": dict(time=t, x=x * 1j, F=reaction),
            "words": dict(time=t, x=["a"] * 3000, F=reaction), "objects": dict(time=t, x=[None] * 3000, F=reaction),
            "three dimensions": dict(time=t, x=np.zeros((10, 10, 30)), F=reaction), "a number": dict(time=t, x=1.0, F=reaction),
            "empty": dict(time=t[:0], x=x[:0], F=reaction[:0]), "no time": dict(x=x, F=reaction),
            "no array": dict(time=t, x=object(), F=reaction), "ragged": dict(time=t, x=[[1.0], [1.0, 2.0]], F=reaction)}
        for name, channels in other.items():
            with self.subTest(name), self.assertRaises(mbk.Error) as caught:
                silent(mbk.measure, mbk.Recording(**channels))
            self.assertTrue(caught.exception.what, name)
            self.assertTrue(caught.exception.hint, name)
            self.assertNotIn("\n", str(caught.exception))
        for name, given in (("a string", "log"), ("nothing", object()), ("an array", x), ("no column", pandas.DataFrame()),
                            ("a column twice", pandas.DataFrame(np.c_[t, x, x], columns=["time", "x", "x"])),
                            ("no word", {"\udc80": x})):
            with self.subTest(name), self.assertRaises(mbk.UsageError) as caught:
                mbk.Recording(given)
            self.assertTrue(caught.exception.hint, name)

    def test_what_is_said_of_arrays_is_checked(self):
        t, x, reaction = joint(3000)
        arrays = {"time": t, "x": x, "F": reaction}
        without = {"x": x, "F": reaction}
        for name, work in (
                ("a unit of another kind", lambda: mbk.measure(mbk.Recording(arrays, units={"x": "N"}))),
                ("an unknown unit", lambda: mbk.measure(mbk.Recording(arrays, units={"x": "parsec"}))),
                ("a unit of nothing", lambda: mbk.Recording(arrays, units={"y": "m"})),
                ("no unit", lambda: mbk.Recording(arrays, units={"x": None})),
                ("units without names", lambda: mbk.Recording(arrays, units=["m"])),
                ("units as a word", lambda: mbk.Recording(arrays, units="mm")),
                ("metadata without names", lambda: mbk.Recording(arrays, metadata=[1])),
                ("an event without a name", lambda: mbk.Recording(arrays, events=[(1.0,)])),
                ("events without a time", lambda: mbk.Recording(arrays, events=["go"])),
                ("no events", lambda: mbk.Recording(arrays, events=5)),
                ("a time and a rate", lambda: mbk.Recording(arrays, rate_hz=1000)),
                ("two times", lambda: mbk.Recording(arrays, time=t)), ("two positions", lambda: mbk.Recording(arrays, x=x)),
                ("no rate", lambda: mbk.Recording(without, rate_hz="fast")),
                ("a rate of 0", lambda: mbk.Recording(without, rate_hz=0)),
                ("a rate that is none", lambda: mbk.Recording(without, rate_hz=math.nan)),
                ("time backwards", lambda: mbk.measure(mbk.Recording(without, time=t[::-1]))),
                ("a time that stands", lambda: mbk.measure(mbk.Recording(without, time=0 * t))),
                ("a time that is none", lambda: mbk.measure(mbk.Recording(without, time=np.where(t == 1, np.nan, t)))),
                ("a date that is none", lambda: mbk.measure(mbk.Recording(
                    without, time=pandas.DatetimeIndex([*pandas.date_range("2026", periods=2999, freq="ms"), pandas.NaT])))),
                ("dates and numbers", lambda: mbk.Recording(without, time=[datetime.datetime(2026, 5, 4)] + [1.0] * 2999)),
                ("a number that is missing", lambda: mbk.measure(mbk.Recording(
                    time=t, x=pandas.Series([None, *x[1:]], dtype="Float64"), F=reaction))),
                ("an empty option", lambda: mbk.measure(arrays, cutoff=[]))):
            with self.subTest(name):
                with self.assertRaises(mbk.Error) as caught:
                    silent(work)
                self.assertTrue(caught.exception.what)
                self.assertTrue(caught.exception.hint)
                self.assertNotIn("\n", str(caught.exception))

    def test_dates_are_counted_from_the_first(self):
        t, x, reaction = joint(3000)
        want = silent(mbk.measure, mbk.Recording(time=t, x=x, F=reaction)).model.K[0, 0]
        dates = pandas.date_range("2026-05-04T12:00", periods=3000, freq="ms")
        zoned = dates.tz_localize("Europe/Berlin")
        for name, time in (("datetime64", dates.to_numpy()), ("timedelta64", dates.to_numpy() - dates.to_numpy()[0]),
                           ("index", dates), ("with a zone", zoned), ("Series", pandas.Series(zoned)),
                           ("datetime", list(dates.to_pydatetime())), ("datetime with a zone", list(zoned.to_pydatetime())),
                           ("timedelta", list((dates - dates[0]).to_pytimedelta()))):
            with self.subTest(name):
                recording = mbk.Recording(time=time, x=x, F=reaction, units={"time": "ms"})
                np.testing.assert_allclose(recording.time, t, atol=1e-12)
                self.assertAlmostEqual(silent(mbk.measure, recording).model.K[0, 0], want, delta=1e-6 * abs(want))
        for name, table in (("index", pandas.DataFrame({"x": x, "F": reaction}, index=zoned)),
                            ("column", pandas.DataFrame({"time": dates, "x": x, "F": reaction}))):
            with self.subTest(name):
                np.testing.assert_allclose(mbk.Recording(table).time, t, atol=1e-12)

    def test_gaps_and_infinities_are_said_and_not_computed_with(self):
        t, x, reaction = joint(6000)
        for value in (math.nan, math.inf, -math.inf, 1e300):
            with self.subTest(value):
                bad = x.copy()
                bad[3000:3003] = value
                try:
                    found = silent(mbk.measure, {"time": t, "x": bad, "F": reaction})
                except mbk.Error as error:
                    self.assertTrue(error.hint)
                else:
                    self.assertTrue(not found.usable or np.isfinite(found.model.K).all())

    def test_pandas_and_xarray_go_in_and_out(self):
        table = self.relaxed.to_dataframe()
        self.assertEqual(table.index.name, "time")
        self.assertEqual(table.attrs["units"]["force_x"], "N")
        want = silent(mbk.measure, self.relaxed, handle_mass=0.194).model
        for name, same in (("DataFrame", table), ("Dataset", self.relaxed.to_xarray()), ("dict", self.relaxed.to_dict())):
            with self.subTest(name):
                got = silent(mbk.measure, same, handle_mass=0.194)
                np.testing.assert_array_equal(got.model.K, want.K)
        self.assertEqual(self.relaxed.to_xarray()["hand_x"].attrs["units"], "m")
        dated = table.copy()
        dated.index = pandas.Timestamp("2026-05-04T12:00:00") + pandas.to_timedelta(table.index, unit="s")
        np.testing.assert_allclose(silent(mbk.measure, dated, handle_mass=0.194).model.K, want.K, rtol=1e-6)

    def test_several_seeds_and_trials_come_in_their_order(self):
        found = mbk.simulate("free_motion", seed=9, seeds=2)
        self.assertEqual(len(found), 2)
        for seed, one in zip((9, 10), found):
            np.testing.assert_array_equal(one["torque_1"], mbk.simulate("free_motion", seed=seed)["torque_1"])

    def test_a_saved_recording_is_the_same(self):
        for ending in ("h5", "mat", "csv"):
            file = self.folder / f"saved.{ending}"
            self.relaxed.save(file)
            back = mbk.read(file)
            self.assertEqual(sorted(back.channels), sorted(self.relaxed.channels))
            for name in back.channels:
                np.testing.assert_array_equal(back[name], self.relaxed[name])
            with self.assertRaises(mbk.UsageError):
                self.relaxed.save(file)
            self.relaxed.save(file, overwrite=True)

    def test_it_says_what_it_holds(self):
        self.assertEqual(self.relaxed.rate_hz, 1000.0)
        self.assertAlmostEqual(self.relaxed.duration_s, 62.1, delta=0.01)
        self.assertIn("hand_x", self.relaxed)
        self.assertIn("x", self.relaxed)
        self.assertNotIn("nothing", self.relaxed)
        self.assertEqual(len(self.relaxed), self.relaxed["x"].size)
        self.assertEqual(self.relaxed.units["hand_x"], "m")
        self.assertIn("62.099 s at 1000 Hz", repr(self.relaxed))
        self.assertIn("<table", self.relaxed._repr_html_())
        self.assertIn("truth_K", self.relaxed.metadata)
        with self.assertRaises(KeyError):
            self.relaxed["nothing"]
        unknown = mbk.Recording(a=np.arange(10.0), b=np.arange(10.0), rate_hz=100)
        self.assertEqual(list(unknown.signals)[:2], ["a", "b"])
        self.assertIn("a", repr(unknown))
        self.assertIn("<table", unknown._repr_html_())

    # ---- options

    def test_the_functions_have_the_options_of_the_command_and_no_others(self):
        table = json.loads(self.command("manual", "--json").stdout)["commands"]
        parents = {tuple(one["path"][:-1]) for one in table if len(one["path"]) > 1}
        checked = 0
        for one in table:
            if one["path"][0] in ("run", "new", "work", "completion", "manual") or tuple(one["path"]) in parents:
                continue
            module = mbk if len(one["path"]) == 1 else getattr(mbk, one["path"][0])
            function = getattr(module, {"import": "import_"}.get(one["path"][-1], one["path"][-1]))
            parameters = inspect.signature(function).parameters
            names = {name.rstrip("_").replace("_", "-") for name, value in parameters.items()
                     if value.kind == inspect.Parameter.KEYWORD_ONLY}
            options = {option["names"][-1][2:] for option in one["options"]}
            with self.subTest(one["path"]):
                self.assertLessEqual(names, options)
                self.assertLessEqual(options - names, {"help", "help-all", "json", "quiet", "out", "overwrite",
                                                               "version"})
                self.assertTrue(all(value.default in (None, False) for value in parameters.values()
                                    if value.kind == inspect.Parameter.KEYWORD_ONLY))
                for option in one["options"]:
                    words = mbk._mbk.in_python(option["description"]).split()
                    if option["names"][-1][2:] in names:
                        self.assertIn(words[-1].lower(), " ".join(function.__doc__.split()).lower())
                        if (first := words[0].strip(",:;")) in option["words"]:  # as it must be typed
                            self.assertIn(f"\n        {first}", function.__doc__)
            checked += 1
        self.assertGreater(checked, 30)

    def test_wrong_options_are_what_the_command_says(self):
        for options, words in ((dict(mode="fast"), ("mode", "fast")), (dict(sg_window=4), ("sg_window", "4")),
                               (dict(cutoff="x"), ("cutoff",)), (dict(handle_mass=-1), ("handle_mass",)),
                               (dict(sg_order=math.nan), ("sg_order",)), (dict(arm=(1, 2)), ("arm",))):
            with self.subTest(options), self.assertRaises(mbk.UsageError) as caught:
                mbk.measure(self.log, **options)
            for word in words:
                self.assertIn(word, str(caught.exception))
            self.assertEqual(caught.exception.exit_code, 2)
        with self.assertRaises(TypeError):
            mbk.measure(self.log, no_such_option=1)
        with self.assertRaises(mbk.UsageError):
            mbk.measure()
        with self.assertRaises(mbk.UsageError):
            mbk.measure(self.log, channels=object())

    def test_values_may_be_of_numpy_and_of_paths(self):
        want = mbk.measure(self.log, sg_window=151, handle_mass=0.25, cutoff=4.5).json
        self.assertEqual(mbk.measure(str(self.log), sg_window=np.int64(151), handle_mass=np.float64(0.25),
                                     cutoff=np.float32(4.5)).json, want)
        self.assertEqual(mbk.measure([self.log], sg_window="151", handle_mass="0.25", cutoff="4.5").json, want)

    # ---- results

    def test_fields_are_attributes_with_units(self):
        result = self.result
        self.assertEqual(result.model.K.shape, (2, 2))
        self.assertEqual(result.to_dict()["model"]["K"], result.model.K.tolist())
        for path, unit in (("model.K", "N/m"), ("model.M", "kg"), ("standard_error.B", "N·s/m"), ("model.x0", "m"),
                           ("fit.VAF", "%"), ("fit.RMSE", "N"), ("ellipses.stiffness.orientation_deg", "°"),
                           ("passivity.trial.absorbed_J", "J"), ("passivity.band_hz", "Hz"), ("inputs.0.duration_s", "s"),
                           ("usable", "")):
            with self.subTest(path):
                self.assertEqual(result.unit(path), unit)
        self.assertIn("variance", result.describe("fit.VAF"))
        with self.assertRaises(KeyError):
            result.unit("model.nothing")
        with self.assertRaisesRegex(AttributeError, "nothing"):
            result.nothing
        with self.assertRaises(AttributeError):
            result.bootstrap
        self.assertIn("ellipses", dir(result))
        self.assertFalse(hasattr(result, "bootstrap"))
        with self.assertRaises(ValueError):
            result.model.K[0, 0] = 1.0

    def test_to_dict_is_its_own(self):
        one = self.result.to_dict()
        one["model"] = None
        self.assertIsNotNone(self.result.to_dict()["model"])
        part = self.result.model.to_dict()
        part["K"][0][0] = 1e9
        self.assertNotEqual(self.result.model.to_dict()["K"][0][0], 1e9)

    def test_documents_are_saved_loaded_pickled_and_copied(self):
        file = self.folder / "result.json"
        self.result.save(file)
        self.assertEqual(mbk.load(file), self.result)
        self.assertIsInstance(mbk.load(file), mbk.Result)
        with self.assertRaises(mbk.UsageError):
            self.result.save(file)
        for again in (pickle.loads(pickle.dumps(self.result)), copy.deepcopy(self.result)):
            self.assertEqual(again, self.result)
            np.testing.assert_array_equal(again.model.K, self.result.model.K)
        (self.folder / "other.json").write_text("{}")
        with self.assertRaises(mbk.DataError):
            mbk.load(self.folder / "other.json")

    def test_results_in_memory_stand_where_files_do(self):
        self.assertEqual(mbk.ellipse(self.result).ellipses.stiffness.area, self.result.ellipses.stiffness.area)
        other = mbk.measure(self.log, handle_mass=0)
        self.assertEqual(list(mbk.compare(self.result, other).to_dataframe().index), ["inertia", "damping", "stiffness"])

    def test_several_recordings_are_a_table(self):
        second = self.folder / "second.h5"
        mbk.simulate("relaxed_sinusoidal", seed=2, out=second)
        found = silent(mbk.measure, self.log, second)
        self.assertIsInstance(found, mbk.Results)
        self.assertEqual(len(found), 2)
        self.assertEqual([one.usable for one in found], [True, True])
        table = found.to_dataframe()
        self.assertEqual(list(table["K_xx"]), [one.model.K[0, 0] for one in found])
        self.assertIn("<table", found._repr_html_())
        self.assertEqual(self.result.to_dataframe().loc["K_xy", "value"], self.result.model.K[0, 1])
        self.assertEqual(self.result.to_dataframe().loc["K_xy", "unit"], "N/m")

    def test_a_notebook_shows_the_tables_of_the_report(self):
        page = self.result._repr_html_()
        for words in ("inertia M", "equilibrium x₀", "95 %", "VAF", "Usable", "N·s/m", "passive"):
            self.assertIn(words, page)
        text = self.command("measure", self.log).stdout
        self.assertIn(f"{mbk._tables.with_half_width(self.result.model.M[0, 0], self.result.standard_error.M[0, 0])}", text)
        hostile = mbk._documents.of(self.result.json.replace("log.h5", "<script>alert(1)</script>"))
        self.assertNotIn("<script>", hostile._repr_html_())

    def test_a_result_is_printed_as_the_command_prints_it(self):
        value = re.compile(r"-?[\d.]+ ± [\d.]+")
        shown, text = str(self.result), self.command("measure", self.log).stdout
        self.assertEqual(len(value.findall(shown)), 14)
        self.assertLessEqual(set(value.findall(shown)), set(value.findall(text)))
        self.assertRegex(shown, r"VAF x 99\.\d+ %, y 99\.\d+ %")
        self.assertEqual(len(repr(self.result).splitlines()), 1)
        self.assertIn(self.log.name, repr(self.result))
        wrong = silent(mbk.measure, {name: -values if name.startswith("force") else values
                                     for name, values in self.relaxed.to_dict().items()})
        self.assertIn("! force-sign-reversed", str(wrong))
        self.assertIn("NOT USABLE", str(wrong))
        self.assertNotRegex(str(wrong), value)
        self.assertIn("not usable", repr(wrong))
        several = silent(mbk.measure, self.log, self.log, self.folder / "none.h5")
        self.assertEqual(len(re.findall(rf"{self.log.name} +yes", str(several))), 2)
        self.assertIn("none.h5", str(several))
        self.assertEqual(len(repr(several).splitlines()), 1)
        joint_result = silent(mbk.measure, dict(zip(("time", "x", "F"), joint())))
        self.assertEqual(len(value.findall(str(joint_result))), 4)

    def test_every_document_shows_what_it_holds_with_units(self):
        for document, words in (
                (mbk.info(self.log), ("duration_s", "62.10", "hand_x", "Info")),
                (mbk.springs.field("rig_springs_table_3_1", trial="config_1"), ("tension [N]", "principal.stiffness", "N/m")),
                (mbk.robot.workspace(at=(300, -50)), ("area_m2", "at.margins", "left_deg [°]")),
                (mbk.study.plan(sd_people=60, sd_trials=25, difference=50), ("mdc95.value", "variance.participant")),
                (self.result.model, ("1.347, −0.9342; −0.9257, 1.887", "N·s/m")),
                (mbk.measure(self.log, domain="joint"), ("joints", "N·m/rad")),
                (mbk.passivity(self.log, self.log), ("passive", " J"))):
            with self.subTest(repr(document)[:60]):
                page = document._repr_html_()
                for word in words:
                    self.assertIn(word, page)
                self.assertNotIn("sha256", page)
        rows = mbk.passivity(self.log, self.log).to_dataframe()
        self.assertEqual((len(rows), list(rows["verdict"])), (2, ["passive", "passive"]))
        self.assertTrue((rows["low95"] < rows["absorbed_J"]).all() and (rows["absorbed_J"] < rows["high95"]).all())
        self.assertEqual(len(mbk.info(self.log, self.log).to_dataframe()), 2 * len(mbk.info(self.log).to_dataframe()))

    def test_every_plot_has_labelled_axes_with_units(self):
        import matplotlib.pyplot as plt
        x, force = self.relaxed["hand_x"], self.relaxed["force_x"]
        onedimensional = silent(mbk.measure, {"time": self.relaxed.time, "x": x, "F": force, "xr": x}, axes=1)
        figures = {
            "recording": self.relaxed.plot, "ellipses": self.result.plot, "fit": self.result.plot_fit,
            "energy": self.result.plot_energy, "passivity": silent(mbk.passivity, self.relaxed).plot,
            "one axis": onedimensional.plot, "exploration": silent(mbk.explore, self.log, only="frequency-response").plot,
            "tf": silent(mbk.tf, self.log, input="-Fx", output="x", poles=2, zeros=0).plot,
            "springs": mbk.springs.field("rig_springs_table_3_1", trial="config_1").plot,
            "validation": mbk.validate("coverage", runs=2).plot,
            "teleop": mbk.teleop(pathlib.Path(__file__).parents[2] / "examples/teleop/position_position.toml").plot}
        for name, draw in figures.items():
            with self.subTest(name):
                figure = draw()
                figure.canvas.draw()
                for axes in figure.axes:
                    self.assertTrue(axes.get_ylabel() or name == "validation", name)
                    for label in (axes.get_xlabel(), axes.get_ylabel()):
                        self.assertRegex(label, r"\[.+\]|^$|coherence|condition|recording|value", name)
                    self.assertTrue(axes.lines or axes.collections, name)
                    if name == "teleop":
                        self.assertTrue(np.isfinite(axes.lines[0].get_xydata()).all(), "every frequency is a number")
                        self.assertLess(axes.get_xlim()[1], 1e6)
                self.assertTrue(any(axes.get_xlabel() for axes in figure.axes))
                plt.close("all")
        with self.assertRaises(NotImplementedError):
            mbk.info(self.log).plot()
        given, panels = plt.subplots(2, 3)
        self.assertIs(self.result.plot(axes=panels[1]), given)
        self.assertTrue(all(panel.lines and not panel.get_title() for panel in panels[1]))
        self.assertFalse(any(panel.lines for panel in panels[0]), "only into the given axes")
        with self.assertRaises(mbk.UsageError):
            self.result.plot(axes=panels)
        self.assertIs(figures["springs"](ax=panels[0, 0]), given)
        self.assertEqual((panels[0, 0].get_title(), panels[0, 0].get_xlabel()), ("", "x [mm]"))
        figures["tf"](axes=panels[:, 2])
        self.assertEqual([panel.get_title() for panel in panels.flat], [""] * 6)
        identified = mbk.identify(self.log, structure="symmetric")
        self.assertEqual(len(identified.plot().axes[0].get_xticks()), 4, "every entry of a matrix")
        self.assertEqual(len(identified.plot_fit().axes), 4)
        with self.assertRaises(mbk.UsageError):
            identified.plot_energy()
        self.assertEqual(len(mbk.passivity(self.log, self.log).plot().axes[0].lines), 3, "both, and zero")
        plt.close("all")

    # ---- what goes wrong

    def test_errors_say_where_what_and_what_to_do(self):
        with self.assertRaises(mbk.DataError) as caught:
            mbk.measure("nothing.mat")
        error = caught.exception
        self.assertEqual(error.file, "nothing.mat")
        self.assertTrue(error.what)
        self.assertTrue(error.hint)
        self.assertEqual(error.exit_code, 3)
        self.assertIsInstance(error, ValueError)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((again.file, again.what, again.hint), (error.file, error.what, error.hint))
        self.assertIn(error.what, self.command("measure", "nothing.mat").stderr)

    def test_warnings_have_codes_and_name_the_line_that_called(self):
        t, x, reaction = joint()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = mbk.measure({"time": t, "x": x, "F": -reaction})
        self.assertFalse(found.usable)
        self.assertEqual(found.exit_code, 4)
        self.assertEqual({one["code"] for one in found.to_dict()["warnings"]},
                         {one.message.code for one in caught if isinstance(one.message, mbk.MbkWarning)})
        self.assertEqual({one.filename for one in caught}, {__file__})
        code = caught[0].message.code
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            warnings.filterwarnings("error", message=rf"\[{code}\]", category=mbk.MbkWarning)
            with self.assertRaises(mbk.MbkWarning):
                mbk.measure({"time": t, "x": x, "F": -reaction})

    def test_one_bad_file_among_several_costs_only_itself(self):
        bad = self.folder / "bad.csv"
        bad.write_text("nothing\n")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = mbk.measure(self.log, bad)
        self.assertEqual(len(found), 1)
        self.assertIn("failed", {one.message.code for one in caught})

    def test_another_type_is_a_type_error_that_says_what_is_taken(self):
        for given in (3, 3.5, np.int64(3), True, object(), self.relaxed["hand_x"]):
            with self.subTest(type(given)), self.assertRaises(TypeError) as caught:
                mbk.measure(given)
            self.assertIsInstance(caught.exception, mbk.UsageError)
            for word in ("file name", "Recording", "keyword", "DataFrame", type(given).__name__):
                self.assertIn(word, str(caught.exception))
        with self.assertRaises(TypeError):
            mbk.Recording(3)

    # ---- cost

    def test_other_threads_run_and_calls_may_overlap(self):
        want = self.result.json
        found, ticks, over = [], [0], threading.Event()

        def count():
            while not over.is_set():
                ticks[0] += 1
                time.sleep(0.0005)

        counting = threading.Thread(target=count)
        counting.start()
        threads = [threading.Thread(target=lambda: found.append(mbk.measure(self.log).json)) for _ in range(4)]
        for one in threads:
            one.start()
        for one in threads:
            one.join()
        over.set()
        counting.join()
        self.assertEqual(found, [want] * 4)
        self.assertGreater(ticks[0], 5)

    def test_ctrl_c_ends_long_calls(self):
        scenario = self.folder / "long.toml"
        scenario.write_text('[control]\nkind = "position"\n[perturbation]\nkind = "multisine"\npeak_deg = 2\n'
                            'duration_s = 1200\n[participant]\nkind = "arm"\n')
        calls = {"a long simulation": lambda: mbk.simulate(scenario), "two": lambda: mbk.simulate(scenario, seeds=2),
                 "validate": lambda: mbk.validate("coverage", runs=100_000)}
        for name, call in calls.items():
            with self.subTest(name):
                began = time.process_time()  # which a busy machine does not prolong
                threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
                with self.assertRaises(KeyboardInterrupt):
                    call()
                self.assertLess(time.process_time() - began, 2.0)

    def test_memory_stays_flat(self):
        t, x, reaction = joint(1500)

        def calls(count):
            for k in range(count):
                recording = mbk.Recording(time=t, x=x, F=reaction)
                document = mbk.info(recording)
                if k % 10 == 0:
                    document.to_dict()
                    document.samples
                with self.assertRaises(mbk.UsageError):
                    mbk.info(recording, rate=-1)

        calls(300)
        gc.collect()
        before = resident()
        calls(int(os.environ.get("MBK_CALLS", "2000")))
        gc.collect()
        self.assertLess(resident() - before, 2e6)


if __name__ == "__main__":
    unittest.main()
