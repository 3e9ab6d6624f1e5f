#!/usr/bin/env python3
"""Runs the benchmarks, and with --page writes what they say into the tables of bench/README.md.

usage: page.py [--bin build/bench/bin] [--only NAME ...] [--short] [--page]

A table stands between two comments, `<!-- bench: NAME -->` and `<!-- end of bench: NAME, … -->`. The second one ends
with a checksum of what is between, which tests/bench/page_test.py compares: a table is what a benchmark printed, with
the day, the machine and its load, and nobody's later opinion. What is not chosen by --only stays as it is.
"""

import argparse
import ast
import dataclasses
import datetime
import hashlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import against
import commands

HERE = Path(__file__).resolve().parent
PAGE = HERE / "README.md"
BLOCK = re.compile(r"<!-- bench: (\w+) -->\n(.*?)<!-- end of bench: \1(?:, ([0-9a-f]{12}))? -->\n", re.DOTALL)
CONDITIONAL = ("Octave",)  # rows that begin so need what a machine may not have


@dataclasses.dataclass(frozen=True)
class Benchmark:
    """A table of the page."""

    name: str
    source: str  # whose rows they are
    program: str = ""  # in the folder of the build; otherwise the source runs in Python
    full: tuple = ()  # options
    short: tuple = ()

    def command(self, programs, short):
        options = [option.format(bin=programs) for option in (self.short if short else self.full)]
        start = [programs / self.program] if self.program else [sys.executable, "-B", HERE / self.source]
        return [*start, *options]


BIN = ("--bin", "{bin}")
BENCHMARKS = [
    Benchmark("noise", "page.py", full=("--noise", "15", *BIN), short=("--noise", "6", *BIN)),
    Benchmark("whole_command", "whole_command.py", full=("--runs", "21", *BIN), short=("--runs", "3", *BIN)),
    Benchmark("identify_command", "identify_command.py", full=("--runs", "61", *BIN), short=("--runs", "3", *BIN)),
    Benchmark("pipeline", "pipeline.py", full=("--turns", "21", *BIN), short=("--turns", "3", *BIN)),
    Benchmark("python_layer", "python_layer.py", full=("--turns", "11", *BIN), short=("--turns", "2", *BIN)),
    Benchmark("many_files", "many_files.py", full=BIN, short=("--files", "4", "--runs", "1", *BIN)),
    Benchmark("long_recording", "long_recording.py", full=BIN, short=("--longest", "10", "--runs", "1", *BIN)),
    Benchmark("study", "study.py", full=BIN, short=("--trials", "4", "--results", "100", *BIN)),
    Benchmark("stages", "stages.cpp", "bench_stages", short=("--benchmark_min_time=0.02",)),
    Benchmark("simulation", "simulation.py", full=("--runs", "9", *BIN), short=("--runs", "2", *BIN)),
    Benchmark("transfer_function", "transfer_function.py", full=("--turns", "21", *BIN), short=("--turns", "3", *BIN)),
    Benchmark("prediction_error", "prediction_error.py", full=("--turns", "5", *BIN), short=("--turns", "1", *BIN)),
    Benchmark("explore", "explore.py", full=("--turns", "11", *BIN), short=("--turns", "1", *BIN)),
    Benchmark("robot_dynamics", "robot_dynamics.cpp", "bench_robot_dynamics", short=("--benchmark_min_time=0.02",)),
    Benchmark("session", "session.cpp", "bench_session", short=("--seconds", "5", "--minutes", "1")),
    Benchmark("floods", "floods.py", full=("--mbk", "{bin}/mbk"), short=("--mbk", "{bin}/mbk", "--stops", "1")),
]


# ---------------------------------------------------------------- rows and tables


def pattern_of(node):
    """What a string in the source of a benchmark prints, as a regular expression; None where it is no string."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return re.escape(node.value.strip())
    if isinstance(node, ast.JoinedStr):
        return "".join(re.escape(str(part.value)) if isinstance(part, ast.Constant) else ".+?" for part in node.values)
    return None


def rows_of(source):
    """Regular expressions of the rows that a benchmark prints, read from its source."""
    text = (HERE / source).read_text(encoding="utf-8")
    if source.endswith(".py"):
        calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
        found = [pattern_of(call.args[0]) for call in calls
                 if getattr(call.func, "id", "") in ("row", "ratios") and call.args]
        return [row for row in found if row and not row.startswith(CONDITIONAL)]
    found = [re.escape(name) for name in re.findall(r"^BENCHMARK\((\w+)\)", text, re.MULTILINE)]
    found += [f"{one}/{name}" for one, name in re.findall(r"^BENCHMARK_CAPTURE\((\w+), (\w+),", text, re.MULTILINE)]
    return found + [re.escape(label.strip()) for label in re.findall(r'^  +print\("([^"]+)"', text, re.MULTILINE)]


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def tables(page):
    """name: what is between its comments, of every table whose checksum is right; raises ValueError where one is not."""
    found = {}
    for match in BLOCK.finditer(page):
        name, text, checksum = match.groups()
        if name in found:
            raise ValueError(f"the table '{name}' is there twice")
        if digest(text) != checksum:
            raise ValueError(f"the table '{name}' is not what the benchmark wrote; run: tools/bench --page --only {name}")
        found[name] = text
    begun = re.findall(r"<!-- bench: (\w+) -->", page)
    if begun != list(found):
        raise ValueError(f"tables that begin: {begun}; that also end: {list(found)}")
    return found


def with_table(page, name, text):
    """The page with another table of that name; raises ValueError where it has none."""
    block = f"<!-- bench: {name} -->\n{text}<!-- end of bench: {name}, {digest(text)} -->\n"
    count = sum(match[1] == name for match in BLOCK.finditer(page))
    if count != 1:
        raise ValueError(f"{PAGE.name} has {count} tables '{name}'; put '<!-- bench: {name} -->' and "
                         f"'<!-- end of bench: {name} -->' on lines of their own where the table is to be")
    return BLOCK.sub(lambda match: block if match[1] == name else match[0], page)


def table_of(printed, short):
    """What stands on the page: the day, the machine, what else it did, and what was printed."""
    load = os.getloadavg()[0]
    kind = "A short run, which is not to be quoted. " if short else ""
    return (f"{kind}Measured on {datetime.date.today().isoformat()}; {commands.processor()}, load {load:.1f} at the end.\n"
            f"```\n{printed.rstrip()}\n```\n")


# ---------------------------------------------------------------- running them


def noise(programs, rounds):
    """`mbk measure` against itself: what this machine calls equal."""
    load = against.FULL
    chosen = [command for command in load.commands() if command.name in ("start", "measure")]
    with tempfile.TemporaryDirectory(prefix="mbk-noise-") as name:
        load.make(programs, Path(name), chosen)
        print(f"{rounds} pairs of the same program; CPU time, the ratio within each pair\n")
        print(f"  {'':<24}{'median':>10}{'its 95 % interval':>22}{'least':>10}{'greatest':>10}")

        def row(title, command):
            found = against.rounds_of(programs / "mbk", programs / "mbk", command, Path(name), rounds)
            ratios = sorted(took["again"] / took["before"] for took in found)
            low, high = against.interval(ratios)
            print(f"  {title:<24}{ratios[len(ratios) // 2]:10.3f}{f'{low:.3f} to {high:.3f}':>22}"
                  f"{ratios[0]:10.3f}{ratios[-1]:10.3f}")

        row("mbk --version", chosen[0])
        row("mbk measure, 62.1 s", chosen[1])


def run(benchmark, programs, short):
    """What it prints, which is shown as it comes; raises against.Failed where it fails."""
    command = benchmark.command(programs, short)
    printed = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=HERE.parent) as process:
        for text in process.stdout:
            printed.append(text)
            print(text, end="", flush=True)
    if process.returncode != 0:
        raise against.Failed(f"exit code {process.returncode} of: {' '.join(map(str, command))}")
    return "".join(printed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=HERE.parent / "build/bench/bin", help="folder of the programs")
    parser.add_argument("--only", action="append", choices=[one.name for one in BENCHMARKS], help="may be repeated")
    parser.add_argument("--short", action="store_true", help="few and short runs, which say so on the page")
    parser.add_argument("--page", action="store_true", help="write bench/README.md")
    parser.add_argument("--noise", type=int, metavar="ROUNDS", help="only this: mbk against itself")
    given = parser.parse_args()
    programs = given.bin.resolve()
    if given.noise:
        return noise(programs, given.noise)
    failed = []
    for benchmark in BENCHMARKS:
        if given.only and benchmark.name not in given.only:
            continue
        print(f"\n---- {benchmark.name}\n", flush=True)
        try:
            printed = run(benchmark, programs, given.short)
        except (OSError, against.Failed) as failure:
            print(f"page.py: {benchmark.name}: {failure}", file=sys.stderr)
            failed.append(benchmark.name)
            continue
        if given.page:  # one by one: what has run is kept if a later one does not
            new = PAGE.with_name(PAGE.name + ".new")
            new.write_text(with_table(PAGE.read_text(encoding="utf-8"), benchmark.name, table_of(printed, given.short)),
                           encoding="utf-8")
            new.replace(PAGE)
    if failed:
        sys.exit(f"page.py: not run to their end, and not on the page: {', '.join(failed)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
