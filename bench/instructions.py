#!/usr/bin/env python3
"""Has a command become slower? Counts the instructions of six commands and compares them with bench/instructions.json.

usage: instructions.py [--build build/release] [--update]

More than 10 % over a figure fails. A change that is meant to cost more writes new figures with --update. With another
compiler, or without valgrind, nothing can be compared: exit code 77.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import commands

HERE = Path(__file__).resolve().parent
FIGURES = HERE / "instructions.json"
LIMIT = 0.10
LOAD = commands.Load(seconds=8, small_files=1, small_seconds=4)
COUNTED = ("measure", "explore", "tf", "simulate", "convert, CSV to HDF5", "session on the virtual clock")
NOT_COMPARABLE = 77


def compiler_of(build):
    """Name and version, as CMake found them."""
    file = next(build.glob("CMakeFiles/*/CMakeCXXCompiler.cmake"))
    found = dict(re.findall(r'set\((CMAKE_CXX_COMPILER_(?:ID|VERSION)) "([^"]*)"\)', file.read_text(encoding="utf-8")))
    return f"{found['CMAKE_CXX_COMPILER_ID']} {found['CMAKE_CXX_COMPILER_VERSION']}"


def count(program, command, folder):
    """Instructions of one run, which valgrind shows the same processor on every machine."""
    ran = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, *command.arguments],
                         cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    found = re.search(r"Collected : (\d+)", ran.stderr)
    if ran.returncode != 0 or not found:
        sys.exit(f"{command.name}: exit code {ran.returncode}\n{ran.stderr[-2000:]}")
    return int(found[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=HERE.parent / "build/release", help="folder of a build (build/release)")
    parser.add_argument("--update", action="store_true", help="write what is counted as the figures")
    given = parser.parse_args()
    build = given.build.resolve()
    compiler = compiler_of(build)
    figures = json.loads(FIGURES.read_text(encoding="utf-8")) if FIGURES.exists() else {}
    if not given.update and figures["compiler"] != compiler:
        print(f"nothing to compare: the figures are those of {figures['compiler']}, and this is {compiler}")
        return NOT_COMPARABLE
    chosen = [command for command in LOAD.commands() if command.name in COUNTED]
    with tempfile.TemporaryDirectory(prefix="mbk-instructions-") as name:
        folder = Path(name)
        LOAD.make(build / "bin", folder, chosen)
        try:
            counted = {command.name: count(build / "bin/mbk", command, folder) for command in chosen}
        except FileNotFoundError:
            print("nothing to compare: there is no valgrind")
            return NOT_COMPARABLE
    if given.update:
        FIGURES.write_text(json.dumps({"compiler": compiler, "commands": counted}, indent=2) + "\n", encoding="utf-8")
        return 0
    slower = False
    for command, now in counted.items():
        change = now / figures["commands"][command] - 1.0
        slower = slower or change > LIMIT
        print(f"{command}: {now:,} instructions, {100 * change:+.1f} %{': SLOWER' if change > LIMIT else ''}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
