#!/usr/bin/env python3
"""MCAP files and bags of ROS 1: what mbk info shows of them, a measurement of two topics, and MCAP of mbk 0.1."""

import pathlib
import subprocess
import unittest

import ros_file
from command import BAD_DATA, FINE, WRONG_USAGE, Case, data_folder, main, make_log, program, run, table_of

try:
    import rosbag
    from genpy import Time
except ImportError:
    rosbag = Time = None

START = 1_700_000_000 * 10**9
SENSOR_OPPOSITE = "x=hand_x,y=hand_y,Fx=-/ft.wrench.force.x,Fy=-/ft.wrench.force.y"


def nanoseconds(seconds):
    return START + round(seconds * 1e9)


class Ros(Case):
    def two_topics(self, log, turned=False, frame="base_link"):
        """The same log as a robot records it: poses at 1 kHz, and wrenches at 1 kHz that lie 0.2 ms behind them."""
        time, x, y, fx, fy = table_of(log)[:5]
        path = self.folder / "trial.mcap"
        file = ros_file.Mcap(path, {"/ft": "geometry_msgs/msg/WrenchStamped", "/pose": "geometry_msgs/msg/PoseStamped"})
        sign = -1.0 if turned else 1.0
        for k, at in enumerate(time[:-1]):
            file.add("/pose", nanoseconds(at), ros_file.pose(nanoseconds(at), x[k], y[k]))
            now = at + 0.0002
            late = [0.8 * one[k] + 0.2 * one[k + 1] for one in (fx, fy)]
            force = [sign * one for one in late]
            file.add("/ft", nanoseconds(now), ros_file.wrench(nanoseconds(now), *force, frame))
        file.close()
        return path

    def test_two_topics_are_measured_on_one_clock(self):
        log = make_log("sinusoidal", "--seed", "3")
        path = self.two_topics(log)
        ran = self.mbk("info", path)
        for words in ("/ft (geometry_msgs/msg/WrenchStamped",
                      "1000 Hz", "/pose.pose.position.x", "--clock"):
            self.assertIn(words, ran.out)
        self.refused(BAD_DATA, "measure", path, says=("'/ft' (1000 Hz)", "'/pose' (1000 Hz)", "--clock"))
        ran = self.mbk("info", "--clock", "/pose", path)
        self.assertRegex(ran.out, "clock .*'/pose'")

    def test_what_was_measured_is_what_the_log_says(self):
        log = make_log("sinusoidal", "--seed", "3")
        path = self.two_topics(log, turned=True)
        got = self.model("--clock", "/pose", "--channels", SENSOR_OPPOSITE, path)
        want = self.model(log.path)
        for symbol in ("M", "B", "K"):
            self.assert_relative(got[symbol], want[symbol], 0.02)
        ran = self.fine("measure", "--json", "--clock", "/pose", "--channels", SENSOR_OPPOSITE, path)
        self.assertNotIn("other-column", [one["code"] for one in ran.json["warnings"]])  # ".force.x" is no position

    def test_a_force_in_the_frame_of_the_tool_is_not_taken_as_one_in_that_of_the_base(self):
        path = self.two_topics(make_log("sinusoidal", "--seed", "3"), turned=True, frame="tool0")
        self.refused(BAD_DATA, "measure", path, says=("'force_x'", "'force_y'", "'tool0'", "'base_link'"))
        self.assertRegex(" ".join(self.mbk("info", path).out.split()), "note: .*'/ft'.* force_x")
        # Their axes are parallel, says the user.
        self.mbk("measure", "--clock", "/pose", "--channels", SENSOR_OPPOSITE, path)

    def test_stamps_that_were_not_set_are_left_out(self):
        path = self.folder / "late.mcap"
        file = ros_file.Mcap(path, {"/ft": "geometry_msgs/msg/WrenchStamped"})
        for k in range(50):
            file.add("/ft", nanoseconds(k / 1000), ros_file.wrench(nanoseconds(k / 1000) if k >= 5 else 0, k, -k))
        file.close()
        flat = " ".join(self.mbk("info", path).out.split())
        self.assertIn("samples 45, 0.044 s", flat)
        self.assertRegex(flat, "5 of 50 messages .*'/ft'")

    def model(self, *arguments):
        return self.mbk("measure", "--json", *arguments).json["model"]

    def test_two_sensors_are_named(self):
        path = self.folder / "two.mcap"
        file = ros_file.Mcap(path, {"/left": "geometry_msgs/msg/WrenchStamped", "/right": "geometry_msgs/msg/WrenchStamped"})
        for k in range(50):
            for topic in ("/left", "/right"):
                file.add(topic, nanoseconds(k / 1000), ros_file.wrench(nanoseconds(k / 1000), k, -k))
        file.close()
        ran = self.mbk("info", path)
        for name in ("'/left.wrench.force.x'", "'/right.wrench.force.x'"):
            self.assertIn(name, ran.out)
        ran = self.mbk("info", "--channels", "Fx=/right.wrench.force.x,Fy=/right.wrench.force.y", path)
        self.assertIn("force_x", ran.out)

    def test_the_start_and_the_frame_are_said(self):
        path = self.folder / "one.mcap"
        file = ros_file.Mcap(path, {"/ft": "geometry_msgs/msg/WrenchStamped"})
        for k in range(50):
            file.add("/ft", nanoseconds(k / 1000) + 10**6, ros_file.wrench(nanoseconds(k / 1000), k, -k))
        file.close()
        said = self.mbk("info", path).out
        flat = " ".join(said.split())
        for words in ("2023-11-14T22:13:20.000000000Z", "'tool0'", "header.stamp",
                      "--channels Fx=-/ft.wrench.force.x,Fy=-/ft.wrench.force.y"):
            self.assertIn(words, flat)

    def test_a_bag_of_ros1(self):
        samples = [(nanoseconds(k / 500), 0.5 * k, -0.25 * k) for k in range(100)]
        path = ros_file.write_bag(self.folder / "one.bag", "/ft", samples)
        self.expect_samples(path, samples)

    @unittest.skipIf(rosbag is None, "rosbag is not installed")
    def test_bags_that_ros_writes(self):
        samples = [(nanoseconds(k / 500), 0.5 * k, -0.25 * k) for k in range(100)]

        class WrenchStamped:  # pylint: disable=too-few-public-methods
            _type = "geometry_msgs/WrenchStamped"
            _md5sum = "d78d3cb249ce23087ade7e7d0c40cfa7"
            _full_text = ros_file.WRENCH_OF_ROS1

        for compression in ("none", "bz2", "lz4"):
            with self.subTest(compression):
                path = self.folder / f"{compression}.bag"
                with rosbag.Bag(str(path), "w", compression=compression, chunk_threshold=2000) as bag:
                    for time, x, y in samples:
                        data = ros_file.wrench_of_ros1(time, x, y)
                        raw = (WrenchStamped._type, data, WrenchStamped._md5sum, WrenchStamped)
                        bag.write("/ft", raw, Time(*divmod(time, 10**9)), raw=True)
                self.expect_samples(path, samples)

    def expect_samples(self, path, samples):
        self.assertIn("ROS 1 bag", self.mbk("info", path).out)
        self.mbk("convert", "--overwrite", path, self.folder / "out.csv")
        lines = (self.folder / "out.csv").read_text(encoding="utf-8").splitlines()
        rows = [line for line in lines if not line.startswith("#")]
        self.assertEqual(rows[0], "time_s,force_x_N,force_y_N")
        got = [tuple(map(float, row.split(","))) for row in rows[1:]]
        self.assertEqual(got, [((time - START) / 1e9, x, y) for time, x, y in samples])
        self.assertIn("# start: 2023-11-14T22:13:20.000000000Z", lines)

    def test_what_mbk_wrote_until_0_1_is_read(self):
        self.mbk("convert", pathlib.Path(__file__).with_name("written_by_0_1.mcap"), self.folder / "back.csv")
        self.assertEqual((self.folder / "back.csv").read_text(encoding="utf-8").splitlines()[1:], [
            "# condition: relaxed", "# start: 2024-05-06T07:08:09.000000000Z", "# event 0.002 1.5 go",
            "time_s,hand_x_m,hand_y_m,joint_1_rad,force_x_N,force_y_N,torque_1_N.m",
            "0,0.1,-0.2,0.5,0,0.25,0",
            "0.001,0.24285714285714285,-0.2,0.8333333333333333,1.5,0.25,-1",
            "0.002,0.3857142857142857,-0.2,1.1666666666666665,3,NaN,-2",
            "0.003,0.5285714285714286,-0.2,1.5,4.5,0.25,-3"])
        self.refused(WRONG_USAGE, "convert", self.folder / "back.csv", self.folder / "out.mcap", says=[".mcap", ".h5"])

    def test_a_large_file_takes_little_memory(self):
        path = self.folder / "large.mcap"
        file = ros_file.Mcap(path, {"/ft": "geometry_msgs/msg/WrenchStamped", "/camera": "sensor_msgs/msg/Image"})
        picture = ros_file.Cdr(START).add("I", 480, 640, 600_000).bytes() + bytes(600_000)
        for k in range(200):
            file.add("/ft", nanoseconds(k / 1000), ros_file.wrench(nanoseconds(k / 1000), k, -k))
            file.add("/camera", nanoseconds(k / 1000), picture)
        file.close()
        self.assertGreater(path.stat().st_size, 100 << 20)
        ran = subprocess.run(["/bin/bash", "-c", 'ulimit -v 700000; exec "$0" info "$1"', program("MBK"), str(path)],
                             capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(ran.returncode, FINE, ran.stderr)
        self.assertIn("/camera.data", ran.stdout)

    def test_recordings_of_others(self):
        folder = data_folder("mcap")
        ran = run("info", folder / "cdr_test_0.mcap")
        self.assertIn("/test_topic (test_msgs/msg/BasicTypes, 3 messages", " ".join(ran.out.split()))
        ran = run("info", folder / "talker.mcap")
        self.assertEqual(ran.code, FINE, ran)


if __name__ == "__main__":
    main()
