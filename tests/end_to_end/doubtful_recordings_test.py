#!/usr/bin/env python3
"""What a file says and cannot mean: clocks in other units, counters that wrap, signals that are held or lost. Each is
right, corrected and reported, or refused with the cure, by every command that reads."""

import math
import random

from command import BAD_DATA, FINE, NOT_USABLE, Case, main, make_log, run, table_of

RATE = 1000
SAMPLES = 40 * RATE
M, B, K = 0.02, 0.5, 8.0  # kg·m², N·m·s/rad, N·m/rad of a wrist
LINES = (0.5, 1.1, 1.7, 2.3, 3.1, 4.3)


def wrist(noise=0.01, seed=1):
    """time, angle and torque of a wrist that is moved by a multisine."""
    noisy = random.Random(seed)
    phases = [noisy.uniform(0, 6.3) for _ in LINES]
    time, angle, torque = [], [], []
    for i in range(SAMPLES):
        t = i / RATE
        x = v = a = 0.0
        for line, phase in zip(LINES, phases):
            w = 2 * math.pi * line
            x += 0.03 * math.sin(w * t + phase)
            v += 0.03 * w * math.cos(w * t + phase)
            a -= 0.03 * w * w * math.sin(w * t + phase)
        time.append(t)
        angle.append(x + noisy.gauss(0, 1e-5))
        torque.append(-(M * a + B * v + K * x) + noisy.gauss(0, noise))
    return time, angle, torque


def held(values, samples, phase=0):
    return [values[max(0, (i - phase) // samples * samples + phase)] for i in range(len(values))]


class Doubtful(Case):
    @classmethod
    def setUpClass(cls):
        cls.time, cls.angle, cls.torque = wrist()

    def table(self, time=None, angle=None, torque=None, names="time,position,reaction", name="wrist.csv"):
        rows = zip(time or self.time, angle or self.angle, torque or self.torque)
        text = names + "\n" + "".join(f"{t!r},{x!r},{f!r}\n" for t, x, f in rows)
        return self.file(name, text)

    CHANNELS = ("--axes", "1", "--channels", "x=position:rad,F=reaction:N.m")

    def commands(self, file):
        """Every command that reads such a recording."""
        yield ("info", file)
        yield ("measure", file, *self.CHANNELS)
        yield ("identify", file, *self.CHANNELS)
        yield ("passivity", file, *self.CHANNELS)
        yield ("explore", file, *self.CHANNELS)
        yield ("movement", file, *self.CHANNELS)
        yield ("tf", file, "--input", "reaction", "--output", "position", "--poles", "2", "--zeros", "0")
        yield ("convert", file, self.folder / "out.h5", *self.CHANNELS)
        yield ("sensor", "delay", file, *self.CHANNELS, "--mass", "1")

    def wrong_unit(self, factor, unit):
        file = self.table(time=[round(1e6 * t) * factor / 1e6 for t in self.time])
        for command in self.commands(file):
            ran = run(*command)
            with self.subTest(f"{unit}: {command[0]}"):
                self.assertEqual(ran.code, BAD_DATA, ran)
                self.assertIn(f"time=time:{unit}", ran.out + ran.err)  # info lists it among its findings
        ran = self.mbk("measure", "--json", "--axes", "1", "--channels",
                       f"time=time:{unit},x=position:rad,F=reaction:N.m", file)
        self.assertAlmostEqual(ran.json["model"]["B"][0][0], B, delta=0.02 * B)

    def test_a_clock_in_milliseconds_is_refused_by_every_command(self):
        self.wrong_unit(1000, "ms")

    def test_a_clock_in_microseconds_is_refused_by_every_command(self):
        self.wrong_unit(1000000, "us")

    def test_a_map_of_the_time_alone_leaves_the_rest_to_its_names(self):
        file = self.table(time=[1000 * t for t in self.time], names="time,position_rad,reaction_Nm")
        ran = self.mbk("measure", "--json", "--channels", "time=time:ms", file)
        self.assertAlmostEqual(ran.json["model"]["B"][0][0], B, delta=0.02 * B)

    def test_a_recording_of_one_sample_a_second_is_refused_and_believed_where_it_is_said(self):
        file = self.file("slow.csv", "time,position_rad,reaction_Nm\n" +
                         "".join(f"{i},{math.sin(i)!r},{math.cos(i)!r}\n" for i in range(60)))
        self.mbk("explore", file, code=BAD_DATA)
        ran = run("explore", file, "--channels", "time=time:s")
        self.assertIn(ran.code, (FINE, BAD_DATA, NOT_USABLE), ran)

    def test_counters_that_wrap_run_on(self):
        ticks = [round(1e6 * t) for t in self.time]
        unsigned = [(2**32 - 5_000_000 + tick) % 2**32 for tick in ticks]
        signed = [(2**32 - 5_000_000 + tick) % 2**32 - 2**31 for tick in ticks]
        for name, time in (("unsigned", unsigned), ("signed", signed)):
            with self.subTest(name):
                file = self.table(time=time, names="time_us,position_rad,reaction_Nm")
                result = self.mbk("measure", "--json", file).json
                self.assertAlmostEqual(result["inputs"][0]["duration_s"], SAMPLES / RATE, delta=0.01)
                self.assertAlmostEqual(result["model"]["B"][0][0], B, delta=0.02 * B)
                self.assertIn("counter", " ".join(result["notes"]))

    def test_a_rate_that_is_said_turns_a_count_of_samples_into_time(self):
        counted = self.table(time=range(len(self.time)))
        self.assertIn("--rate", self.mbk("measure", counted, code=BAD_DATA).err)
        coarse = self.table(time=[round(t, 2) for t in self.time], name="coarse.csv")
        self.assertIn("--rate", self.mbk("measure", coarse, code=BAD_DATA).err)
        for file in (counted, coarse):
            result = self.mbk("measure", "--json", "--rate", RATE, file).json
            self.assertAlmostEqual(result["model"]["B"][0][0], B, delta=0.02 * B)

    def test_the_log_of_libfranka_is_known_by_its_header(self):
        joints = range(7)
        names = ["time", "success_rate", *(f"state.q[{k}]" for k in joints), *(f"state.tau_J[{k}]" for k in joints),
                 *(f"state.O_T_EE[{k}]" for k in range(16)), *(f"state.O_F_ext_hat_K[{k}]" for k in range(6))]
        lines = [",".join(names)]
        for i in range(0, 3000):
            pose = [0.0] * 16
            pose[12:15] = [0.3 + self.angle[i], 0.1, 0.5]
            row = [123456 + i, 1.0, *(0.1 * k + self.angle[i] for k in joints), *(self.torque[i] for _ in joints), *pose,
                   *(self.torque[i] for _ in range(6))]
            lines.append(",".join(map(repr, row)))
        file = self.file("franka.csv", "\n".join(lines) + "\n")
        shown = self.fine("info", "--json", file).json
        self.assertAlmostEqual(shown["rate_hz"], 1000, delta=1)
        channels = {channel["name"]: channel for channel in shown["channels"]}
        self.assertIn("joint_7", channels)
        self.assertIn("torque_1", channels)
        self.assertAlmostEqual(channels["hand_x"]["maximum"], 0.3 + max(self.angle[:3000]))
        # What libfranka calls external force is what the robot exerts on its environment.
        self.assertAlmostEqual(channels["force_x"]["maximum"], -min(self.torque[:3000]))
        self.assertNotIn("hand_z", channels)
        shown = self.fine("info", "--json", "--axes", 3, file).json
        channels = {channel["name"]: channel for channel in shown["channels"]}
        self.assertAlmostEqual(channels["hand_z"]["maximum"], 0.5)
        self.assertAlmostEqual(channels["force_z"]["maximum"], -min(self.torque[:3000]))

    def test_a_column_z_is_ignored_until_it_is_asked_for(self):
        names, units = "time,x,F,z,Fz,az", "s,rad,N.m,V,deg,V"
        rows = [f"{0.001 * i},{self.angle[i]!r},{self.torque[i]!r},1,2,{i}" for i in range(3000)]
        file = self.file("z.csv", "\n".join([names, units, *rows]) + "\n")
        shown = self.fine("info", "--json", file).json
        self.assertEqual([channel["name"] for channel in shown["channels"]], ["position", "reaction"])

    def damping(self, file):
        result = self.mbk("measure", "--json", file).json
        return result["model"]["B"][0][0], result["standard_error"]["B"][0][0], result

    def test_a_force_or_position_that_is_held_is_taken_at_its_own_samples(self):
        for name, samples in (("angle", 8), ("torque", 20), ("torque", 4), ("angle", 20)):
            with self.subTest(f"{name} every {samples}"):
                values = held(getattr(self, name), samples)
                file = self.table(**{name: values}, names="time,position_rad,reaction_Nm")
                found, error, result = self.damping(file)
                self.assertAlmostEqual(found, B, delta=max(0.02 * B, 3 * error))
                self.assertIn("held-signal", [warning["code"] for warning in result["warnings"]])
                shown = self.mbk("info", "--json", file).json
                channel = "position" if name == "angle" else "reaction"
                facts = next(one for one in shown["channels"] if one["name"] == channel)
                self.assertAlmostEqual(facts["update_hz"], RATE / samples, delta=0.01 * RATE / samples)
                self.assertEqual(facts["stale"]["kind"], "held")

    def test_samples_that_are_zero_or_repeat_are_missing(self):
        lost = random.Random(3)
        zeros = [0.0 if lost.random() < 0.1 else f for f in self.torque]
        repeats = list(self.torque)
        for i in range(1, len(repeats)):
            if lost.random() < 0.3:
                repeats[i] = repeats[i - 1]
        for name, torque in (("zeros", zeros), ("repeats", repeats)):
            with self.subTest(name):
                found, error, result = self.damping(self.table(torque=torque, names="time,position_rad,reaction_Nm"))
                self.assertAlmostEqual(found, B, delta=max(0.02 * B, 3 * error))
                self.assertIn("missing-samples", [warning["code"] for warning in result["warnings"]])

    def test_a_slow_channel_that_is_filled_with_zeros_is_taken_at_its_own_samples(self):
        for every in (2, 5):
            torque = [f if i % every == 0 else 0.0 for i, f in enumerate(self.torque)]
            found, error, result = self.damping(self.table(torque=torque, names="time,position_rad,reaction_Nm"))
            self.assertAlmostEqual(found, B, delta=max(0.02 * B, 3 * error))
            self.assertIn("missing-samples", [warning["code"] for warning in result["warnings"]])

    def test_long_freezes_are_refused_with_their_place(self):
        frozen = list(self.torque)
        for begin in range(500, len(frozen) - 200, 1000):
            frozen[begin:begin + 100] = [frozen[begin]] * 100
        file = self.table(torque=frozen, names="time,position_rad,reaction_Nm")
        ran = self.mbk("measure", file, code=BAD_DATA)
        self.assertIn("--from", ran.err)
        stale = [one["name"] for one in self.mbk("info", "--json", file).json["channels"] if "stale" in one]
        self.assertEqual(len(stale), 1, stale)

    def test_convert_copies_a_held_signal_as_it_is(self):
        file = self.table(torque=held(self.torque, 20), names="time,position_rad,reaction_Nm")
        self.mbk("convert", file, self.folder / "copy.h5")
        self.mbk("convert", self.folder / "copy.h5", self.folder / "copy.csv")
        numbers = [[[float(cell) for cell in line.split(",")] for line in one.read_text().splitlines()
                    if line[0] in "-.0123456789"] for one in (file, self.folder / "copy.csv")]
        self.assertEqual(*numbers)

    def test_an_honest_encoder_that_also_rests_is_not_accused(self):
        columns = list(table_of(make_log(), 62000))
        for k in (1, 2):  # the hand, in steps of a coarse encoder
            columns[k] = [round(value / 5e-5) * 5e-5 for value in columns[k]]
        text = "time,x,y,Fx,Fy,xr,yr\n" + "".join(",".join(map(repr, row)) + "\n" for row in zip(*columns))
        result = self.mbk("measure", "--json", self.file("arm.csv", text)).json
        codes = [warning["code"] for warning in result["warnings"]]
        self.assertNotIn("held-signal", codes)
        self.assertNotIn("missing-samples", codes)

    def test_simulated_robots_that_rest_stick_and_flicker_are_not_accused(self):
        for scenario, trial in (("relaxed_ramp_and_hold", ()), ("one_axis_random_binary", ("--trial", "trial_4")),
                                ("rig_table_3_1", ("--trial", "config_6")), ("rig_springs_table_3_1", ("--trial", "config_6")),
                                ("relaxed_underdamped", ())):
            with self.subTest(scenario):
                self.mbk("simulate", scenario, *trial, "--quiet", "--out", self.folder / f"{scenario}.h5")
                for file in self.folder.glob(f"{scenario}*.h5"):
                    for channel in self.mbk("info", "--json", file).json["channels"]:
                        self.assertNotIn("stale", channel)


if __name__ == "__main__":
    main()
