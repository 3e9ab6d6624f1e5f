#!/usr/bin/env python3
"""--engine: the same bytes from processes, from a job array of a real Slurm, whatever ends."""

import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

import command
from command import BAD_DATA, FINE, WRONG_USAGE, program, run

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "cluster"), str(TESTS.parent / "bench")]
import private_slurm  # noqa: E402
import study as studies  # noqa: E402
from processes import ended_by_kill, processes_of, workers_of  # noqa: E402

RUNS = 32  # of 40 ms
VALIDATE = ("validate", "reliability", "--runs", str(RUNS), "--json", "--quiet")
SHORT = ("--chunk-units", "3")


def short_trials(folder, count):
    """Recordings of 12 s of a simulated participant."""
    trials = []
    for seed in range(1, count + 1):
        whole = folder / f"whole_{seed}.csv"
        made = run("simulate", "relaxed_sinusoidal", "--seed", seed, "--quiet", "--out", whole)
        assert made.code == FINE, made
        lines = whole.read_text(encoding="utf-8").splitlines(keepends=True)
        rows = [line for line in lines if not line.startswith("#")]
        trials.append(folder / f"trial_{seed}.csv")
        trials[-1].write_text("".join([line for line in lines if line.startswith("#")] + rows[:12001]),
                              encoding="utf-8")
        whole.unlink()
    return trials


class JobCase(command.Case):
    trials = None
    repeated = None
    resampled = None  # without an engine
    environment = None
    engine = ()

    @classmethod
    def setUpClass(cls):
        if JobCase.trials is None:
            JobCase.trials = short_trials(command.folder_of_logs(), 4)
            whole = run(*VALIDATE)
            JobCase.table, JobCase.judged = whole.out, whole.code

    def setUp(self):
        super().setUp()
        self.studies = 0

    def study(self):
        self.studies += 1
        study = self.folder / f"study{self.studies}"
        self.mbk("study", "init", study)
        for number, trial in enumerate(self.trials):
            self.mbk("study", "add", trial, "--participant", number + 1, "--study", study)
        return study

    def repeated_study(self):
        """Of 20 people in two sessions, whose results were written into its database."""
        if JobCase.repeated is None:
            JobCase.repeated = studies.filled_study(program("MBK"), command.folder_of_logs(), 40)
        return JobCase.repeated

    def exported(self, study):
        return self.mbk("study", "export", "--study", study).out

    def job(self, *arguments, code=FINE, **options):
        return self.mbk(*arguments, *self.engine, code=code, environment=self.environment, folder=self.folder, **options)

    def begin(self, *arguments):
        """The same without waiting for it."""
        return subprocess.Popen([program("MBK"), *map(str, arguments), *self.engine], cwd=self.folder,
                                env={**os.environ, **(self.environment or {})}, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE)

    def wait_for(self, holds, longest=30):
        end = time.monotonic() + longest
        while time.monotonic() < end:
            if holds():
                return
            time.sleep(0.02)
        self.fail("it did not come to that")

    def shards(self):
        return sorted(path.name for path in self.folder.rglob("*.shard"))


class Engines:
    """What every engine has to do."""

    def test_measures_a_study_to_the_same_bytes(self):
        here, there = self.study(), self.study()
        self.mbk("study", "measure", "--study", here)
        ran = self.job("study", "measure", "--study", there, "--chunk-units", "1")
        self.assertIn("4 usable", ran.out)
        self.assertEqual(self.exported(there), self.exported(here))
        self.assertFalse((there / "jobs").exists())
        self.mbk("study", "check", "--study", there)
        self.assertNotRegex(self.job("study", "measure", "--study", there).out, "[1-9]")  # nothing is measured again

    def test_resamples_people_to_the_same_bytes(self):
        summary = ("study", "summary", "--study", self.repeated_study(), "--bootstrap", "1000", "--outcome", "K_xx",
                   "--compare", "session", "--json")
        if JobCase.resampled is None:
            JobCase.resampled = self.mbk(*summary)
            self.assertEqual(JobCase.resampled.json["bootstrap"], {"draws": 1000, "seed": 1})
        self.assertEqual(self.job(*summary, "--chunk-units", "400").out, JobCase.resampled.out)

    def test_a_killed_process_costs_no_result(self):
        began = self.begin(*VALIDATE, *SHORT)
        killed = 0
        self.wait_for(lambda: self.shards() or began.poll() is not None)
        lot = random.Random(1)
        while killed < 3 and began.poll() is None:
            workers = workers_of(self.folder)
            if workers:
                killed += ended_by_kill(lot.choice(workers))
            time.sleep(0.1)
        out, err = began.communicate(timeout=120)
        self.assertEqual(began.returncode, self.judged, err)
        self.assertGreater(killed, 0)
        self.assertEqual(out.decode(), self.table)

    def test_a_process_that_hangs_is_replaced(self):
        began = self.begin(*VALIDATE, *SHORT, "--silence", "1")
        self.wait_for(lambda: self.shards() or began.poll() is not None)
        self.wait_for(lambda: workers_of(self.folder) or began.poll() is not None)
        for worker in workers_of(self.folder)[:1]:
            os.kill(worker, signal.SIGSTOP)
        out, err = began.communicate(timeout=120)
        self.assertEqual(began.returncode, self.judged, err)
        self.assertEqual(out.decode(), self.table)

    def test_a_killed_coordinator_loses_no_finished_chunk(self):
        began = self.begin(*VALIDATE, *SHORT)
        self.wait_for(lambda: len(self.shards()) >= 3)
        began.kill()
        began.communicate()
        self.wait_for(lambda: not processes_of(self.folder))  # a rank between two chunks has no worker
        finished = self.shards()
        self.assertGreaterEqual(len(finished), 3)
        ran = self.job(*VALIDATE, *SHORT, "--keep-job", code=self.judged)
        self.assertEqual(ran.out, self.table)
        left = self.shards()
        self.assertLessEqual(set(finished), set(left))
        chunks = [name.split(".")[0] for name in left]
        for name in finished:
            self.assertEqual(chunks.count(name.split(".")[0]), 1, "none was done again")


class Local(Engines, JobCase):
    engine = ("--engine", "local", "--tasks", "2")

    def test_simulates_the_same_recordings(self):
        for name, engine in (("here", ()), ("there", self.engine + ("--chunk-units", "1"))):
            (self.folder / name).mkdir()
            self.mbk("simulate", "relaxed_sinusoidal", "--seeds", "3", "--seed", "5", "--out", "trial.h5", *engine,
                     folder=self.folder / name)
        there = {path.name: path.read_bytes() for path in (self.folder / "there").iterdir()}
        here = {path.name: path.read_bytes() for path in (self.folder / "here").iterdir()}
        self.assertEqual(set(here), {f"trial_seed{seed}.h5" for seed in (5, 6, 7)})
        self.assertEqual(there, here)

    def test_explores_each_of_many_files_to_the_same_bytes(self):
        broken = self.folder / "broken.csv"
        broken.write_text("time,x\n0,1\n", encoding="utf-8")
        explore = ("explore", "--each", *self.trials[:2], "broken.csv", "gone.h5", "--only", "impulse-response")
        for form in (("--json",), ()):
            here = self.mbk(*explore, *form, code=BAD_DATA, folder=self.folder)
            there = self.job(*explore, *form, "--chunk-units", "1", code=BAD_DATA)
            self.assertEqual(there.out, here.out)
            self.assertIn("gone.h5", there.err)
        self.assertFalse((self.folder / "mbk-jobs").exists())
        both = self.mbk(*explore, "--json", code=BAD_DATA, folder=self.folder).json
        self.assertEqual((len(both["results"]), len(both["failed"])), (2, 2))
        one = self.mbk("explore", self.trials[0], "--only", "impulse-response", "--json").json
        self.assertEqual({**both["results"][0], "software": one["software"]}, one)

    def test_a_file_that_changed_since_a_job_was_begun_is_not_explored_in_its_place(self):
        shutil.copy(self.trials[0], self.folder / "one.csv")
        explore = ("explore", "--each", "one.csv", "--only", "impulse-response", "--chunk-units", "1", "--keep-job")
        self.job(*explore)
        job = next((self.folder / "mbk-jobs").iterdir())
        for shard in (job / "shards").iterdir():
            shard.unlink()
        shutil.copy(self.trials[1], self.folder / "one.csv")
        self.assertIn("1 failed", self.mbk("work", job, "--chunk", 0, folder=self.folder).out)
        self.assertEqual(self.job(*explore).out, self.fine(*explore[:-3], folder=self.folder).out)

    def test_workers_that_someone_else_starts_share_a_job(self):
        self.job(*VALIDATE, *SHORT, "--keep-job", code=self.judged)
        shards = next(self.folder.rglob("shards"))
        for shard in shards.iterdir():
            shard.unlink()
        workers = [subprocess.Popen([program("MBK"), "work", str(shards.parent)], stdout=subprocess.PIPE)
                   for _ in range(2)]
        did = [worker.communicate(timeout=120)[0].decode().splitlines() for worker in workers]
        self.assertEqual([worker.returncode for worker in workers], [FINE, FINE])
        self.assertTrue(all(did), "each did a part")
        self.assertEqual({line.split(":")[0] for lines in did for line in lines},
                         {f"chunk {number}" for number in range(len({path.stem for path in shards.iterdir()}))})
        self.assertEqual(self.job(*VALIDATE, *SHORT, code=self.judged).out, self.table)

    def test_mpi_is_told_what_to_do_instead(self):
        self.refused(WRONG_USAGE, *VALIDATE, "--engine", "mpi", folder=self.folder, says="mpirun -n N mbk work FOLDER")

    def test_progress_as_json_lines(self):
        ran = self.job(*VALIDATE, "--chunk-units", "12", "--progress-json", code=self.judged)
        self.assertEqual(ran.out, self.table)
        lines = [json.loads(line) for line in ran.err.splitlines()]
        for line in lines:
            command.schemas.check(line)
        self.assertEqual(lines[-1]["finished_units"], RUNS)

    def test_the_same_table_by_any_chunks(self):
        for units in (7, RUNS):
            ran = self.job(*VALIDATE, "--chunk-units", units, code=self.judged)
            self.assertEqual(ran.out, self.table)
        self.assertFalse((self.folder / "mbk-jobs").exists())

    def test_a_job_of_another_version_is_refused(self):
        study = self.study()
        began = self.begin("study", "measure", "--study", study, "--keep-job", "--chunk-units", "1")
        began.communicate()
        job = next((study / "jobs").iterdir())
        text = (job / "job.json").read_text(encoding="utf-8")
        document = json.loads(text)
        command.schemas.check(document)
        (job / "job.json").write_text(text.replace(document["program"], "0.0.9 abc"), encoding="utf-8")
        self.refused(BAD_DATA, "work", job, "--chunk", 0, says="0.0.9")
        self.refused(BAD_DATA, "study", "measure", "--study", study, *self.engine, "--job-folder", job, says="0.0.9")

    def test_status_tells_what_each_task_took(self):
        study = self.study()
        self.job("study", "measure", "--study", study, "--keep-job", "--chunk-units", "2")
        status = self.mbk("study", "status", "--study", study, "--json").json
        job = status["jobs"][0]
        self.assertEqual((job["finished"], job["finished_units"], len(job["tasks"])), (2, 4, 2))
        self.assertEqual(sum(task["units"] for task in job["tasks"]), 4)
        shown = self.mbk("work", job["folder"], "--status", "--json").json
        self.assertEqual((shown["finished"], shown["finished_units"]), (2, 4))
        lines = (pathlib.Path(job["folder"]) / "progress.jsonl").read_text(encoding="utf-8").splitlines()
        for line in lines:
            command.schemas.check(json.loads(line))

    def test_ctrl_c_ends_everything_and_can_be_taken_up(self):
        began = self.begin(*VALIDATE, *SHORT)
        self.wait_for(lambda: self.shards())
        began.send_signal(signal.SIGINT)
        began.communicate(timeout=20)
        self.assertEqual(began.returncode, 128 + signal.SIGINT)
        self.assertEqual(workers_of(self.folder), [])
        self.assertEqual(self.job(*VALIDATE, *SHORT, code=self.judged).out, self.table)

    def test_says_what_cannot_be_had(self):
        self.refused(WRONG_USAGE, "validate", "robot", "--runs", "2", *self.engine, folder=self.folder, says="--engine")
        self.refused(WRONG_USAGE, "validate", "reliability", *self.engine, "--detach", folder=self.folder, says="slurm")
        self.refused(WRONG_USAGE, "work", self.folder, "--status", says=str(self.folder))
        self.refused(WRONG_USAGE, "study", "summary", "--study", self.repeated_study(), *self.engine,
                     says="--bootstrap")
        self.refused(WRONG_USAGE, "explore", self.trials[0], *self.engine, says="--each")


@unittest.skipIf(private_slurm.missing(), f"not there: {', '.join(private_slurm.missing())}")
class Slurm(Engines, JobCase):
    engine = ("--engine", "slurm", "--settle", "0.5")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.slurm = private_slurm.PrivateSlurm(max_array=18)
        cls.slurm.__enter__()
        cls.addClassCleanup(cls.slurm.stop)
        cls.environment = cls.slurm.environment

    def tearDown(self):
        self.slurm.say("scancel", "--user=root")
        self.slurm.say("scontrol", "update", f"NodeName={self.slurm.host}", "State=RESUME")
        super().tearDown()

    def test_is_detached_told_of_cancelled_and_collected(self):
        study = self.study()
        measure = ("study", "measure", "--study", study, "--chunk-units", "1")
        # The node takes nothing yet, so that the tasks wait.
        self.slurm.say("scontrol", "update", f"NodeName={self.slurm.host}", "State=DRAIN", "Reason=test")
        ran = self.job(*measure, "--detach")
        self.assertIn("mbk work", ran.err)
        (status,) = self.mbk("study", "status", "--study", study, "--json").json["jobs"]
        self.assertEqual((status["finished"], status["chunks"]), (0, 4))
        self.assertEqual(len(self.slurm.say("squeue", "-h", "-r").splitlines()), 4)
        job = next((study / "jobs").iterdir())
        self.mbk("work", job, "--cancel", environment=self.environment)
        self.assertEqual(self.slurm.say("squeue", "-h", "-r"), "")
        self.slurm.say("scontrol", "update", f"NodeName={self.slurm.host}", "State=RESUME")
        self.job(*measure, "--detach")
        self.wait_for(lambda: len(list(job.glob("shards/*.shard"))) == 4)
        self.assertIn("4 usable", self.job(*measure).out)

    def test_asks_for_no_more_tasks_than_the_controller_allows(self):
        ran = self.job(*VALIDATE, "--chunk-units", "1", "--keep-job", code=self.judged)
        self.assertEqual(ran.out, self.table)
        job = json.loads(next(self.folder.rglob("job.json")).read_text(encoding="utf-8"))
        self.assertLessEqual(job["chunks"], 18)

    def test_paths_that_shells_and_slurm_take_apart(self):
        owned = self.folder / "owned"
        for name in ("with space", "100%", "50%A_%a", "it's $(touch owned) `touch owned` #;&", '"quoted"'):
            with self.subTest(name=name):
                job = self.folder / name / "job"
                job.parent.mkdir()
                ran = self.job(*VALIDATE, *SHORT, "--job-folder", job, "--keep-job", code=self.judged)
                self.assertEqual(ran.out, self.table)
                logs = [log for log in self.folder.rglob("*.txt") if re.fullmatch(r"\d+_\d+\.txt", log.name)]
                self.assertEqual({log.is_relative_to(job) for log in logs}, {True}, "what tasks say stands in the job's folder")
                shutil.rmtree(job)
        self.assertFalse(owned.exists())

    def test_paths_that_slurm_cannot_take_are_refused(self):
        for name, what in (("a\ntouch owned\n", "control character"), ("tab\tb", "control character"), ("back\\slash", "backslash")):
            with self.subTest(name=name):
                job = self.folder / name / "job"
                job.parent.mkdir()
                ran = self.refused(WRONG_USAGE, *VALIDATE, *SHORT, *self.engine, "--job-folder", job, folder=self.folder,
                                   environment=self.environment, says=[what, "--job-folder"])
                self.assertNotIn("sinfo", ran.err)
        self.assertFalse((self.folder / "owned").exists())

    def test_what_slurm_refuses_is_named(self):
        ran = self.job(*VALIDATE, *SHORT, "--partition", "nowhere", code=BAD_DATA)
        self.assertIn("partition", ran.err)

    def test_partition_and_limit_reach_the_controller(self):
        self.slurm.say("scontrol", "update", f"NodeName={self.slurm.host}", "State=DRAIN", "Reason=test")
        self.job(*VALIDATE, *SHORT, "--detach", "--partition", "other", "--tasks", "3")
        said = self.slurm.say("squeue", "-h", "-o", "%P %i")
        self.assertIn("other", said)
        self.assertIn("%3", said)
        self.slurm.say("scancel", "--user=root")
        self.slurm.say("scontrol", "update", f"NodeName={self.slurm.host}", "State=RESUME")

    def test_a_controller_that_does_not_answer_costs_nothing(self):
        began = self.begin(*VALIDATE, *SHORT)
        self.wait_for(lambda: self.shards())
        self.slurm.daemons["slurmctld"].send_signal(signal.SIGSTOP)
        time.sleep(1.5)
        self.slurm.daemons["slurmctld"].send_signal(signal.SIGCONT)
        out, err = began.communicate(timeout=150)
        self.assertEqual(began.returncode, self.judged, err)
        self.assertEqual(out.decode(), self.table)


if __name__ == "__main__":
    command.main()
