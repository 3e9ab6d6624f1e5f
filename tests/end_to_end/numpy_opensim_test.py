#!/usr/bin/env python3
"""Arrays of NumPy and tables of OpenSim, as their programs write them, through the command."""

import struct
import zipfile

from command import Case, main, make_log, table_of

SAMPLES = 62000
NAMES = ("time", "hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y")


def npy(descr, shape, data, fortran=False, version=1):
    header = f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}".encode("utf-8")
    header += b" " * (-(len(header) + 11) % 64) + b"\n"
    return b"\x93NUMPY" + bytes((version, 0)) + struct.pack("<H" if version == 1 else "<I", len(header)) + header + data


class Numpy(Case):
    @classmethod
    def setUpClass(cls):
        cls.columns = table_of(make_log(), SAMPLES)

    def model(self, path, *options):
        return self.fine("measure", "--json", path, *options).json["model"]

    def test_every_file_gives_the_same_model(self):
        columns = self.columns
        count = len(columns[0])
        plain = self.file("plain.csv", ",".join(NAMES) + "\n" +
                          "".join(",".join(map(repr, row)) + "\n" for row in zip(*columns)))
        model = self.model(plain)
        archive = self.folder / "trial.npz"
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as zipped:
            for k, (name, column) in enumerate(zip(NAMES, columns)):
                order = "<>"[k % 2]
                zipped.writestr(f"{name}.npy", npy(f"'{order}f8'", f"({count},)", struct.pack(f"{order}{count}d", *column)))
        self.assertEqual(self.model(archive), model)
        rows = [value for row in zip(*columns) for value in row]
        fields = ", ".join(f"('{name}', '<f8')" for name in NAMES)
        records = self.file("records.npy", npy(f"[{fields}]", f"({count},)", struct.pack(f"<{len(rows)}d", *rows), version=3))
        self.assertEqual(self.model(records), model)
        numbers = ("--channels", "time=1,x=2,y=3,Fx=4,Fy=5,xr=6,yr=7")
        matrix = self.file("matrix.npy", npy("'<f8'", f"({count}, 7)", struct.pack(f"<{len(rows)}d", *rows), version=2))
        self.assertEqual(self.model(matrix, *numbers), model)
        flat = [value for column in columns for value in column]
        fortran = self.file("fortran.npy", npy("'>f8'", f"({count}, 7)", struct.pack(f">{len(flat)}d", *flat), True))
        self.assertEqual(self.model(fortran, *numbers), model)

    def test_objects_are_refused_with_the_way_out(self):
        path = self.file("objects.npy", npy("'|O'", "(2,)", b"\x80\x04]q."))
        self.bad_data(path, says=["objects", "numpy.savez"])
        archive = self.folder / "trial.npz"
        with zipfile.ZipFile(archive, "w") as zipped:
            zipped.writestr("time.npy", npy("'<f8'", "(2,)", struct.pack("<2d", 0, 0.1)))
            zipped.writestr("x.npy", npy("'<f8'", "(2,)", struct.pack("<2d", 1, 2)))
            zipped.writestr("force.npy", npy("'|O'", "(2,)", b"\x80\x04]q."))
        self.bad_data(archive, "--axes", "1", "--channels", "x=x,F=force", says=["reaction", "'force'", "numpy.savez"])

    def test_what_is_cut_short_is_refused(self):
        whole = npy("'<f8'", "(100, 2)", bytes(1600))
        for length in (7, 40, len(whole) - 1):
            self.bad_data(self.file("cut.npy", whole[:length]), says="NumPy" if length < 100 else "bytes")
        self.bad_data(self.file("cut.npz", b"PK\x03\x04" + bytes(40)), says="zip")


class Opensim(Case):
    def test_a_table_in_degrees(self):
        head = "Coordinates\nversion=1\nnRows=3\nnColumns=4\ninDegrees={}\n\nendheader\n"
        body = "time\telbow_flexion\tpelvis_tx\tF\n0\t90\t0.5\t1\n0.01\t91\tNAN\t2\n0.02\t92\t0.7\t3\n"
        path = self.file("reach.mot", head.format("yes") + body)
        options = ("--channels", "q1=elbow_flexion,x=pelvis_tx,Fx=F")
        facts = self.fine("info", "--json", *options, path).json
        ranges = {one["name"]: one["minimum"] for one in facts["channels"]}
        self.assertAlmostEqual(ranges["joint_1"], 1.5707963267948966)
        self.assertEqual((ranges["hand_x"], facts["rate_hz"]), (0.5, 100.0))
        self.assertTrue(any("joint_1" in note and "deg" in note for note in facts["notes"]), facts["notes"])
        self.bad_data(path, "--axes", "1", "--channels", "x=elbow_flexion,F=F",
                      says=["'elbow_flexion'", "x=elbow_flexion:deg"])
        radians = self.fine("info", "--json", *options, self.file("rad.mot", head.format("no") + body)).json
        self.assertEqual({one["name"]: one["minimum"] for one in radians["channels"]}["joint_1"], 90.0)

    def test_markers(self):
        rows = "".join(f"{k + 1}\t{k / 100}\t{k}\t{2 * k}\t0\t{k}\t\t\n" for k in range(100))
        path = self.file("reach.trc", "PathFileType\t4\t(X/Y/Z)\treach.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\t"
                         "Units\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n100\t100\t100\t2\tmm\t100\t1\t100\n"
                         "Frame#\tTime\tHand\t\t\tElbow\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n" + rows)
        contents = self.fine("info", "--json", path).json
        self.assertEqual([(a["name"], a.get("unit")) for a in contents["arrays"][1:4]],
                         [("Time", "s"), ("Hand.x", "mm"), ("Hand.y", "mm")])
        facts = self.fine("info", "--json", "--channels", "x=Hand.x,y=Hand.y", path).json
        self.assertEqual({one["name"]: one["maximum"] for one in facts["channels"]}, {"hand_x": 0.099, "hand_y": 0.198})
        self.assertAlmostEqual(facts["rate_hz"], 100.0)


if __name__ == "__main__":
    main()
