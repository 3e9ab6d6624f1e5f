#!/usr/bin/env python3
"""mbk robot identify: inertia, friction and delay of a robot from its motion, simulated and recorded by others."""

import functools
import math
import pathlib

import ros_file
from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, data_folder, folder_of_logs, main, run

ROBOTS = pathlib.Path(__file__).parents[2] / "examples/robots"
ALPHA = {"alpha1": 0.06929, "alpha2": 0.04217, "alpha3": 0.04416}  # Dyck 2013, table A.1 [kg·m²]
VISCOUS = {"viscous_1": 0.06510, "viscous_2": 0.07389}  # [N·m·s/rad]
COULOMB = {"coulomb_1": 0.03, "coulomb_2": 0.03}  # of the scenario free_motion [N·m]
COLUMNS = "time=time,q1=joint_1{q},q2=joint_2{q},tau1=torque_1{t},tau2=torque_2{t}"


def free_motion(seed=1, breakaway_Nm=None):
    """The ready scenario free_motion; optionally with friction that increases towards standstill."""
    return simulated(seed, breakaway_Nm)


@functools.lru_cache(maxsize=None)
def simulated(seed, breakaway_Nm):
    scenario = folder_of_logs() / f"free_{seed}_{breakaway_Nm}.toml"
    text = run("simulate", "--show", "free_motion").out
    if breakaway_Nm:
        text = text.replace("[robot]\n", f"[robot]\nbreakaway_Nm = [{breakaway_Nm}, {breakaway_Nm}]\n")
    scenario.write_text(text, encoding="utf-8")
    recording = scenario.with_suffix(".h5")
    ran = run("simulate", scenario, "--seed", seed, "--out", recording, "--quiet")
    assert ran.code == 0, ran
    return recording


def values(result):
    return {one["name"]: one["value"] for one in result["parameters"]}


def codes(result):
    return [warning["code"] for warning in result["warnings"]]


class Simulated(Case):
    def identify(self, *arguments, code=0):
        return self.mbk("robot", "identify", *arguments, "--json", code=code).json

    def assert_is_the_robot(self, result, of_value=0.005):
        found = values(result)
        for name, value in {**ALPHA, **VISCOUS, **COULOMB}.items():
            self.assertAlmostEqual(found[name], value, delta=of_value * value, msg=name)

    def test_finds_inertia_friction_and_delay(self):
        found = self.identify(free_motion())
        self.assertEqual((found["schema"], found["method"], found["usable"]), ("mbk.robot/1", "wls", True))
        self.assert_is_the_robot(found)
        self.assertAlmostEqual(found["motor_delay_s"], 0.5e-3, delta=1e-5)  # a torque held for a sample of 1 ms
        self.assertTrue(all(fit["VAF"] > 99.9 for fit in found["fit"]))
        self.assertEqual((found["excitation"]["rank"], found["excitation"]["structural_rank"]), (9, 9))
        self.assertGreater(found["inertia"]["smallest_eigenvalue"], 0)

    def test_text_says_what_json_says(self):
        text = self.fine("robot", "identify", free_motion()).out
        self.assert_lines_fit(text)
        for words in ("alpha1", "kg·m²", "N·m·s/rad", "joint 2", "positive definite"):
            self.assertIn(words, text)

    def test_files_are_fitted_together_and_others_judge(self):
        one, two, three = (free_motion(seed) for seed in (1, 2, 3))
        both = self.identify(one, two, "--held-out", three)
        self.assert_is_the_robot(both)
        self.assertEqual([entry["file"] for entry in both["inputs"]], [str(one), str(two)])
        self.assertEqual((both["validated_on"], both["held_out_files"]), ("held-out", [str(three)]))
        # Nothing of the first two is kept for judging, so more rows stand behind the coefficients.
        self.assertGreater(both["samples"], 2 * self.identify(one)["samples"])
        # What judges does not change what is found.
        self.assertEqual(values(both), values(self.identify(one, two, "--held-out", one)))

    def test_the_former_name_of_held_out_is_still_read(self):
        one, two = free_motion(1), free_motion(2)
        self.assertEqual(self.identify(one, "--held-back", two), self.identify(one, "--held-out", two))
        former = self.mbk("robot", "identify", one, "--held-back", two)
        self.assertIn("warning: --held-back is now --held-out", former.err)
        self.assertNotIn("held-back", self.fine("robot", "identify", "--help").out)

    def test_terms_that_are_left_out_are_missed(self):
        found = self.identify(free_motion(), "--terms", "viscous")
        self.assertEqual(list(values(found)), [*ALPHA, *VISCOUS])
        self.assertGreater(values(found)["viscous_1"], 1.05 * VISCOUS["viscous_1"])  # takes the dry friction's part
        bare = self.identify(free_motion(), "--terms", "none")
        self.assertEqual(list(values(bare)), list(ALPHA))
        self.assertLess(bare["fit"][0]["VAF"], found["fit"][0]["VAF"])

    def test_a_delay_that_is_given_is_kept(self):
        found = self.identify(free_motion(), "--motor-delay", "0")
        self.assertEqual(found["motor_delay_s"], 0)
        self.assertNotIn("motor_delay_standard_error_s", found)
        self.assertLess(found["fit"][0]["VAF"], self.identify(free_motion())["fit"][0]["VAF"])

    def test_what_is_known_keeps_its_value(self):
        found = self.identify(free_motion(), "--fix", "alpha2,viscous_1")
        fixed = {one["name"]: one for one in found["parameters"] if one.get("fixed")}
        self.assertEqual({name: one["value"] for name, one in fixed.items()},
                         {"alpha2": ALPHA["alpha2"], "viscous_1": VISCOUS["viscous_1"]})
        self.assertEqual([one["standard_error"] for one in fixed.values()], [None, None])
        self.assert_is_the_robot(found)

    def test_values_of_a_description_stay_where_terms_are_added(self):
        robot = self.file("robot.toml", "[robot]\nkind = \"planar\"\nviscous_Nms_per_rad = [0.07, 0.08]\n\n"
                                        "[drive]\nterms = [\"viscous\"]\n")
        found = self.identify(free_motion(), "--robot", robot, "--terms", "viscous,coulomb", "--fix", "viscous_2")
        self.assertEqual(values(found)["viscous_2"], 0.08)
        self.refused(WRONG_USAGE, "robot", "identify", free_motion(), "--robot", robot, "--terms", "viscous,coulomb",
                     "--fix", "coulomb_1", says=["--fix", "'coulomb_1'"])

    def test_every_method_finds_the_robot(self):
        for method, more in (("ls", ()), ("iv", ()), ("iv", ("--motion-cutoff", "4"))):
            with self.subTest(method=method, more=more):
                found = self.identify(free_motion(), "--method", method, *more)
                self.assertEqual(found["method"], method)
                self.assert_is_the_robot(found)
                if method == "iv":
                    self.assertEqual(found["instruments"], "smoothed motion" if more else "hand reference")

    def test_the_stribeck_velocity_is_found(self):
        breakaway = free_motion(breakaway_Nm=0.06)
        terms = ("--terms", "viscous,coulomb,stribeck,offset")
        found = self.identify(breakaway, *terms, "--stribeck-velocity", "auto")
        # 0.05 rad/s in the simulated robot; the fit hardly depends on it near its best.
        self.assertAlmostEqual(found["drive"]["stribeck_velocity"], 0.05, delta=0.0025)
        self.assertAlmostEqual(values(found)["stribeck_1"], 0.03, delta=0.0015)
        worse = self.identify(breakaway, *terms, "--stribeck-velocity", "0.3")
        self.assertGreater(worse["fit"][0]["RMSE"], 2 * found["fit"][0]["RMSE"])

    def test_a_stored_robot_is_where_to_begin_again(self):
        stored = self.folder / "robot.json"
        self.fine("robot", "identify", free_motion(), "--json", "--out", stored)
        again = self.identify(free_motion(2), "--robot", stored, "--fix", "coulomb_1")
        self.assertEqual(values(again)["coulomb_1"], values(self.identify(free_motion()))["coulomb_1"])
        self.assert_is_the_robot(again)


    def test_a_robot_that_can_exist_is_the_free_one_where_that_is_possible(self):
        free, found = self.identify(free_motion()), self.identify(free_motion(), "--consistent")
        self.assert_is_the_robot(found)
        self.assertEqual(found["consistent"]["links"], [])  # two links whose angles are both against the base
        self.assertEqual(found["consistent"]["free_fit"], free["fit"])
        self.assertLess(max(found["consistent"]["VAF_lost"]), 1e-3)
        self.assertEqual(found["covariance"], free["covariance"])

    def test_force_takes_a_robot_that_can_exist(self):
        stored = self.folder / "robot.json"
        self.fine("robot", "identify", free_motion(), "--consistent", "--json", "--out", stored)
        force = self.mbk("robot", "force", free_motion(2), "--robot", stored, "--json").json
        self.assertLess(max(force["RMS"]), 0.2)  # nothing at the hand
        again = self.identify(free_motion(2), "--robot", stored, "--consistent")
        self.assert_is_the_robot(again)


class Wrong(Case):
    def test_torques_in_another_unit_are_seen(self):
        for unit, factor in (("N·mm", "*1000"), ("kN·m", ":N.mm")):
            with self.subTest(unit):
                ran = self.mbk("robot", "identify", free_motion(), "--channels", COLUMNS.format(q="", t=factor),
                               "--json", code=NOT_USABLE)
                warning = next(one for one in ran.json["warnings"] if one["code"] == "torque-unit")
                self.assertIn(unit, warning["message"])
                self.assertIs(ran.json["usable"], False)

    def test_angles_in_degrees_cross_the_limits_of_the_joints(self):
        ran = self.refused(BAD_DATA, "robot", "identify", free_motion(), "--channels",
                           COLUMNS.format(q="*57.29578", t=""), says=["sample 1 ", "0.000000 s", "limit"])
        self.assertIn("--channels", ran.err)

    def test_a_channel_that_is_missing_is_named(self):
        for left_out, says in ((",tau2=torque_2", "'torque_2'"), (",q1=joint_1", "'joint_1'")):
            with self.subTest(left_out):
                channels = COLUMNS.format(q="", t="").replace(left_out, "")
                self.refused(BAD_DATA, "robot", "identify", free_motion(), "--channels", channels,
                             says=[str(free_motion()), says, "--channels"])

    def test_options_that_cannot_be_meant(self):
        for options, says in ((("--terms", "viscous,magic"), ("--terms", "'magic'", "coulomb")),
                              (("--fix", "beta"), ("--fix", "'beta'", "alpha1")),
                              (("--fix", "coulomb_1"), ("--fix", "'coulomb_1'")),
                              (("--motor-delay", "soon"), ("--motor-delay", "'soon'")),
                              (("--motor-delay", "2000"), ("delay", "2 s")),
                              (("--stribeck-velocity", "auto"), ("--stribeck-velocity", "--terms")),
                              (("--terms", "stribeck", "--stribeck-velocity", "-1"), "--stribeck-velocity"),
                              (("--method", "gls"), ("--method", "'gls'")),
                              (("--motion-cutoff", "0"), "--motion-cutoff")):
            with self.subTest(options):
                self.refused(WRONG_USAGE, "robot", "identify", free_motion(), *options, says=says)

    def test_a_robot_of_other_joints_is_refused(self):
        self.refused(BAD_DATA, "robot", "identify", free_motion(), "--robot", ROBOTS / "emps.toml",
                     says=["'joint_1'", " rad"])


ARM = ('<robot name="arm"><link name="base"/>'
       '<link name="upper"><inertial><origin xyz="0.15 0 0"/><mass value="2"/>'
       '<inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
       '<link name="fore"><inertial><origin xyz="0.15 0 0"/><mass value="1.5"/>'
       '<inertia ixx="0.001" iyy="0.015" izz="0.015" ixy="0" ixz="0" iyz="0"/></inertial></link>'
       '<joint name="shoulder_joint" type="continuous"><parent link="base"/><child link="upper"/>'
       '<axis xyz="0 0 1"/></joint>'
       '<joint name="elbow_joint" type="continuous"><parent link="upper"/><child link="fore"/>'
       '<origin xyz="0.3 0 0"/><axis xyz="0 0 1"/></joint></robot>')
MASS_X = 1.5 * 0.15  # of the forearm [kg·m]


def arm_motion(k, rate=250.0):
    """Angles and torques of that arm in a horizontal plane: {joint: (angle, torque)}."""
    angle, speed, acceleration = [], [], []
    for offset, parts in ((0.6, ((0.3, 0.5), (0.1, 1.3))), (1.2, ((0.25, 0.7), (0.1, 1.7)))):
        phases = [(size, 2 * math.pi * hz, 2 * math.pi * hz * k / rate) for size, hz in parts]
        angle.append(offset + sum(a * math.sin(p) for a, _, p in phases))
        speed.append(sum(a * w * math.cos(p) for a, w, p in phases))
        acceleration.append(sum(-a * w * w * math.sin(p) for a, w, p in phases))
    lower = 0.015 + 1.5 * 0.15**2
    coupling = 0.3 * MASS_X * math.cos(angle[1])
    upper = 0.02 + 2 * 0.15**2 + 1.5 * 0.3**2 + lower + 2 * coupling
    turning = 0.3 * MASS_X * math.sin(angle[1])
    torque = (upper * acceleration[0] + (lower + coupling) * acceleration[1]
              - turning * (2 * speed[0] * speed[1] + speed[1]**2),
              (lower + coupling) * acceleration[0] + lower * acceleration[1] + turning * speed[0]**2)
    return {"shoulder_joint": (angle[0], torque[0]), "elbow_joint": (angle[1], torque[1])}


class JointNames(Case):
    """Joint states of ROS come in the order of the alphabet, a chain from its base."""

    def recording(self, order=lambda k: ("elbow_joint", "shoulder_joint"), samples=5000):
        path = self.folder / "free.mcap"
        file = ros_file.Mcap(path, {"/joint_states": "sensor_msgs/msg/JointState"})
        for k in range(samples):
            joints = {"finger": (0.04, 0.0), "wheel": (0.1 * k, 0.2), **arm_motion(k)}
            nanoseconds = 1_700_000_000 * 10**9 + 4_000_000 * k
            file.add("/joint_states", nanoseconds, ros_file.joint_state(nanoseconds, {n: joints[n] for n in order(k)}))
        file.close()
        return path

    def robot(self, urdf=ARM):
        self.file("arm.urdf", urdf)
        return self.file("arm.toml", "[robot]\nkind = 'urdf'\nfile = 'arm.urdf'\ntip_link = 'fore'\n"
                                     "tool_mm = [300, 0, 0]\n[drive]\nterms = []\n")

    def assert_is_the_arm(self, *arguments):
        found = self.mbk("robot", "identify", "--robot", self.robot(), "--json", *arguments).json
        self.assertAlmostEqual(values(found)["fore.mass_x"], MASS_X, delta=0.002)

    def test_joints_are_found_by_their_names(self):
        orders = {"alphabet": lambda k: ("elbow_joint", "shoulder_joint"),
                  "chain": lambda k: ("shoulder_joint", "elbow_joint"),
                  "in turns": lambda k: ("shoulder_joint", "elbow_joint")[::1 if k % 3 else -1],
                  "among others": lambda k: ("elbow_joint", "finger", "shoulder_joint", "wheel")}
        for name, order in orders.items():
            with self.subTest(name):
                self.assert_is_the_arm(self.recording(order))

    def test_names_go_into_other_files(self):
        path = self.recording()
        for end in ("h5", "csv", "mat"):
            with self.subTest(end):
                self.mbk("convert", path, self.folder / f"out.{end}")
                self.assert_is_the_arm(self.folder / f"out.{end}")

    def test_nothing_pulls_at_the_hand_of_an_arm_that_moves_freely(self):
        found = self.mbk("robot", "force", self.recording(), "--robot", self.robot(), "--json").json
        self.assertLess(max(found["RMS"]), 0.1)

    def test_other_names_are_an_error_with_both_lists(self):
        robot = self.robot(ARM.replace("shoulder_joint", "shoulder_pan"))
        for command in (("robot", "identify"), ("robot", "force"), ("measure", "--force-source", "virtual")):
            self.refused(BAD_DATA, *command, self.recording(samples=500), "--robot", robot,
                         says=("elbow_joint, shoulder_joint", "shoulder_pan, elbow_joint", "--channels q1="))

    def test_a_map_may_not_contradict_the_names(self):
        path = self.recording(samples=500)
        names = [f"/joint_states.{what}.{joint}" for what in ("position", "effort")
                 for joint in ("elbow_joint", "shoulder_joint")]
        swapped = "q1={0},q2={1},tau1={2},tau2={3}".format(*names)
        self.refused(BAD_DATA, "robot", "identify", path, "--robot", self.robot(), "--channels", swapped,
                     says=("'elbow_joint'", "q1=NAME"))

    def test_a_map_says_which_joint_is_which_where_names_differ(self):
        path = self.recording()
        names = [f"/joint_states.{what}.{joint}" for what in ("position", "effort")
                 for joint in ("shoulder_joint", "elbow_joint")]
        robot = self.robot(ARM.replace("shoulder_joint", "pan").replace("elbow_joint", "lift"))
        found = self.mbk("robot", "identify", "--robot", robot, "--json", path, "--channels",
                         "q1={0},q2={1},tau1={2},tau2={3}".format(*names)).json
        self.assertAlmostEqual(values(found)["fore.mass_x"], MASS_X, delta=0.002)

    def test_a_robot_without_names_has_as_many_joints_as_the_recording(self):
        path = self.recording(lambda k: ("elbow_joint", "finger", "shoulder_joint"), samples=500)
        self.refused(BAD_DATA, "robot", "identify", path,
                     says=("'elbow_joint', 'finger', 'shoulder_joint'", "--channels"))

    def test_a_length_is_no_angle(self):
        path = self.recording(samples=500)
        names = [f"/joint_states.{what}.{joint}" for what in ("position", "effort")
                 for joint in ("shoulder_joint", "elbow_joint")]
        self.refused(BAD_DATA, "robot", "identify", path, "--robot", self.robot(), "--channels",
                     "q1={0}:m,q2={1},tau1={2},tau2={3}".format(*names), says=("'joint_1'", " rad"))
        ran = self.mbk("info", self.recording(lambda k: ("finger",), samples=500))
        self.assertNotIn("rad", ran.out)


class Emps(Case):
    """A. Janot, M. Gautier, M. Brunot (2019): one drive that slides, with the values that were published for it."""

    def test_finds_the_published_values(self):
        found = run("robot", "identify", data_folder("emps", "DATA_EMPS.mat"), "--robot", ROBOTS / "emps.toml",
                    "--channels", "q1=qm:m,tau1=vir*35.15065188:N,time=t", "--cutoff", "100", "--json")
        self.assertEqual(found.code, 0, found)
        published = (("mass", 95.1089, 0.005), ("viscous_1", 203.5034, 0.03), ("coulomb_1", 20.3935, 0.03))
        for name, value, share in published:
            self.assertAlmostEqual(values(found.json)[name], value, delta=share * value, msg=name)
        self.assertGreaterEqual(found.json["fit"][0]["VAF_in_sample"], 99.7)

    def test_a_drive_that_can_exist_has_them_too(self):
        arguments = ("robot", "identify", data_folder("emps", "DATA_EMPS.mat"), "--robot", ROBOTS / "emps.toml",
                     "--channels", "q1=qm:m,tau1=vir*35.15065188:N,time=t", "--cutoff", "100", "--json")
        free, found = run(*arguments), run(*arguments, "--consistent")
        self.assertEqual(found.code, 0, found)
        for name, value in values(free.json).items():
            self.assertAlmostEqual(values(found.json)[name], value, delta=1e-3 * abs(value), msg=name)
        self.assertLess(found.json["consistent"]["VAF_lost_in_sample"][0], 1e-3)

    def test_a_mass_that_nobody_stated_cannot_be_fixed(self):
        self.refused(WRONG_USAGE, "robot", "identify", data_folder("emps", "DATA_EMPS.mat"), "--robot",
                     ROBOTS / "emps.toml", "--fix", "mass", says=["--fix", "'mass'"])


class DoublePendulum(Case):
    """The double pendulum of examples/robots, whose encoders have steps of 0.38 mrad and whose clock is uneven."""

    TRAINING = [f"C1_20230629-{name}.csv" for name in ("143339", "143524", "143601", "143704", "143747", "143906")]
    JUDGING = "C1_20230629-154220.csv"

    def identify(self, *files, code=0):
        folder = data_folder("double_pendulum")
        return self.mbk("robot", "identify", *files, "--robot", ROBOTS / "double_pendulum.toml", "--fix",
                        "upper.mass_x,lower.mass_x", "--resample", "500", "--channels",
                        "time=time,q1=pos_meas1,q2=pos_meas2,tau1=tau_meas1,tau2=tau_meas2", "--json", folder=folder,
                        code=code).json

    def judged(self, *options, code=0):
        return self.identify(*self.TRAINING, "--held-out", self.JUDGING, *options, code=code)["fit"]

    def test_predicts_a_recording_that_it_has_not_seen(self):
        one, two = (fit["VAF"] for fit in self.judged("--cutoff", "5"))
        self.assertGreaterEqual(one, 92)
        self.assertGreaterEqual(two, 95)

    def test_links_that_can_exist_predict_as_well(self):
        for band in ("5", "10"):
            with self.subTest(band):
                found = self.identify(*self.TRAINING, "--held-out", self.JUDGING, "--cutoff", band, "--consistent")
                consistent = found["consistent"]
                self.assertEqual([link["name"] for link in consistent["links"]], ["upper", "lower"])
                for link in consistent["links"]:
                    self.assertGreater(link["mass_kg"], 0)
                    self.assertGreater(link["pseudo_inertia_smallest_eigenvalue"], 0)
                    # no moment of inertia exceeds the sum of the others
                    moments = [link["inertia_about_centre_kg_m2"][k][k] for k in range(3)]
                    self.assertLess(max(moments), sum(moments) - max(moments))
                self.assertEqual([link["centre_m"][0] for link in consistent["links"]], [0, 0])  # --fix
                self.assertLess(max(consistent["VAF_lost"] + consistent["VAF_lost_in_sample"]), 0.5)
                self.assertNotIn("consistent-fit-poor", codes(found))

    def test_links_that_can_exist_contradict_a_torque_of_the_wrong_sign(self):
        turned = "time=time,q1=pos_meas1,q2=pos_meas2,tau1=tau_meas1,tau2=-tau_meas2"
        ran = self.mbk("robot", "identify", *self.TRAINING, "--robot", ROBOTS / "double_pendulum.toml", "--resample",
                       "500", "--channels", turned, "--cutoff", "5", "--consistent", "--json",
                       folder=data_folder("double_pendulum"), code=NOT_USABLE)
        self.assertIn("consistent-fit-poor", codes(ran.json))
        self.assertGreater(max(ran.json["consistent"]["VAF_lost_in_sample"]), 10)

    def test_the_text_shows_links_and_says_what_is_open(self):
        text = self.fine("robot", "identify", *self.TRAINING, "--robot", ROBOTS / "double_pendulum.toml", "--fix",
                         "upper.mass_x,lower.mass_x", "--resample", "500", "--channels",
                         "time=time,q1=pos_meas1,q2=pos_meas2,tau1=tau_meas1,tau2=tau_meas2", "--consistent",
                         folder=data_folder("double_pendulum")).out
        self.assert_lines_fit(text)
        for words in ("mass kg", "free fit"):
            self.assertIn(words, " ".join(text.split()))

    def test_noise_of_a_wide_band_biases_least_squares_and_not_instruments(self):
        by_squares = self.judged("--cutoff", "20", code=NOT_USABLE)
        self.assertLess(by_squares[0]["VAF"], 73)
        self.assertLess(by_squares[1]["VAF"], 83)
        by_instruments = self.judged("--cutoff", "20", "--method", "iv")
        self.assertGreaterEqual(by_instruments[0]["VAF_from_smoothed_motion"], 85)
        self.assertGreaterEqual(by_instruments[1]["VAF_from_smoothed_motion"], 90)

    def test_what_a_joint_that_stands_still_cannot_show_is_named(self):
        found = self.identify("C1_20230629-143906.csv", code=NOT_USABLE)
        self.assertIn("joint 2", " ".join(found["notes"]))
        self.assertIsNone(found["fit"][1]["VAF"])
        missing = {one["name"] for one in found["parameters"] if not one["identified"] and not one.get("fixed")}
        self.assertLessEqual({"lower.inertia_yy", "motor_inertia_2", "viscous_2", "coulomb_2", "offset_2"}, missing)
        self.assertLess(found["excitation"]["rank"], found["excitation"]["structural_rank"])
        warning = next(one["message"] for one in found["warnings"] if one["code"] == "poorly-conditioned")
        for name in ("motor_inertia_2", "viscous_2", "coulomb_2"):
            self.assertIn(name, warning)


if __name__ == "__main__":
    main()
