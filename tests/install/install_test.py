#!/usr/bin/env python3
"""What `cmake --install` leaves is a program with its texts, and libraries that another project finds and uses."""

import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import jsonschema

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests"))
import headers  # noqa: E402

PUBLIC = {"Eigen", "boost", "tl", "fmt"}  # outside libraries that may stand in headers
OF_C = {"stddef.h", "stdint.h"}  # in headers that C reads too
LONGEST_S = 600


def program(variable):
    return os.environ.get(variable) or sys.exit(f"set {variable}; ctest does so by itself")


def ran(*command, code=0):
    process = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=LONGEST_S, check=False)
    if (process.returncode == 0) != (code == 0):
        raise AssertionError(f"{command}\nexit {process.returncode}\n{process.stdout}\n{process.stderr}")
    return process.stdout + (process.stderr if code else "")


def batches():
    """The sources of the build, those together that are compiled together; none where the build does not say."""
    commands = pathlib.Path(program("BUILD"), "compile_commands.json")
    for command in json.loads(commands.read_text()) if commands.exists() else ():
        file = pathlib.Path(command["file"])
        together = re.findall(r'#include "([^"]+)"', file.read_text()) if file.parent.name == "Unity" else [file]
        inside = [pathlib.Path(one) for one in together if SOURCE in pathlib.Path(one).parents]
        yield [str(one.relative_to(SOURCE)) for one in inside]


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-install-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.prefix = cls.folder / "prefix"
        ran(program("CMAKE"), "--install", program("BUILD"), "--prefix", cls.prefix)
        cls.include = cls.prefix / "include"
        cls.headers = sorted(cls.include.rglob("*.h"))

    def configured(self, name, project, code=0, *options):
        """A project that stands in the folder `project`, configured against the installed mbk."""
        return ran(program("CMAKE"), "-S", project, "-B", self.folder / name, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                   f"-DCMAKE_CXX_COMPILER={program('CXX')}", "-DCMAKE_BUILD_TYPE=Release", *options, code=code)

    def test_another_project_measures_what_mbk_measures(self):
        recording = self.folder / "recording.mat"
        ran(program("MAKE_LOG"), "--protocol", "sinusoidal", "--out", recording)
        expected = json.loads(ran(self.prefix / "bin/mbk", "measure", "--json", recording))["model"]
        self.configured("example", self.prefix / "share/doc/mbk/examples/use_the_library")
        ran(program("CMAKE"), "--build", self.folder / "example", "--parallel", "2")
        for name in ("measure_recording", "measure_with_two_modules"):  # mbk::mbk, and single modules
            said = dict(line.split(" ", 1) for line in ran(self.folder / "example" / name, recording).splitlines())
            for matrix in "MBK":
                numbers = [float(one) for one in said[matrix].split()]
                # The same code on the same bytes, each printed with every digit.
                self.assertEqual(numbers, [one for row in expected[matrix] for one in row], (name, matrix))
        for name in ("filter_a_signal", "judge_a_model", "simulate_a_participant"):  # what they say: tests/examples
            self.assertTrue(ran(self.folder / "example" / name))
        self.assertTrue(ran(self.folder / "example" / "run_a_study", self.folder))

    def test_a_driver_is_built_from_its_example(self):
        example = self.prefix / "share/doc/mbk/examples/device_plugin"
        self.configured("driver", example)
        ran(program("CMAKE"), "--build", self.folder / "driver")
        experiment = self.folder / "wheels.toml"
        experiment.write_text((example / "experiment.toml").read_text().replace("build/", "driver/"))
        self.assertIn("two wheels", ran(self.prefix / "bin/mbk", "robot", "check", experiment, "--live", "0.2"))

    def found(self, arguments, code=0):
        project = self.folder / "finding"
        project.mkdir(exist_ok=True)
        (project / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(finding LANGUAGES CXX)\n"
                                                f"find_package(mbk {arguments})\n")
        return self.configured("finding/build", project, code, "--fresh")

    def test_only_a_fitting_version_is_found(self):
        for version in ("0.1", "1.1", "2.0"):
            self.assertIn("mbkConfig.cmake, version: 1.0", self.found(f"{version} REQUIRED", code=1))

    def test_modules_are_components(self):
        self.found("1.0 REQUIRED COMPONENTS measurement recording")
        self.assertIn("nonsense", self.found("1.0 REQUIRED COMPONENTS nonsense", code=1))

    def test_no_path_of_the_tree_stands_in_what_is_installed(self):
        paths = [str(SOURCE), str(pathlib.Path(program("BUILD")).resolve()), str(self.prefix)]
        for file in (*self.prefix.rglob("*.cmake"), *self.headers):
            text = file.read_text()
            for path in paths:
                self.assertNotIn(path, text, file)

    def test_headers_include_only_what_is_installed_or_public(self):
        self.assertGreater(len(self.headers), 50)
        for header in self.headers:
            for left, name in re.findall(r'(?m)^#include ([<"])([^>"]+)', header.read_text()):
                with self.subTest(header=header.name, include=name):
                    if left == '"':
                        self.assertTrue((self.include / name).exists())
                    elif "/" in name or "." in name:  # the rest is the standard library's
                        self.assertIn(name.split("/")[0], PUBLIC | OF_C)

    def test_every_header_compiles_by_itself(self):
        """Two kinds have been compiled so by the build, but for what precompiled headers brought (tests/headers.py looks at
        that): those that their own source includes first, and those before which nothing else of ours was read."""
        def own_source_begins_with(name):
            source = (SOURCE / name).with_suffix(".cpp")
            return source.exists() and re.search(r"#include .*", source.read_text()).group() == f'#include "{name}"'

        built = headers.Tree(SOURCE).compiled_by_themselves(batches())
        names = {header: str(header.relative_to(self.include)) for header in self.headers}
        remaining = [header for header, name in names.items() if name not in built and not own_source_begins_with(name)]
        eigen = ran("pkg-config", "--cflags", "eigen3").replace("-I", "-isystem").split()
        compiler = (program("CXX"), "-std=c++20", "-Wall", "-Werror", f"-I{self.include}", *eigen)
        # Most of the time would go into reading Eigen again, which a header that includes it is given precompiled.
        shared = self.folder / "eigen_core.h"
        shared.write_text("#include <Eigen/Core>\n")
        ran(*compiler, "-x", "c++-header", shared, "-o", f"{shared}.gch")
        tree = headers.Tree(self.include)

        def compiled(header):
            given = ("-include", shared) if "Eigen/Core" in tree.brought(str(header.relative_to(self.include))) else ()
            ran(*compiler, "-Winvalid-pch", *given, "-fsyntax-only", "-include", header, "-x", "c++", os.devnull)

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(compiled, remaining))

    def test_what_it_writes_fits_the_schemas_beside_it(self):
        """They refer to each other by where they stand."""
        folder = self.prefix / "share/mbk/schemas"
        self.assertIn("result.schema.json", [one.name for one in folder.iterdir()])
        recording = self.folder / "to_fit.mat"
        ran(program("MAKE_LOG"), "--protocol", "sinusoidal", "--out", recording)
        path = folder / "result.schema.json"
        schema = json.loads(path.read_text(encoding="utf-8"))
        resolver = jsonschema.RefResolver(path.as_uri(), schema)
        result = json.loads(ran(self.prefix / "bin/mbk", "measure", "--json", recording))
        jsonschema.validate(result, schema, cls=jsonschema.Draft7Validator, resolver=resolver)
        del result["model"]["K"]
        with self.assertRaises(jsonschema.ValidationError):
            jsonschema.validate(result, schema, cls=jsonschema.Draft7Validator, resolver=resolver)

    def test_headers_of_tests_stay_behind(self):
        self.assertEqual([one.name for one in self.headers if one.name.startswith("test_")], [])

    def test_pages_completion_and_documents_are_in_their_places(self):
        share = self.prefix / "share"
        for name in ("man/man1/mbk.1", "man/man1/mbk-springs-field.1", "bash-completion/completions/mbk",
                     "zsh/site-functions/_mbk", "fish/vendor_completions.d/mbk.fish", "doc/mbk/LICENSE",
                     "doc/mbk/THIRD_PARTY_NOTICES.md", "doc/mbk/copyright", "doc/mbk/docs/guide/install.md",
                     "doc/mbk/examples/scenarios/relaxed_sinusoidal.toml", "mbk/schemas/result.schema.json", "doc/mbk/examples/01_measure/run.sh"):
            self.assertTrue((share / name).is_file(), name)
        self.assertFalse((share / "doc/mbk/docs/site").exists())  # what builds the site, of no use without the tree
        mbk = self.prefix / "bin/mbk"
        self.assertEqual((share / "man/man1/mbk-measure.1").read_text(), ran(mbk, "manual", "measure"))
        self.assertEqual((share / "bash-completion/completions/mbk").read_text(), ran(mbk, "completion", "bash"))


if __name__ == "__main__":
    unittest.main()
