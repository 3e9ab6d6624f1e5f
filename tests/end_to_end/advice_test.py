#!/usr/bin/env python3
"""The advice of every warning, followed on the recording that raised it: the warning goes, or the truth is nearer."""

import functools
import json
import math
import pathlib
import random
import re
import tempfile
import unittest

import schemas
from command import NOT_USABLE, Case, flat, main, run, write_csv
from help_tree import every_command
from mistakes import as_option, first_options, right_map
from explore_test import trial
from tf_test import oscillator

ROOT = pathlib.Path(__file__).parents[2]
CODES = schemas.validator("result").schema["definitions"]["WarningCode"]["enum"]

OF_OTHER_PROGRAMS = ("slurm_engine.cpp", "chart_format.cpp")  # which call programs with their own options

ADVICE = {}  # code: a function of the test case, which raises it and follows its advice


def advice_of(code):
    def remember(function):
        ADVICE[code] = function
        return function
    return remember


def codes_of(ran):
    return [warning["code"] for warning in ran.json["warnings"]]


def hint_of(ran, code):
    return next(warning["try"] for warning in ran.json["warnings"] if warning["code"] == code)


@functools.lru_cache(maxsize=None)
def shared_folder():
    folder = tempfile.TemporaryDirectory(prefix="mbk-advice-")
    unittest.addModuleCleanup(folder.cleanup)
    return pathlib.Path(folder.name)


@functools.lru_cache(maxsize=None)
def scenario_text(name):
    return run("simulate", "--show", name).out


@functools.lru_cache(maxsize=None)
def recording_of(name, text, seed, trial):
    folder = pathlib.Path(tempfile.mkdtemp(dir=shared_folder()))
    scenario = folder / f"{name}.toml"
    scenario.write_text(text, encoding="utf-8")
    ran = run("simulate", scenario, "--seed", seed, "--out", folder / f"{name}.h5", "--quiet",
              *(("--trial", trial) if trial else ()))
    if ran.code != 0:
        raise AssertionError(ran)
    return next(folder.glob(f"{name}*.h5"))


@functools.lru_cache(maxsize=None)
def columns_of(path):
    table = path.parent / "table.csv"
    if run("convert", path, table, "--overwrite").code != 0:
        raise AssertionError(f"{path} is not converted")
    lines = [line for line in table.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    rows = [list(map(float, line.split(","))) for line in lines[1:]]
    return lines[0].split(","), [list(column) for column in zip(*rows)]


class Advice(Case):
    def simulated(self, name, *changes, seed=1, trial=None):
        """A ready scenario with lines replaced, as a recording; simulated once."""
        text = scenario_text(name)
        for pattern, line in changes:
            text, count = re.subn(pattern, line, text, count=1, flags=re.M)
            self.assertEqual(count, 1, f"{pattern} is not in {name}")
        return recording_of(name, text, seed, trial)

    def columns(self, path):
        """Names and columns of a recording, as a table."""
        names, columns = columns_of(path)
        return names, list(columns)

    def with_columns(self, path, name, **changes):
        """The recording as a table in which columns are changed, each by a function of its values."""
        names, columns = self.columns(path)
        for column, change in changes.items():
            k = next(i for i, full in enumerate(names) if full.startswith(column))
            columns[k] = change(columns[k])
        return write_csv(self.folder / name, columns, names)

    def measured(self, *arguments):
        return run("measure", "--json", "--quiet", *arguments)

    def goes(self, code, raised, followed):
        self.assertIn(code, codes_of(raised), raised)
        self.assertNotIn(code, codes_of(followed), followed)

    def truth_is_nearer(self, code, raised, followed, path):
        self.assertIn(code, codes_of(raised), raised)
        metadata = run("info", path, "--json").json["metadata"]
        truth = {name: json.loads(metadata[f"truth_{name}"]) for name in "MBK"}

        def distance(ran):
            return sum(sum((a - b) ** 2 for a, b in zip(flat(ran.json["model"][name]), flat(truth[name]))) /
                       sum(b ** 2 for b in flat(truth[name])) for name in "MBK")
        self.assertLess(distance(followed), distance(raised))

    def test_every_code_has_its_advice_followed(self):
        for code in CODES:
            with self.subTest(code):
                self.assertIn(code, ADVICE)
                ADVICE[code](self)

    def test_only_options_and_commands_that_exist_are_named(self):
        """In every message of the library and the program."""
        tree = every_command()
        options = {option for command in tree for option in command.options} | {"--help"}
        options |= {"--for", "--install"}  # of the robot that misbehaves; of CMake
        options |= {"--help-all", "--held-back", "--least-extension", "--most-delay", "--most-springs"}  # read for one version
        commands = {command.path[0] for command in tree if command.path}
        for source in sorted(ROOT.glob("mbk/**/*.cpp")) + sorted(ROOT.glob("apps/mbk/**/*.cpp")):
            if source.name.endswith("_test.cpp") or source.name in OF_OTHER_PROGRAMS:
                continue
            for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', source.read_text(encoding="utf-8")):
                for option in re.findall(r"(?<![\w-])(--[a-z][a-z-]+)", text):
                    self.assertIn(option, options, f"{source.relative_to(ROOT)}: {text}")
                for command in re.findall(r"'mbk ([a-z]+)", text):
                    self.assertIn(command, commands, f"{source.relative_to(ROOT)}: {text}")


# ---- what a recording was read as ----

def read_wrongly(test, code, change, *options, scenario="relaxed_sinusoidal"):
    path = test.simulated(scenario)
    raised = test.measured(*as_option(change(right_map())), *options, path)
    followed = test.measured(*first_options(hint_of(raised, code)), *options, path)
    test.goes(code, raised, followed)
    test.assertIs(followed.json["usable"], True)


@advice_of("implausible-scale")
def _(test):
    read_wrongly(test, "implausible-scale", lambda e: {**e, "x": "hand_x*1000", "y": "hand_y*1000"})


@advice_of("axes-scaled-differently")
def _(test):
    read_wrongly(test, "axes-scaled-differently", lambda e: {**e, "Fy": "force_y*0.224809"})  # lbf


@advice_of("force-sign-reversed")
def _(test):
    read_wrongly(test, "force-sign-reversed", lambda e: {**e, "Fx": "-force_x", "Fy": "-force_y"})


@advice_of("axes-mismatched")
def _(test):
    read_wrongly(test, "axes-mismatched", lambda e: {**e, "Fx": "-force_x"})


@advice_of("inertia-not-symmetric")
def _(test):  # turn the force back, or correct its gain
    path = test.simulated("relaxed_sinusoidal")
    names, columns = test.columns(path)
    x, y = (columns[next(k for k, full in enumerate(names) if full.startswith(name))] for name in ("force_x", "force_y"))
    for degrees in (4, -12):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        turned = test.with_columns(path, f"turned_{degrees}.csv",
                                   force_x=lambda _: [c * a - s * b for a, b in zip(x, y)],
                                   force_y=lambda _: [s * a + c * b for a, b in zip(x, y)])
        raised = test.measured("--handle-mass", 0.194, turned)
        options = first_options(hint_of(raised, "inertia-not-symmetric"))
        test.assertEqual(options[0], "--force-rotation-deg")
        test.assertAlmostEqual(float(options[1]), -degrees, delta=1)
        followed = test.measured("--handle-mass", 0.194, *options, turned)
        test.goes("inertia-not-symmetric", raised, followed)
        truth = test.measured(path).json["model"]["K"]
        for a, b in zip(flat(followed.json["model"]["K"]), flat(truth)):
            test.assertAlmostEqual(a, b, delta=3)


@advice_of("same-column")
def _(test):  # name the right column
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured(*as_option({**right_map(), "Fy": "force_x"}), path)
    test.goes("same-column", raised, test.measured(*as_option(right_map()), path))


@advice_of("other-column")
def _(test):  # without --channels the file's own names are taken
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured(*as_option({**right_map(), "x": "reference_x"}), path)
    test.assertIn("--channels", hint_of(raised, "other-column"))
    test.goes("other-column", raised, test.measured(path))


@advice_of("consistent-fit-poor")
def _(test):  # check the sign of each torque
    arm, turned = two_links(test), two_links(test, turned=True)
    raised = identified_robot(test, turned, "--consistent", "--terms", "motor_inertia,viscous,coulomb,offset")
    test.assertIn("sign", hint_of(raised, "consistent-fit-poor"))
    test.assertIs(raised.json["usable"], False)
    followed = identified_robot(test, arm, "--consistent", "--terms", "motor_inertia,viscous,coulomb,offset")
    test.goes("consistent-fit-poor", raised, followed)
    test.assertIs(followed.json["usable"], True)
    # and a term that is missing: the rotor of the second joint
    raised = identified_robot(test, arm, "--consistent", "--terms", "viscous,coulomb,offset")
    terms = first_options(hint_of(raised, "consistent-fit-poor"))
    test.goes("consistent-fit-poor", raised, identified_robot(test, arm, "--consistent", *terms))


@advice_of("handle-mass-too-large")
def _(test):  # leave it out
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured("--handle-mass", "5", path)
    test.goes("handle-mass-too-large", raised, test.measured(path))


# ---- the model ----

@advice_of("inertia-not-positive")
def _(test):
    code, path = "inertia-not-positive", test.simulated("rigid_sinusoidal_6N")
    raised = test.measured("--method", "ls", path)
    test.assertEqual(first_options(hint_of(raised, code)), ("--method", "iv"))
    followed = test.measured("--method", "iv", path)
    test.goes(code, raised, followed)
    test.assertIs(followed.json["usable"], True)
    test.truth_is_nearer(code, raised, followed, path)
    # and the filter, where that is the cause
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured("--cutoff", "0.3", path)
    test.assertIn("--cutoff", hint_of(raised, code))
    test.goes(code, raised, test.measured(path))
    # of a robot: rotors behind gears that nobody modelled
    arm = two_links(test)
    raised = identified_robot(test, arm, "--terms", "viscous,coulomb,offset")
    terms = first_options(hint_of(raised, code))
    test.assertEqual(terms, ("--terms", "motor_inertia,viscous,coulomb,offset"))
    followed = identified_robot(test, arm, *terms)
    test.goes(code, raised, followed)
    test.assertIs(followed.json["usable"], True)
    # and too little motion, of which bodies that can exist are found all the same
    faint = two_links(test, rotor=0.0, noise=5.0)
    raised = identified_robot(test, faint, "--terms", "viscous,coulomb,offset")
    test.assertIn("--consistent", hint_of(raised, code))
    followed = identified_robot(test, faint, "--terms", "viscous,coulomb,offset", "--consistent")
    test.goes(code, raised, followed)
    test.assertIs(followed.json["usable"], True)


@advice_of("stiffness-not-positive")
def _(test):
    code, path = "stiffness-not-positive", test.simulated("force_task")
    raised = test.measured("--method", "ls", path)
    test.assertEqual(first_options(hint_of(raised, code)), ("--method", "iv"))
    test.goes(code, raised, test.measured("--method", "iv", path))


@advice_of("damping-not-positive")
def _(test):  # the energy says whether the limb acted
    code, path = "damping-not-positive", test.simulated("rigid_underdamped_2N")
    raised = test.measured(path)
    test.assertIn(code, codes_of(raised), raised)
    test.assertIn("mbk passivity", hint_of(raised, code))
    absorbed = float(run("info", path, "--json").json["metadata"]["truth_energy_absorbed_J"])
    test.assertLess(absorbed, 0.0)
    trial = run("passivity", path, "--json", "--quiet").json["passivity"]["trial"]
    test.assertEqual(trial["verdict"], "active")


@advice_of("band-too-narrow")
def _(test):
    code, path = "band-too-narrow", test.simulated("relaxed_sinusoidal")
    raised = test.measured("--cutoff", "1", path)
    test.assertIn("--cutoff", hint_of(raised, code))
    test.goes(code, raised, test.measured(path))
    raised = test.measured(test.simulated("relaxed_sinusoidal", (r"^harmonics = .*$", "harmonics = [2, 3]")))
    test.assertIn("frequenc", hint_of(raised, code))
    test.goes(code, raised, test.measured(test.simulated("relaxed_sinusoidal")))


@advice_of("motion-on-one-line")
def _(test):
    code, path = "motion-on-one-line", test.simulated("one_axis_random_binary", trial="trial_1")
    raised = test.measured(path)
    options = first_options(hint_of(raised, code))
    test.assertEqual(options[:2], ("--axes", "1"))
    followed = test.measured(*options, path)
    test.goes(code, raised, followed)
    test.assertEqual(followed.json["axes"], 1)


@advice_of("motion-too-small")
def _(test):  # perturb more
    def in_steps(values):
        return [round(value, 4) for value in values]

    def coarse(peak):
        path = test.simulated("relaxed_sinusoidal", (r"^peak_deg = .*$", f"peak_deg = {peak}"))
        return test.with_columns(path, "coarse.csv", hand_x=in_steps, hand_y=in_steps)
    code = "motion-too-small"
    raised = test.measured(coarse(0.4))
    test.goes(code, raised, test.measured(coarse(4)))


@advice_of("poorly-conditioned")
def _(test):  # several frequencies
    raised = test.measured(test.simulated("relaxed_sinusoidal", (r"^harmonics = .*$", "harmonics = [10]"),
                                          (r"^floor_N = .*$", "floor_N = 0")))
    test.goes("poorly-conditioned", raised, test.measured(test.simulated("relaxed_sinusoidal")))


@advice_of("held-out-fit-poor")
def _(test):  # look at the parts
    code = "held-out-fit-poor"

    def changing(values):
        return [value if k < 48_000 else 3 * value for k, value in enumerate(values)]
    path = test.with_columns(test.simulated("relaxed_sinusoidal"), "changing.csv", force_x=changing, force_y=changing)
    raised = test.measured(path)
    test.assertIn("--to", hint_of(raised, code))
    test.goes(code, raised, test.measured("--to", "47", path))


@advice_of("fit-poor")
def _(test):
    code, path = "fit-poor", test.simulated("rigid_sinusoidal_6N")
    raised = test.measured("--method", "ls", path)
    test.assertEqual(first_options(hint_of(raised, code)), ("--method", "iv"))
    test.truth_is_nearer(code, raised, test.measured("--method", "iv", path), path)


@advice_of("closed-loop-bias")
def _(test):
    code, path = "closed-loop-bias", test.simulated("rigid_sinusoidal_6N")
    raised = test.measured("--method", "ls", path)
    test.assertEqual(first_options(hint_of(raised, code)), ("--method", "iv"))
    followed = test.measured("--method", "iv", path)
    test.goes(code, raised, followed)
    test.truth_is_nearer(code, raised, followed, path)


@advice_of("no-reference")
def _(test):
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured("--channels", "time=time,x=hand_x,y=hand_y,Fx=force_x,Fy=force_y", path)
    test.assertIn("xr, yr", hint_of(raised, "no-reference"))
    test.goes("no-reference", raised, test.measured(path))


@advice_of("unmodelled-response")
def _(test):  # ask for no response
    raised = test.measured(test.simulated("rigid_underdamped_2N"))
    quiet = test.simulated("rigid_underdamped_2N", (r"^position_gain = .*$", "position_gain = 0"))
    test.assertIn("response", hint_of(raised, "unmodelled-response"))
    test.goes("unmodelled-response", raised, test.measured(quiet))


def departing(test, line, *changes, scenario="relaxed_sinusoidal"):
    """The relaxed arm with something beside M, B and K."""
    return test.simulated(scenario, (r"^\[participant.remnant\]", f"{line}\n\n[participant.remnant]"), *changes)


@advice_of("missing-dynamics")
def _(test):
    path = test.simulated("relaxed_sinusoidal", (r'^kind = "load_cell"', 'kind = "load_cell"\ndelay_ms = 10'))
    raised = test.measured(path)
    test.assertIn("--force-delay-ms", hint_of(raised, "missing-dynamics"))
    followed = test.measured("--force-delay-ms", 10, path)
    test.goes("missing-dynamics", raised, followed)
    test.truth_is_nearer("missing-dynamics", raised, followed, path)


@advice_of("nonlinear-stiffness")
def _(test):  # perturb less
    cubic = "[participant.departures]\ncubic_stiffness_N_per_m3 = 1e6"
    raised = test.measured(departing(test, cubic))
    followed = test.measured(departing(test, cubic, (r"^peak_deg = 2 ", "peak_deg = 0.7 ")))
    test.goes("nonlinear-stiffness", raised, followed)


@advice_of("dry-friction")
def _(test):  # look for friction, and remove it
    path = departing(test, "[participant.departures]\ndry_friction_N = 0.5")
    raised = test.measured(path)
    test.goes("dry-friction", raised, test.measured(test.simulated("relaxed_sinusoidal")))
    # of a robot: friction that grows near standstill
    path = test.simulated("free_motion", (r"^\[robot\]$", "[robot]\nbreakaway_Nm = [0.06, 0.06]"))
    raised = run("robot", "identify", "--json", "--quiet", path)
    test.assertIn("--stribeck-velocity auto", hint_of(raised, "dry-friction"))
    test.goes("dry-friction", raised, run("robot", "identify", "--json", "--quiet", path, "--terms",
                                          "viscous,coulomb,stribeck,offset", "--stribeck-velocity", "auto"))


def on_a_drive(test, drive, slower=1, peak_deg=20):
    """The robot by itself, on a drive with these keys; its sines so many times slower."""
    period = 10 * slower
    path = test.simulated("free_motion", (r"^\[control\]$", f"[robot.capstan]\n{drive}\n\n[control]"),
                          (r"^steps_per_tick.*$|^home_mm", "steps_per_tick = 4\nhome_mm"),
                          (r"^period_s = 10", f"period_s = {period}"))
    return run("robot", "identify", "--json", "--quiet", path)


def advised_slowness(hint, top_hz):
    """By how much slower than `top_hz` the advice wants the motion to be."""
    return math.ceil(top_hz / float(re.search(r"([\d.]+) Hz", hint)[1]))


@advice_of("elastic-drive")
def _(test):  # move more slowly, or stiffen the drive
    raised = on_a_drive(test, "stiffness_Nm_per_rad = [400, 400]")
    slower = advised_slowness(hint_of(raised, "elastic-drive"), 1.9)
    test.goes("elastic-drive", raised, on_a_drive(test, "stiffness_Nm_per_rad = [400, 400]", slower))
    test.goes("elastic-drive", raised, on_a_drive(test, "stiffness_Nm_per_rad = [40000, 40000]"))


@advice_of("backlash")
def _(test):  # take the play out of the drive, or move more slowly
    stiff = "stiffness_Nm_per_rad = [20000, 20000]\n"
    raised = on_a_drive(test, stiff + "backlash_deg = [0.2, 0.2]")
    test.assertIn("play", hint_of(raised, "backlash"))
    test.goes("backlash", raised, on_a_drive(test, stiff))


@advice_of("robot-changed")
def _(test):  # identify the robot anew, in the condition of the measurement
    def identified(*changes):
        path = test.simulated("free_motion", *changes)
        out = path.with_suffix(".robot.json")
        run("robot", "identify", "--json", "--quiet", "--overwrite", "--out", out, path)
        return "--force-source", "virtual", "--robot", out
    arm = test.simulated("relaxed_virtual_sensor"), "--handle-mass", "0.135"
    cold = identified((r"^coulomb_Nm = .*$", "coulomb_Nm = [0.03, 0.03]\nviscous_Nms_per_rad = [0.13, 0.15]"))
    raised = test.measured(*arm, *cold)
    test.assertEqual(raised.code, NOT_USABLE)
    followed = test.measured(*arm, *identified())
    test.assertEqual(followed.code, 0)
    test.goes("robot-changed", raised, followed)


def changes_half_way(test, code, change):
    path = departing(test, "[[participant.stiffness_at]]\ntime_s = 30\nfactor = 1\n\n"
                           f"[[participant.stiffness_at]]\ntime_s = 31\n{change}")
    raised = test.measured(path)
    test.assertIn("--to", hint_of(raised, code))
    for part in (("--to", 29), ("--from", 33)):
        test.goes(code, raised, test.measured(*part, path))


@advice_of("stiffness-changes")
def _(test):
    changes_half_way(test, "stiffness-changes", "factor = 2")


@advice_of("damping-changes")
def _(test):
    changes_half_way(test, "damping-changes", "factor = 1\ndamping_factor = 2")


@advice_of("memory")
def _(test):  # 'mbk explore' shows what M, B and K lack
    raised = test.measured(departing(test, "[participant.departures]\nrelaxing_share = 0.3"))
    test.assertIn("mbk explore", hint_of(raised, "memory"))
    test.goes("memory", raised, test.measured(test.simulated("relaxed_sinusoidal")))


@advice_of("even-nonlinearity")
def _(test):
    raised = test.measured(departing(test, "[participant.departures]\none_sided_share = 0.6"))
    test.assertIn("mbk explore", hint_of(raised, "even-nonlinearity"))
    test.goes("even-nonlinearity", raised, test.measured(test.simulated("relaxed_sinusoidal")))


@advice_of("lack-of-fit")
def _(test):  # a limb that is stiffer on one side, which no M, B and K are
    raised = test.measured(departing(test, "[participant.departures]\none_sided_share = 0.9"))
    test.assertIn("mbk explore", hint_of(raised, "lack-of-fit"))
    test.goes("lack-of-fit", raised, test.measured(test.simulated("relaxed_sinusoidal")))


@advice_of("force-drifts")
def _(test):
    path = test.simulated("relaxed_sinusoidal",
                          (r'^kind = "load_cell"', 'kind = "load_cell"\ndrift_rate_N_per_s = [0.02, 0.02]'))
    raised = test.measured(path)
    test.assertIn("--from", hint_of(raised, "force-drifts"))
    test.goes("force-drifts", raised, test.measured("--from", 20, "--to", 34, path))


@advice_of("contact-lost")
def _(test):  # the hand leaves the handle, whose own inertia is 5 % of the force
    path = test.simulated("relaxed_sinusoidal")
    names, columns = test.columns(path)
    time = columns[0]

    def lost(values):
        return [0.05 * value if t > 30.37 else value for t, value in zip(time, values)]
    raised = test.measured(test.with_columns(path, "lost.csv", force_x=lost, force_y=lost))
    test.assertIs(raised.json["usable"], False)
    test.assertRegex(next(w["message"] for w in raised.json["warnings"] if w["code"] == "contact-lost"),
                     r"^from 31(\.\d)? s on the force varies by at most [4-9](\.\d)? %")
    followed = test.measured(*first_options(hint_of(raised, "contact-lost")), test.folder / "lost.csv")
    test.goes("contact-lost", raised, followed)
    test.assertIs(followed.json["usable"], True)


@advice_of("tremor")
def _(test):
    path = departing(test, "[participant.departures]\ntremor_N = 1\ntremor_hz = 4.5")
    raised = test.measured("--method", "ls", path)
    test.assertEqual(first_options(hint_of(raised, "tremor")), ("--method", "iv"))
    followed = test.measured("--method", "iv", path)
    test.goes("tremor", raised, followed)
    test.truth_is_nearer("tremor", raised, followed, path)


@advice_of("weak-instruments")
def _(test):
    code, path = "weak-instruments", test.simulated("rigid_underdamped_8N", seed=31)
    raised = test.measured("--method", "iv", path)
    test.assertEqual(first_options(hint_of(raised, code)), ("--method", "ls"))
    followed = test.measured("--method", "ls", path)
    test.goes(code, raised, followed)
    test.truth_is_nearer(code, raised, followed, path)


@advice_of("invalid-instruments")
def _(test):
    code, path = "invalid-instruments", test.simulated("rigid_underdamped_2N")
    raised = test.measured("--method", "iv", path)
    test.assertEqual(first_options(hint_of(raised, code)), ("--method", "ls"))
    followed = test.measured("--method", "ls", path)
    test.goes(code, raised, followed)
    test.truth_is_nearer(code, raised, followed, path)


@advice_of("mixed-conditions")
def _(test):  # pool only what belongs together
    def with_condition(name, condition):
        table = test.with_columns(test.simulated(name), f"{name}.csv")
        table.write_text(f"# mbk.recording/1\n# condition: {condition}\n" + table.read_text(encoding="utf-8"), encoding="utf-8")
        return table
    one, other = with_condition("relaxed_sinusoidal", "relaxed"), with_condition("relaxed_underdamped", "rigid")
    raised = test.measured("--pool", one, other)
    test.assertIn("pool", hint_of(raised, "mixed-conditions"))
    test.goes("mixed-conditions", raised, test.measured("--pool", one))


def excluded(test, key, text):
    """A recording of which its operator excluded something."""
    table = test.with_columns(test.simulated("relaxed_sinusoidal"), f"{key}.csv")
    table.write_text(f"# mbk.recording/1\n# {key}: {text}\n" + table.read_text(encoding="utf-8"), encoding="utf-8")
    return table


@advice_of("excluded-trial")
def _(test):  # leave it out
    one, other = excluded(test, "excluded", "coughed"), test.simulated("relaxed_underdamped")
    raised = test.measured(one)
    test.assertIn("recording", hint_of(raised, "excluded-trial"))
    test.goes("excluded-trial", raised, test.measured(other))


@advice_of("excluded-window")
def _(test):
    path = excluded(test, "excluded_windows", "20-24 s: coughed")
    raised = test.measured("--mode", "reference", path)
    test.assertIn("default", hint_of(raised, "excluded-window"))
    test.goes("excluded-window", raised, test.measured("--mode", "default", path))


@advice_of("no-held-out-data")
def _(test):
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured("--mode", "reference", "--to", "52", path)
    test.assertIn("--split", hint_of(raised, "no-held-out-data"))
    test.goes("no-held-out-data", raised, test.measured("--mode", "reference", path))


@advice_of("too-little-data")
def _(test):
    path = test.simulated("relaxed_sinusoidal")
    raised = test.measured("--from", "12", "--to", "22", path)
    test.assertRegex(hint_of(raised, "too-little-data"), r"\d s\b")
    test.goes("too-little-data", raised, test.measured(path))


@advice_of("decimation-changes-model")
def _(test):  # leave --sg-window out
    def hum(amplitude, phase):
        return lambda values: [v + amplitude * math.sin(2 * math.pi * 93 * k / 1000 + phase) for k, v in enumerate(values)]
    path = test.with_columns(test.simulated("relaxed_sinusoidal"), "hum.csv", force_x=hum(3.0, 0), hand_x=hum(1e-4, 0.5))
    raised = test.measured("--method", "ls", "--decimate-check", "--sg-window", "7", path)
    test.assertIn("--sg-window", hint_of(raised, "decimation-changes-model"))
    test.goes("decimation-changes-model", raised, test.measured("--method", "ls", "--decimate-check", path))


# ---- the recording ----

CLOCK = (r"^\[sensors.force\]$", "[sensors.clock]\njitter_us = 60\n[sensors.force]")


@advice_of("clock-jitter")
def _(test):
    path = test.simulated("relaxed_sinusoidal", CLOCK)
    raised = test.measured(path)
    test.assertIn("--resample", hint_of(raised, "clock-jitter"))
    test.goes("clock-jitter", raised, test.measured("--resample", "1000", path))


@advice_of("resampled")
def _(test):  # record with a steady clock
    raised = test.measured("--resample", "1000", test.simulated("relaxed_sinusoidal", CLOCK))
    test.goes("resampled", raised, test.measured(test.simulated("relaxed_sinusoidal")))


@advice_of("clipping")
def _(test):  # choose a window without it
    def clipped(values):
        return [max(-1.0, min(1.0, value)) if 10_000 < k < 25_000 else value for k, value in enumerate(values)]
    path = test.with_columns(test.simulated("relaxed_sinusoidal"), "clipped.csv", force_x=clipped)
    raised = test.measured("--from", "11", "--to", "24", path)
    test.assertIn("window", hint_of(raised, "clipping"))
    test.goes("clipping", raised, test.measured("--from", "25.1", path))


# ---- mbk tf and mbk robot identify ----

TWO_LINKS = """<robot name="two_links"><link name="base"/>
<joint name="one" type="continuous"><parent link="base"/><child link="first"/><axis xyz="0 0 1"/></joint>
<link name="first"><inertial><origin xyz="0.12 0 0"/><mass value="0.5"/>
  <inertia ixx="0.001" iyy="0.003" izz="0.003" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="two" type="continuous"><parent link="first"/><child link="second"/><origin xyz="0.25 0 0"/>
  <axis xyz="0 0 1"/></joint>
<link name="second"><inertial><origin xyz="0.1 0 0"/><mass value="0.3"/>
  <inertia ixx="0.001" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="grip" type="fixed"><parent link="second"/><child link="hand"/><origin xyz="0.2 0 0"/></joint>
<link name="hand"/></robot>
"""


def two_links(test, rotor=0.1, noise=0.002, turned=False):
    """Two light links in a horizontal plane; behind a gear, the rotor of the second joint weighs as much as `rotor`
    kg·m². Closed form of Lagrange's equations, sines of each joint."""
    chance, rows = random.Random(1), []
    first, second, length, centre = 0.003 + 0.5 * 0.12 ** 2, 0.002 + 0.3 * 0.1 ** 2, 0.25, 0.3 * 0.1
    for i in range(30_000):
        t, q, v, a = i / 500, [0.4, 1.5], [0.0, 0.0], [0.0, 0.0]
        for joint in (0, 1):
            for line in range(1, 7):
                w = 2 * math.pi * (0.23 * line + 0.05 * joint)
                angle, size = w * t + 1.7 * line * line + joint, 0.1 + 0.3 * joint
                q[joint] += size * math.sin(angle)
                v[joint] += size * w * math.cos(angle)
                a[joint] -= size * w * w * math.sin(angle)
        own, cross = first + 0.3 * length ** 2, length * centre
        c, s = cross * math.cos(q[1]), cross * math.sin(q[1])
        one = (own + second + 2 * c) * a[0] + (second + c) * a[1] - s * (2 * v[0] * v[1] + v[1] ** 2)
        two = (second + c) * a[0] + (second + rotor) * a[1] + s * v[0] ** 2
        one += 0.02 * v[0] + 0.03 * math.tanh(v[0] / 0.02)
        two += 0.02 * v[1] + 0.03 * math.tanh(v[1] / 0.02)
        rows.append((t, *q, one + chance.gauss(0, noise), (-1 if turned else 1) * two + chance.gauss(0, noise)))
    test.file("two_links.urdf", TWO_LINKS)
    test.file("two_links.toml", "[robot]\nkind = \"urdf\"\nfile = \"two_links.urdf\"\n"
                                "[drive]\nterms = [\"viscous\", \"coulomb\", \"offset\"]\n")
    name = f"two_links_{rotor}_{noise}_{turned}.csv"
    return write_csv(test.folder / name, zip(*rows), ["time", "q1", "q2", "tau1", "tau2"])


def identified_robot(test, path, *options):
    return run("robot", "identify", "--json", "--quiet", path, "--robot", test.folder / "two_links.toml",
               "--motor-delay", "0", *options)


def tf(test, *options, rows=None):
    lines = ["time,force,motion"] + [",".join(f"{value:.12g}" for value in row) for row in rows or oscillator()]
    path = test.file("signals.csv", "\n".join(lines) + "\n")
    return run("tf", path, "--input", "force", "--output", "motion", "--json", *options)


def behind_a_lag(time_constant, noise):
    """The oscillator's answer behind 1/(time_constant s + 1), and noise on it."""
    chance, z, last, fine, rows = random.Random(2), 0.0, 0.0, 20, []
    for time, u, y in oscillator(0.0):
        for k in range(fine):
            z += 0.01 / fine / time_constant * (last + (y - last) * (k + 0.5) / fine - z)
        last = y
        rows.append((time, u, z + noise * chance.gauss(0, 1)))
    return rows


def explored(*files):
    return run("explore", "--json", *files)


def rows_of_a_spring(test, name, force=lambda i, value: value):
    """60 s of one axis at 1 kHz, and a file of it: a force as it was measured, or as `force` makes it."""
    chance, rows = random.Random(4), []
    for i in range(60_000):
        t, x, v, a = i / 1000, 0.0, 0.0, 0.0
        for line in (0.7, 1.3, 2.1, 2.9):
            w = 2 * math.pi * line
            x += 0.003 * math.sin(w * t + line)
            v += 0.003 * w * math.cos(w * t + line)
            a -= 0.003 * w * w * math.sin(w * t + line)
        rows.append((t, x, -(1.5 * a + 8 * v + 200 * x) + chance.gauss(0, 0.02)))
    held = [row[2] for row in rows]
    rows = [(t, x, force(i, held)) for i, (t, x, _) in enumerate(rows)]
    return write_csv(test.folder / name, zip(*rows), ["time", "position_m", "reaction_N"])


@advice_of("held-signal")
def _(test):  # record at the rate of the recording
    held = rows_of_a_spring(test, "held.csv", lambda i, f: f[i // 20 * 20])
    whole = rows_of_a_spring(test, "whole.csv", lambda i, f: f[i])
    raised = run("measure", "--json", held)
    test.assertIn("rate", hint_of(raised, "held-signal"))
    test.goes("held-signal", raised, run("measure", "--json", whole))


@advice_of("missing-samples")
def _(test):  # record a sample only when it was measured
    lost = random.Random(5)
    zeros = rows_of_a_spring(test, "zeros.csv", lambda i, f: 0.0 if lost.random() < 0.1 else f[i])
    whole = rows_of_a_spring(test, "whole.csv", lambda i, f: f[i])
    raised = run("measure", "--json", zeros)
    test.assertIn("sample", hint_of(raised, "missing-samples"))
    test.goes("missing-samples", raised, run("measure", "--json", whole))


@advice_of("low-coherence")
def _(test):  # perturb more strongly
    weak = trial(test, "weak", 1, 1, peak="peak_mm = 0.05", sensor=5)
    strong = trial(test, "strong", 1, 1, peak="peak_mm = 8", sensor=5)
    options = ("--max-frequency", "4")
    raised = explored(weak, *options)
    test.assertIn("perturb", hint_of(raised, "low-coherence"))
    test.goes("low-coherence", raised, explored(strong, *options))


@advice_of("few-realisations")
def _(test):  # more trials
    files = [trial(test, f"trial{k}", k, k) for k in range(1, 6)]
    raised = explored(*files[:3])
    test.assertIn("trials", hint_of(raised, "few-realisations"))
    test.goes("few-realisations", raised, explored(*files))


@advice_of("nonlinear-distortion")
def _(test):  # perturb less
    hardening = "[participant.departures]\ncubic_stiffness_N_per_m3 = 2e5"

    def files(millimetres):
        return [trial(test, f"trial{k}", k, k, peak=f"peak_mm = {millimetres}", more=hardening) for k in range(1, 7)]
    raised = explored(*files(8))
    test.assertIn("perturb", hint_of(raised, "nonlinear-distortion"))
    test.goes("nonlinear-distortion", raised, explored(*files(0.8)))


@advice_of("input-explains-residual")
def _(test):  # more poles
    rows = behind_a_lag(0.3, 0.03)
    raised = tf(test, "--poles", "2", "--zeros", "0", rows=rows)
    test.assertIn("poles", hint_of(raised, "input-explains-residual"))
    test.goes("input-explains-residual", raised, tf(test, "--poles", "3", "--zeros", "0", rows=rows))


@advice_of("residual-not-white")
def _(test):  # leave --hac-lag at 1 s
    chance = random.Random(1)
    noise, rows = 0.0, []
    for time, u, y in oscillator(0.0):
        noise = 0.95 * noise + 0.1 * chance.gauss(0, 1)
        rows.append((time, u, y + noise))
    raised = tf(test, "--poles", "2", "--zeros", "0", "--hac-lag", "0", rows=rows)
    test.goes("residual-not-white", raised, tf(test, "--poles", "2", "--zeros", "0", rows=rows))


@advice_of("pole-outside-band")
def _(test):  # excite the system there
    raised = tf(test, "--poles", "3", "--zeros", "0", rows=behind_a_lag(0.004, 0.0002))
    test.assertNotIn("--split", hint_of(raised, "pole-outside-band"))  # held-out data do not excite it either
    # of a pole that is excited there is no such word
    test.goes("pole-outside-band", raised, tf(test, "--poles", "3", "--zeros", "0", rows=behind_a_lag(0.02, 0.0002)))


@advice_of("delay-at-limit")
def _(test):  # look further
    rows = oscillator()
    late = [(time, u, y) for (time, _, y), (_, u, _) in zip(rows, rows[30:])]  # u is known 0.3 s early
    signals = ("--poles", "2", "--zeros", "0", "--delay", "auto")
    raised = tf(test, *signals, "--max-delay", "0.2", rows=late)
    further = re.search(r"--max-delay ([\d.]+)", hint_of(raised, "delay-at-limit"))[1]
    test.goes("delay-at-limit", raised, tf(test, *signals, "--max-delay", further, rows=late))


@advice_of("uneven-clock")
def _(test):  # it is taken into account; an even clock has no such word
    rows = [row for k, row in enumerate(oscillator()) if k % 5 in (0, 2)]
    test.goes("uneven-clock", tf(test, "--poles", "2", "--zeros", "0", rows=rows), tf(test, "--poles", "2", "--zeros", "0"))


@advice_of("torque-unit")
def _(test):
    path = test.simulated("free_motion")
    entries = {"q1": "joint_1", "q2": "joint_2", "tau1": "torque_1*1000", "tau2": "torque_2*1000"}
    raised = run("robot", "identify", "--json", "--quiet", *as_option(entries), path)
    test.assertIn("N.mm", hint_of(raised, "torque-unit"))
    cured = {name: source + (":N.mm" if name.startswith("tau") else "") for name, source in entries.items()}
    test.goes("torque-unit", raised, run("robot", "identify", "--json", "--quiet", *as_option(cured), path))


if __name__ == "__main__":
    main()
