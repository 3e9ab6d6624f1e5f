#!/usr/bin/env python3
"""mbk new: what a wizard writes is read back by the command that uses it; nothing is lost; answers come from a pipe."""

import pathlib
import re
import subprocess

import command
from command import BAD_DATA, FINE, WRONG_USAGE, Case, main, make_log, program, table_of, write_csv
from terminal_test import at_terminal

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"


class Asked(Case):
    def answer(self, *arguments, answers="", code=FINE):
        """mbk with these lines on standard input."""
        process = subprocess.run([program("MBK"), *map(str, arguments)], input=answers.encode(), cwd=self.folder,
                                 capture_output=True, timeout=60, check=False)
        ran = command.Ran(process, "mbk " + " ".join(map(str, arguments)))
        self.assertEqual(ran.code, code, ran)
        return ran


class Channels(Asked):
    NAMES = ("Time (ms)", "PosX_mm", "PosY_mm", "Hand force X [N]", "Hand force Y [N]", "ref pos x", "ref pos y")
    MAP = "time=1:ms,x=2:mm,y=3:mm,Fx=4:N,Fy=5:N,xr=6,yr=7"

    def log(self, names=NAMES):
        time, x, y, *others = table_of(make_log())
        return write_csv(self.folder / "log.csv", [[1e3 * t for t in time], [1e3 * v for v in x], [1e3 * v for v in y],
                                                   *others], names)

    def test_the_option_that_it_prints_measures_the_file(self):
        ran = self.answer("new", "channels", self.log(), "--yes")
        self.assertEqual(ran.out, f"--channels {self.MAP}\n")
        measured = self.fine("measure", "--json", self.folder / "log.csv", *ran.out.split()).json
        self.assert_relative(measured["model"]["K"], make_log().truth["K"], 0.1)

    def test_the_guess_fits_one_screen_with_a_drawn_line_for_each_channel(self):
        log = self.log()
        head, *rows = log.read_text(encoding="utf-8").splitlines()
        wide = self.file("wide.csv", "\n".join([head + "".join(f",other{k}" for k in range(40)),
                                                *(row + 40 * ",0" for row in rows)]))
        for file in (log, wide):
            ran = self.answer("new", "channels", file.name, answers="\n")
            screen, _, line = ran.err.rpartition("channels [as shown]")
            self.assertLessEqual(len(screen.splitlines()) + 1, 24)
            self.assertLessEqual(max(map(len, screen.splitlines())), 80)
            self.assertIn("first 3 s", screen)
            self.assertRegex(line, rf"mbk measure {file.name} --channels {self.MAP}\n")
            for entry in self.MAP.split(","):
                channel, column, *unit = entry.replace("=", ":").split(":")
                self.assertRegex(screen, rf"(?m)^  {channel} +{column} .*{unit[0] if unit else 'SI'} .* to .*[\u2801-\u28ff]")

    def test_what_is_missing_is_named_and_an_assumed_unit_is_marked(self):
        time, x, y, *_ = table_of(make_log())
        log = write_csv(self.folder / "log.csv", [time, [1e3 * v for v in x], [1e3 * v for v in y], x], ("t", "x", "y", "u"))
        ran = self.answer("new", "channels", log, code=WRONG_USAGE)
        self.assertRegex(ran.err, r"(?m)^  x +2 x +mm\? ")
        self.assertRegex(ran.err, r"(?m)^  Fx +not recognised")
        self.assertEqual(ran.out, "")

    def test_a_person_may_answer_otherwise(self):
        other = self.MAP.replace("Fx=4", "Fx=-4")
        self.assertEqual(self.answer("new", "channels", self.log(), answers=other + "\n").out, f"--channels {other}\n")
        for answers in ("\n", ""):  # accepted; nobody answers
            self.assertEqual(self.answer("new", "channels", self.log(), answers=answers).out, f"--channels {self.MAP}\n")

    def test_a_part_of_a_map_changes_the_guess(self):
        ran = self.answer("new", "channels", self.log(), answers="Fx=-4,xr=-6\n")
        self.assertEqual(ran.out, "--channels time=1:ms,x=2:mm,y=3:mm,Fy=5:N,yr=7,Fx=-4,xr=-6\n")
        ran = self.answer("new", "channels", self.log(), answers="x=2:mm,F=4\n")  # another number of axes
        self.assertEqual(ran.out, "--channels time=1:ms,x=2:mm,F=4\n")

    def test_at_a_terminal_the_command_is_printed_alone(self):
        code, shown = at_terminal("new", "channels", self.log())
        self.assertEqual(code, FINE)
        self.assertIn(f"--channels {self.MAP}", shown)
        self.assertEqual(shown.count("--channels"), 1)

    def test_measure_points_to_it(self):
        time, x, y, *_ = table_of(make_log())
        for file in (self.log(names=()), write_csv(self.folder / "no_force.csv", [time, x, y], ("t", "x", "y"))):
            self.assertIn("mbk new channels", self.answer("measure", file, code=BAD_DATA).err)

    def test_it_writes_a_file_and_overwrites_none(self):
        log = self.log()
        self.answer("new", "channels", log, "--yes", "--out", "channels.txt")
        self.assertEqual((self.folder / "channels.txt").read_text(encoding="utf-8"), f"--channels {self.MAP}\n")
        self.answer("new", "channels", log, "--yes", "--out", "channels.txt", code=WRONG_USAGE)

    def test_without_names_it_asks(self):
        log = self.log(names=())
        ran = self.answer("new", "channels", log, "--yes", code=WRONG_USAGE)
        self.assertEqual(ran.out, "")
        self.assertIn("--yes", ran.err)
        self.assertIn("x, F", ran.err)
        self.assertEqual(self.answer("new", "channels", log, answers=self.MAP + "\n").out, f"--channels {self.MAP}\n")
        for answers, says in (("", "x, F"), ("x=77\n", "77"), ("x\n", "channels")):
            ran = self.answer("new", "channels", log, answers=answers, code=WRONG_USAGE)
            self.assertEqual(ran.out, "")
            self.assertIn(says, ran.err)

    def test_a_file_that_is_none(self):
        self.answer("new", "channels", "none.csv", "--yes", code=BAD_DATA)


class Experiments(Asked):
    def planned(self, name):
        return self.fine("run", self.folder / name, "--dry-run").out

    def test_what_is_proposed_can_be_run(self):
        self.answer("new", "experiment", "--yes")
        text = self.planned("experiment.toml")
        self.assertEqual(len(re.findall(r"trial_\d", text)), 3, text)
        self.assertRegex(text, r"speed +peak [\d.]+ ")

    def test_answers_come_from_a_pipe(self):
        self.answer("new", "experiment", "--out", "force.toml", answers="simulated\nforce\n\n30\nrigid grasp\n1\n")
        text = self.planned("force.toml")
        self.assertIn("rigid grasp", text)
        self.assertRegex(text, r"force rate +peak [\d.]+ N/s")
        self.assertNotIn("acceleration  ", text)
        self.answer("new", "experiment", "--out", "udp.toml", answers="udp\n192.168.1.10\n25001\n300\n280\n\npulses\n10\n\n2\n")
        text = (self.folder / "udp.toml").read_text(encoding="utf-8")
        self.assertIn('address = "192.168.1.10"\nport = 25001\n', text)
        self.assertIn("d1_mm = 300\nd2_mm = 280\nhome_mm = [300, -50]\n", text)
        self.assertIn("amplitude_mm = 10", text)
        checked = self.fine("robot", "check", self.folder / "udp.toml").out
        for fact in ("300", "280 mm"):
            self.assertIn(fact, checked)

    def test_nothing_is_written_where_an_answer_is_wrong_or_missing(self):
        for answers, says in (("simulated\nwaves\n", "waves"), ("simulated\nsines\n-2\n", "-2"),
                              ("simulated\n", "--yes")):
            self.assertIn(says, self.answer("new", "experiment", answers=answers, code=WRONG_USAGE).err)
        self.assertIn("amplitude", self.answer("new", "experiment", answers="simulated\nsines\n500\n\n\n\n",
                                               code=WRONG_USAGE).err)
        self.assertEqual(self.names(), [])

    def test_a_file_that_is_there_stays(self):
        mine = self.file("experiment.toml", "mine\n")
        self.answer("new", "experiment", "--yes", code=WRONG_USAGE)
        self.assertEqual(mine.read_text(encoding="utf-8"), "mine\n")
        self.answer("new", "experiment", "--yes", "--overwrite")
        self.planned("experiment.toml")


class Robots(Asked):
    def described(self, name):
        return self.fine("robot", "describe", self.folder / name, "--json").json

    def test_a_planar_robot(self):
        self.answer("new", "robot", "--yes")
        self.described("robot.toml")
        self.answer("new", "robot", "--out", "longer.toml", answers="planar\n300\n\n-50,80\n\n\n")
        text = self.fine("robot", "describe", self.folder / "longer.toml").out
        self.assertIn("300", text)
        self.answer("new", "robot", "--yes", code=WRONG_USAGE)

    def test_one_axis(self):
        self.answer("new", "robot", answers="one_axis\nslide\n-200,200\n12.5\n")
        self.described("robot.toml")
        self.assertIn("mass_kg = 12.5", (self.folder / "robot.toml").read_text(encoding="utf-8"))
        self.answer("new", "robot", "--out", "b.toml", answers="one_axis\nturn\n60,-60\n0.1\n", code=BAD_DATA)

    def test_a_urdf_is_looked_at(self):
        (self.folder / "made").mkdir()
        self.answer("new", "robot", EXAMPLES / "robots/double_pendulum.urdf", "--out", "made/arm.toml",
                    answers="x,z\n0,0,-9.81\n")
        self.assertEqual(len(self.described("made/arm.toml")["joints"]), 2)
        self.answer("new", "robot", self.file("bad.urdf", "<robot>"), "--out", "bad.toml", "--yes", code=BAD_DATA)


if __name__ == "__main__":
    main()
