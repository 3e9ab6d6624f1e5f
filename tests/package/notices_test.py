#!/usr/bin/env python3
"""THIRD_PARTY_NOTICES.md names every library that the program links and every package whose headers are in it."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
NOTICES = (SOURCE / "THIRD_PARTY_NOTICES.md").read_text()
TABLE = "\n".join(line for line in NOTICES.splitlines() if line.startswith("| ["))
SHIPPED = re.compile(r"^(apps/mbk|mbk/[\w/]+)/CMakeFiles/(?!\w*_test\.dir)\w+\.dir/")


def ran(*command):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300, check=False).stdout


class Notices(unittest.TestCase):
    @unittest.skipUnless(shutil.which("readelf"), "there is no readelf")
    def test_every_library_that_is_linked_is_named(self):
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", ran("readelf", "--dynamic", os.environ["MBK"]))
        self.assertIn("libc.so.6", needed)
        for library in needed:
            self.assertIn(f"`{library}`", TABLE)

    @unittest.skipUnless(shutil.which("ninja") and shutil.which("dpkg-query"), "there is no ninja, or no dpkg")
    def test_every_package_whose_headers_are_compiled_in_is_named(self):
        headers, ships = set(), False
        for line in ran("ninja", "-C", os.environ["BUILD"], "-t", "deps").splitlines():
            if line and not line.startswith(" "):
                ships = bool(SHIPPED.match(line))
            elif ships and line.startswith("    /usr/"):
                headers.add(os.path.normpath(line.strip()))
        self.assertGreater(len(headers), 100)
        owners = ran("dpkg-query", "--search", *sorted(headers))
        packages = {line.split(":")[0] for line in owners.splitlines()}
        self.assertIn("libeigen3-dev", packages)
        for package in packages:
            self.assertIn(f"`{package}`", TABLE)


if __name__ == "__main__":
    unittest.main()
