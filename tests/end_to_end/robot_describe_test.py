#!/usr/bin/env python3
"""mbk robot describe: what was understood of a robot's description, and in one line what was not."""

import pathlib
import re

from command import BAD_DATA, WRONG_USAGE, Case, main

ROBOTS = pathlib.Path(__file__).resolve().parents[2] / "examples" / "robots"


class Describe(Case):
    def describe(self, text, urdf=None):
        """The arguments that describe a robot of these texts."""
        path = self.folder / "robot.toml"
        path.write_text(text)
        if urdf is not None:
            (self.folder / "arm.urdf").write_text(urdf)
        return "robot", "describe", path

    def test_every_example(self):
        for path in sorted(ROBOTS.iterdir()):
            with self.subTest(path.name):
                text = self.fine("robot", "describe", path).out
                self.assert_lines_fit(text)
                self.assertIn("coefficients", text)

    def test_joints_hand_drives_and_base_parameters(self):
        text = " ".join(self.fine("robot", "describe", ROBOTS / "double_pendulum.toml").out.split())
        for words in ("shoulder", "0.00, -500.00 mm", "motor inertia, viscous",
                      "adds −0.2·lower.mass to upper.mass_z, 0.04·lower.mass to upper.inertia_yy", "13 of 28 coefficients"):
            self.assertIn(words, text)

    def test_the_numbers(self):
        robot = self.fine("robot", "describe", ROBOTS / "double_pendulum.toml", "--json").json
        self.assertEqual(robot["schema"], "mbk.robot_description/1")
        self.assertEqual([joint["name"] for joint in robot["joints"]], ["shoulder", "elbow"])
        self.assertEqual(robot["joints"][0]["limits"], [None, None])
        self.assertEqual(robot["structural_rank"], 13)
        self.assertAlmostEqual(robot["hand_at_zero"][1], -0.5, places=12)
        of = {one["name"]: one for one in robot["coefficients"]}
        self.assertEqual(of["coulomb_1"], {"name": "coulomb_1", "unit": "N·m", "value": 0.16})
        self.assertIsNone(of["offset_1"]["value"])
        self.assertEqual(of["upper.mass"]["part_of"], {})
        self.assertEqual(set(of["lower.mass"]["part_of"]), {"upper.mass_z", "upper.inertia_yy"})
        self.assertAlmostEqual(of["lower.mass"]["part_of"]["upper.inertia_yy"], 0.04, places=9)

    def test_a_urdf_by_itself_is_the_whole_chain(self):
        robot = self.fine("robot", "describe", ROBOTS / "double_pendulum.urdf", "--json").json
        self.assertEqual(len(robot["joints"]), 2)

    def test_out(self):
        out = self.folder / "described.json"
        self.fine("robot", "describe", ROBOTS / "emps.toml", "--json", "--out", out)
        self.assertIn("mbk.robot_description/1", out.read_text())
        self.refused(WRONG_USAGE, "robot", "describe", ROBOTS / "emps.toml", "--out", out, says="--overwrite")

    def test_limits_that_leave_no_place_to_stand(self):
        for limits in ("smallest_opening_deg = 200", "smallest_opening_deg = 1e300", "theta1_deg = [-1e9, -1e8]"):
            with self.subTest(limits):
                self.refused(BAD_DATA, *self.describe(f"[robot]\nkind = 'planar'\n{limits}\n"),
                             says="smallest_opening_deg")

    def test_limits_that_leave_a_sliver(self):
        """Where the even grid of postures has one point, at the corner."""
        text = self.fine(*self.describe("[robot]\nkind = 'planar'\nsmallest_opening_deg = 179.9999\n")).out
        self.assertIn("coefficients", text)

    def test_links_that_cannot_exist(self):
        urdf = "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\n"
        pendulum = (ROBOTS / "double_pendulum.urdf").read_text()
        self.refused(BAD_DATA, *self.describe(urdf, pendulum.replace('mass value="', 'mass value="-', 1)),
                     says=["'upper'", "mass", "-0.5"])
        self.refused(BAD_DATA, *self.describe(urdf, pendulum.replace('damping="', 'damping="-', 1)),
                     says=["<dynamics>", "'shoulder'"])
        for wrong in ('ixx="-0.01"', 'ixx="9"', 'ixy="0.5"'):
            with self.subTest(wrong):
                before = wrong.split('"')[0] + '"'
                text = re.sub(f'{before}[^"]*"', wrong, pendulum, count=1)
                robot = self.describe(urdf + "[drive]\nterms = ['viscous', 'coulomb']\n", text)
                self.assertIn("'upper'", self.fine(*robot).out)
                self.assertEqual(len(self.fine(*robot, "--json").json["impossible"]), 1)
                self.refused(BAD_DATA, "robot", "force", self.folder / "robot.toml", "--robot", robot[-1],
                             says="inertia")
        self.assertEqual(self.fine(*self.describe(urdf, pendulum), "--json").json["impossible"], [])

    def test_the_hand_of_one_joint_is_a_place_or_an_angle(self):
        """A drive that turns measures an angle; the hand at the end of a link that turns is somewhere, in mm."""
        self.assertIn("0.00 mm", self.fine(*self.describe("[robot]\nkind = 'one_axis'\nslides = true\n")).out)
        self.assertIn("·10⁻³ rad", self.fine(*self.describe("[robot]\nkind = 'one_axis'\nslides = false\n")).out)
        urdf = "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\ntip_link = 'upper'\n"
        urdf += "tool_mm = [0, 0, -200]\nhand_axes = ['x', 'z']\n"
        text = self.fine(*self.describe(urdf, (ROBOTS / "double_pendulum.urdf").read_text())).out
        self.assertIn("0.00, -200.00 mm", text)

    def test_drives_and_planar_links_that_cannot_exist(self):
        axis = "[robot]\nkind = 'one_axis'\nslides = true\nmass_kg = 1\n[drive]\nterms = ['viscous', 'coulomb']\n"
        self.refused(BAD_DATA, *self.describe(axis + "viscous_Ns_per_m = [-1]\n"), says="viscous_Ns_per_m")
        self.refused(BAD_DATA, *self.describe(axis + "coulomb_N = [-1]\n"), says="coulomb_N")
        for alpha in ("[-0.07, 0.04, 0.04]", "[0.07, 0.5, 0.04]", "[0.07, 0.04, -0.04]"):
            self.refused(BAD_DATA, *self.describe(f"[robot]\nkind = 'planar'\nalpha_kg_m2 = {alpha}\n"),
                         says="alpha_kg_m2")

    def test_what_is_no_robot(self):
        self.refused(WRONG_USAGE, "robot", "describe", says="FILE")
        self.refused(BAD_DATA, "robot", "describe", self.folder / "gone.toml", says="gone.toml")
        self.refused(BAD_DATA, "robot", "describe", self.folder, says=str(self.folder))
        self.refused(BAD_DATA, *self.describe("[robot]\nkind = 'crane'\n"), says="planar, one_axis, urdf")
        self.refused(BAD_DATA, *self.describe("[robot]\nkind = 'planar'\nd1_m = 'x'\n"), says="d1_mm")
        urdf = "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\n"
        self.refused(BAD_DATA, *self.describe(urdf), says="arm.urdf")
        self.refused(BAD_DATA, *self.describe(urdf, "<robot"), says=["arm.urdf", "URDF"])
        self.refused(BAD_DATA, *self.describe(urdf, "\0\1\2"), says=["arm.urdf", "URDF"])
        pendulum = (ROBOTS / "double_pendulum.urdf").read_text()
        self.refused(BAD_DATA, *self.describe(urdf + "tip_link = 'foot'\n", pendulum), says=["foot", "'hand'"])
        self.refused(BAD_DATA, *self.describe(urdf, pendulum.replace('"0 -1 0"', '"0 0 0"', 1)), says="shoulder")
        self.refused(BAD_DATA, *self.describe(urdf, pendulum.replace("continuous", "floating", 1)), says="floating")
        self.refused(BAD_DATA, *self.describe(urdf, pendulum.replace('value="0.62', 'value="heavy', 1)), says="heavy")


if __name__ == "__main__":
    main()
