#!/usr/bin/env python3
"""Has a command become slower? Counts the instructions of whole commands and holds them to bench/instructions.json.

usage: instructions.py [--build build/release] [--only NAME ...] [--repeat N] [--update] [--figures FILE]

Times of a shared machine differ by more than a change that matters; counts of instructions are the same on every
machine that has valgrind and AVX2, with the same compiler, flags and libraries (bench/callgrind.py says why). What they
do not hold is in bench/README.md.

More than 3 % over a figure fails, with the functions that grew. More than 3 % under it does not, and asks for a new
figure. A change that is meant to cost more writes new figures with --update and says why in its commit. With other
versions of compiler or libraries nothing can be compared: exit code 77, as where there is no valgrind.
"""

import argparse
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import callgrind
import commands

HERE = Path(__file__).resolve().parent
FIGURES = HERE / "instructions.json"
LIMIT = 0.03
LOAD = commands.Load(seconds=8, small_files=20, small_seconds=4)
KEPT = 0.004  # share of the total from which on a function stands in the figures
SHOWN = 8  # functions of either list
NOT_COMPARABLE = 77
LIBRARIES = ("eigen3", "fmt", "libdeflate", "nlohmann_json", "zlib", "tomlplusplus", "CLI11")


# ---------------------------------------------------------------- what the figures hold for


def cache_of(build):
    """The entries of CMakeCache.txt."""
    lines = (build / "CMakeCache.txt").read_text(encoding="utf-8").splitlines()
    return dict(re.findall(r"^([A-Za-z0-9_.-]+):[A-Z]+=(.*)$", "\n".join(lines), re.MULTILINE))


def compiler_of(build):
    """Name and version, as CMake found them."""
    for file in sorted(build.glob("CMakeFiles/*/CMakeCXXCompiler.cmake")):
        found = dict(re.findall(r'set\((CMAKE_CXX_COMPILER_(?:ID|VERSION)) "([^"]*)"\)', file.read_text(encoding="utf-8")))
        return f"{found.get('CMAKE_CXX_COMPILER_ID')} {found.get('CMAKE_CXX_COMPILER_VERSION')}"
    return "unknown"


def conditions(build):
    """All that changes the counts and is no part of this repository."""
    cache = cache_of(build)
    kind = cache.get("CMAKE_BUILD_TYPE", "")
    flags = [cache.get("CMAKE_CXX_FLAGS", ""), cache.get(f"CMAKE_CXX_FLAGS_{kind.upper()}", "")]
    features = Path("/proc/cpuinfo").read_text(encoding="utf-8").split()
    made = {"processor": f"{platform.machine()}, {'AVX2' if 'avx2' in features and 'fma' in features else 'no AVX2'}",
            "compiler": compiler_of(build), "flags": " ".join(" ".join([kind, *flags]).split()),
            "MBK_UNITY": cache.get("MBK_UNITY", ""), "valgrind": callgrind.version(),
            "C library": os.confstr("CS_GNU_LIBC_VERSION")}
    for library in LIBRARIES:
        try:
            said = subprocess.run(["pkg-config", "--modversion", library], capture_output=True, text=True, check=False)
        except OSError:
            break
        if said.returncode == 0:
            made[library] = said.stdout.strip()
    return made


def not_comparable(figures, here):
    """One line for each thing that is another than when the figures were made."""
    made = figures["made_with"]
    return [f"{name}: {here.get(name) or 'none'} here, {made.get(name) or 'none'} of the figures"
            for name in sorted(made.keys() | here.keys()) if made.get(name) != here.get(name)]


# ---------------------------------------------------------------- figures and what was counted


def figure_of(counted):
    """What is kept of a count: the total, and inclusive and self of each function that matters."""
    least = KEPT * counted.total
    kept = {name: list(both) for name, both in counted.functions.items() if both[1] >= least or both[0] >= 5 * least}
    return {"instructions": counted.total,
            "functions": dict(sorted(kept.items(), key=lambda item: (-item[1][1], -item[1][0], item[0])))}


def grew(figure, counted):
    """Lines of the functions that execute more than before, by themselves and with all that they call."""
    least = int(KEPT * figure["instructions"])

    def rows(which, below):
        found = []
        for name, both in counted.functions.items():
            before = figure["functions"].get(name)
            if both[which] <= below * counted.whole:
                more = both[which] - (before[which] if before else min(least, both[which]))
                if more > 0.001 * figure["instructions"]:
                    text = f"{before[which]:>15,}" if before else f"{'under':>4} {5 * least if which == 0 else least:>9,}"
                    found.append((more, f"    {both[which]:>15,}{text:>16}  {name}"))
        return [line for _, line in sorted(found, reverse=True)[:SHOWN]]

    lines = []
    # Those that hold nearly everything, such as main, say nothing.
    for title, of in (("by themselves", rows(1, 1.0)), ("with what they call", rows(0, 0.9))):
        if of:
            lines += [f"  functions that grew, {title}: instructions now, before", *of]
    return lines or ["  no single function grew by more than 0.1 % of the command"]


def compare(figures, counted, expected):
    """@param counted   name: Counted, or Failed where the command failed
    @param expected  names of all commands there are
    @returns  the text, and whether all is well"""
    lines, fine = [], True
    for name in figures["commands"]:
        if name not in expected:
            lines.append(f"{name}: has a figure and is no command any more; take it away with --update")
            fine = False
    for name, found in counted.items():
        figure = figures["commands"].get(name)
        if isinstance(found, callgrind.Failed):
            lines.append(f"{name}: {found}")
            fine = False
        elif figure is None:
            lines.append(f"{name}: {found.total:,} instructions and no figure; write one with --update")
            fine = False
        else:
            change = found.total / figure["instructions"] - 1.0
            line = f"{name}: {found.total:,} instructions, {100 * change:+.2f} % of {figure['instructions']:,}"
            if change > LIMIT:
                fine = False
                lines += [f"{line}: SLOWER, by more than {100 * LIMIT:g} %", *grew(figure, found)]
            elif change < -LIMIT:
                lines.append(f"{line}: faster; keep it so with --update")
            else:
                lines.append(line)
    return "\n".join(lines), fine


def read_figures(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        sys.exit(f"instructions.py: {path}: {error}; write it with --update")


def write_figures(path, here, figures):
    """Functions one a line, so that a difference can be read."""
    parts = []
    for name, figure in figures.items():
        functions = ",\n".join(f"        {json.dumps(one)}: {json.dumps(both)}" for one, both in figure["functions"].items())
        parts.append(f'    {json.dumps(name)}: {{\n      "instructions": {figure["instructions"]},\n'
                     f'      "functions": {{\n{functions}\n      }}\n    }}')
    made = json.dumps(here, indent=2).replace("\n", "\n  ")
    text = f'{{\n  "made_with": {made},\n  "commands": {{\n' + ",\n".join(parts) + "\n  }\n}\n"
    new = path.with_name(path.name + ".new")
    new.write_text(text, encoding="utf-8")
    new.replace(path)


# ---------------------------------------------------------------- the program


def count_all(programs, chosen, repeat):
    """name: Counted or Failed, of the first run; the spread of more runs is printed."""
    counted = {}
    with tempfile.TemporaryDirectory(prefix="mbk-instructions-") as name:
        folder = Path(name)
        LOAD.make(programs, folder, chosen)
        for command in chosen:
            totals = []
            for _ in range(repeat):
                commands.clear(folder, command)
                try:
                    found = callgrind.count([programs / "mbk", *command.arguments], folder)
                except callgrind.Failed as failure:
                    found = failure
                counted.setdefault(command.name, found)
                if isinstance(found, callgrind.Failed):
                    break
                totals.append(found.total)
            if repeat > 1 and totals:
                print(f"{command.name}: {min(totals):,} to {max(totals):,} instructions in {len(totals)} runs, "
                      f"spread {100 * (max(totals) / min(totals) - 1):.4f} %", flush=True)
    return counted


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=HERE.parent / "build/release", help="folder of a build (build/release)")
    parser.add_argument("--only", action="append", metavar="NAME", help="only this command; may be repeated")
    parser.add_argument("--repeat", type=int, default=1, help="so many runs of each, and how much they differ (1)")
    parser.add_argument("--update", action="store_true", help="write what is counted as the figures")
    parser.add_argument("--figures", type=Path, default=FIGURES, help="other figures than bench/instructions.json")
    given = parser.parse_args(arguments)
    if given.repeat < 1:
        parser.error("--repeat must be at least 1")
    everything = LOAD.commands()
    names = [command.name for command in everything]
    for name in given.only or []:
        if name not in names:
            parser.error(f"there is no command '{name}'; there are: {', '.join(names)}")
    chosen = [command for command in everything if not given.only or command.name in given.only]
    build = given.build.resolve()
    for program in ("bin/mbk", "bin/make_log", "CMakeCache.txt"):
        if not (build / program).exists():
            sys.exit(f"instructions.py: {build / program} is not there; build first, or name the folder with --build")
    if callgrind.version() is None:
        print("instructions.py: there is no valgrind, so nothing is counted; install valgrind")
        return NOT_COMPARABLE
    here = conditions(build)
    if not given.update or given.only:
        figures = read_figures(given.figures)
        if others := not_comparable(figures, here):
            print("\n  ".join(["instructions.py: not comparable with the figures, so nothing is counted:", *others]))
            if given.update:
                sys.exit("with --update, leave --only away: figures of one file are made in one place")
            return NOT_COMPARABLE
    counted = count_all(build / "bin", chosen, given.repeat)
    if not given.update:
        text, fine = compare(figures, counted, names)
        print(text)
        if not fine:
            print(f"\nA change that means it: tools/instructions --update, and why in the commit ({given.figures})")
        return 0 if fine else 1
    for name, found in counted.items():
        if isinstance(found, callgrind.Failed):
            sys.exit(f"instructions.py: {name}: {found}")
    old = figures["commands"] if given.only else {}
    new = {name: figure_of(counted[name]) if name in counted else old[name] for name in names
           if name in counted or name in old}
    write_figures(given.figures, here, new)
    print(f"{len(counted)} figures written into {given.figures}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
