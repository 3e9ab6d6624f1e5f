#!/usr/bin/env python3
"""Program and library run with glibc 2.34, that of Ubuntu 22.04 and Enterprise Linux 9, or older.

The newest symbol that each asks for is named. A newer one gets a detour as hypot has it: cmake/older_glibc.c.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

OLDEST = (2, 34)
SKIPPED = 77


def newest(symbols):
    """((2, 34), "dlsym"): the newest version of glibc in what objdump says, and a symbol that asks for it."""
    found = re.findall(r"\*UND\*.*\(GLIBC_([\d.]+)\)\s+(\S+)", symbols)
    return max((tuple(map(int, version.split("."))), name) for version, name in found)


class Glibc(unittest.TestCase):
    def test_the_newest_is_found(self):
        self.assertEqual(newest("0000 DF *UND*\t0000 (GLIBC_2.9) pipe2\n0000 DF *UND*\t0000 (GLIBC_2.35) hypot\n"),
                         ((2, 35), "hypot"))

    def test_nothing_newer_is_asked_for(self):
        build = pathlib.Path(os.environ["BUILD"])
        binaries = [pathlib.Path(os.environ["MBK"]), *build.glob("lib/libmbk.so.*.*.*"), *build.glob("octave/*.mex")]
        for binary in binaries:
            said = subprocess.run(["objdump", "--dynamic-syms", binary], capture_output=True, text=True, check=True).stdout
            version, symbol = newest(said)
            print(f"{binary.name}: glibc {'.'.join(map(str, version))} ({symbol})")
            self.assertLessEqual(version, OLDEST, f"{binary} asks for {symbol} of glibc {version}")


if __name__ == "__main__":
    if not shutil.which("objdump"):
        print("not here: objdump")
        sys.exit(SKIPPED)
    unittest.main()
