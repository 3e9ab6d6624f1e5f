#!/usr/bin/env python3
"""mbk robot force and mbk measure --force-source: the force at the hand without a force sensor."""

import csv
import functools
import json
import math
import pathlib
import shutil

from command import BAD_DATA, FINE, NOT_USABLE, WRONG_USAGE, Case, folder_of_logs, main, run

ROBOTS = pathlib.Path(__file__).parents[2] / "examples/robots"
STIFFNESS = [[421.57, -18.87], [-18.87, 213.35]]  # of the rig's trial K1_M1 [N/m]
MASS = 0.539  # [kg]
SENSOR = 0.05  # N: what is left of both forces' noise
CHANNELS = "time=time,q1=joint_1,q2=joint_2,Fx=force_x,Fy=force_y,xr=reference_x,yr=reference_y"
LINKS, MASSES, CENTRES = (0.2, 0.3), (0.5234602302310271, 0.6255677234174437), (0.2, 0.25569305436052964)


@functools.lru_cache(maxsize=None)
def made(name, *arguments):
    """What a command writes to a file of that name, once."""
    path = folder_of_logs() / name
    ran = run(*arguments, "--out", path)
    assert ran.code == FINE, ran
    return path


def rig():
    written = made("rig.h5", "simulate", "rig_table_5_1", "--trial", "K1_M1", "--quiet")
    return written.with_stem("rig_K1_M1")  # a scenario of several trials puts their names into the file's


def robot():
    free = made("free.h5", "simulate", "free_motion", "--quiet")
    return made("robot.json", "robot", "identify", free, "--json")


def pendulum_csv(force, q2=0.9, swing=0.01, seconds=20.0, rate=200.0):
    """The double pendulum of examples/robots, slowly swinging about q1 = 0.4 while `force` pulls at its hand."""
    g, rows = 9.81, ["time,joint_1,joint_2,torque_1,torque_2"]
    for i in range(int(seconds * rate)):
        t = i / rate
        one = 0.4 + swing * math.sin(2 * math.pi * 0.2 * t)
        two = q2 + swing * math.sin(2 * math.pi * 0.3 * t)
        both = one + two
        J = ((LINKS[0] * math.cos(one) + LINKS[1] * math.cos(both), LINKS[1] * math.cos(both)),
             (LINKS[0] * math.sin(one) + LINKS[1] * math.sin(both), LINKS[1] * math.sin(both)))
        lower = g * MASSES[1] * CENTRES[1] * math.sin(both)
        weight = (g * (MASSES[0] * CENTRES[0] + MASSES[1] * LINKS[0]) * math.sin(one) + lower, lower)
        torque = [weight[k] - J[0][k] * force[0] - J[1][k] * force[1] for k in range(2)]
        rows.append(",".join(map(repr, (t, one, two, *torque))))
    return "\n".join(rows) + "\n"


class Force(Case):
    def force(self, *arguments):
        return self.fine("robot", "force", *arguments, "--json").json

    def pendulum(self):
        """A description of examples/robots/double_pendulum.urdf without friction."""
        shutil.copyfile(ROBOTS / "double_pendulum.urdf", self.folder / "double_pendulum.urdf")
        return self.file("pendulum.toml", "[robot]\nkind = \"urdf\"\nfile = \"double_pendulum.urdf\"\n"
                                          "hand_axes = [\"x\", \"z\"]\n\n[drive]\nterms = []\n")

    def test_agrees_with_the_sensor(self):
        found = self.force(rig(), "--robot", robot())
        self.assertEqual((found["schema"], found["force_source"], found["lag_s"]), ("mbk.force/1", "virtual", 0))
        self.assertLess(max(found["force_comparison"]["all"]["RMSE"]), SENSOR)
        self.assertGreater(min(found["RMS"]), 1.0)
        self.assertGreater(min(found["standard_error_RMS"]), 0)
        self.assertLess(max(found["standard_error_RMS"]), SENSOR)

    def test_text_says_what_json_says(self):
        text = self.fine("robot", "force", rig(), "--robot", robot()).out
        self.assert_lines_fit(text)
        x = self.force(rig(), "--robot", robot())["RMS"][0]
        for words in (f"Fx  {x:.3g} N", "virtual sensor", "force sensor"):
            self.assertIn(words, text)

    def test_writes_a_recording_that_measures_the_same(self):
        path = self.folder / "force.h5"
        self.fine("robot", "force", rig(), "--robot", robot(), "--out", path)
        facts = self.fine("info", path).out
        for words in ("force_x", "force_error_x", "sensor_force_x"):
            self.assertIn(words, facts)
        on_its_way = self.fine("measure", rig(), "--force-source", "virtual", "--robot", robot(), "--json").json
        afterwards = self.fine("measure", path, "--json").json
        # Both ends of the window lie elsewhere, and the truth is as far away as either.
        self.assert_relative(afterwards["model"]["K"], on_its_way["model"]["K"], 1e-4)
        self.assert_relative(afterwards["model"]["K"], STIFFNESS, 1e-3)

    def test_the_csv_holds_both_forces(self):
        path = self.folder / "force.csv"
        self.fine("robot", "force", rig(), "--robot", robot(), "--from", "10", "--to", "12", "--out", path)
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        rows = list(csv.DictReader(lines))
        self.assertTrue(1500 < len(rows) <= 2001, len(rows))  # two seconds less what the smoothing takes
        error = [float(row["force_x_N"]) - float(row["sensor_force_x_N"]) for row in rows]
        self.assertLess(math.sqrt(sum(e * e for e in error) / len(error)), SENSOR)
        self.assertTrue(all(float(row["force_error_x_N"]) > 0 for row in rows))

    def test_the_observer_comes_late(self):
        found = self.force(rig(), "--robot", robot(), "--force-source", "observer")
        self.assertEqual(found["force_source"], "observer")
        self.assertGreater(found["lag_s"], 0.005)
        self.assertAlmostEqual(found["force_comparison"]["lag_s"][0], found["lag_s"], delta=0.5 * found["lag_s"])
        self.assertNotIn("standard_error_RMS", found)
        exact = self.force(rig(), "--robot", robot())
        self.assertGreater(found["force_comparison"]["all"]["RMSE"][0], 5 * exact["force_comparison"]["all"]["RMSE"][0])

    def test_a_force_that_no_sensor_recorded(self):
        bare = self.force(rig(), "--robot", robot(), "--channels",
                          "time=time,q1=joint_1,q2=joint_2,tau1=torque_1,tau2=torque_2")
        self.assertNotIn("force_comparison", bare)
        self.assert_relative(bare["RMS"], self.force(rig(), "--robot", robot())["RMS"], 1e-9)

    def test_a_description_in_toml_is_a_robot_too(self):
        stated = self.file("robot.toml", "[robot]\nkind = \"planar\"\ncoulomb_Nm = [0.03, 0.03]\n\n"
                                         "[drive]\nterms = [\"viscous\", \"coulomb\"]\nmotor_delay_ms = 0.5\n")
        found = self.force(rig(), "--robot", stated)
        self.assertLess(max(found["force_comparison"]["all"]["RMSE"]), SENSOR)
        self.assertNotIn("standard_error_RMS", found)  # nobody knows how sure those numbers are

    def test_a_robot_that_is_not_usable_gives_no_force(self):
        free = made("free.h5", "simulate", "free_motion", "--quiet")
        bad = self.folder / "turned.json"
        self.mbk("robot", "identify", free, "--json", "--out", bad, "--channels",
                 "time=time,q1=joint_1,q2=joint_2,tau1=-torque_1,tau2=-torque_2", code=NOT_USABLE)
        out = self.folder / "force.h5"
        for command in (("robot", "force", rig(), "--out", out),
                        ("measure", rig(), "--force-source", "virtual")):
            self.refused(NOT_USABLE, *command, "--robot", bad,
                         says=["turned.json", "not usable", "inertia-not-positive", "identify the robot again"])
        self.assertFalse(out.exists())

    def test_without_a_robot_it_is_the_published_one(self):
        published = self.file("robot.toml", "[robot]\nkind = \"planar\"\n\n[drive]\nterms = [\"viscous\"]\n")
        self.assertEqual(self.force(rig())["RMS"], self.force(rig(), "--robot", published)["RMS"])
        # Its table has no dry friction, and this robot has.
        self.assertGreater(max(self.force(rig())["force_comparison"]["all"]["RMSE"]), 2 * SENSOR)

    def test_a_urdf_is_a_robot_too(self):
        recording = self.file("pendulum.csv", pendulum_csv((1.5, -2.0)))
        found = self.force(recording, "--robot", self.pendulum())
        for axis, size in enumerate((1.5, 2.0)):
            self.assertAlmostEqual(found["RMS"][axis], size, delta=0.02)  # N: inertia of a swing that was left out

    def test_a_stretched_arm_is_refused_with_the_time(self):
        recording = self.file("stretched.csv", pendulum_csv((0.0, 0.0), q2=0.0))
        ran = self.refused(BAD_DATA, "robot", "force", recording, "--robot", self.pendulum(),
                           says=["singular", "sample"])
        self.assertRegex(ran.err, r"\d s\)")
        self.assertIn("stretched.csv", ran.err)

    def test_torques_in_another_unit_are_refused(self):
        for factor, says in (("*1000", "N·m"), (":N.mm", "unit")):
            with self.subTest(factor):
                self.refused(BAD_DATA, "robot", "force", rig(), "--robot", robot(), "--channels",
                             f"{CHANNELS},tau1=torque_1{factor},tau2=torque_2{factor}", says=[says, "--channels"])

    def test_angles_in_degrees_cross_the_limits_of_the_joints(self):
        in_degrees = CHANNELS.replace("joint_1", "joint_1*57.29578") + ",tau1=torque_1,tau2=torque_2"
        self.refused(BAD_DATA, "robot", "force", rig(), "--robot", robot(), "--channels", in_degrees,
                     says=["sample 1 ", "θ₁", "limit"])

    def test_a_recording_without_joints_is_refused(self):
        ankle = made("ankle.h5", "simulate", "ankle_reflex", "--quiet")
        self.refused(BAD_DATA, "robot", "force", ankle, "--robot", robot(), says=["'joint_1'", "position"])
        no_torque = CHANNELS + ",tau1=torque_1"
        self.refused(BAD_DATA, "robot", "force", rig(), "--robot", robot(), "--channels", no_torque,
                     says=["'torque_2'", "--channels"])

    def test_usage(self):
        self.refused(WRONG_USAGE, "robot", "force", rig(), rig(), "--robot", robot(), says="--parts")
        self.refused(WRONG_USAGE, "robot", "force", rig(), "--force-source", "sensor",
                     says=["--force-source", "'sensor'"])
        self.refused(WRONG_USAGE, "robot", "force", rig(), "--robot", robot(), "--out", self.folder / "force.txt",
                     says="'.txt'")
        for option in ("--split", "--every"):  # of fits, which it does not make
            self.refused(WRONG_USAGE, "robot", "force", rig(), option, "20", says=option)

    def test_nothing_is_overwritten_unasked(self):
        kept = self.file("kept.csv", "precious")
        self.refused(WRONG_USAGE, "robot", "force", rig(), "--robot", robot(), "--out", kept, says="--overwrite")
        self.assertEqual(kept.read_text(encoding="utf-8"), "precious")


class Measure(Case):
    def measure(self, *options):
        return self.fine("measure", rig(), "--json", "--force-source", *options).json

    def test_the_virtual_force_gives_what_the_sensor_gives(self):
        found = self.measure("virtual", "--robot", robot())
        for name, truth, tolerance in (("K", STIFFNESS, 1e-3), ("M", [[MASS, 0], [0, MASS]], 5e-3)):
            self.assert_relative(found["model"][name], truth, tolerance)
        self.assertIn("virtual", found["preparation"][0]["force_source"])
        self.assertGreater(min(found["force_comparison"]["VAF"]), 99.9)
        self.assertLess(max(found["force_comparison"]["all"]["RMSE"]), SENSOR)

    def test_the_robot_is_part_of_the_uncertainty(self):
        found = self.measure("virtual", "--robot", robot())
        for name in ("M", "B", "K"):
            for i in range(2):
                for j in range(2):
                    of_robot = found["standard_error_of_robot"][name][i][j]
                    self.assertTrue(0 < of_robot < found["standard_error"][name][i][j], (name, i, j))

    def test_a_robot_that_is_less_sure_widens_them(self):
        stored = json.loads(robot().read_text(encoding="utf-8"))
        stored["covariance"] = [[1e8 * value for value in row] for row in stored["covariance"]]
        unsure = self.measure("virtual", "--robot", self.file("unsure.json", json.dumps(stored)))
        sure = self.measure("virtual", "--robot", robot())
        self.assertEqual(unsure["model"], sure["model"])
        self.assert_relative(unsure["standard_error_of_robot"]["K"],
                             [[1e4 * value for value in row] for row in sure["standard_error_of_robot"]["K"]], 1e-9)
        self.assertGreater(unsure["standard_error"]["K"][0][0], 10 * sure["standard_error"]["K"][0][0])

    def test_what_the_sensor_would_have_given_stands_beside_it(self):
        found, sensed = self.measure("virtual", "--robot", robot()), self.measure("sensor")
        beside = found["by_force_sensor"]
        self.assert_relative(beside["model"]["K"], sensed["model"]["K"], 1e-4)  # both windows end elsewhere
        for name in ("M", "B", "K"):
            for i in range(2):
                for j in range(2):
                    self.assertAlmostEqual(beside["induced_error"][name][i][j],
                                           found["model"][name][i][j] - beside["model"][name][i][j], places=12)

    def test_the_observer_is_worse(self):
        late, exact = (self.measure(source, "--robot", robot()) for source in ("observer", "virtual"))
        self.assertGreater(abs(late["by_force_sensor"]["induced_error"]["B"][0][0]),
                           10 * abs(exact["by_force_sensor"]["induced_error"]["B"][0][0]))
        self.assertNotIn("standard_error_of_robot", late)

    def test_text_says_so(self):
        text = self.fine("measure", rig(), "--force-source", "virtual", "--robot", robot()).out
        for words in ("force", "robot model"):
            self.assertIn(words, text)

    def test_a_robot_without_a_computed_force_is_refused(self):
        self.refused(WRONG_USAGE, "measure", rig(), "--robot", robot(), says=["--robot", "--force-source"])


class StoredRobot(Case):
    def refused_robot(self, path, *says):
        ran = self.refused(BAD_DATA, "robot", "force", rig(), "--robot", path, says=[str(path), *says])
        self.assertRegex(ran.err, r"; \w")

    def test_what_is_none_is_refused_by_name(self):
        text = robot().read_text(encoding="utf-8")
        self.refused_robot(self.file("cut.json", text[:len(text) // 2]), "JSON", "byte")
        other = made("measured.json", "measure", rig(), "--json")
        self.refused_robot(other, "mbk.robot/1")
        self.refused_robot(self.folder / "none.json")
        self.refused_robot(ROBOTS / "emps.toml", "mass", "mbk robot identify")

    def test_parts_that_cannot_be_are_named(self):
        def short(stored):
            stored["covariance"].pop()

        def negative(stored):
            stored["covariance"][0][0] = -1

        def renamed(stored):
            stored["parameters"][0]["name"] = "beta"

        def late(stored):
            stored["motor_delay_s"] = 40

        def magic(stored):
            stored["drive"]["terms"].append("magic")

        for change, says in ((short, "9×9"), (negative, "covariance"), (renamed, "parameters"), (late, "motor delay"),
                             (magic, "\"magic\"")):
            with self.subTest(change.__name__):
                stored = json.loads(robot().read_text(encoding="utf-8"))
                change(stored)
                self.refused_robot(self.file(f"{change.__name__}.json", json.dumps(stored)), says)


if __name__ == "__main__":
    main()
