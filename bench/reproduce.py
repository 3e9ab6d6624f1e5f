#!/usr/bin/env python3
"""How long the whole of `mbk reproduce` takes, and whether a second run gives the same numbers.

usage: bench/reproduce.py [--bin build/release/bin]

Both runs are reported, the second on one thread and without the printed numbers: ours must not depend on either.
"""

import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

PRINTED = ("printed", "printed_value", "rounding", "difference", "agreement")


def ours(document):
    """The document without what was printed."""
    document.pop("agreement")
    for exhibit in document["exhibits"]:
        for table in exhibit["tables"]:
            for row in table["rows"]:
                for cell in row["cells"]:
                    for key in PRINTED:
                        cell.pop(key)
    return document


def timed(mbk, folder, *arguments):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    process = subprocess.run([mbk, "reproduce", "--out", folder, "--quiet", *arguments], check=False,
                             stdout=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{' '.join(arguments) or 'as it is':<32} {time.monotonic() - start:6.1f} s, "
          f"{after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:6.1f} s of processor time, "
          f"exit {process.returncode}")
    print("  " + process.stdout.splitlines()[-1].strip())
    return ours(json.loads((folder / "reproduction.json").read_text()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, default="build/release/bin", help="where mbk is (%(default)s)")
    mbk = parser.parse_args().bin / "mbk"
    with tempfile.TemporaryDirectory() as folder:
        first = timed(mbk, pathlib.Path(folder) / "first")
        second = timed(mbk, pathlib.Path(folder) / "second", "--threads", "1", "--without-printed")
    same = first == second
    print("both runs have the same numbers" if same else "THE RUNS DIFFER")
    sys.exit(0 if same else 1)


if __name__ == "__main__":
    main()
