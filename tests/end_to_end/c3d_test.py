#!/usr/bin/env python3
"""C3D files: what mbk info shows of them, and a measurement of one."""

import math
import struct

from command import Case, data_folder, main, run

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
        self.assertLess(medialis["gain"][0]["interval95"][1], 0)  # the quadriceps extends: its torque opposes flexion


if __name__ == "__main__":
    main()
