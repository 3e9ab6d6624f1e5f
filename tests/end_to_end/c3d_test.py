#!/usr/bin/env python3
"""C3D files: what mbk info shows of them, a measurement of one, and those that mbk convert writes."""

import math
import struct

from command import BAD_DATA, WRONG_USAGE, Case, data_folder, main, make_log, run

RATE = 1000.0
INERTIA, DAMPING, STIFFNESS = 0.02, 0.5, 40.0


def parameter(group, name, kind, dimensions, data):
    """A record of the parameter section; the next one follows it at once."""
    content = struct.pack("bB", kind, len(dimensions)) + bytes(dimensions) + data + b"\0"
    return struct.pack("bb", len(name), group) + name.encode() + struct.pack("<H", 2 + len(content)) + content


def texts(group, name, values):
    encoded = [value.encode() for value in values]
    longest = max(map(len, encoded))
    return parameter(group, name, -1, (longest, len(values)), b"".join(one.ljust(longest) for one in encoded))


def reals(group, name, *values):
    return parameter(group, name, 4, (len(values),), struct.pack(f"<{len(values)}f", *values))


def words(group, name, *values):
    return parameter(group, name, 2, (len(values),), struct.pack(f"<{len(values)}H", *values))


def write_c3d(path, points, channels, units, samples=1, data_start=4, frames_said=None, scale=1.0, more=b""):
    """Intel reals. points: {label: [(x, y, z), ...]}, channels: {label: [...]} with `samples` to a frame. POINT:DATA_START,
    POINT:FRAMES and ANALOG:SCALE may say something wrong; `more`: further records of the parameters."""
    frames = len(next(iter(points.values()))) if points else len(next(iter(channels.values()))) // samples
    rate = RATE / samples
    section = b"\x05\xffPOINT\x03\0\0\x06\xfeANALOG\x03\0\0"
    section += words(1, "USED", len(points)) + words(1, "FRAMES", (frames_said or frames) % 65536)
    section += words(1, "DATA_START", data_start) + more
    section += reals(1, "SCALE", -1.0) + reals(1, "RATE", rate) + texts(1, "UNITS", ["mm"])
    section += words(2, "USED", len(channels)) + reals(2, "RATE", RATE) + reals(2, "GEN_SCALE", 1.0)
    section += reals(2, "SCALE", *[scale] * len(channels)) + words(2, "OFFSET", *[0] * len(channels))
    section += texts(2, "LABELS", list(channels)) + texts(2, "UNITS", units)
    if points:
        section += texts(1, "LABELS", list(points))
    header = struct.pack("<BBHHHHHfHHf", 2, 0x50, len(points), len(channels) * samples, 1, min(frames, 65535), 0, -1.0, 4,
                         samples, rate)
    data = bytearray()
    for f in range(frames):
        for track in points.values():
            data += struct.pack("<4f", *track[f], 0.0)
        for s in range(f * samples, (f + 1) * samples):
            data += struct.pack(f"<{len(channels)}f", *[channel[s] for channel in channels.values()])
    path.write_bytes(header.ljust(512, b"\0") + (b"\1\x50\2\x54" + section).ljust(1024, b"\0") + bytes(data))
    return path


def limb(samples=20000):
    """Angle [deg] and torque [N·m] of a limb of known impedance, moved by a sum of sines."""
    angle, torque = [], []
    lines = [(0.02, 2 * math.pi * hz, phase) for hz, phase in ((0.7, 0.1), (2.1, 1.3), (4.3, 2.9), (7.9, 0.7))]
    for k in range(samples):
        t = k / RATE
        x = sum(a * math.sin(w * t + p) for a, w, p in lines)
        v = sum(a * w * math.cos(w * t + p) for a, w, p in lines)
        acceleration = sum(-a * w * w * math.sin(w * t + p) for a, w, p in lines)
        angle.append(math.degrees(x))
        torque.append(-(INERTIA * acceleration + DAMPING * v + STIFFNESS * x))
    return angle, torque


class C3d(Case):
    def limb_file(self, samples=1, **wrong):
        angle, torque = limb()
        points = {"Hand": [(angle[k], 0.0, 1.0) for k in range(0, len(angle), samples)]}
        return write_c3d(self.folder / "limb.c3d", points, {"Knee angle": angle, "Torque": torque}, ["deg", "Nm"],
                         samples, **wrong)

    def test_info_lists_names_units_and_rates(self):
        path = self.limb_file(samples=10)
        listing = self.fine("info", "--json", path).json
        self.assertEqual(listing["inputs"][0]["format"], "C3D")
        arrays = {array["name"]: array for array in listing["arrays"]}
        self.assertEqual(list(arrays), ["Hand.x", "Hand.y", "Hand.z", "Knee angle", "Torque"])
        self.assertEqual((arrays["Hand.x"]["unit"], arrays["Hand.x"]["rate_hz"], arrays["Hand.x"]["rows"]),
                         ("mm", 100.0, 2000))
        self.assertEqual((arrays["Torque"]["unit"], arrays["Torque"]["rate_hz"]), ("Nm", 1000.0))
        text = self.fine("info", path).out
        for fact in ("2000", " 100 Hz", "1000 Hz"):
            self.assertIn(fact, text)

    def test_channels_make_a_recording_with_time_from_the_rate(self):
        facts = self.fine("info", "--json", "--axes", "1", "--channels", "x=Knee angle,F=Torque", self.limb_file()).json
        self.assertEqual((facts["samples"], facts["rate_hz"]), (20000, 1000.0))
        self.assertEqual({c["name"]: c["unit"] for c in facts["channels"]}, {"position": "rad", "reaction": "N.m"})

    def test_a_limb_is_measured(self):
        ran = run("measure", "--json", "--axes", "1", "--channels", "x=Knee angle,F=Torque", self.limb_file())
        model = ran.json["model"]
        # The file holds 32-bit reals, whose rounding the second derivative magnifies.
        self.assert_relative(model["M"], [[INERTIA]], 0.01)
        self.assert_relative(model["B"], [[DAMPING]], 0.01)
        self.assert_relative(model["K"], [[STIFFNESS]], 0.01)
        self.assertEqual(ran.json["units"]["K"], "N·m/rad")

    def test_a_data_start_among_the_parameters_changes_no_number(self):
        measure = ("measure", "--json", "--axes", "1", "--channels", "x=Knee angle,F=Torque")
        right = run(*measure, self.limb_file()).json["model"]
        wrong = run(*measure, self.limb_file(data_start=2, frames_said=20000 - 1)).json
        self.assertEqual(wrong["model"], right)
        notes = " ".join(self.fine("info", "--json", self.limb_file(data_start=2, frames_said=20000 - 1)).json["notes"])
        self.assertIn("block 4", notes)
        self.assertIn("20000", notes)

    def test_frames_beyond_a_word_are_not_lost(self):
        force = [float(k % 1000) for k in range(70000)]
        field = words(3, "ACTUAL_START_FIELD", 1, 0) + words(3, "ACTUAL_END_FIELD", 70000 % 65536, 1)
        path = write_c3d(self.folder / "long.c3d", {}, {"F": force}, ["N"], more=b"\x05\xfdTRIAL\x03\0\0" + field)
        listing = self.fine("info", "--json", path).json
        self.assertEqual(listing["samples"], 70000)
        for fact in ("70000", "TRIAL:ACTUAL_END_FIELD", "POINT:FRAMES", "4464"):
            self.assertIn(fact, " ".join(listing["notes"]))

    def test_a_scale_of_zero_is_refused_where_it_is_asked_for(self):
        self.bad_data(self.limb_file(scale=0.0), "--axes", "1", "--channels", "x=Knee angle,F=Torque", command="measure",
                      says=("'Knee angle'", "ANALOG:SCALE"))

    def test_a_label_that_repeats_means_neither(self):
        points = {"Hand": [(0.001 * k, 0.0, 1.0) for k in range(500)]}
        path = write_c3d(self.folder / "twice.c3d", points, {"Torqua": [0.5] * 500, "Torque": [1.0] * 500}, ["Nm", "Nm"])
        path.write_bytes(path.read_bytes().replace(b"Torqua", b"Torque"))
        self.bad_data(path, "--axes", "1", "--channels", "x=Hand.x,F=Torque", command="info",
                      says=("'Torque'", "'Torque#1'", "column 4", "'Torque#2'", "column 5"))

    def test_two_rates_are_refused_and_the_way_out_works(self):
        path = self.limb_file(samples=10)
        channels = "q1=Knee angle,x=Hand.x"
        self.bad_data(path, "--channels", channels, command="info", says=("1000 Hz", " 100 Hz", "Knee angle@100"))
        facts = self.fine("info", "--json", "--channels", "q1=Knee angle@100,x=Hand.x", path).json
        self.assertEqual(facts["samples"], 2000)
        self.assertAlmostEqual(facts["rate_hz"], 100.0, places=9)
        self.assertRegex(" ".join(facts["notes"]), r"\b10(th)?\b")

    def test_a_rate_that_contradicts_the_file_is_refused(self):
        self.refused(2, "info", "--rate", "500", "--channels", "q1=Knee angle", self.limb_file(),
                     says="1000 Hz")

    def test_a_file_cut_short_is_refused(self):
        whole = self.limb_file().read_bytes()
        for size in (2, 100, 511, 515, 600, 1023, 1536, len(whole) - 1):
            self.bad_data(self.file("cut.c3d", whole[:size]), command="info")


def parameters_of(section):
    """{"GROUP:NAME": (type, dimensions, bytes)} of a parameter section, by the layout that c3d.org describes."""
    names, found, at = {}, {}, 4
    while section[at]:
        size, number = section[at], struct.unpack_from("b", section, at + 1)[0]
        name, link = section[at + 2:at + 2 + size].decode("ascii"), at + 2 + size
        if number < 0:
            names[-number] = name
        else:
            kind, count = struct.unpack_from("bB", section, link + 2)
            dimensions = tuple(section[link + 4:link + 4 + count])
            begin = link + 4 + count
            found[number, name] = kind, dimensions, section[begin:begin + abs(kind) * math.prod(dimensions)]
        at = link + struct.unpack_from("<H", section, link)[0]
    return {f"{names[number]}:{name}": value for (number, name), value in found.items()}


class C3dFile:
    """A file of Intel reals with one analog sample per frame."""

    def __init__(self, path):
        content = path.read_bytes()
        assert content[:2] == b"\x02\x50" and content[512:514] == b"\x01\x50" and content[515] == 84, content[:600]
        (self.points, self.channels, self.first, self.last, _, scale, start, self.samples,
         self.rate) = struct.unpack_from("<HHHHHfHHf", content, 2)
        assert scale < 0 and start == 2 + content[514], (scale, start)
        self.parameters = parameters_of(content[512:512 * (start - 1)])
        width = 4 * self.points + self.channels
        data = content[512 * (start - 1):]
        assert len(data) % (4 * width) == 0, (len(data), width)
        self.frames = list(struct.iter_unpack(f"<{width}f", data))

    def numbers(self, name):
        kind, _, data = self.parameters[name]
        return list(struct.unpack(f"<{len(data) // abs(kind)}{ {1: 'B', 2: 'H', 4: 'f'}[kind]}", data))

    def texts(self, name):
        values = []
        for part in (name, *(f"{name}{k}" for k in range(2, 9))):
            if part in self.parameters:
                _, (width, *_), data = self.parameters[part]
                values += [data[k:k + width].decode().rstrip(" ") for k in range(0, len(data), width)]
        return values


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


class Written(Case):
    """What mbk convert writes, by a reader of its own and by mbk."""

    def csv(self, columns, comments=()):
        """Columns of a recording at 1 kHz."""
        samples = len(next(iter(columns.values())))
        rows = zip([f"{k / RATE:.6g}" for k in range(samples)], *columns.values())
        lines = ["# mbk.recording/1", *comments, ",".join(("time_s", *columns))]
        return self.file("in.csv", "\n".join([*lines, *(",".join(map(str, row)) for row in rows)]) + "\n")

    def convert(self, source, *options):
        return self.mbk("convert", source, self.folder / "out.c3d", "--overwrite", *options)

    def test_layout(self):
        columns = {"hand_x_m": [0.1, 0.2, "NaN", 0.4], "hand_y_m": [-0.1, -0.2, -0.3, 1e-9], "force_x_N": [1, 2, 3.3, -4],
                   "force_y_N": [0, 0, 0, 1e20], "emg_biceps_V": [1e-6, 2.5e-6, -3e-6, 4e-3]}
        ran = self.convert(self.csv(columns, ["# participant: 7", "# event 0.001 3 onset", "# event 61.5 -1 Ende ä"]))
        self.assertRegex(ran.err, r"out.c3d: not written: 1 of 4 values of hand_x\b[^\n]*NaN")
        file = C3dFile(self.folder / "out.c3d")
        self.assertEqual((file.points, file.channels, file.first, file.last), (1, 5, 1, 4))
        self.assertEqual((file.samples, file.rate), (1, 1000.0))
        for name, value in {"POINT:USED": [1], "POINT:FRAMES": [4], "POINT:RATE": [1000.0], "POINT:SCALE": [-1.0],
                            "TRIAL:ACTUAL_START_FIELD": [1, 0], "TRIAL:ACTUAL_END_FIELD": [4, 0], "ANALOG:USED": [5],
                            "ANALOG:RATE": [1000.0], "ANALOG:GEN_SCALE": [1.0], "ANALOG:SCALE": [1.0] * 5,
                            "ANALOG:OFFSET": [0] * 5, "EVENT:USED": [2], "EVENT:TIMES": [0.0, single(0.001), 1.0, 1.5],
                            "EVENT:ICON_IDS": [0, 0], "EVENT:GENERIC_FLAGS": [1, 1]}.items():
            self.assertEqual(file.numbers(name), value, name)
        self.assertEqual(file.parameters["EVENT:TIMES"][1], (2, 2))
        self.assertNotIn("POINT:LONG_FRAMES", file.parameters)
        for name, value in {"POINT:LABELS": ["hand"], "POINT:UNITS": ["mm"], "ANALOG:FORMAT": ["SIGNED"],
                            "ANALOG:LABELS": ["hand_x", "hand_y", "force_x", "force_y", "emg_biceps"],
                            "ANALOG:UNITS": ["m", "m", "N", "N", "V"], "EVENT:LABELS": ["onset", "Ende ä"],
                            "EVENT:CONTEXTS": ["", ""], "MANUFACTURER:SOFTWARE": ["mbk"]}.items():
            self.assertEqual(file.texts(name), value, name)
        self.assertEqual(len(file.texts("ANALOG:DESCRIPTIONS")), 5)
        for k, frame in enumerate(file.frames):
            values = [single(float(column[k])) for column in columns.values()]
            if k == 2:  # no x: the marker is invalid
                self.assertEqual(frame[:4], (0.0, 0.0, 0.0, -1.0))
                self.assertTrue(math.isnan(frame[4]))
                self.assertEqual(frame[5:], tuple(values[1:]))
            else:
                hand = [single(1000.0 * columns[name][k]) for name in ("hand_x_m", "hand_y_m")]
                self.assertEqual(frame, (*hand, 0.0, 0.0, *values))
        facts = self.fine("info", "--json", self.folder / "out.c3d").json
        self.assertEqual(facts["metadata"], {"participant": "7"})
        events = [(event["name"], event["value"]) for event in facts["events"]]
        self.assertEqual(events, [("onset", 3.0), ("Ende ä", -1.0)])

    def test_back_and_forth_the_recording_is_the_same(self):
        source = make_log().path
        self.convert(source)
        first = C3dFile(self.folder / "out.c3d")
        self.mbk("convert", self.folder / "out.c3d", self.folder / "back.h5")
        self.convert(self.folder / "back.h5")
        again = C3dFile(self.folder / "out.c3d")
        self.assertEqual([frame[4:] for frame in again.frames], [frame[4:] for frame in first.frames])  # the channels
        said, original = (self.fine("info", "--json", path).json for path in (self.folder / "back.h5", source))
        for key in ("samples", "events", "metadata"):
            self.assertEqual(said[key], original[key], key)
        self.assertAlmostEqual(said["rate_hz"], original["rate_hz"], places=6)
        units = [{c["name"]: c["unit"] for c in facts["channels"]} for facts in (said, original)]
        self.assertEqual(*units)

    def test_a_measurement_does_not_see_the_format(self):
        source = make_log().path
        self.convert(source)
        models = [self.fine("measure", "--json", path).json["model"] for path in (source, self.folder / "out.c3d")]
        for name in ("M", "B", "K"):
            self.assert_relative(models[1][name], models[0][name], 1e-4)

    def test_one_axis_has_no_marker(self):
        self.convert(self.csv({"position_rad": [0.1, 0.2, 0.3], "reaction_N.m": [1, 2, 4]}))
        file = C3dFile(self.folder / "out.c3d")
        self.assertEqual((file.points, file.texts("POINT:LABELS"), file.texts("ANALOG:UNITS")), (0, [], ["rad", "N.m"]))
        self.assertEqual(file.frames[2], (single(0.3), 4.0))

    def test_300_channels_and_70000_frames(self):
        self.convert(self.csv({f"emg_{k}_V": [k, -k] for k in range(300)}))
        file = C3dFile(self.folder / "out.c3d")
        self.assertEqual((file.channels, file.numbers("ANALOG:USED")), (300, [300]))
        self.assertEqual([file.parameters[f"ANALOG:{name}"][1][-1] for name in ("LABELS", "SCALE2")], [255, 45])
        labels = file.texts("ANALOG:LABELS")
        self.assertEqual({label: file.frames[1][k] for k, label in enumerate(labels)}, {f"emg_{k}": -k for k in range(300)})
        self.convert(self.csv({"position_m": range(70000), "reaction_N": range(70000)}))
        file = C3dFile(self.folder / "out.c3d")
        self.assertEqual((file.last, file.numbers("POINT:FRAMES"), file.numbers("POINT:LONG_FRAMES")), (65535, [65535], [70000.0]))
        self.assertEqual(file.numbers("TRIAL:ACTUAL_END_FIELD"), [70000 - 65536, 1])
        self.assertEqual((len(file.frames), file.frames[-1]), (70000, (69999.0, 69999.0)))

    def test_what_c3d_cannot_hold_is_refused(self):
        target = self.folder / "out.c3d"
        good = {"position_m": [0, 1, 2], "reaction_N": [1, 2, 3]}
        for columns, says in (({**good, "reaction_N": [1, 1e39, 3]}, ["reaction", "single precision", ".h5"]),
                              ({name: values[:1] for name, values in good.items()}, ["sample", ".h5"])):
            self.refused(BAD_DATA, "convert", self.csv(columns), target, says=says)
        uneven = self.file("in.csv", "time_s,position_m,reaction_N\n0,1,1\n0.1,2,2\n0.25,3,3\n0.3,4,4\n")
        self.refused(BAD_DATA, "convert", uneven, target, says=["even clock", ".h5"])
        unknown = self.file("in.csv", "clock,gaze\n0,1\n1,2\n")
        self.refused(BAD_DATA, "convert", unknown, target, says=["--channels", ".h5"])
        self.assertEqual(self.names(), ["in.csv"])

    def test_files_are_replaced_only_if_asked(self):
        target = self.file("there.c3d", "precious")
        self.refused(WRONG_USAGE, "convert", self.csv({"position_m": [0, 1], "reaction_N": [1, 2]}), target, says="--overwrite")
        self.assertEqual(target.read_text(), "precious")

    def test_a_trial_is_not_simulated_into_rounded_numbers(self):
        self.refused(WRONG_USAGE, "simulate", "relaxed_sinusoidal", "--out", self.folder / "a.c3d",
                     says=["single precision", ".h5", "mbk convert"])


class Outside(Case):
    def test_one_trial_in_three_formats_shows_the_same(self):
        folder = data_folder("c3d")
        listings = [self.fine("info", "--json", folder / f"Sample01_Eb015{kind}.c3d").json for kind in ("pr", "vr", "pi")]
        self.assertEqual(listings[0]["arrays"], listings[1]["arrays"])
        for real, integer in zip(listings[0]["arrays"], listings[2]["arrays"]):
            self.assertEqual(real["name"], integer["name"])
            self.assertAlmostEqual(real["maximum"], integer["maximum"], delta=0.05)  # half of POINT:SCALE

    def test_a_knee_that_acts_is_measured_and_flagged(self):
        path = data_folder("c3d") / "Sample35_isokinetic_EMG_angle_torque.c3d"
        result = run("measure", "--json", "--axes", "1", "--channels", "x=Angle,F=Torque", path).json
        self.assertEqual(result["units"]["K"], "N·m/rad")
        codes = {warning["code"] for warning in result["warnings"]}
        self.assertIn("damping-not-positive", codes)

    def test_the_emg_of_that_knee_explains_its_torque(self):
        path = data_folder("c3d") / "Sample35_isokinetic_EMG_angle_torque.c3d"
        asked = ("explore", "--axes", "1", "--only", "reflex", "--json", path,
                 "--channels", "x=Angle:deg,F=Torque:N.m,emg_medialis=1:uV,emg_lateralis=2:uV")
        alone, found = (self.fine(*asked, *more).json["parallel_cascade"] for more in ((), ("--muscles", "medialis,lateralis")))
        self.assertNotIn("emg", alone)
        self.assertEqual(alone["shares"], found["shares"])
        emg = found["emg"]
        self.assertTrue(emg["explains"], emg["why"])
        self.assertGreater(emg["shares"][0]["intrinsic_and_emg"]["VAF"], found["shares"][0]["intrinsic_alone"]["VAF"] + 3)
        slow = emg["coherence"][0]
        self.assertGreater(slow["motion_and_emg"][0], slow["motion"][0] + 0.1)
        medialis = emg["muscles"][0]
        self.assertEqual((medialis["channel"], medialis["unit"]), ("emg_medialis", "mean"))
        self.assertGreater(medialis["gain"][0]["interval95"][0], 0)  # the quadriceps makes torque of extension


if __name__ == "__main__":
    main()
