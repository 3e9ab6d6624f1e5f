#!/usr/bin/env python3
"""HDF5 files as h5py writes them: the layout of mbk, files of others, and damage."""

import random
import unittest

try:
    import h5py
except ImportError:
    h5py = None

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

    def test_what_is_not_recognised_is_listed(self):
        def fill(file):
            file["trial/gaze"] = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
            file["label"] = "left"

        listed = run("info", self.write("other.h5", fill))
        self.assertEqual(listed.code, FINE, listed)
        for text in ("HDF5", "trial/gaze", "3×2", "'label' is text"):
            self.assertIn(text, listed.out)

    def test_a_file_without_numbers_is_refused(self):
        path = self.write("texts.h5", lambda file: file.attrs.update(title="nothing"))
        ran = run("measure", path)
        self.assertEqual(ran.code, BAD_DATA, ran)
        self.assertIn("it has no numeric variable", ran.err)

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
