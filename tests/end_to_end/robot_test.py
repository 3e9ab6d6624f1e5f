#!/usr/bin/env python3
"""mbk robot workspace: where the hand can be, as picture, numbers and drawing."""

import math
import xml.dom.minidom

from command import WRONG_USAGE, Case, main

D1, D2 = 0.254, 0.2667


def hand(theta1_deg, theta2_deg, d1=D1, d2=D2):
    """The forward kinematics (A.1), in metres."""
    one, two = math.radians(theta1_deg), math.radians(theta2_deg)
    return d1 * math.cos(one) + d2 * math.sin(two), d1 * math.sin(one) - d2 * math.cos(two)


def millimetres(place):
    return ",".join(f"{1e3 * value:.9f}" for value in place)


class Workspace(Case):
    def test_the_text_has_picture_limits_extents_and_area(self):
        text = self.fine("robot", "workspace").out
        self.assert_lines_fit(text)
        for words in ("-55° ≤ θ₁ ≤ 90°", "0° ≤ θ₂ ≤ 145°", "≥ 35°", "d₁ 254 mm, d₂ 266.7 mm", "0.1793 m²"):
            self.assertIn(words, text)
        self.assertGreater(sum("⠀" < c <= "⣿" for c in text), 80)
        self.assertNotIn("manipulability", text)  # which is that of a place

    def test_the_numbers_are_those_of_the_kinematics(self):
        space = self.fine("robot", "workspace", "--json").json
        self.assertEqual((space["schema"], space["links_m"]), ("mbk.workspace/1", [D1, D2]))
        corners = [hand(-55, 0), hand(90, 0), hand(90, 145)]
        for corner in corners:
            self.assertLess(min(math.dist(corner, place) for place in space["outline_m"]), 1e-12)
        xs, ys = zip(*space["outline_m"])
        self.assertEqual(space["x_m"], [min(xs), max(xs)])
        self.assertEqual(space["y_m"], [min(ys), max(ys)])
        # d₁d₂ ∫ (90° − a) cos a da from a = −55° to 90°, which is ∫∫ |det J| dθ
        low, high = math.radians(-55), math.radians(90)
        exact = D1 * D2 * (-math.cos(high) - (high - low) * math.sin(low) + math.cos(low))
        self.assertAlmostEqual(space["area_m2"] / exact, 1.0, delta=1e-6)

    def test_at_a_place_the_joints_bring_the_hand_there(self):
        for angles in ((30, 40), (80, 5), (-20, 20), (60, 110)):
            at = self.fine("robot", "workspace", "--json", "--at", millimetres(hand(*angles))).json["at"]
            for found, expected in zip(at["theta_deg"], angles):
                self.assertAlmostEqual(found, expected, places=6)
            (a, b), (c, d) = at["jacobian_m"]
            self.assertAlmostEqual(at["manipulability_m2"], abs(a * d - b * c), places=12)
            self.assertAlmostEqual(at["manipulability_m2"],
                                   D1 * D2 * math.cos(math.radians(angles[0] - angles[1])), places=9)
            left = {(one["quantity"], one["kind"]): one["left_deg"] for one in at["margins"]}
            self.assertAlmostEqual(left["θ₁", "most"], 90 - angles[0], places=6)
            self.assertAlmostEqual(left["θ₂", "least"], angles[1], places=6)
            self.assertAlmostEqual(min(left.values()), min(90 - angles[0], angles[0] + 55, angles[1], 145 - angles[1],
                                                           angles[0] - angles[1] + 55), places=6)
            small, large = at["inertia_at_hand_kg"]["eigenvalues"]
            self.assertTrue(0.1 < small < large < 100, at)

    def test_at_a_place_the_text_says_the_same(self):
        text = self.fine("robot", "workspace", "--at", "300,50").out
        self.assert_lines_fit(text)
        for words in ("(300, 50) mm", "θ₁ 65.69°, θ₂ 47.12°", "manipulability", "inertia at hand",
                      "θ₁ ≤ 90°", "24.31°"):
            self.assertIn(words, text)

    def test_other_links_reach_elsewhere(self):
        space = self.fine("robot", "workspace", "--json", "--d1-mm", "300", "--d2-mm", "200").json
        self.assertEqual(space["links_m"], [0.3, 0.2])
        self.assertLess(min(math.dist(hand(90, 145, 0.3, 0.2), place) for place in space["outline_m"]), 1e-12)

    def test_the_drawing_is_an_svg_that_stands_alone(self):
        path = self.folder / "workspace.svg"
        self.assertEqual(self.fine("robot", "workspace", "--at", "300,50", "--out", path).out, "")
        text = path.read_text(encoding="utf-8")
        root = xml.dom.minidom.parseString(text).documentElement
        self.assertEqual((root.tagName, root.getAttribute("role")), ("svg", "img"))
        self.assertEqual(len(root.getElementsByTagName("title")), 1)
        for outside in ("href", "<script", "@import", "url("):
            self.assertNotIn(outside, text)
        for name in ("workspace", "links", "hand", "x [mm]", "y [mm]"):
            self.assertIn(f">{name}</text>", text)
        self.refused(WRONG_USAGE, "robot", "workspace", "--out", path, says="--overwrite")
        self.fine("robot", "workspace", "--out", path, "--overwrite")
        self.assertNotEqual(path.read_text(encoding="utf-8"), text)

    def test_json_into_a_drawing_is_refused(self):
        self.refused(WRONG_USAGE, "robot", "workspace", "--json", "--out", self.folder / "a.svg", says="--json")
        self.assertEqual(self.names(), [])


class WrongInput(Case):
    def test_places_that_the_links_do_not_reach(self):
        for place in ("600,0", "0,0", "5,5"):
            self.refused(WRONG_USAGE, "robot", "workspace", f"--at={place}", says=["0.0127", "0.5207"])

    def test_places_beyond_a_limit_name_it(self):
        for angles, says in (((95, 60), ("θ₁", "95.00°", "90°")),
                             ((30, -3), ("θ₂", "-3.00°", " 0°")),
                             ((20, 85), ("25.00°", "35°"))):
            with self.subTest(angles):
                self.refused(WRONG_USAGE, "robot", "workspace", f"--at={millimetres(hand(*angles))}", says=says)

    def test_the_corner_where_the_links_fold(self):
        self.refused(WRONG_USAGE, "robot", "workspace", "--at=0,-12.7", says="line")

    def test_what_is_no_place(self):
        for place in ("", "300", "300;50", "300,", ",50", "a,b", "nan,50", "300,inf", "1e400,0", "300,50,1", "300 ,50"):
            with self.subTest(place):
                self.refused(WRONG_USAGE, "robot", "workspace", f"--at={place}" if place else "--at", says="--at")

    def test_lengths(self):
        for option in ("--d1-mm", "--d2-mm"):
            for value in ("0", "-1", "abc", "nan", "inf"):
                self.refused(WRONG_USAGE, "robot", "workspace", f"{option}={value}", says=option)

    def test_commands(self):
        self.refused(WRONG_USAGE, "robot", says="mbk robot --help")
        self.refused(WRONG_USAGE, "robot", "dance", says="mbk robot --help")
        self.refused(WRONG_USAGE, "robot", "workspace", "--bogus", says=["--bogus", "mbk robot workspace --help"])

    def test_help(self):
        for arguments in (["robot"], ["robot", "workspace"]):
            text = self.fine(*arguments, "--help").out
            self.assert_lines_fit(text)
            self.assertRegex(text, r"Examples?:\n  mbk robot workspace")


if __name__ == "__main__":
    main()
