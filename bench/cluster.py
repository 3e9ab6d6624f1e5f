#!/usr/bin/env python3
"""Work on many processes, by each engine: the same bytes, and what it costs. The figures of docs/guide/cluster.md.

  bytes     100,000 draws of people (well below 10 ms each), 2,000 trials of 12 s that are simulated and written as
            recordings, and 2,000 of 62 s that are simulated and measured, by each engine with three lengths of chunks,
            20 tasks killed at random in each: held against one process. --of chooses one of the three
  cores     one task and two, in pairs, on warm files; beside them what two processes do that have nothing in common
  overhead  10,000 units (--units) of 0.1 to 0.2 s by Slurm and by local processes, and an array of as many tasks that
            do nothing
  rate      trials of 62.1 s a second and core, by an engine and by threads of one process
  merge     10⁶ results of 200 bytes
  resume    kill -9 of the process that waits: finished chunks that were done again

cores, overhead and rate compare times of this machine: nothing else may run. Slurm is one of its own on this machine
(tests/cluster/private_slurm.py). What was measured stands in --state; a part that stands there is not measured again,
so that a campaign that was interrupted goes on. Exit code 1: a result differs, or a finished chunk was lost.

usage: cluster.py [--part bytes cores …] [--of draws …] [--short] [--units N] [--bin build/release/bin] [--state FILE]
                  [--again]
"""

import argparse
import contextlib
import hashlib
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests" / "cluster")]

import private_slurm  # noqa: E402
import study as studies  # noqa: E402
from processes import ended_by_kill, workers_of  # noqa: E402

ENGINES = ("local", "slurm")
WORKS = ("draws", "written", "measured")
JUDGED = (0, 1, 4, 6)  # exit codes of commands that did what they were asked
FULL = {"draws": 100_000, "draw_chunks": (1000, 3000, 10_000), "written": 2000, "written_chunks": (20, 60, 150),
        "runs": 1000, "run_chunks": (10, 25, 60), "kills": 20, "pairs": 3, "trials": 1000, "units": 10_000,
        "unit_chunk": 100, "merge": 1_000_000, "resumes": 5}
SHORT = {"draws": 3000, "draw_chunks": (200, 500, 1000), "written": 12, "written_chunks": (1, 2, 5),
         "runs": 10, "run_chunks": (1, 2, 5), "kills": 3, "pairs": 1, "trials": 20, "units": 100,
         "unit_chunk": 10, "merge": 50_000, "resumes": 1}


class Took:
    """What a command printed, and what it took."""

    def __init__(self, out, seconds, killed):
        self.out, self.seconds, self.killed = out, seconds, killed
        self.sum = hashlib.sha256(out).hexdigest()


class Campaign:
    def __init__(self, options, folder, slurm):
        self.options, self.folder, self.slurm = options, folder, slurm
        self.size = SHORT if options.short else FULL
        self.mbk = options.bin.resolve() / "mbk"
        self.lot = random.Random(options.seed)
        self.state = json.loads(options.state.read_text()) if options.state.exists() else {}
        self.wrong = []

    # --- running things

    def environment(self, engine):
        return dict(self.slurm.environment if engine == "slurm" else os.environ)

    def start(self, engine, *arguments):
        command = [self.mbk, *arguments] + (["--engine", engine] if engine else [])
        with open(self.folder / "out", "wb") as out, open(self.folder / "err", "wb") as err:  # no pipe, which may fill
            return subprocess.Popen(list(map(str, command)), cwd=self.folder, env=self.environment(engine),
                                    stdin=subprocess.DEVNULL, stdout=out, stderr=err)

    def run(self, engine, *arguments, kills=0, expected_s=10.0):
        begin = time.monotonic()
        with self.start(engine, *arguments) as process:
            killed = self.kill_some(process, kills, expected_s)
            process.wait()
        out, err = (self.folder / "out").read_bytes(), (self.folder / "err").read_bytes()
        if process.returncode not in JUDGED:
            sys.exit(f"cluster.py: exit {process.returncode} of mbk {' '.join(map(str, arguments))} --engine {engine}\n"
                     f"{err.decode()[-2000:]}")
        return Took(out, time.monotonic() - begin, killed)

    def kill_some(self, process, kills, expected_s):
        """Kills tasks at random moments of the time that it is expected to take."""
        killed = 0
        while killed < kills:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(self.lot.uniform(0.0, expected_s / (kills + 10)))
                return killed
            workers = workers_of(self.folder)
            killed += bool(workers) and ended_by_kill(self.lot.choice(workers))
        return killed

    def record(self, key, measure):
        """What was measured under that key, now or in an earlier run."""
        key = f"{'short' if self.options.short else 'full'}: {key}"
        if key not in self.state or self.options.again:
            print(f"… {key}", file=sys.stderr, flush=True)
            self.state[key] = measure()
            self.options.state.parent.mkdir(parents=True, exist_ok=True)
            part = self.options.state.with_name(self.options.state.name + ".part")
            part.write_text(json.dumps(self.state, indent=1))
            part.replace(self.options.state)
        return self.state[key]

    def row(self, what, asked, found, fine=True):
        print(f"{what:<44} {asked:<18} {found}", flush=True)
        if not fine:
            self.wrong.append(what)

    # --- what is worked on

    def draws(self):
        study = self.folder / "filled_600"
        if not study.exists():
            studies.filled_study(self.mbk, self.folder, 600)
        return ("study", "summary", "--study", study, "--json", "--quiet", "--compare", "session", "1", "2",
                "--bootstrap", self.size["draws"])

    def trials(self):
        return ("validate", "recovery", "--runs", self.size["runs"], "--json", "--quiet")

    def written(self):
        scenario = self.folder / "short.toml"
        if not scenario.exists():
            ready = subprocess.run([self.mbk, "simulate", "--show", "relaxed_sinusoidal"], check=True,
                                   capture_output=True, text=True).stdout
            text, changed = re.subn(r"(?m)^duration_s = .*$", "duration_s = 12", ready)
            if changed != 1:
                sys.exit("cluster.py: the ready scenario relaxed_sinusoidal has no duration_s")
            scenario.write_text(text, encoding="utf-8")
        (self.folder / "written").mkdir(exist_ok=True)
        return ("simulate", scenario, "--seeds", self.size["written"], "--out", self.folder / "written/trial.h5",
                "--quiet")

    def sum_of_written(self, took):
        """Of the recordings in the folder `written`, which is empty then, and of what was printed. A task that is killed
        while it writes leaves a file with a temporary name, which is no recording."""
        folder = self.folder / "written"
        files = sorted(folder.glob("*.h5"))
        if len(files) != self.size["written"]:
            sys.exit(f"cluster.py: {len(files)} recordings in place of {self.size['written']}: {files[:3]} …")
        left = {path.name for path in folder.iterdir()} - {path.name for path in files}
        if left:
            print(f"  left by tasks that were killed: {', '.join(sorted(left))}", flush=True)
        whole = hashlib.sha256(took.out)
        for file in files:
            whole.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
        shutil.rmtree(folder)
        folder.mkdir()
        return whole.hexdigest()

    def fresh_study(self, name="copy"):
        """A study of trials that were not measured yet."""
        template = self.folder / "measured"
        if not template.exists():
            studies.added_study(self.mbk, self.folder, self.size["trials"])
        copy = self.folder / name
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(template, copy, copy_function=os.link)
        for database in template.glob("study.sqlite*"):
            (copy / database.name).unlink()
            shutil.copy2(database, copy)
        return copy

    def measured(self, engine, *arguments):
        return self.run(engine, "study", "measure", "--study", self.fresh_study(), "--quiet", *arguments).seconds

    # --- the parts

    def bytes(self):
        works = {"draws": (f"{self.size['draws']:,} draws", self.draws, self.size["draw_chunks"]),
                 "written": (f"{self.size['written']:,} trials of 12 s, written", self.written,
                             self.size["written_chunks"]),
                 "measured": (f"{2 * self.size['runs']:,} simulated trials", self.trials, self.size["run_chunks"])}
        for work in self.options.of:
            name, make_arguments, chunks = works[work]
            arguments = make_arguments()

            def done(engine, *more, **kills):
                took = self.run(engine, *arguments, *more, **kills)
                both = took.sum if work != "written" else self.sum_of_written(took)
                return {"sha256": both, "seconds": took.seconds, "killed": took.killed}

            one = self.record(f"bytes, {name}, one process", lambda: done(None))
            self.row(name, "", f"one process: {one['seconds']:.0f} s")
            for engine in ENGINES:
                for units in chunks:
                    found = self.record(f"bytes, {name}, {engine}, {units}",
                                        lambda: done(engine, "--chunk-units", units, "--settle", "1",
                                                     kills=self.size["kills"], expected_s=one["seconds"]))
                    same = found["sha256"] == one["sha256"]
                    self.row(f"  {engine}, chunks of {units}", "same bytes",
                             f"{'same bytes' if same else 'OTHER BYTES'}, {found['killed']} killed, "
                             f"{found['seconds']:.0f} s", same)

    def cores(self):
        def ratios(engine):
            tasks = ("--chunk-units", str(max(1, self.size["trials"] // 20)))
            pairs = []
            for _ in range(self.size["pairs"]):
                one = self.measured(engine, "--tasks", "1", *tasks)
                pairs.append(one / self.measured(engine, "--tasks", "2", *tasks))
            return pairs

        def side_by_side(count):
            fresh = [self.fresh_study(f"copy_{k}") for k in range(count)]
            begin = time.monotonic()
            running = [self.start(None, "study", "measure", "--study", one, "--quiet", "--threads", 1) for one in fresh]
            if any(one.wait() not in JUDGED for one in running):
                sys.exit("cluster.py: a process that measures a study by itself failed")
            return time.monotonic() - begin

        alone = self.record("cores, no engine", lambda: [2 * side_by_side(1) / side_by_side(2)
                                                         for _ in range(self.size["pairs"])])
        self.row("one process and two, each with its own study", "what the machine has",
                 f"{statistics.median(alone):.2f} × (median of {', '.join(f'{one:.2f}' for one in alone)})")
        for engine in ENGINES:
            found = self.record(f"cores, {engine}", lambda engine=engine: ratios(engine))
            self.row(f"1 → 2 cores, {self.size['trials']} trials, {engine}", "≥ 1.85 ×",
                     f"{statistics.median(found):.2f} × (median of {', '.join(f'{one:.2f}' for one in found)})")

    def overhead(self):
        units, chunk = self.options.units or self.size["units"], self.size["unit_chunk"]
        arguments = ("validate", "coverage", "--runs", units, "--json",
                     "--quiet", "--chunk-units", chunk)
        script = self.folder / "nothing.sh"
        script.write_text("#!/bin/bash\ntrue\n", encoding="utf-8")

        def once():
            local = self.run("local", *arguments, "--tasks", "2").seconds
            slurm = self.run("slurm", *arguments).seconds
            begin = time.monotonic()
            subprocess.run(["sbatch", "--wait", f"--array=0-{math.ceil(units / chunk) - 1}", "--output=/dev/null",
                            script], check=True, cwd=self.folder, env=self.environment("slurm"),
                           stdout=subprocess.DEVNULL)
            return {"local_s": local, "slurm_s": slurm, "controller_s": time.monotonic() - begin}

        found = [self.record(f"overhead, {units} units, {k + 1}", once) for k in range(1 if self.options.short else 3)]
        for one in found:
            self.row(f"{units:,} units in {math.ceil(units / chunk)} tasks", "",
                     f"local {one['local_s']:.1f} s, slurm {one['slurm_s']:.1f} s, an empty array "
                     f"{one['controller_s']:.1f} s; {2 * one['local_s'] / units:.3f} s a unit")
        beside = statistics.median((one["slurm_s"] - one["local_s"] - one["controller_s"]) / one["local_s"] for one in found)
        plain = statistics.median((one["slurm_s"] - one["local_s"]) / one["local_s"] for one in found)
        self.row("Slurm over local", "≤ 5 % beside it", f"{100 * beside:+.1f} % beside the controller's own time, "
                                                        f"{100 * plain:+.1f} % with it")

    def rate(self):
        cores = len(os.sched_getaffinity(0))

        def once(engine):
            threads = self.measured(None, "--threads", cores)
            return {"threads_s": threads, "engine_s": self.measured(engine, "--tasks", cores)}

        for engine in ENGINES:
            found = [self.record(f"rate, {engine}, {k + 1}", lambda engine=engine: once(engine))
                     for k in range(self.size["pairs"])]
            per_core = statistics.median(self.size["trials"] / one["engine_s"] / cores for one in found)
            share = statistics.median(one["threads_s"] / one["engine_s"] for one in found)
            self.row(f"trials/s and core, {self.size['trials']} trials, {engine}", "≥ 90 % of local",
                     f"{per_core:.2f}, {100 * share:.0f} % of threads in one process")

    def merge(self):
        def once():
            test = self.mbk.with_name("batch_test")
            ran = subprocess.run([test, "--gtest_filter=Merge.OfManyResultsTakesLittleTimeAndMemory"], check=False,
                                 env={**os.environ, "MBK_MERGE_RESULTS": str(self.size["merge"])}, capture_output=True,
                                 text=True)
            if ran.returncode != 0:
                sys.exit(f"cluster.py: {test}: {ran.stdout}{ran.stderr}")
            return next(line for line in ran.stdout.splitlines() if " results of " in line)

        self.row("merge of 10⁶ results", "≤ 30 s, ≤ 300 MB", self.record("merge", once))

    def resume(self):
        arguments = ("validate", "reliability", "--runs", 60, "--json", "--quiet", "--chunk-units", 3, "--settle", "1")
        one = self.record("resume, one process", lambda: self.run(None, *arguments[:-4]).sum)

        def shards():
            return {path.name for path in self.folder.rglob("*.shard")}

        def once(engine):
            shutil.rmtree(self.folder / "mbk-jobs", ignore_errors=True)
            with self.start(engine, *arguments) as process:
                enough = self.lot.randint(2, 12)
                while len(shards()) < enough and process.poll() is None:
                    time.sleep(0.01)
                process.kill()
            while workers_of(self.folder):
                time.sleep(0.05)
            before = shards()
            took = self.run(engine, *arguments, "--keep-job")
            after = [name.split(".")[0] for name in shards()]
            again = sum(after.count(name.split(".")[0]) > 1 for name in before) + len(before - shards())
            shutil.rmtree(self.folder / "mbk-jobs")
            return {"finished": len(before), "again": again, "sha256": took.sum}

        for engine in ENGINES:
            found = [self.record(f"resume, {engine}, {k + 1}", lambda engine=engine: once(engine))
                     for k in range(self.size["resumes"])]
            again, same = sum(each["again"] for each in found), all(each["sha256"] == one for each in found)
            self.row(f"kill -9 of the coordinator, {engine}", "loses 0",
                     f"{again} of {sum(each['finished'] for each in found)} finished chunks lost in {len(found)} kills, "
                     f"{'same bytes' if same else 'OTHER BYTES'}", again == 0 and same)


PARTS = ("bytes", "cores", "overhead", "rate", "merge", "resume")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--of", nargs="+", choices=WORKS, default=WORKS, help="what the bytes are of")
    parser.add_argument("--short", action="store_true", help="a few of each, to see that it runs")
    parser.add_argument("--units", type=int, help="of overhead (10,000); fewer make its share larger, never smaller")
    parser.add_argument("--again", action="store_true", help="measure what stands in --state once more")
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/release/bin"))
    parser.add_argument("--state", type=pathlib.Path, default=pathlib.Path("build/cluster.json"))
    parser.add_argument("--folder", type=pathlib.Path, help="where files are written (a temporary folder)")
    parser.add_argument("--seed", type=int, default=1, help="of the kills")
    options = parser.parse_args()
    for one in (signal.SIGINT, signal.SIGTERM):  # daemons and folders go, whichever ends it
        signal.signal(one, lambda *_: sys.exit("cluster.py: interrupted; what was measured stands in --state"))
    with tempfile.TemporaryDirectory(prefix="mbk-cluster-", dir=options.folder) as name:
        with private_slurm.PrivateSlurm() as slurm:
            campaign = Campaign(options, pathlib.Path(name), slurm)
            for part in options.part:
                getattr(campaign, part)()
    if campaign.wrong:
        sys.exit(f"cluster.py: not as asked: {'; '.join(campaign.wrong)}")


if __name__ == "__main__":
    main()
