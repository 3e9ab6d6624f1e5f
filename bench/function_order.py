#!/usr/bin/env python3
"""Writes apps/mbk/function_order.txt: the functions that measuring a recording executes, which the linker puts together.

They are a tenth of the program and would stand all over it. The kernel maps a program in pieces of 64 kB, so that more
than half of it would be in memory. What is executed is seen in valgrind. To keep the list short, functions whose names begin
alike stand in it by that beginning where at least SHARE of their bytes are executed. What other processors execute in
their place, valgrind's having neither AVX-512 nor instructions for SHA-256, stands beside them. A name that is no more,
or that is new, does no harm: such a function stands where it would have stood. tests/end_to_end/memory_test.py holds the
memory.

usage: tools/function-order [--build build/release]
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import callgrind

HERE = Path(__file__).resolve().parent
ORDER = HERE.parent / "apps/mbk/function_order.txt"
SHARE = 0.7  # of their bytes
ELSEWHERE = ("compress_sha_instructions", "queryCacheSizes_amd")  # what valgrind's processor does by other functions


def usual(folder):
    """Arguments of mbk."""
    return [["--version"], ["identify", "--json", folder / "log.h5"], ["measure", folder / "log.mat"],
            ["measure", "--json", "--mode", "reference", folder / "log.mat"]]


def executed(mbk, arguments, folder):
    """Names of the program's functions, as the linker knows them."""
    names, of_mbk = set(), False
    for line in callgrind.profile([mbk, *arguments], folder, "--demangle=no", "--compress-strings=no").splitlines():
        if line.startswith("ob="):
            of_mbk = line[3:].strip() == str(mbk)
        elif line.startswith("fn=") and of_mbk:
            names.add(re.sub(r"'\d+$", "", line[3:].strip()))
    return names


def functions(mbk):
    """Bytes of each function of the program by name, and the names by address: constructors have two or three. Several
    functions that are called alike are one."""
    said = subprocess.run(["nm", "--print-size", "--defined-only", mbk], capture_output=True, text=True, check=True).stdout
    bytes_of, names_at = {}, {}
    for line in said.splitlines():
        words = line.split()
        if len(words) == 4 and words[2] in "tTwWuU":
            bytes_of[words[3]] = bytes_of.get(words[3], 0) + int(words[1], 16)
            names_at.setdefault(words[0], []).append(words[3])
    return bytes_of, names_at


def on_other_processors(names, used):
    """Those of the names that are executed there in the place of one that is used here."""
    wider = {name.replace("v3", "v4").replace("V3", "V4") for name in used}
    return {name for name in names if name in wider or any(one in name for one in ELSEWHERE)}


def patterns(bytes_of, used):
    """The beginnings of names, with an asterisk, and whole names that cover all that are used."""
    names, found = sorted(bytes_of), []

    def cover(low, high, least):
        """@param least  characters that tell names[low:high] from all others"""
        inside = [name for name in names[low:high] if name in used]
        if not inside:
            return
        if high - low == 1 or sum(bytes_of[name] for name in inside) >= SHARE * sum(bytes_of[n] for n in names[low:high]):
            found.append(names[low][:least] + ("*" if least < len(names[low]) or high - low > 1 else ""))
            return
        first, last = names[low], names[high - 1]
        same = next((k for k, (a, b) in enumerate(zip(first, last)) if a != b), len(first))
        if len(first) == same:  # it begins all the others
            if first in used:
                found.append(first)
            low += 1
        while low < high:
            end = low
            while end < high and names[end][same] == names[low][same]:
                end += 1
            cover(low, end, same + 1)
            low = end

    cover(0, len(names), 0)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=HERE.parent / "build/release", help="folder of a build (build/release)")
    programs = parser.parse_args().build.resolve() / "bin"
    mbk = programs / "mbk"
    with tempfile.TemporaryDirectory(prefix="mbk-function-order-") as name:
        folder = Path(name)
        for make in ([programs / "make_log", "--protocol", "sinusoidal", "--seed", "1", "--out", folder / "log.mat"],
                     [mbk, "convert", folder / "log.mat", folder / "log.h5", "--quiet"]):
            subprocess.run(make, check=True, stdout=subprocess.DEVNULL)
        try:
            used = set().union(*(executed(mbk, arguments, folder) for arguments in usual(folder)))
        except callgrind.Failed as failure:
            sys.exit(f"function_order.py: {failure}")
    bytes_of, names_at = functions(mbk)
    used |= on_other_processors(bytes_of, used)
    used = {name for names in names_at.values() if not used.isdisjoint(names) for name in names}
    new = ORDER.with_name(ORDER.name + ".new")
    new.write_text("".join(f"{pattern}\n" for pattern in patterns(bytes_of, used)), encoding="utf-8")
    new.replace(ORDER)
    print(f"{len(used)} functions of {sum(bytes_of[name] for name in used) / 1e6:.1f} MB in {ORDER}")


if __name__ == "__main__":
    main()
