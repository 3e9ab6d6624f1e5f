#!/usr/bin/env python3
"""The register of dependencies in docs/guide/regulation.md has what THIRD_PARTY_NOTICES.md has, and all that the program links."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
NOTICES = (SOURCE / "THIRD_PARTY_NOTICES.md").read_text(encoding="utf-8")
PAGE = (SOURCE / "docs/guide/regulation.md").read_text(encoding="utf-8")
REGISTER = PAGE[PAGE.index("## Register of dependencies"):]


def rows():
    """What a table of notices says of each item, by its name."""
    return {re.match(r"\| \[(.*?)\]", line).group(1): line for line in NOTICES.splitlines() if line.startswith("| [")}


def items():
    return [line.split("|")[1].strip() for line in REGISTER.splitlines() if line.startswith("| ")][1:]


class Register(unittest.TestCase):
    def test_has_the_same_items_as_the_notices(self):
        self.assertGreater(len(items()), 20)
        self.assertEqual(sorted(items()), sorted(rows()))

    @unittest.skipUnless(shutil.which("readelf") and "MBK" in os.environ, "there is no readelf, or no program")
    def test_has_every_library_that_the_program_links(self):
        ran = subprocess.run(["readelf", "--dynamic", os.environ["MBK"]], capture_output=True, text=True, check=True)
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", ran.stdout)
        self.assertIn("libstdc++.so.6", needed)
        for library in needed:
            names = [name for name, row in rows().items() if f"`{library}`" in row]
            self.assertEqual(len(names), 1, f"{library} stands in {len(names)} rows of the notices")
            self.assertIn(names[0], items())

    def test_makes_no_claim_of_conformity(self):
        self.assertIn("nobody claims", PAGE)
        for claim in (r"\bcomplies\b", r"\bcompliant\b", r"\bcertified\b", r"\bis validated\b"):
            self.assertIsNone(re.search(claim, PAGE), claim)


if __name__ == "__main__":
    unittest.main()
