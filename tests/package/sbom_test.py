#!/usr/bin/env python3
"""tools/sbom: the fields that SPDX 2.3 asks for, and every part that ships."""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
# Those that the table of parts uses; a new one is looked up on https://spdx.org/licenses and added.
KNOWN = {"0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "CC0-1.0", "GPL-2.0-only", "GPL-3.0-or-later",
         "LGPL-2.1-or-later", "MIT", "MPL-2.0", "Zlib", "blessing", "bzip2-1.0.6"}
EXCEPTIONS = {"GCC-exception-3.1", "Linux-syscall-note"}


def made(*arguments, **environment):
    return subprocess.run([SOURCE / "tools/sbom", *arguments], capture_output=True, text=True, check=True,
                          env={**os.environ, **environment}).stdout


class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = made(SOURCE_DATE_EPOCH="1700000000")
        cls.document = json.loads(cls.text)
        cls.parts = {one["name"]: one for one in cls.document["packages"]}

    def test_the_document_has_what_spdx_asks_for(self):
        document = self.document
        self.assertEqual((document["spdxVersion"], document["dataLicense"], document["SPDXID"]),
                         ("SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT"))
        self.assertEqual(document["creationInfo"]["created"], "2023-11-14T22:13:20Z")
        self.assertRegex(document["creationInfo"]["creators"][0], r"\ATool: \S+\Z")
        self.assertRegex(document["documentNamespace"], r"\Ahttps://[^#\s]+\Z")
        self.assertTrue(document["name"])

    def test_each_part_has_what_spdx_asks_for(self):
        names = [one["SPDXID"] for one in self.document["packages"]]
        self.assertEqual(len(names), len(set(names)))
        for one in self.document["packages"]:
            with self.subTest(one["name"]):
                self.assertRegex(one["SPDXID"], r"\ASPDXRef-[A-Za-z0-9.-]+\Z")
                self.assertRegex(one["downloadLocation"], r"\A(NOASSERTION|https://\S+)\Z")
                self.assertRegex(one["versionInfo"], r"\d")
                self.assertIs(one["filesAnalyzed"], False)
                self.assertTrue(one["copyrightText"])
                for field in ("licenseConcluded", "licenseDeclared"):
                    for term in re.split(r" (?:AND|OR) ", one[field]):
                        licence, _, exception = term.partition(" WITH ")
                        self.assertIn(licence, KNOWN)
                        self.assertIn(exception, EXCEPTIONS | {""})
                for reference in one["externalRefs"]:
                    self.assertRegex(reference["referenceLocator"], r"\Apkg:(deb/debian|npm|generic)/[^\s+]+@[^\s+]+\Z")

    def test_every_part_is_tied_to_mbk(self):
        relations = self.document["relationships"]
        self.assertEqual(relations[0], {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                                        "relatedSpdxElement": "SPDXRef-mbk"})
        tied = {one["relatedSpdxElement"] for one in relations if one["spdxElementId"] == "SPDXRef-mbk"}
        self.assertEqual(tied, {one["SPDXID"] for one in self.document["packages"]} - {"SPDXRef-mbk"})

    def test_the_pages_parts_are_there_and_their_tools_are_not(self):
        for name in ("echarts", "zrender", "tslib"):
            self.assertEqual(len(self.parts[name]["checksums"][0]["checksumValue"]), 128)
        self.assertNotIn("vite", self.parts)
        self.assertNotIn("typescript", self.parts)

    def test_the_same_tree_gives_the_same_bytes(self):
        self.assertEqual(made(SOURCE_DATE_EPOCH="1700000000", TZ="Asia/Tokyo", LC_ALL="C"), self.text)

    def test_libraries_that_were_built_are_named_with_their_version_and_their_sum(self):
        with tempfile.TemporaryDirectory() as folder:
            libraries = pathlib.Path(folder)
            (libraries / "sources").mkdir()
            (libraries / "sources/zlib_9.8.orig.tar.gz").write_bytes(b"zlib")
            (libraries / "sources.tsv").write_text("zlib\t1:9.8+x-1\n")
            document = json.loads(made(libraries))
        zlib = next(one for one in document["packages"] if one["name"] == "zlib")
        self.assertEqual(zlib["versionInfo"], "1:9.8+x-1")
        self.assertEqual(zlib["checksums"][0]["checksumValue"],
                         hashlib.sha256(b"zlib").hexdigest())
        relation = next(one for one in document["relationships"] if one["relatedSpdxElement"] == zlib["SPDXID"])
        self.assertEqual(relation["relationshipType"], "STATIC_LINK")

    def test_whatever_is_built_for_the_archive_is_in_the_list(self):
        script = (SOURCE / "tools/third-party").read_text()
        packages = re.search(r"for package in (zlib [^;]*);", script).group(1).replace("\\", "").split()
        self.assertGreater(len(packages), 10)
        for package in packages:
            self.assertIn(package, self.parts)


if __name__ == "__main__":
    if not shutil.which("dpkg-query"):
        print("not here: dpkg-query")
        sys.exit(SKIPPED)
    unittest.main()
