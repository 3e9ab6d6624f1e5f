#!/usr/bin/env python3
"""mbk teleop: known answers of Llewellyn's criterion, the operator's excess, intervals of a parameter, wrong input."""

import json
import pathlib
import re

from command import BAD_DATA, NOT_USABLE, WRONG_USAGE, Case, main, make_log, run

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples/teleop"
DESIGN = """[architecture]
kind = "position-position"
[master]
mass_kg = 0
damping_N_s_per_m = {b_m}
controller_damping_N_s_per_m = {d_m}
controller_stiffness_N_per_m = {k_m}
[slave]
mass_kg = 0
damping_N_s_per_m = {b_s}
controller_damping_N_s_per_m = {d_s}
controller_stiffness_N_per_m = {k_s}
"""
TWO_PORT = """[two_port]
form = "{form}"
{form}11 = {{numerator = {n11}}}
{form}12 = {{numerator = {n12}}}
{form}21 = {{numerator = {n21}}}
{form}22 = {{numerator = {n22}}}
"""


def result(index=(4.0, 6.0), band=(0.5, 3.0), schema="mbk.result/2", **changed):
    """What 'mbk measure --json' says of an operator whose smallest index has that interval."""
    low, high = index
    model = {"method": "ls", "VAF": [98.0, 97.0], "usable": True, "fits": True, "band_hz": band, "extrapolated": False,
             "index": {"frequency_hz": list(band), "lower95": [low, low + 1], "upper95": [high + 1, high]}}
    return json.dumps({"schema": schema, "usable": True, "warnings": [], "passivity": {
        "prediction": {"verdict": "passive"}, "band_hz": band, "models": [model]}, **changed})


class Teleop(Case):
    def design(self, extra="", **values):
        given = {"b_m": 2, "b_s": 3, "d_m": 10, "k_m": 100, "d_s": 20, "k_s": 200, **values}
        return self.file("design.toml", DESIGN.format(**given) + extra)

    def violated(self, found, key="llewellyn"):
        return [one["name"] for one in found[key]["conditions"] if not one["holds"]]

    def test_largest_a_is_the_closed_form(self):
        found = self.fine("teleop", self.design(), "--json").json
        self.assertEqual((found["schema"], found["decided"]), ("mbk.teleop/1", "exactly"))
        self.assertEqual(found["llewellyn"]["verdict"], "stable")
        one, two = found["largest_a"]
        self.assertAlmostEqual(two["a"], 19 / 3, delta=1e-12)
        self.assertLess(two["at_most"] - two["at_least"], 1e-12)
        self.assertAlmostEqual(one["a"], 2 + 10 * 3 / 23, delta=1e-12)

    def test_numbers_whose_exact_answer_would_take_minutes_are_refused(self):
        delay = "[delay]\nto_slave_ms = {}\nto_master_ms = 5\n"
        self.refused(BAD_DATA, "teleop", self.design(delay.format("1e-320")),
                     says=("delay.to_slave_ms", "1e-06 s"))
        self.refused(BAD_DATA, "teleop", self.design(k_s="1e300"),
                     says=("slave.controller_stiffness_N_per_m", "1e+12"))
        for option in ("--parameter=slave.k=0:1e300", "--parameter=slave.k=1e-320:1"):
            self.refused(WRONG_USAGE, "teleop", self.design(), option, says=("--parameter", "1e+12"
                         if "300" in option else "1e-09"))
        self.refused(WRONG_USAGE, "teleop", self.design(), "--parameter=slave.k=0:1", "--excess=0:1e300",
                     says="--excess 0:1e300")
        self.fine("teleop", self.design(delay.format(0), k_s="1e12"), "--json")

    def test_without_damping_only_one_ratio_is_stable(self):
        for k_s, verdict in ((200, "marginal"), (210, "unstable"), (190, "unstable")):
            found = self.fine("teleop", self.design(b_m=0, b_s=0, k_s=k_s), "--json").json
            self.assertEqual(found["llewellyn"]["verdict"], verdict, k_s)
        found = self.fine("teleop", self.design(b_m=0, b_s=0), "--json", "--parameter", "slave.k=0:1000").json
        (only,) = found["admissible"]["intervals"]
        self.assertEqual((only["low"]["value"], only["high"]["value"]), (200, 200))

    def test_the_stable_stiffnesses_are_an_interval_with_two_ends(self):
        ran = self.fine("teleop", self.design(b_m=1, b_s=1), "--json", "--parameter", "slave.k=0:1000")
        (interval,) = ran.json["admissible"]["intervals"]
        self.assertAlmostEqual(interval["low"]["value"], 92.754616, places=6)
        self.assertAlmostEqual(interval["high"]["value"], 431.245384, places=6)
        text = self.fine("teleop", self.design(b_m=1, b_s=1), "--parameter", "slave.k=0:1000").out
        self.assertRegex(text, r"92\.76 .*431\.2")
        self.assert_lines_fit(text)

    def test_a_resonance_narrower_than_a_grid_is_found(self):
        ran = self.fine("teleop", EXAMPLES / "narrow_resonance.toml", "--json").json
        self.assertEqual(self.violated(ran), ["r11", "product"])
        (band,) = ran["llewellyn"]["conditions"][2]["violated"]
        self.assertAlmostEqual(band["worst"], 10, places=3)
        self.assertAlmostEqual(band["value"], -0.01, places=6)
        self.assertIn("r11 ≥ 0", self.fine("teleop", EXAMPLES / "narrow_resonance.toml").out)
        curve = ran["curves"][0]
        at = min(range(len(curve["value"])), key=curve["value"].__getitem__)
        self.assertAlmostEqual(curve["frequency"][at], 10, places=3)
        self.assertLess(curve["value"][at], 0)
        self.assertEqual(curve["frequency"], sorted(curve["frequency"]))

    def test_the_ideal_teleoperator_is_marginal(self):
        ideal = self.file("ideal.toml", TWO_PORT.format(form="h", n11="[0]", n12="[1]", n21="[-1]", n22="[0]"))
        found = self.fine("teleop", ideal, "--json").json["llewellyn"]
        self.assertEqual((found["verdict"], found["equality_everywhere"]), ("marginal", True))

    def test_position_force_fails_for_every_gain(self):
        found = self.fine("teleop", EXAMPLES / "position_force.toml", "--json", "--parameter",
                          "channels.force_to_master=0:2").json
        self.assertEqual(self.violated(found), ["squares"])
        (only,) = found["admissible"]["intervals"]
        self.assertEqual((only["low"]["value"], only["high"]["value"]), (0, 0))

    def test_the_operator_counts_with_the_lower_bound_of_the_index_in_its_band(self):
        design = self.design("[operator]\nport = 2\n")
        for interval, verdict in (([4.0, 6.0], "stable"), ([-6.3, 1.0], "stable"), ([-6.4, 1.0], "unstable")):
            found = self.fine("teleop", design, "--operator", self.file("r.json", result(interval)), "--json").json
            self.assertEqual(found["operator"]["a"], -interval[0])
            self.assertEqual(found["modified_llewellyn"]["verdict"], verdict, interval)
        text = self.fine("teleop", design, "--operator", self.file("r.json", result([-7.0, -1.0]))).out
        self.assertRegex(" ".join(text.split()), r"\b0\.5 .*\b3 Hz")
        self.assertIn("shortage", text)

    def test_a_result_that_is_not_usable_is_refused(self):
        good = json.loads(result())
        none, poor, bare = (json.loads(result()) for _ in range(3))
        none["passivity"]["prediction"]["verdict"] = "none"
        poor["passivity"]["models"][0]["fits"] = False
        bare["passivity"]["band_hz"] = None
        for name, document, says in (
                ("flag", {**good, "usable": False}, "not usable"), ("none", none, "not usable"),
                ("first", {**good, "schema": "mbk.result/1", "usable": False}, "not usable"),
                ("poor", poor, "too little of the force"), ("band", bare, "excited coherently"),
                ("warned", {**good, "warnings": [{"code": "fit-poor"}]}, "too little of the force"),
                ("former word", {**good, "warnings": [{"code": "held-back-fit-poor"}]}, "too little of the force")):
            with self.subTest(name):
                self.refused(NOT_USABLE, "teleop", self.design(), "--operator",
                             self.file(f"{name}.json", json.dumps(document)), says=[f"{name}.json", says])

    def test_a_measured_result_that_is_not_usable_is_refused(self):
        recording, measured = self.folder / "rigid.mat", self.folder / "rigid.json"
        self.fine("simulate", "rigid_underdamped_2N", "--out", recording, "--quiet")
        self.assertFalse(run("measure", recording, "--json", "--quiet").json["usable"])
        run("measure", recording, "--json", "--quiet", "--out", measured)
        self.refused(NOT_USABLE, "teleop", self.design(), "--operator", measured, says=[str(measured), "not usable"])

    def test_a_measured_operator_is_taken_with_its_antisymmetric_part(self):
        measured = self.folder / "measured.json"
        self.fine("measure", make_log().path, "--json", "--out", measured)
        passivity = json.loads(measured.read_text())["passivity"]
        lowest = min(passivity["models"][0]["index"]["lower95"])
        found = self.fine("teleop", self.design(), "--operator", measured, "--json").json
        self.assertEqual(found["operator"]["a"], -lowest)
        self.assertLess(lowest, passivity["eop"]["interval95"][0])  # of the symmetric part alone
        self.assertEqual(found["operator"]["port"], 1)

    def test_exact_delay_names_its_grid(self):
        delay = ("[delay]\nto_slave_ms = 5\nto_master_ms = 5\nexact = true\ngrid_from_rad_per_s = 0.1\n"
                 "grid_to_rad_per_s = 1000\ngrid_points = 500\n")
        ran = self.fine("teleop", self.design(delay))
        for fact in ("500 points", "0.1", "1000 rad/s"):
            self.assertIn(fact, ran.out)
        self.assertEqual(self.fine("teleop", self.design(delay), "--json").json["decided"], "on the grid")
        self.refused(WRONG_USAGE, "teleop", self.design(delay), "--parameter", "slave.k=0:1", says="pade")

    def test_a_delay_is_the_true_one_unless_a_pade_order_is_given(self):
        delay = "[delay]\nto_slave_ms = 50\nto_master_ms = 50\n"
        true, pade, exact = (self.fine("teleop", self.design(delay + more), "--json").json
                             for more in ("", "pade = 2\n", "exact = true\n"))
        self.assertEqual((true["decided"], true["grid"]["bounded"]), ("on the grid", True))
        self.assertIsNone(true["grid"]["to"])  # all frequencies
        self.assertEqual((pade["decided"], "grid" in pade), ("exactly", False))
        self.assertEqual(true["llewellyn"], exact["llewellyn"])
        self.assertNotEqual(true["largest_a"], pade["largest_a"])
        for one in true["largest_a"]:
            self.assertLess(one["at_most"] - one["at_least"], 1e-4)
        self.refused(BAD_DATA, "teleop", self.design(delay + "pade = 2\nexact = true\n"), says="delay.exact")
        self.refused(WRONG_USAGE, "teleop", self.design(delay), "--parameter", "slave.k=0:1", says="pade")

    def test_true_delays_without_mass_are_worst_where_the_phase_is_a_turn(self):
        # r11 r22 = (b_m + d_m)(b_s + d_s), and p = d_m d_s e^(−jωT) at high frequencies: a at port 1 is b_m
        design = self.design("[delay]\nto_slave_ms = 20\nto_master_ms = 30\n", b_m=2, b_s=0, k_m=0, k_s=0)
        one = self.fine("teleop", design, "--json").json["largest_a"][0]
        self.assertAlmostEqual(one["at_most"], 2.0, delta=1e-5)
        self.assertAlmostEqual(one["at_least"], 2.0, delta=0.05)  # touches at all low frequencies: an early end

    def test_what_a_pade_approximation_invents_is_no_place_to_look(self):
        force = (EXAMPLES / "position_force.toml").read_text(encoding="utf-8")
        delay = "\n[delay]\nto_slave_ms = 50\nto_master_ms = 50\n"
        limit = 2.56 / 0.05  # where the phase of order 2 is off by 0.1 rad
        text = self.fine("teleop", self.file("pade.toml", force + delay + "pade = 2\n")).out
        worst = [float(number) for number in re.findall(r"worst\s+near\s+([\d.e+]+)\s+rad/s", text)]
        self.assertTrue(worst)
        self.assertLess(max(worst), limit * 1.01)

    def test_curves_span_the_corners_of_the_design(self):
        for more in ("", "[delay]\nto_slave_ms = 50\n", "[delay]\nto_slave_ms = 50\npade = 3\n"):
            curve = self.fine("teleop", self.design(more, b_m=1, b_s=1), "--json").json["curves"][0]
            # corners k/(b + d) of 100/11 and 200/21 rad/s, k/d = 10 rad/s; 20 rad/s
            self.assertGreater(curve["frequency"][0], 0.5)
            self.assertLess(curve["frequency"][-1], 500)

    def test_an_operator_of_a_joint_that_turns_is_refused(self):
        turning = json.loads(result([1.0, 2.0]))
        turning["units"] = {"B": "N·m·s/rad"}
        self.refused(BAD_DATA, "teleop", self.design(), "--operator", self.file("r.json", json.dumps(turning)),
                     says=["r.json", "N·m·s/rad"])

    def test_an_excess_buys_stiffness(self):
        design, measured = self.design(b_m=1, b_s=1), self.file("r.json", result([4.0, 6.0]))
        ran = self.fine("teleop", design, "--parameter", "slave.k=0:5000", "--excess", "0:8:3", "--operator", measured,
                        "--charts", self.folder / "c", "--json", "--quiet").json["excess"]
        self.assertEqual([step["excess"] for step in ran["steps"]], [0, 4, 8])
        for step in ran["steps"]:
            # 4 (b_m + δ + d_m)(b_s + d_s) k_m k_s = (d_m k_s + d_s k_m)²: roots of k_s² + 2 (200 − q) k_s + 200²
            (interval,) = step["admissible"]["intervals"]
            half = 2 * (11 + step["excess"]) * 21 - 200
            root = (half * half - 200 * 200)**0.5
            self.assertAlmostEqual(interval["low"]["value"], half - root, places=6)
            self.assertAlmostEqual(interval["high"]["value"], half + root, places=6)
        self.assertLess(ran["steps"][-1]["felt"]["free"], ran["steps"][0]["felt"]["free"])
        drawn = (self.folder / "c_excess.svg").read_text(encoding="utf-8")
        self.assertIn("measured, low", drawn)
        text = self.fine("teleop", design, "--parameter", "slave.k=0:5000", "--excess", "0:8:3", "--quiet").out
        self.assertRegex(text, r"92\.76 .*431\.2")
        self.assert_lines_fit(text)
        self.refused(WRONG_USAGE, "teleop", design, "--excess", "0:8", says="--parameter")
        for wrong in ("", "1", "2:1", "0:8:1", "0:8:x", "0:8:5000", "a:b"):
            self.refused(WRONG_USAGE, "teleop", design, "--parameter", "slave.k=0:1", "--excess", wrong,
                         says="--excess")

    def test_a_simulation_agrees_with_the_criterion(self):
        for k_s, verdict, outcomes in ((200, "stable", ["dies_out"]), (1000, "unstable", ["dies_out", "grows"])):
            design = self.moving(k_s=k_s)
            found = self.fine("teleop", design, "--simulate", "--json", "--quiet").json
            self.assertEqual(found["llewellyn"]["verdict"], verdict)
            runs = found["simulation"]["runs"]
            self.assertEqual([run["outcome"] for run in runs], outcomes)
        expected = runs[1]["expected"]
        self.assertAlmostEqual(runs[1]["frequency"], expected["frequency"], delta=0.02 * expected["frequency"])
        for end in ("hand", "environment"):
            self.assertGreaterEqual(min(expected[end].values()), 0)
        text = self.fine("teleop", design, "--simulate", "--quiet", "--charts", self.folder / "s").out
        self.assertIn("GROWS", text)
        self.assert_lines_fit(text)
        for run in (1, 2):
            self.assertIn("</svg>", (self.folder / f"s_simulated-{run}.svg").read_text(encoding="utf-8"))

    def moving(self, extra="", **values):
        text = DESIGN.format(**{"b_m": 1, "b_s": 1, "d_m": 10, "k_m": 100, "d_s": 20, **values})
        return self.file("moving.toml", text.replace("mass_kg = 0", "mass_kg = 0.5") + extra)

    def test_a_lossy_line_loses_what_it_should(self):
        extra = "[simulation]\nduration_s = 5\nloss_percent = 20\njitter_ms = 4\nseed = 3\n"
        asked = ("teleop", self.moving(extra, k_s=200), "--simulate", "--quiet", "--json")
        (run,) = self.fine(*asked).json["simulation"]["runs"]
        self.assertEqual(run["packets"], 10000)
        self.assertAlmostEqual(run["packets_lost"], 2000, delta=160)  # four standard deviations
        again = self.fine(*asked).json["simulation"]["runs"]
        self.assertEqual(again, [run])

    def test_what_cannot_be_simulated_is_refused(self):
        self.refused(WRONG_USAGE, "teleop", self.design(), "--simulate", says="mass_kg")
        narrow = EXAMPLES / "narrow_resonance.toml"
        self.refused(WRONG_USAGE, "teleop", narrow, "--simulate", says="architecture")
        for wrong, says in (("loss_percent = 101", "loss_percent"), ("on_loss = 'what'", "on_loss"),
                            ("rate_hz = 0", "rate_hz"), ("[simulation.patient]\nparticipant = 7", "participant"),
                            ("[simulation.patient]\nkind = 'impedance'\nmass_kg = -1", "mass_kg")):
            self.refused(BAD_DATA, "teleop", self.moving(f"[simulation]\n{wrong}\n", k_s=200), says=says)

    def test_charts_are_written_and_not_over_others(self):
        prefix = self.folder / "c"
        self.fine("teleop", self.design(), "--charts", prefix)
        for name in ("r11", "r22", "third"):
            self.assertIn("</svg>", (self.folder / f"c_{name}.svg").read_text(encoding="utf-8"))
        self.refused(WRONG_USAGE, "teleop", self.design(), "--charts", prefix, says=["c_r11.svg", "--overwrite"])
        self.fine("teleop", self.design(), "--charts", prefix, "--overwrite")
        self.refused(WRONG_USAGE, "teleop", self.design(), "--overwrite", says="--charts")

    def test_malformed_two_ports_name_the_entry(self):
        good = dict(form="z", n11="[1]", n12="[0]", n21="[0]", n22="[1]")
        for change, says in ((dict(n12="[]"), "z12.numerator"), (dict(n21='["a"]'), "z21.numerator"),
                             (dict(n22="[1], denominator = [0]"), "z22.denominator"),
                             (dict(n11="[inf]"), "z11.numerator"), (dict(n11="1"), "z11.numerator")):
            path = self.file("bad.toml", TWO_PORT.format(**{**good, **change}))
            self.refused(BAD_DATA, "teleop", path, says=["bad.toml", says])
        path = self.file("bad.toml", re.sub("z21.*\n", "", TWO_PORT.format(**good)))
        self.refused(BAD_DATA, "teleop", path, says="z21")
        path = self.file("bad.toml", TWO_PORT.format(**good) + "z33 = 1\n")
        self.refused(BAD_DATA, "teleop", path, says="z33")

    def test_wrong_input_is_refused(self):
        self.refused(BAD_DATA, "teleop", self.folder / "none.toml", says="none.toml")
        self.refused(BAD_DATA, "teleop", self.file("empty.toml", ""), says="architecture")
        self.refused(BAD_DATA, "teleop", self.design(b_m='"much"'), says="damping_N_s_per_m")
        self.refused(WRONG_USAGE, "teleop", self.design(), "--parameter", "slave.q=0:1", says=["slave.q", "slave.k"])
        for wrong in ("slave.k", "slave.k=1", "slave.k=2:1", "slave.k=a:b", ""):
            self.refused(WRONG_USAGE, "teleop", self.design(), "--parameter", wrong, says="--parameter")
        narrow = EXAMPLES / "narrow_resonance.toml"
        self.refused(WRONG_USAGE, "teleop", narrow, "--parameter", "slave.k=0:1", says="architecture")
        for content, says in (("{", "byte"), ("{}", "schema"),
                              ('{"schema": "mbk.result/2", "passivity": {}}', "operator")):
            path = self.file("r.json", content)
            self.refused(BAD_DATA, "teleop", self.design(), "--operator", path, says=["r.json", says])
        twice = self.design("[operator]\nshortage_N_s_per_m = 1\n")
        self.refused(WRONG_USAGE, "teleop", twice, "--operator", self.file("r.json", result([1, 2])),
                     says="shortage_N_s_per_m")
        none = self.file("none.toml", TWO_PORT.format(form="z", n11="[0]", n12="[0]", n21="[0]", n22="[0]"))
        self.fine("teleop", none)

    def test_every_example_runs(self):
        for path in sorted(EXAMPLES.glob("*.toml")):
            with self.subTest(path.name):
                self.assert_lines_fit(self.fine("teleop", path).out)


if __name__ == "__main__":
    main()
