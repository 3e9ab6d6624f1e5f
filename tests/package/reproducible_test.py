#!/usr/bin/env python3
"""Packages and archive of one build are the same bytes, whoever packs them, wherever and whenever.

tools/release compares two builds; this compares what is packed of one, at other times, with another umask, locale, time
zone, home and folder. MBK_PORTABLE names a build of the preset portable, whose archive is compared, too.
"""

import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
BUILD = os.environ.get("MBK_PORTABLE") or os.environ["BUILD"]


class Reproducible(unittest.TestCase):
    def packed(self, tool, *arguments):
        """{name: sum} of what two runs of a tool leave."""
        found = []
        for umask, said in (("022", {"LC_ALL": "C.UTF-8", "TZ": "UTC"}), ("077", {"LC_ALL": "C", "TZ": "Pacific/Auckland"})):
            with tempfile.TemporaryDirectory(prefix=f"mbk {umask} ") as folder:
                environment = {**os.environ, **said, "HOME": folder, "SOURCE_DATE_EPOCH": "1700000000"}
                done = subprocess.run(["sh", "-c", f'umask {umask} && exec "$0" "$@"', SOURCE / "tools" / tool, "--from", BUILD,
                                       "--to", f"{folder}/made", *arguments], capture_output=True, text=True, check=False,
                                      env=environment)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                found.append({one.name: hashlib.sha256(one.read_bytes()).hexdigest()
                              for one in sorted(pathlib.Path(folder, "made").iterdir())})
        return found

    def test_packages(self):
        first, second = self.packed("package", "--lintian", "no")
        self.assertGreater(len(first), 1)
        self.assertEqual(first, second)

    @unittest.skipUnless(os.environ.get("MBK_PORTABLE"), "set MBK_PORTABLE to a build of the preset portable")
    def test_the_archive(self):
        first, second = self.packed("tarball")
        self.assertEqual(len(first), 1)
        self.assertEqual(first, second)


if __name__ == "__main__":
    missing = [tool for tool in ("cpack", "dpkg-deb") if not shutil.which(tool)]
    if missing:
        print("not here:", *missing)
        sys.exit(SKIPPED)
    unittest.main()
