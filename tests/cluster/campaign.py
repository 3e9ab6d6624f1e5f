#!/usr/bin/env python3
"""The figures of docs/guide/cluster.md, on this machine: every engine, three lengths of chunks, kills at random.

  MBK=build/test/bin/mbk tests/cluster/campaign.py bytes --study reliability --runs 100000 --kills 20
  MBK=build/test/bin/mbk tests/cluster/campaign.py cores --study recovery --runs 40 --pairs 5
  MBK=build/test/bin/mbk tests/cluster/campaign.py overhead --study coverage --runs 1000
"""

import argparse
import os
import pathlib
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import private_slurm
from processes import ended_by_kill, workers_of

MBK = os.environ.get("MBK", "build/test/bin/mbk")
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Campaign:
    def __init__(self, options, slurm):
        self.options, self.slurm = options, slurm
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mbk-campaign-"))
        self.lot = random.Random(options.seed)

    def command(self, engine, extra):
        command = [str(pathlib.Path(MBK).resolve()), "validate", self.options.study, "--runs", str(self.options.runs),
                   "--json", "--quiet", *extra]
        return command + (["--engine", engine] if engine else [])

    def environment(self, engine):
        environment = dict(self.slurm.environment if engine == "slurm" else os.environ)
        environment.update(MPI)
        return environment

    def run(self, engine, *extra, kills=0):
        """What it printed, the time that it took, processor time of local processes, and how many were killed."""
        before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        with subprocess.Popen(self.command(engine, extra), cwd=self.folder, env=self.environment(engine),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            killed = 0
            while kills > killed and process.poll() is None:
                time.sleep(self.lot.uniform(0.05, self.options.between))
                workers = workers_of(self.folder)
                if workers and process.poll() is None:
                    killed += ended_by_kill(self.lot.choice(workers))
            out, err = process.communicate()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if process.returncode not in (0, 1, 6):
            sys.exit(f"{engine} {extra}: exit {process.returncode}\n{err.decode()[-2000:]}")
        return out, time.monotonic() - begin, cpu, killed

    def bytes(self):
        reference, seconds, _, _ = self.run(None)
        print(f"in one process: {seconds:.0f} s", flush=True)
        for engine in self.options.engines:
            for units in self.options.chunk_units:
                out, seconds, _, killed = self.run(engine, "--chunk-units", str(units), "--settle", "2",
                                                   kills=self.options.kills)
                same = "the same bytes" if out == reference else "OTHER BYTES"
                print(f"{engine}, chunks of {units}: {seconds:.0f} s, {killed} killed, {same}", flush=True)
                if out != reference:
                    sys.exit(1)

    def cores(self):
        for engine in self.options.engines:
            ratios, used = [], []
            for _ in range(self.options.pairs):
                _, one, _, _ = self.run(engine, "--tasks", "1", "--chunk-units", str(self.options.chunk_units[0]))
                _, two, cpu, _ = self.run(engine, "--tasks", "2", "--chunk-units", str(self.options.chunk_units[0]))
                ratios.append(one / two)
                used.append(cpu / two)
            print(f"{engine}: {statistics.median(ratios):.2f} × (of {', '.join(f'{r:.2f}' for r in ratios)}); "
                  f"processors busy with two: {statistics.median(used):.2f}", flush=True)

    def overhead(self):
        """Slurm beside local, and what the controller alone needs for as many tasks that do nothing."""
        units = str(self.options.chunk_units[0])
        array = -(-self.options.runs // self.options.chunk_units[0]) - 1
        script = self.folder / "nothing.sh"
        script.write_text("#!/bin/bash\ntrue\n", encoding="utf-8")
        differences = []
        for _ in range(self.options.pairs):
            _, local, _, _ = self.run("local", "--tasks", "2", "--chunk-units", units)
            _, slurm, _, _ = self.run("slurm", "--chunk-units", units)
            begin = time.monotonic()
            subprocess.run(["sbatch", "--wait", f"--array=0-{array}", "--output=/dev/null", script], check=True,
                           cwd=self.folder, env=self.environment("slurm"), stdout=subprocess.DEVNULL)
            alone = time.monotonic() - begin
            differences.append((slurm - local) / local)
            print(f"local {local:.1f} s, slurm {slurm:.1f} s, controller alone {alone:.1f} s for {array + 1} tasks",
                  flush=True)
        print(f"slurm takes {100 * statistics.median(differences):+.1f} % (median)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("bytes", "cores", "overhead"))
    parser.add_argument("--study", default="reliability")
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--between", type=float, default=3.0, help="at most, between two kills [s]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--chunk-units", type=int, nargs="+", default=[100])
    parser.add_argument("--engines", nargs="+", default=["local", "slurm", "mpi"])
    options = parser.parse_args()
    with private_slurm.PrivateSlurm() as slurm:
        getattr(Campaign(options, slurm), options.what)()


if __name__ == "__main__":
    main()
