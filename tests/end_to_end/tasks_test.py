#!/usr/bin/env python3
"""What people sit down to do, done by whoever knows nothing but `mbk --help`: every command and option that is used has
been read in a help text before, and the steps (help texts read, commands run) are counted. tests/web/tasks_test.mjs does
the tasks of a browser.

  MBK=build/release/bin/mbk MAKE_LOG=build/release/bin/make_log python3 tests/end_to_end/tasks_test.py    prints the counts
"""

import json
import pathlib
import re
import signal
import subprocess
import time

from command import FINE, NOT_USABLE, Case, main, make_log, program, run, table_of, write_csv

ROOT = pathlib.Path(__file__).resolve().parents[2]

#: The number of steps of each task, by its test.
STEPS = {
    "see what is in a file": 3,
    "measure my own spreadsheet": 3,
    "find why a measurement is poor": 3,
    "write a page to hand on": 3,
    "convert for a colleague": 3,
    "compare two conditions": 3,
    "plan an experiment and try it": 6,
    "ask whether the limb was passive": 3,
    "keep the trials of several people": 10,
    "check a robot of my own": 4,
    "find which column is what": 6,
    "ask whether a teleoperator is stable": 3,
    "reproduce a table of the thesis": 4,
    "recover a session that was cut off": 3,
}


class Newcomer:
    """Someone at a terminal. `help` and `do` are steps; `do` fails where a word was never read."""

    def __init__(self, case):
        self.case, self.steps, self.texts = case, [], {}
        self.help()

    def help(self, *command):
        """Reads the help of a command that stands in what was read before."""
        for depth, word in enumerate(command):
            self.read(command[:depth], word)
        self.texts[command] = self.ran(*command, "--help").out

    def read(self, command, word):
        """`word` stands in the help of `command`, which was read."""
        self.case.assertIn(command, self.texts, f"nobody has read 'mbk {' '.join(command)} --help'")
        self.case.assertTrue(self.stands(word, command), (command, word))

    def stands(self, word, command):
        return re.search(rf"(?m)(^|[\s,'\[]){re.escape(word)}\b", self.texts[command])

    def do(self, *words, code=FINE):
        """Runs a command line."""
        command = tuple(word for word in words if isinstance(word, str) and (word,) in self.texts)[:1]
        command = words[:2] if words[:2] in self.texts else command
        self.case.assertTrue(command, f"nobody has read the help of {words}")
        for word in words[len(command):]:
            if isinstance(word, str) and word.startswith("--"):
                self.read(command, word.split("=")[0])
        ran = self.ran(*words)
        self.case.assertEqual(ran.code, code, ran)
        return ran

    def ran(self, *words):
        self.steps.append(" ".join(map(str, words)))
        return run(*words, folder=self.case.folder)


class Tasks(Case):
    counted = {}

    @classmethod
    def tearDownClass(cls):
        for name, steps in cls.counted.items():
            print(f"{steps:3} steps  {name}")

    def setUp(self):
        super().setUp()
        self.newcomer = Newcomer(self)

    def in_its_steps(self):
        """The task is done, in exactly as many steps as STEPS says."""
        name = self.id().rsplit(".test_", 1)[1].replace("_", " ")
        self.counted[name] = len(self.newcomer.steps)
        self.assertEqual(len(self.newcomer.steps), STEPS[name], self.newcomer.steps)

    def csv(self):
        """A recording as a spreadsheet has it: its own names, mm, semicolons."""
        columns = table_of(make_log())
        time, x, y, *rest = columns
        return write_csv(self.folder / "mine.csv", [time, [1e3 * one for one in x], [1e3 * one for one in y], *rest],
                         ("t_s", "px", "py", "fx", "fy", "rx", "ry"), ";")

    def results(self, *names):
        """Results of a relaxed and of another simulated trial, as somebody left them."""
        for name, protocol in zip(names, ("sinusoidal", "underdamped")):
            self.mbk("measure", make_log(protocol).path, "--json", "--out", self.folder / name)

    def test_see_what_is_in_a_file(self):
        self.newcomer.help("info")
        said = self.newcomer.do("info", make_log().path).out
        self.assertIn("1000", said)
        self.in_its_steps()

    def test_measure_my_own_spreadsheet(self):
        self.csv()
        self.newcomer.help("measure")
        ran = self.newcomer.do("measure", "mine.csv", "--channels",
                               "time=t_s,x=px:mm,y=py:mm,Fx=fx,Fy=fy,xr=rx,yr=ry", "--json", "--out", "mine.json")
        self.assertEqual(ran.out, "")
        found = json.loads((self.folder / "mine.json").read_text())["model"]
        self.assert_relative(found["K"], make_log().truth["K"], 0.05)
        self.in_its_steps()

    def test_find_why_a_measurement_is_poor(self):
        columns = table_of(make_log())
        still = [[0.3] * len(columns[0]), [-0.05] * len(columns[0])]
        write_csv(self.folder / "poor.csv", [columns[0], *still, *columns[3:]])
        self.newcomer.help("measure")
        ran = run("measure", "poor.csv", folder=self.folder)
        self.newcomer.steps.append("measure poor.csv")
        self.assertIn(ran.code, (NOT_USABLE, 3), ran)  # it says so, and does not show a number as a good one
        self.assertRegex(ran.out + ran.err, r"hand_x|motion|position|excit", ran)
        self.in_its_steps()

    def test_write_a_page_to_hand_on(self):
        self.newcomer.help("measure")
        self.newcomer.do("measure", make_log().path, "--report", "page.html", "--report-note", "bench, 4 May")
        self.assertIn("bench, 4 May", (self.folder / "page.html").read_text(encoding="utf-8"))
        self.in_its_steps()

    def test_convert_for_a_colleague(self):
        self.newcomer.help("convert")
        self.newcomer.do("convert", make_log().path, "colleague.csv")
        self.assertIn("force", (self.folder / "colleague.csv").read_text(encoding="utf-8")[:4000].lower())
        self.in_its_steps()

    def test_compare_two_conditions(self):
        self.results("relaxed.json", "tensed.json")
        self.newcomer.help("compare")
        self.assertIn("stiffness", self.newcomer.do("compare", "relaxed.json", "tensed.json").out)
        self.in_its_steps()

    def test_plan_an_experiment_and_try_it(self):
        self.newcomer.help("simulate")
        text = self.newcomer.do("simulate", "--show", "relaxed_sinusoidal").out
        (self.folder / "mine.toml").write_text(text, encoding="utf-8")
        self.newcomer.help("run")
        self.assertIn("N", self.newcomer.do("run", "mine.toml", "--dry-run").out)
        self.newcomer.do("run", "mine.toml", "--fast", "--no-measure", "--quiet", "--out", "try.h5")
        self.assertTrue((self.folder / "try.h5").exists())
        self.in_its_steps()

    def test_ask_whether_the_limb_was_passive(self):
        self.newcomer.help("passivity")
        self.assertIn("passive", self.newcomer.do("passivity", make_log().path).out)
        self.in_its_steps()

    def test_keep_the_trials_of_several_people(self):
        for command in ((), ("init",), ("add",), ("measure",), ("list",)):
            self.newcomer.help("study", *command)
        self.newcomer.do("study", "init", "arms", "--title", "Stiffness at rest")
        self.newcomer.do("study", "add", make_log().path, "--study", "arms", "--participant", "7", "--condition",
                         "relaxed")
        self.newcomer.do("study", "measure", "--study", "arms", "--quiet")
        self.assertIn("relaxed", self.newcomer.do("study", "list", "--study", "arms").out)
        self.in_its_steps()

    def test_check_a_robot_of_my_own(self):
        self.newcomer.help("robot")
        self.newcomer.help("robot", "check")
        self.assertIn("links", self.newcomer.do("robot", "check", "relaxed_sinusoidal").out)
        self.in_its_steps()

    def test_find_which_column_is_what(self):
        time_s, x, y, *rest = table_of(make_log())
        columns = [[1e3 * t for t in time_s], [1e3 * v for v in x], [1e3 * v for v in y], *rest]
        write_csv(self.folder / "theirs.csv", columns,
                  ("Time (ms)", "PosX_mm", "PosY_mm", "Hand force X [N]", "Hand force Y [N]", "ref pos x", "ref pos y"))
        self.newcomer.help("new")
        self.newcomer.help("new", "channels")
        option = self.newcomer.do("new", "channels", "theirs.csv", "--yes").out.split()
        self.newcomer.help("measure")
        self.assertIn("stiffness K", self.newcomer.do("measure", "theirs.csv", *option).out)
        self.in_its_steps()

    def test_ask_whether_a_teleoperator_is_stable(self):
        self.newcomer.help("teleop")
        design = ROOT / "examples" / "teleop" / "position_position.toml"
        self.assertIn("stable", self.newcomer.do("teleop", design).out)
        self.in_its_steps()

    def test_reproduce_a_table_of_the_thesis(self):
        self.newcomer.help("reproduce")
        self.assertIn("table-3.6", self.newcomer.do("reproduce", "--list").out)
        self.newcomer.do("reproduce", "--only", "table-3.6", "--out", "thesis")
        self.assertTrue((self.folder / "thesis" / "index.html").exists())
        self.in_its_steps()

    def test_recover_a_session_that_was_cut_off(self):
        journal = self.folder / "cut.h5.journal"
        command = [program("MBK"), "run", "relaxed_sinusoidal", "--no-console", "--no-measure", "--out", "cut.h5"]
        quiet = subprocess.DEVNULL
        with subprocess.Popen(command, cwd=self.folder, stdout=quiet, stderr=quiet) as session:
            until = time.monotonic() + 60
            while not (journal.exists() and journal.stat().st_size > 100_000) and time.monotonic() < until:
                time.sleep(0.05)
            session.send_signal(signal.SIGKILL)
        self.newcomer.help("recover")
        self.newcomer.do("recover", journal.name)
        self.assertIn("interrupted", self.mbk("info", self.folder / "cut.h5").out)
        self.in_its_steps()


if __name__ == "__main__":
    main()
