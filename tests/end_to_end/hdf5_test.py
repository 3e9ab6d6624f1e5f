#!/usr/bin/env python3
"""HDF5 files as h5py writes them: the layout of mbk, files of others, and damage."""

import random
import unittest

try:
    import h5py
    import numpy
except ImportError:
    h5py = numpy = None
try:
    import tables
except ImportError:
    tables = None

from command import BAD_DATA, FINE, NOT_USABLE, Case, main, make_log, run, table_of

NAMES = ("time", "hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y")
SAME = 1e-12  # relative; the numbers that go in are the same to the last bit
WRITERS = ("earliest", "latest")


@unittest.skipIf(h5py is None, "h5py is not installed")
class Hdf5(Case):
    def write(self, name, fill, writer="earliest", **options):
        path = self.folder / name
        with h5py.File(path, "w", libver=writer, **options) as file:
            fill(file)
        return path

    def assert_same_model(self, first, second):
        for name in ("M", "B", "K", "x0"):
            self.assert_relative(first["model"][name], second["model"][name], SAME)

    def test_the_layout_of_mbk_gives_the_model_of_the_matrix(self):
        log = make_log()
        columns = dict(zip(NAMES, table_of(log)))
        expected = run("measure", "--json", log.path).json

        def fill(file):
            file["time"] = columns["time"]
            file["time"].attrs["unit"] = "s"
            for name in NAMES[1:]:
                channel = file.create_dataset(f"channels/{name}", data=columns[name], chunks=True, compression="gzip",
                                              shuffle=True, fletcher32=True, maxshape=(None,))
                channel.attrs["unit"] = "N" if name.startswith("force") else "m"
                channel.attrs["frame"] = "base"
            file.attrs["participant"] = "Ánna"

        for writer in WRITERS:
            with self.subTest(writer):
                path = self.write("own.h5", fill, writer)
                self.assert_same_model(run("measure", "--json", path).json, expected)
                info = run("info", "--json", path)
                self.assertEqual(info.code, FINE, info)
                self.assertIn("Ánna", info.out)

    def test_a_matrix_of_another_file_by_the_numbers_of_its_columns(self):
        log = make_log()
        rows = list(zip(*table_of(log)))

        def fill(file):
            file["trial/signals"] = rows
            file["trial/label"] = "left"

        expected = run("measure", "--json", log.path).json
        numbers = "time=1,x=2,y=3,Fx=4,Fy=5,xr=6,yr=7"
        for writer in WRITERS:
            for variable in ("trial/signals", "trial.signals"):
                with self.subTest(writer=writer, variable=variable):
                    path = self.write("other.h5", fill, writer)
                    ran = run("measure", "--json", path, "--variable", variable, "--channels", numbers)
                    self.assertIn(ran.code, (FINE, NOT_USABLE), ran)
                    self.assert_same_model(ran.json, expected)

    def test_the_columns_of_a_table_by_their_names(self):
        log = make_log()
        columns = table_of(log)
        expected = run("measure", "--json", log.path).json
        kinds = [("time", "f8"), ("hand", "f8", (2,)), ("mode", "S4"), ("force_x", "f8"), ("force_y", ">f8"),
                 ("reference", "f8", (2,))]
        rows = numpy.zeros(len(columns[0]), dtype=kinds)
        rows["time"], rows["force_x"], rows["force_y"], rows["mode"] = columns[0], columns[3], columns[4], b"on"
        rows["hand"], rows["reference"] = numpy.array(columns[1:3]).T, numpy.array(columns[5:7]).T
        channels = "x=log/hand[1],y=log/hand[2],Fx=log/force_x,Fy=log.force_y,xr=log/reference[1],yr=log/reference[2]"
        for writer in WRITERS:
            for packing in ({}, {"compression": "gzip", "shuffle": True}, {"compression": "lzf"}):
                with self.subTest(writer=writer, **packing):
                    path = self.write("table.h5", lambda file, packing=packing: file.create_dataset(
                        "log", data=rows, chunks=True, **packing), writer)
                    self.assert_same_model(run("measure", "--json", path, "--channels", channels).json, expected)

    @unittest.skipIf(tables is None, "PyTables is not installed")
    def test_a_table_of_pytables_with_its_own_names(self):
        log = make_log()
        expected = run("measure", "--json", log.path).json
        rows = numpy.rec.fromarrays(table_of(log), names=NAMES)
        path = self.folder / "robot.h5"
        with tables.open_file(path, "w") as file:
            file.create_table("/session", "log", obj=rows, createparents=True,
                              filters=tables.Filters(complevel=5, complib="zlib"))
            file.create_array("/session", "note", b"no recording of anyone")
        ran = run("measure", "--json", path)
        self.assertEqual(ran.code, FINE, ran)
        self.assert_same_model(ran.json, expected)

    def test_numbers_that_lzf_packed(self):
        columns = dict(zip(NAMES, table_of(make_log())))

        def fill(file):
            for name, values in columns.items():
                file.create_dataset(name, data=values, chunks=True, compression="lzf", shuffle=True, fletcher32=True)

        for writer in WRITERS:
            self.assert_same_model(run("measure", "--json", self.write("lzf.h5", fill, writer)).json,
                                   run("measure", "--json", make_log().path).json)

    def test_links_are_followed_and_what_leads_elsewhere_is_named(self):
        def fill(file):
            file["raw/chan3"] = [1.0, 2.0, 3.0]
            file["time"] = h5py.SoftLink("/raw/clock")
            file["raw/clock"] = [0.0, 0.1, 0.2]
            file["hand_x"] = h5py.SoftLink("raw/chan3")
            file["force_x"] = file["raw/chan3"]
            file["raw/all"] = file["/"]
            file["raw/other"] = h5py.ExternalLink("other.h5", "/x")

        for writer in WRITERS:
            ran = self.fine("info", "--json", self.write("links.h5", fill, writer))
            channels = {channel["name"]: channel for channel in ran.json["channels"]}
            self.assertEqual(sorted(channels), ["force_x", "hand_x"])
            self.assertEqual(channels["hand_x"]["maximum"], 3.0)
            notes = "\n".join(ran.json["notes"])
            for name in ("'raw/other'", "'/x'", "'other.h5'", "'raw/all'"):
                self.assertIn(name, notes)

    def test_a_damaged_neighbour_costs_only_itself(self):
        def fill(file):
            file["time"] = [0.0, 0.1, 0.2]
            file["hand_x"] = [1.0, 2.0, 3.0]
            file.create_dataset("video/frames", data=[7.5] * 64, chunks=(64,), fletcher32=True)
            file.create_dataset("half", shape=(40,), chunks=(10,), dtype="f8")[:10] = 1.0

        path = self.write("whole.h5", fill)
        whole = path.read_bytes()
        at = whole.index(numpy.full(8, 7.5).tobytes())
        path.write_bytes(whole[:at] + b"\1" + whole[at + 1:])
        ran = self.fine("info", path)
        said = " ".join(ran.out.split())
        for fact in ("'video/frames'", "checksum", "'half'"):
            self.assertIn(fact, said)
        self.bad_data(path, "--channels", "x=video/frames", command="info", says="'video/frames'")
        path = self.write("half.h5", lambda file: (fill(file), file.move("half", "reference_x")))
        self.bad_data(path, says=["'reference_x'", "--channels"])

    def test_what_is_not_recognised_is_listed(self):
        def fill(file):
            file["trial/gaze"] = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
            file["label"] = "left"

        listed = run("info", self.write("other.h5", fill))
        self.assertEqual(listed.code, FINE, listed)
        for text in ("HDF5", "trial/gaze", "3×2", "'label'"):
            self.assertIn(text, listed.out)

    def test_a_file_without_numbers_is_refused(self):
        path = self.write("texts.h5", lambda file: file.attrs.update(title="nothing"))
        ran = run("measure", path)
        self.assertEqual(ran.code, BAD_DATA, ran)
        self.assertIn("variable", ran.err)

    def test_damage_never_crashes(self):
        whole = self.write("whole.h5", lambda file: file.update(time=[0.0, 0.1, 0.2], hand_x=[1.0, 2.0, 3.0]),
                           "latest").read_bytes()
        chance = random.Random(20130603)
        damaged = self.folder / "damaged.h5"
        for trial in range(40):
            changed = bytearray(whole)
            changed[chance.randrange(len(changed))] = chance.randrange(256)
            for content in (bytes(changed), whole[:chance.randrange(len(whole))]):
                damaged.write_bytes(content)
                ran = run("info", damaged)
                self.assertIn(ran.code, (FINE, BAD_DATA), (trial, ran))


if __name__ == "__main__":
    main()
