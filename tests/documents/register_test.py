#!/usr/bin/env python3
"""THIRD_PARTY_NOTICES.md names every library that the program links, and docs/guide/limits.md claims no conformity."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
NOTICES = (SOURCE / "THIRD_PARTY_NOTICES.md").read_text(encoding="utf-8")
LIMITS = (SOURCE / "docs/guide/limits.md").read_text(encoding="utf-8")


def rows():
    """The row of each library in the tables of the notices, by its name."""
    return {re.match(r"\| \[(.*?)\]", line).group(1): line for line in NOTICES.splitlines() if line.startswith("| [")}


class Notices(unittest.TestCase):
    @unittest.skipUnless(shutil.which("readelf") and "MBK" in os.environ, "there is no readelf, or no program")
    def test_name_every_library_that_the_program_links(self):
        ran = subprocess.run(["readelf", "--dynamic", os.environ["MBK"]], capture_output=True, text=True, check=True)
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", ran.stdout)
        self.assertIn("libstdc++.so.6", needed)
        for library in needed:
            names = [name for name, row in rows().items() if f"`{library}`" in row]
            self.assertEqual(len(names), 1, f"{library} is in {len(names)} rows of the notices")


class RegulatedWork(unittest.TestCase):
    def test_makes_no_claim_of_conformity(self):
        self.assertIn("Nobody claims", LIMITS)
        for claim in (r"\bcomplies\b", r"\bcompliant\b", r"\bcertified\b", r"\bis validated\b"):
            self.assertIsNone(re.search(claim, LIMITS), claim)


if __name__ == "__main__":
    unittest.main()
