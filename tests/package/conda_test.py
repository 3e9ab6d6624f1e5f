#!/usr/bin/env python3
"""The recipe for conda-forge has the form of schema version 1, this version, and every library of the build."""

import pathlib
import re
import sys
import unittest

try:
    import yaml
except ImportError:
    yaml = None

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
# Debian's names of what [build] of tools/packages has, where conda-forge's differ by more than lib and -dev.
NAMES = {"libboost-dev": "libboost-headers", "libbz2-dev": "bzip2", "libeigen3-dev": "eigen", "libexpected-dev": "tl-expected",
         "liblz4-dev": "lz4-c", "liblzf-dev": "liblzf", "libdeflate-dev": "libdeflate", "libsqlite3-dev": "sqlite",
         "nlohmann-json3-dev": "nlohmann_json", "zlib1g-dev": "zlib"}
KEYS = {"schema_version", "context", "package", "source", "build", "requirements", "tests", "about", "extra"}


class Recipe(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recipe = yaml.safe_load((SOURCE / "packaging/conda/recipe.yaml").read_text(encoding="utf-8"))

    def test_it_has_the_parts_of_a_recipe_and_no_others(self):
        self.assertEqual(set(self.recipe), KEYS)
        self.assertEqual(self.recipe["schema_version"], 1)
        self.assertEqual(self.recipe["package"], {"name": "mbk", "version": "${{ version }}"})
        self.assertIsInstance(self.recipe["build"]["number"], int)
        self.assertEqual(set(self.recipe["requirements"]), {"build", "host", "run"})
        for part in self.recipe["requirements"].values():
            self.assertTrue(all(isinstance(one, str) for one in part))

    def test_the_version_is_this_one(self):
        version = re.search(r"project\(mbk VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
        self.assertEqual(self.recipe["context"]["version"], version)

    def test_the_source_has_an_address_and_a_sum(self):
        self.assertIn("${{ version }}", self.recipe["source"]["url"])
        self.assertRegex(self.recipe["source"]["sha256"], r"\A[0-9a-f]{64}\Z")

    def test_every_library_of_the_build_is_asked_for(self):
        group = re.search(r"\[build\]\n(.*?)\n\n", (SOURCE / "tools/packages").read_text(encoding="utf-8"), re.DOTALL)[1]
        for package in re.findall(r"^(\S+-dev)\b", group, re.MULTILINE):
            name = NAMES.get(package, package.removeprefix("lib").removesuffix("-dev"))
            self.assertIn(name, self.recipe["requirements"]["host"], package)

    def test_the_licence_files_are_there(self):
        self.assertEqual(self.recipe["about"]["license"], "BSD-3-Clause")
        for file in self.recipe["about"]["license_file"]:
            self.assertTrue((SOURCE / file).is_file(), file)

    def test_every_option_of_the_script_is_one_of_the_build(self):
        cmake = "".join(one.read_text(encoding="utf-8") for one in (SOURCE / "CMakeLists.txt", SOURCE / "bindings/CMakeLists.txt"))
        for option in re.findall(r"-D(MBK_\w+)", " ".join(self.recipe["build"]["script"])):
            self.assertIn(f"option({option} ", cmake)


if __name__ == "__main__":
    if yaml is None:
        print("not here: python3-yaml")
        sys.exit(SKIPPED)
    unittest.main()
