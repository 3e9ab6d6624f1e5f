#!/usr/bin/env python3
"""Channels from several matrices of one file: MAT as SciPy writes it, with Simulink's structures, and HDF5."""

import unittest

from command import BAD_DATA, FINE, WRONG_USAGE, Case, data_folder, main, make_log, run, table_of

try:
    import h5py
    import numpy
    import scipy.io
except ImportError:
    h5py = numpy = scipy = None

MODEL = ("M", "B", "K", "x0")


@unittest.skipIf(h5py is None or scipy is None, "h5py or SciPy is not installed")
class SeveralMatrices(Case):
    @classmethod
    def setUpClass(cls):
        log = make_log()
        columns = numpy.array(table_of(log))
        cls.time = columns[0]
        cls.position, cls.force, cls.reference = columns[1:3].T, columns[3:5].T, columns[5:7].T  # N×2 each
        cls.expected = run("measure", "--json", log.path).json["model"]

    def assert_measured(self, path, channels):
        ran = run("measure", "--json", path, "--channels", channels)
        self.assertEqual(ran.code, FINE, ran)
        for name in MODEL:
            self.assertEqual(ran.json["model"][name], self.expected[name], name)

    def test_matrices_of_a_mat_file_tall_and_wide(self):
        path = self.folder / "log.mat"
        scipy.io.savemat(path, {"t": self.time, "pos": self.position, "force": self.force.T, "target": self.reference})
        self.assert_measured(path, "time=t,x=pos[1],y=pos[2],Fx=force[1],Fy=force[2],xr=target[1],yr=target[2]")

    def test_structures_of_simulink(self):
        path = self.folder / "out.mat"
        signals = numpy.zeros(3, dtype=[("values", object), ("label", object)])
        for k, (values, label) in enumerate(((self.position, "pos"), (self.force, "force"), (self.reference, "target"))):
            signals[k] = (values, label)
        scipy.io.savemat(path, {"out": {"time": self.time.reshape(-1, 1), "signals": signals}})
        name = "out.signals({}).values[{}]"
        entries = ((1, "x", "y"), (2, "Fx", "Fy"), (3, "xr", "yr"))
        self.assert_measured(path, ",".join(f"{a}={name.format(k, 1)},{b}={name.format(k, 2)}" for k, a, b in entries))

    def test_structures_and_cells_of_matlab_7_3(self):
        path = self.folder / "out.mat"
        with h5py.File(path, "w", userblock_size=512) as file:
            def hidden(values):
                stored = file.create_dataset(f"#refs#/{len(file['#refs#']) if '#refs#' in file else 0}", data=values.T)
                stored.attrs["MATLAB_class"] = numpy.bytes_("double")
                return stored.ref

            def of_references(name, references, kind=None):
                stored = file.create_dataset(name, data=numpy.array(references, dtype=h5py.ref_dtype).reshape(-1, 1))
                if kind:
                    stored.attrs["MATLAB_class"] = numpy.bytes_(kind)

            of_references("out/signals/values", [hidden(self.position), hidden(self.force)])
            of_references("trials", [hidden(self.reference), hidden(self.time.reshape(-1, 1))], "cell")
            file["out"].attrs["MATLAB_class"] = file["out/signals"].attrs["MATLAB_class"] = numpy.bytes_("struct")
        with open(path, "r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
        self.assert_measured(path, "time=trials{2},x=out.signals(1).values[1],y=out.signals(1).values[2],"
                                   "Fx=out.signals(2).values[1],Fy=out.signals(2).values[2],"
                                   "xr=trials{1}[1],yr=trials{1}[2]")

    def test_a_file_of_matlab_7_4(self):
        listed = self.fine("info", data_folder("mat", "testhdf5_7.4_GLNX86.mat"))
        self.assertRegex(listed.out, r"testdouble +1×9 +0 +6\.28319")
        self.assertNotIn("ignored", listed.out)

    def test_datasets_of_hdf5(self):
        path = self.folder / "log.h5"
        with h5py.File(path, "w") as file:
            file["trial/time"] = self.time
            file["trial/pos"] = self.position * 1000
            file["trial/pos"].attrs["unit"] = "mm"
            file["trial/force"] = self.force.T
            file["trial/target"] = self.reference
        ran = run("info", "--json", path, "--channels", "x=trial/pos[1],Fx=trial.force[2]")
        self.assertEqual(ran.code, FINE, ran)
        self.assertIn("'trial/time'", " ".join(ran.json["notes"]))
        from_columns = {channel["name"]: channel for channel in ran.json["channels"]}
        self.assertEqual(from_columns["hand_x"]["unit"], "m")
        self.assertAlmostEqual(from_columns["hand_x"]["maximum"], self.position[:, 0].max(), places=12)
        self.assertEqual(from_columns["force_x"]["maximum"], self.force[:, 1].max())

    def test_every_error_names_what_there_is_and_the_form(self):
        path = self.folder / "log.mat"
        scipy.io.savemat(path, {"pos": self.position, "force": self.force[:-1]})
        for channels, code, says in (
                (None, BAD_DATA, ['"time=pos[1],x=pos[2],Fx=force[1]"', "pos ("]),
                ("x=pos", BAD_DATA, ['"x=pos[1]"', "×2"]),
                ("x=1,Fx=2", WRONG_USAGE, ['"x=pos[1]"', "--variable NAME", "force ("]),
                ("x=pos[3]", BAD_DATA, ["column 3", "×2"]),
                ("x=position[1]", BAD_DATA, ["'position'", "pos (", "force ("]),
                ("x=pos[1],Fx=force[1]", BAD_DATA, ["'pos[1]'", f"{len(self.time)} samples", str(len(self.time) - 1)])):
            with self.subTest(channels):
                options = ("--channels", channels) if channels else ()
                self.refused(code, "measure", path, "--rate", "1000", *options, says=says)


if __name__ == "__main__":
    main()
