#!/usr/bin/env python3
"""mbk run on the simulated robot: what it records and measures, how it is stopped, what it refuses."""

import os
import pathlib
import pty
import select
import shutil
import signal
import subprocess
import time

from command import BAD_DATA, FINE, WRONG_USAGE, Case, main, program, run

SAFETY_STOP = 5

SHORT = """
[recording]
condition = "relaxed"
[robot]
handle_mass_kg = 0.194
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = {duration}
moving_in_s = 1
[participant]
kind = "arm"
number = 1
[person]
number = 7
consent = "form 12"
{more}
"""


class Running(Case):
    def experiment(self, duration=3.0, more=""):
        return self.file("short.toml", SHORT.format(duration=duration, more=more))

    name = "trial.h5"

    def target(self, name=None):
        return self.folder / (name or self.name)

    def metadata(self, recording):
        return self.mbk("info", recording, "--json").json["metadata"]

    def test_a_session_measures_what_simulate_and_measure_do(self):
        session, simulated = self.target("session.h5"), self.target("simulated.h5")
        self.assertEqual(run("run", "relaxed_sinusoidal", "--fast", "--out", session, "--no-measure").code, FINE)
        self.assertEqual(run("simulate", "relaxed_sinusoidal", "--out", simulated).code, FINE)
        results = [self.mbk("measure", file, "--handle-mass", 0.194, "--json").json for file in (session, simulated)]
        for name in "MBK":
            for row in range(2):
                for column in range(2):
                    values = [result["model"][name][row][column] for result in results]
                    spread = sum(result["standard_error"][name][row][column] ** 2 for result in results) ** 0.5
                    self.assertLess(abs(values[0] - values[1]), 3.0 * spread, f"{name}[{row}][{column}]")

    def test_what_is_recorded_says_who_what_and_how_it_ended(self):
        ran = run("run", self.experiment(), "--fast", "--out", self.target(), "--participant", 12)
        self.assertEqual(ran.code, FINE, ran)
        self.assertIn("stiffness K", ran.out)
        self.assertIn("0 dropped", ran.out)
        metadata = self.metadata(self.target())
        self.assertEqual(metadata["participant"], "12")
        self.assertEqual(metadata["consent"], "form 12")
        self.assertEqual(metadata["ended"], "completed")
        self.assertFalse(pathlib.Path(f"{self.target()}.journal").exists())

    def test_a_dry_run_moves_and_writes_nothing(self):
        ran = run("run", self.experiment(), "--dry-run", folder=self.folder)
        self.assertEqual(ran.code, FINE, ran)
        for word in ("soft start", "band", "measured force", "of    40", "mm/s"):
            self.assertIn(word, ran.out)
        self.assert_lines_fit(ran.out)
        self.assertEqual(self.names(), ["short.toml"])

    def test_nothing_begins_that_breaks_a_limit(self):
        for more, word in (("[safety]\nspeed_mm_per_s = 20\n", "speed_mm_per_s"),
                           ("[safety]\nexcursion_mm = 5\n", "excursion_mm"),
                           ("[safety]\nworkspace_high_mm = [301, 100]\nworkspace_low_mm = [0, -100]\n", "workspace"),
                           ("[safety]\njoint_margin_deg = 40\n", "joint_margin_deg")):
            ran = run("run", self.experiment(more=more), "--fast", "--out", self.target())
            self.assertEqual(ran.code, WRONG_USAGE, ran)
            self.assertIn(word, ran.err)
            self.assertFalse(self.target().exists())

    def test_wrong_keys_and_names_of_people_are_refused_with_their_line(self):
        for more, word in (("initials = \"AB\"\n", "initials"), ("[safety]\nspeeed_mm_per_s = 3\n", "speed_mm_per_s"),
                           ("[session]\nsettle_s = -1\n", "settle_s")):
            text = SHORT.format(duration=3, more=more)
            if "[session]\nsettle" in more:
                text = text.replace("settle_s = 0.1\n", "settle_s = -1\n").replace(more, "")
            path = self.experiment()
            path.write_text(text)
            ran = run("run", path, "--fast", "--out", self.target())
            self.assertEqual(ran.code, BAD_DATA, ran)
            self.assertIn(word, ran.err)
            self.assertIn("line", ran.err)

    def test_nothing_is_overwritten(self):
        self.assertEqual(run("run", self.experiment(), "--fast", "--out", self.target(), "--no-measure").code, FINE)
        before = self.target().read_bytes()
        ran = run("run", self.experiment(), "--fast", "--out", self.target())
        self.assertEqual(ran.code, WRONG_USAGE, ran)
        self.assertEqual(self.target().read_bytes(), before)

    def test_the_name_of_the_recording_is_judged_before_anything_moves(self):
        experiment = self.experiment()
        (self.folder / "nowhere.h5").symlink_to(self.folder / "gone" / "there.h5")
        (self.folder / "round.h5").symlink_to("round.h5")
        for name, says in (("p07", "format"), ("p07.xlsx", "format"), (247 * "a" + ".h5", "name"),
                           ("nowhere.h5", "nowhere.h5"), ("round.h5", "symbolic links"), ("gone/p07.h5", "No such")):
            for more in ((), ("--dry-run",)):
                ran = run("run", experiment, "--fast", "--quiet", "--out", self.target(name), *more)
                self.assertIn(ran.code, (WRONG_USAGE, BAD_DATA), ran)
                self.assertIn(says, ran.err)
                self.assertEqual(ran.out, "")
        self.assertEqual(sorted(self.names()), ["nowhere.h5", "round.h5", "short.toml"])

    def in_mid_trial(self, act, *options, duration=20, signals=()):
        """Begins a trial, acts once it perturbs; its outcome."""
        with subprocess.Popen([program("MBK"), "run", self.experiment(duration), "--no-measure", "--out", self.target(),
                               *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            for line in process.stderr:
                if "perturb" in line:
                    break
            act(process)
            for signum in signals:
                process.send_signal(signum)
            out, err = process.communicate(timeout=120)
        return process.returncode, out, err

    def test_a_stop_is_told_though_the_recording_cannot_be_written(self):
        def take_the_name(process):
            self.target().write_text("mine")
        code, out, err = self.in_mid_trial(take_the_name, signals=[signal.SIGINT])
        self.assertEqual(code, SAFETY_STOP, err)
        self.assertIn("safety stop: the operator stopped it", out)
        self.assertIn("motors: confirmed off", out)
        self.assertIn("trial.h5.journal", out)
        self.assertIn("trial.h5", err)
        self.assertEqual(self.target().read_text(), "mine")
        self.fine("recover", self.target("trial.h5.journal"), "--out", self.target("other.h5"))
        self.assertIn("safety stop", self.metadata(self.target("other.h5"))["ended"])

    def test_a_folder_that_is_removed_loses_nothing(self):
        self.name = "inner/trial.h5"
        self.target().parent.mkdir()
        code, out, err = self.in_mid_trial(lambda process: shutil.rmtree(self.target().parent))
        self.assertEqual(code, SAFETY_STOP, err)
        saved = pathlib.Path(out.split(": ")[0])
        self.assertTrue(saved.is_file(), out)
        self.assertGreater(self.mbk("info", saved, "--json").json["samples"], 500)

    def test_a_journal_that_is_being_recorded_is_left_alone(self):
        def recover(process):
            ran = self.refused(WRONG_USAGE, "recover", self.target("trial.h5.journal"), says="process")
            self.assertIn(str(process.pid), ran.err)
            self.refused(WRONG_USAGE, "run", self.experiment(), "--fast", "--quiet", "--out", self.target(),
                         says=f"process {process.pid}")
        code, out, err = self.in_mid_trial(recover, duration=3)
        self.assertEqual(code, FINE, err)
        self.assertIn("completed", out)

    def test_sleeps_that_return_at_once_do_not_hurry_the_clock(self):
        shim = os.environ.get("MBK_CRASH_SHIM")
        if not shim:
            self.skipTest("MBK_CRASH_SHIM is not set")
        began = time.monotonic()
        ran = run("run", self.experiment(), "--no-measure", "--quiet", "--out", self.target(),
                  environment={"LD_PRELOAD": shim, "MBK_SLEEPLESS": "1"})
        self.assertEqual(ran.code, FINE, ran)
        self.assertRegex(ran.out, "! .*clock")
        samples = self.mbk("info", self.target(), "--json").json["samples"]
        self.assertGreaterEqual(time.monotonic() - began, 0.99e-3 * samples)  # no faster than time

    def test_whoever_has_withdrawn_is_neither_perturbed_nor_measured(self):
        ran = run("run", self.experiment(more="withdrawn = true\n"), "--fast", "--out", self.target())
        self.assertEqual(ran.code, WRONG_USAGE, ran)
        self.assertIn("withdrawn", ran.err)
        recorded = self.target("recorded.csv")
        self.assertEqual(run("run", self.experiment(), "--fast", "--out", self.target(), "--no-measure").code, FINE)
        self.assertEqual(run("convert", self.target(), recorded).code, FINE)
        text = recorded.read_text()
        self.assertIn("withdrawn", text)
        recorded.write_text(text.replace("withdrawn = no", "withdrawn = yes").replace("withdrawn: no",
                                                                                       "withdrawn: yes"))
        ran = run("measure", recorded)
        self.assertEqual(ran.code, BAD_DATA, ran)
        self.assertIn("withdrawn", ran.err)

    def at_a_terminal(self, *keys):
        """A session in real time, with a terminal of its own, at which keys are pressed."""
        path, target = self.experiment(20.0), self.target()
        child, terminal = pty.fork()
        if child == 0:
            try:
                os.execv(program("MBK"), ["mbk", "run", str(path), "--out", str(target), "--no-console"])
            finally:
                os._exit(127)  # this is the child, which must not go on with the tests
        journal = pathlib.Path(f"{target}.journal")
        shown, pressed, until = b"", 0, time.monotonic() + 120
        while time.monotonic() < until:
            if select.select([terminal], [], [], 0.05)[0]:
                try:
                    shown += os.read(terminal, 65536)
                except OSError:  # the terminal of a program that has ended
                    break
            begun = journal.exists() and journal.stat().st_size > 100_000
            if pressed < len(keys) and (begun if pressed == 0 else b"[y/N]" in shown):
                os.write(terminal, keys[pressed])
                pressed += 1
        os.close(terminal)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), shown.decode("utf-8", "replace")

    def test_the_space_bar_and_an_interrupt_are_safety_stops(self):
        for number, key in enumerate((b" ", b"\x03")):
            with self.subTest(key=key):
                self.name = f"stop{number}.h5"
                code, shown = self.at_a_terminal(key, b"n\n")
                self.assertEqual(code, SAFETY_STOP, shown)
                metadata = self.metadata(self.target())
                self.assertEqual(metadata["ended"], "safety stop")
                self.assertIn("operator", metadata["ended_detail"])

    def test_e_ends_a_trial_early(self):
        code, shown = self.at_a_terminal(b"e", b"n\n")
        self.assertEqual(code, FINE, shown)
        self.assertEqual(self.metadata(self.target())["ended"], "ended early by the operator")

    def test_after_a_stop_the_trial_can_be_done_again(self):
        code, shown = self.at_a_terminal(b" ", b"y\n", b"n\n")
        self.assertTrue(self.target("trial_2.h5").exists(), shown)


if __name__ == "__main__":
    main()
