#!/usr/bin/env python3
"""mbk measure --domain joint: the model at shoulder and elbow, against what the simulated arm has there."""

import math

from command import WRONG_USAGE, Case, main, make_log, run

SHOULDER, UPPER_ARM, FOREARM = (0.30, -0.57), 0.31, 0.34  # of the ready scenarios
TRUE_K = ((42.4, -28.6), (-28.6, 125.3))  # participant 1, relaxed [N/m]


def product(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(2)) for j in range(2)] for i in range(2)]


def transposed(A):
    return [list(row) for row in zip(*A)]


class JointDomain(Case):
    def relaxed(self):
        path = self.folder / "relaxed.h5"
        self.fine("simulate", "relaxed_sinusoidal", "--out", path, "--quiet")
        return path

    def test_it_is_the_simulated_arm_at_its_joints(self):
        result = self.fine("measure", self.relaxed(), "--domain", "joint", "--handle-mass", "0.194", "--json").json
        joints = result["joint_domain"]
        self.assertEqual(joints["of"], "arm")
        J = joints["jacobian_m"]
        shoulder, elbow, hand = joints["points_m"]
        self.assertAlmostEqual(math.dist(shoulder, SHOULDER), 0.0, places=9)
        self.assertAlmostEqual(math.dist(shoulder, elbow), UPPER_ARM, places=9)
        self.assertAlmostEqual(math.dist(elbow, hand), FOREARM, places=9)
        self.assertAlmostEqual(joints["determinant_m2"],
                               UPPER_ARM * FOREARM * math.sin(math.radians(joints["joint_angles_deg"][1])), places=9)
        # The participant's K_q = JᵀKJ at rest; the hand's mean place is a fraction of a millimetre from there.
        true_K = product(product(transposed(J), TRUE_K), J)
        for i in range(2):
            for j in range(2):
                error = joints["standard_error"]["K"][i][j]
                self.assertLess(abs(joints["model"]["K"][i][j] - true_K[i][j]), 4.0 * error)
                self.assertLess(error, 0.1 * true_K[0][0])
        for force in joints["bias_force_N"]:
            self.assertLess(abs(force), 0.1)  # a relaxed arm pushes nowhere
        k_a = result["antisymmetry"]["stiffness"]["value"]
        self.assertAlmostEqual(joints["antisymmetry"]["stiffness"]["value"], joints["determinant_m2"] * k_a, places=9)
        self.assertEqual(len(joints["covariance"]["matrix"]), 14)

    def test_the_text_says_of_whom_and_where(self):
        text = self.fine("identify", self.relaxed(), "--domain", "joint").out
        for word in ("joints", "shoulder", "N·m/rad", "bias force", "det J"):
            self.assertIn(word, text)
        self.assert_lines_fit(text)

    def test_the_hand_is_measured_unless_asked(self):
        path = self.relaxed()
        self.assertNotIn("joint_domain", self.fine("measure", path, "--json").json)
        self.assertEqual(self.fine("measure", path, "--domain", "hand").out, self.fine("measure", path).out)

    def test_the_robot_speaks_where_the_arm_is_not_known(self):
        path = self.folder / "bare.csv"
        self.fine("convert", self.relaxed(), path)
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        path.write_text("".join(line for line in lines if not line.startswith(("# shoulder", "# upper", "# forearm"))),
                        encoding="utf-8")
        joints = self.fine("measure", path, "--domain", "joint", "--json").json["joint_domain"]
        self.assertEqual((joints["of"], joints["second_joint_against"]), ("robot", "base"))

    def test_an_arm_may_be_named(self):
        path = self.relaxed()
        left = self.fine("measure", path, "--domain", "joint", "--arm", "0.3,-0.57,0.31,0.34,left", "--json").json
        usual = self.fine("measure", path, "--domain", "joint", "--json").json
        named = self.fine("measure", path, "--domain", "joint", "--arm", "0.3,-0.57,0.31,0.34", "--json").json
        self.assertEqual(named["joint_domain"], usual["joint_domain"])
        self.assertAlmostEqual(left["joint_domain"]["determinant_m2"], -usual["joint_domain"]["determinant_m2"],
                               places=12)
        log = make_log().path
        self.bad_data(log, "--domain", "joint", says=["posture", "--arm"])
        self.bad_data(log, "--domain", "joint", "--arm=5,5,0.3,0.3", says="0.3")
        for wrong in ("1,2,3", "1,2,0,0.3", "1,2,-1,0.3", "a,2,0.3,0.3", "1,nan,0.3,0.3", "1,2,0.3,0.3,up",
                      "1,2,0.3,0.3,left,1", "1,2,0.3,0.3,", ""):
            with self.subTest(wrong):
                self.refused(WRONG_USAGE, "measure", log, "--domain", "joint", f"--arm={wrong}", says="--arm")
        self.refused(WRONG_USAGE, "measure", log, "--arm", "0.3,-0.57,0.31,0.34", says="--domain joint")

    def test_one_axis_and_pooled_postures_are_refused(self):
        self.bad_data(make_log("sinusoidal", "--one-axis").path, "--domain", "joint", says="axis")
        usual = self.relaxed()
        other = self.folder / "other.toml"
        ran = run("simulate", "--show", "relaxed_sinusoidal")
        self.assertIn("shoulder_mm = [300, -570]", ran.out)
        other.write_text(ran.out.replace("shoulder_mm = [300, -570]", "shoulder_mm = [250, -570]"), encoding="utf-8")
        moved = self.folder / "moved.h5"
        self.fine("simulate", other, "--out", moved, "--quiet")
        self.refused(3, "measure", usual, moved, "--pool", "--domain", "joint", says="posture")


if __name__ == "__main__":
    main()
