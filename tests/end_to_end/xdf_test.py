#!/usr/bin/env python3
"""XDF files of Lab Streaming Layer: what mbk info shows of them, and measurements of streams with clocks of their own."""

import gzip
import math
import struct

from command import Case, data_folder, main, run

INERTIA, DAMPING, STIFFNESS = 0.02, 0.5, 40.0
LINES = [(0.02, 2 * math.pi * hz, phase) for hz, phase in ((0.7, 0.1), (2.1, 1.3), (4.3, 2.9), (7.9, 0.7))]
BOUNDARY = bytes.fromhex("43A546DCCBF5410FB30ED5467383CBE4")


def angle(t):
    return sum(a * math.sin(w * t + p) for a, w, p in LINES)


def torque(t):
    v = sum(a * w * math.cos(w * t + p) for a, w, p in LINES)
    acceleration = sum(-a * w * w * math.sin(w * t + p) for a, w, p in LINES)
    return -(INERTIA * acceleration + DAMPING * v + STIFFNESS * angle(t))


def chunk(tag, content):
    return struct.pack("<BIH", 4, len(content) + 2, tag) + content


def header(number, name, labels, rate, form="double64"):
    channels = "".join(f"<channel><label>{label}</label><unit>{unit}</unit></channel>" for label, unit in labels)
    xml = (f"<?xml version='1.0'?><info><name>{name}</name><type>Force</type><channel_count>{len(labels)}</channel_count>"
           f"<nominal_srate>{rate}</nominal_srate><channel_format>{form}</channel_format>"
           f"<desc><channels>{channels}</channels></desc></info>")
    return chunk(2, struct.pack("<I", number) + xml.encode())


def samples(number, stamps, values):
    content = struct.pack("<IBI", number, 4, len(stamps))
    for stamp, value in zip(stamps, values):
        content += struct.pack("<Bdd", 8, stamp, value)
    return chunk(3, content)


def markers(number, stamps, texts):
    content = struct.pack("<IBI", number, 4, len(stamps))
    for stamp, text in zip(stamps, texts):
        content += struct.pack("<BdBB", 8, stamp, 1, len(text)) + text.encode()
    return chunk(3, content)


def two_streams(seconds=20.0, force_clock=37.25, drift=2e-5, step=0.0, swapped=()):
    """An arm at 1000 Hz, a cell at 500 Hz whose clock is elsewhere and runs fast, and markers. The clock of the cell is
    set by `step` after half of the time; seconds of the arm that are `swapped` come one after the next."""
    parts = [b"XDF:", chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>"),
             header(1, "Arm", [("angle", "radians")], 1000), header(2, "Cell", [("torque", "N.m")], 500),
             header(3, "Task", [("marker", "")], 0, "string")]
    begin = 100.0
    on_cell = lambda t: (t - force_clock) * (1.0 + drift) + (step if t >= begin + seconds / 2 else 0.0)
    jitter = lambda k: 2e-4 * math.sin(12.9898 * k)
    for second in range(int(seconds)):
        arm_second = second + (1 if second in swapped else -1 if second - 1 in swapped else 0)
        arm = [begin + arm_second + k / 1000 for k in range(1000)]
        cell = [begin + second + 0.0007 + k / 500 for k in range(500)]
        parts.append(samples(1, [t + jitter(k) for k, t in enumerate(arm)], [angle(t) for t in arm]))
        parts.append(samples(2, [on_cell(t) + jitter(k) for k, t in enumerate(cell)], [torque(t) for t in cell]))
        t = begin + second + 0.5
        parts.append(chunk(4, struct.pack("<Idd", 1, t, 0.0)))
        parts.append(chunk(4, struct.pack("<Idd", 2, on_cell(t), t - on_cell(t))))
        parts.append(chunk(4, struct.pack("<Idd", 3, t, 0.0)))
        if second % 5 == 0:
            parts += [markers(3, [t], ["push"]), chunk(5, BOUNDARY)]
    return b"".join(parts)


CHANNELS = ("--axes", "1", "--channels", "x=Arm.angle,F=Cell.torque")


class Xdf(Case):
    def test_info_shows_the_streams_and_what_was_corrected(self):
        path = self.file("arm.xdf", two_streams())
        ran = self.fine("info", path)
        for line in ("Arm.angle", "Cell.torque", "Cell.raw_time"):
            self.assertIn(line, ran.out)
        notes = " ".join(self.fine("info", "--json", path).json["notes"])
        for facts in (r"'Arm' \(Force\): 20000 samples .*\b1 channel\b.*1000 Hz.*1000 Hz", r"'Cell': .*clock.*\+37\.24",
                      "-20 µs/s", r"'Arm': .*0\.201 ms", "'Task' .*4 events"):
            self.assertRegex(notes, facts)

    def test_streams_of_two_clocks_are_measured_on_the_one_that_is_named(self):
        path = self.file("arm.xdf", two_streams())
        self.bad_data(path, *CHANNELS, command="measure", says=("'Arm' (1000 Hz)", "'Cell' (500 Hz)", "--clock 'Arm'"))
        result = run("measure", "--json", *CHANNELS, "--clock", "Arm", path).json
        self.assert_relative(result["model"]["K"], [[STIFFNESS]], 0.01)
        self.assert_relative(result["model"]["B"], [[DAMPING]], 0.02)
        self.assert_relative(result["model"]["M"], [[INERTIA]], 0.02)
        info = self.fine("info", "--json", *CHANNELS, "--clock", "Arm", path).json
        self.assertRegex(" ".join(info["notes"]), "clock .*'Arm'")
        written = run("convert", *CHANNELS, "--clock", "Arm", path, self.folder / "arm.h5")
        self.assertEqual(written.code, 0)
        self.assertIn("2 channels, 4 events", written.out)

    def test_a_step_of_the_senders_clock_is_taken_out(self):
        for step in (0.02, -0.02, 0.8, 3.0):
            path = self.file("arm.xdf", two_streams(step=step))
            result = run("measure", "--json", *CHANNELS, "--clock", "Arm", path).json
            self.assert_relative(result["model"]["K"], [[STIFFNESS]], 0.01)
            self.assert_relative(result["model"]["B"], [[DAMPING]], 0.02)
            self.assert_relative(result["model"]["M"], [[INERTIA]], 0.02)
            self.assertRegex(run("measure", *CHANNELS, "--clock", "Arm", path).out, r"'Cell': .*clock.*\d m?s\b")

    def test_samples_out_of_order_are_sorted(self):
        ordered, swapped = self.file("ordered.xdf", two_streams()), self.file("swapped.xdf", two_streams(swapped=(7,)))
        tables = []
        for path in (ordered, swapped):
            self.assertEqual(run("convert", "--axes", "1", "--channels", "x=Arm.angle", path, self.folder / "x.csv").code, 0)
            tables.append([line.split(",")[1] for line in (self.folder / "x.csv").read_text().splitlines()
                           if not line.startswith("#")])
            (self.folder / "x.csv").unlink()
        self.assertEqual(*tables)
        self.assertIn("2000 of 20000 samples",
                      " ".join(self.fine("info", "--json", swapped).json["notes"]))

    def test_raw_stamps_can_be_taken_instead(self):
        path = self.file("arm.xdf", two_streams())
        one = ("info", "--json", "--axes", "1")
        even = self.fine(*one, "--channels", "x=Arm.angle", path).json
        raw = self.fine(*one, "--channels", "time=Arm.raw_time,x=Arm.angle", path).json
        self.assertLess(even["interval_s"]["standard_deviation"], 1e-9)
        self.assertGreater(raw["interval_s"]["standard_deviation"], 1e-5)
        self.refused(2, "info", "--axes", "1", "--channels", "time=Arm.raw_time,x=Arm.angle,F=Cell.torque", "--clock",
                     "Arm", path, says="time")

    def test_packed_files_are_the_same(self):
        bare = self.file("arm.xdf", two_streams(seconds=3))
        packed = self.file("arm.xdfz", gzip.compress(bare.read_bytes()))
        listings = [self.fine("info", "--json", path).json for path in (bare, packed)]
        self.assertEqual(listings[0]["arrays"], listings[1]["arrays"])
        self.assertEqual(listings[0]["notes"], listings[1]["notes"])
        self.bad_data(self.file("text.gz", gzip.compress(b"t,x\n0,1\n")), command="info", says=("gunzip",))
        self.bad_data(self.file("cut.xdfz", packed.read_bytes()[:-9]), command="info", says="gzip")

    def test_behind_damage_the_file_is_read_on(self):
        whole = bytearray(two_streams())
        whole[200_000:200_400] = b"\xff" * 400
        notes = " ".join(self.fine("info", "--json", self.file("damaged.xdf", bytes(whole))).json["notes"])
        self.assertRegex(notes, r"\d bytes\b.*boundary")
        for cut in (3, 4, 40, 70):
            self.bad_data(self.file("cut.xdf", bytes(whole[:cut])), command="info")


class Outside(Case):
    def test_a_recording_in_which_a_clock_was_reset(self):
        path = data_folder("xdf") / "clock_resets.xdf"
        listing = self.fine("info", "--json", path).json
        self.assertEqual(listing["arrays"][0]["rows"], 27815)
        notes = " ".join(listing["notes"])
        self.assertIn("clock was reset", notes)
        self.assertRegex(notes, "'MyMarkerStream' .*175 events")


if __name__ == "__main__":
    main()
