"""The whole commands that instructions.py counts, and the recordings that they read."""

import dataclasses
import os
import subprocess
import sys

SCENARIO = """
[recording]
condition = "benchmark"
rate_hz = {rate}
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = {seconds}
moving_in_s = 1
[participant]
kind = "arm"
number = 1
"""
SESSION = SCENARIO + """
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
"""


@dataclasses.dataclass(frozen=True)
class Command:
    name: str
    arguments: list  # of mbk, in the folder of the inputs
    reads: str = ""  # which input it needs, a name in Load.make
    writes: str = ""  # the file that it leaves there


@dataclasses.dataclass(frozen=True)
class Load:
    """How long the recordings are [s], and how many small ones there are and how long [s]."""

    seconds: float
    small_files: int
    small_seconds: float
    small_rate: int = 100  # [Hz]

    def make(self, programs, folder, chosen):
        """Writes what the chosen commands read into the folder; the same bytes each time.
        @param programs  the folder of mbk and make_log"""
        def run(program, *arguments):
            ran = subprocess.run([programs / program, *map(str, arguments)], cwd=folder, capture_output=True, text=True,
                                 check=False)
            if ran.returncode != 0:
                sys.exit(f"{program} {' '.join(map(str, arguments))}: exit code {ran.returncode}\n{ran.stderr}")

        def scenario(name, text, seconds, rate=1000):
            (folder / name).write_text(text.format(seconds=seconds, rate=rate), encoding="utf-8")

        def recording():
            scenario("scenario.toml", SCENARIO, self.seconds)
            run("mbk", "simulate", "scenario.toml", "--quiet", "--out", "recording.mat")
            run("mbk", "convert", "recording.mat", "recording.csv", "--quiet")

        def small():
            scenario("small.toml", SCENARIO, self.small_seconds, self.small_rate)
            run("mbk", "simulate", "small.toml", "--quiet", "--seeds", self.small_files, "--out", "small.mat")

        make = {"recording": recording, "small": small, "session": lambda: scenario("session.toml", SESSION, self.seconds),
                "log": lambda: run("make_log", "--protocol", "sinusoidal", "--seed", 1, "--out", "log.mat")}
        for needed in sorted({command.reads for command in chosen if command.reads}):
            make[needed]()

    def commands(self):
        small = [f"small_seed{k + 1}.mat" for k in range(self.small_files)]
        window = ["--from", "12", "--to", str(min(max(self.seconds, 20), 62))]  # of the log, whose protocol sets its length
        return [
            Command("start", ["--version"]),
            Command("measure", ["measure", "recording.mat"], "recording"),
            Command("measure, reference mode", ["measure", "--mode", "reference", *window, "log.mat"], "log"),
            Command("identify", ["identify", "recording.mat"], "recording"),
            Command("explore", ["explore", "recording.mat"], "recording"),
            Command("passivity", ["passivity", "recording.mat"], "recording"),
            Command("tf", ["tf", "recording.mat", "--input", "xr", "--output", "x", "--poles", "2", "--zeros", "1",
                           "--to", "10", "--threads", "1"], "recording"),
            Command("simulate", ["simulate", "scenario.toml", "--quiet", "--out", "simulated.mat"], "recording",
                    "simulated.mat"),
            Command("convert, MAT to CSV", ["convert", "recording.mat", "converted.csv", "--quiet"], "recording",
                    "converted.csv"),
            Command("convert, CSV to HDF5", ["convert", "recording.csv", "converted.h5", "--quiet"], "recording",
                    "converted.h5"),
            Command("session on the virtual clock", ["run", "session.toml", "--fast", "--quiet", "--no-console",
                                                     "--no-measure", "--out", "session.h5"], "session", "session.h5"),
            Command(f"measure, {self.small_files} small files", ["measure", "--quiet", "--threads", "1", *small], "small"),
        ]


def clear(folder, command):
    """Takes away what an earlier run of the command wrote."""
    if command.writes:
        (folder / command.writes).unlink(missing_ok=True)


def processor():
    """Its name as Linux knows it, and how many of them."""
    name = "unknown processor"
    with open("/proc/cpuinfo", encoding="utf-8") as lines:
        for line in lines:
            if line.startswith("model name"):
                name = line.partition(":")[2].strip()
                break
    return f"{name}, {os.cpu_count()} cores"
