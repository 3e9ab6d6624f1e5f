#!/usr/bin/env python3
"""The Debian packages: they hold what they should, need what they link, and run where unpacked."""

import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TOOLS = ("cpack", "dpkg-deb", "dpkg-shlibdeps", "file", "readelf")
SKIPPED = 77
PYTHON = pathlib.Path(os.environ["BUILD"], "python/mbk/__init__.py").exists()


def ran(*command, **options):
    process = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=500, check=False, **options)
    if process.returncode != 0:
        raise AssertionError(f"{command}\nexit {process.returncode}\n{process.stdout}\n{process.stderr}")
    return process.stdout


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-package-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        made = pathlib.Path(os.environ["PACKAGES"])  # which lintian looks at after this: tests/package/CMakeLists.txt
        ran(SOURCE / "tools/package", "--from", os.environ["BUILD"], "--to", made, "--lintian", "no")
        cls.root = cls.folder / "root"
        cls.packages = {}
        for file in made.glob("*.deb"):
            cls.packages[file.name.split("_")[0]] = file
            ran("dpkg-deb", "--extract", file, cls.root)
        cls.mbk = cls.root / "usr/bin/mbk"

    def field(self, package, name):
        return ran("dpkg-deb", "--field", self.packages[package], name).strip()

    def contents(self, package):
        lines = ran("dpkg-deb", "--contents", self.packages[package]).splitlines()
        return [line.split(" -> ")[0].split()[-1] for line in lines]  # a link stands before what it leads to

    def test_there_are_three_and_that_of_python_where_it_is_built(self):
        sections = {"mbk": "science", "libmbk-dev": "libdevel", "libmbk1": "libs"}
        if PYTHON:
            sections["python3-mbk"] = "python"
        self.assertEqual(sorted(self.packages), sorted(sections))
        for package, section in sections.items():
            self.assertEqual(self.field(package, "Section"), section)
            self.assertRegex(self.field(package, "Version"), r"\A\d+\.\d+\.\d+-\d+\Z")

    def test_each_holds_its_own(self):
        program, development = self.contents("mbk"), self.contents("libmbk-dev")
        for path in ("bin/mbk", "share/man/man1/mbk.1.gz", "share/man/man1/mbk-springs-find.1.gz",
                     "share/bash-completion/completions/mbk", "share/zsh/vendor-completions/_mbk",
                     "share/fish/vendor_completions.d/mbk.fish", "share/doc/mbk/copyright",
                     "share/doc/mbk/changelog.Debian.gz", "share/doc/mbk/changelog.gz",
                     "share/doc/mbk/THIRD_PARTY_NOTICES.md", "share/doc/mbk/docs/guide/README.md"):
            self.assertIn(f"./usr/{path}", program)
        for path in ("include/mbk/measure/measurement/measure.h", "share/doc/libmbk-dev/copyright"):
            self.assertIn(f"./usr/{path}", development)
        kit = "./usr/share/doc/mbk/bridge/"  # files to copy to the robot's computer
        self.assertFalse([path for path in program if re.search(r"\.(h|a|cmake)$", path) and not path.startswith(kit)])
        self.assertTrue([path for path in development if path.endswith("/mbkConfig.cmake")])
        library = self.contents("libmbk1")
        self.assertTrue([path for path in library if path.endswith("/libmbk.so.1")])
        self.assertFalse([path for path in library if path.endswith((".h", "/libmbk.so"))])
        self.assertIn("./usr/include/mbk.h", development)
        self.assertTrue([path for path in development if path.endswith("/libmbk.so")])

    def test_they_are_the_same_bytes_whoever_packs_them(self):
        # tools/release compares two builds; this compares what is packed of one.
        with tempfile.TemporaryDirectory(prefix="mbk another folder ") as folder:
            elsewhere = {**os.environ, "LC_ALL": "C", "TZ": "Pacific/Auckland", "HOME": folder}
            ran("sh", "-c", 'umask 077 && exec "$0" "$@"', SOURCE / "tools/package", "--from", os.environ["BUILD"], "--to",
                f"{folder}/made", "--lintian", "no", env=elsewhere)
            for file in self.packages.values():
                self.assertEqual(pathlib.Path(folder, "made", file.name).read_bytes(), file.read_bytes(), file.name)

    def test_it_runs_where_it_is_unpacked(self):
        version = self.field("mbk", "Version").split("-")[0]
        self.assertEqual(ran(self.mbk, "--version").splitlines()[0], f"mbk {version}")
        recording = self.folder / "recording.mat"
        ran(self.mbk, "simulate", "free_motion", "--quiet", "--out", recording)
        self.assertIn("recording.mat", ran(self.mbk, "info", recording))

    def test_depends_names_every_library_that_it_links(self):
        for package, binary in (("mbk", self.mbk), ("libmbk1", next(self.root.rglob("libmbk.so.1")))):
            depends = self.field(package, "Depends")
            needed = re.findall(r"\(NEEDED\).*\[(.*)\]", ran("readelf", "--dynamic", binary))
            self.assertIn("libc.so.6", needed)
            self.assertNotIn("RUNPATH", ran("readelf", "--dynamic", binary))
            for library in needed:
                owners = {line.split(":")[0] for line in ran("dpkg-query", "--search", f"*/{library}").splitlines()}
                with self.subTest(library):
                    self.assertTrue(any(re.search(rf"(^|, ){re.escape(one)}( |,|$)", depends) for one in owners),
                                    f"{library} is in {owners}, Depends: {depends}")

    def test_libraries_need_the_packages_that_the_config_finds(self):
        library, *depends = self.field("libmbk-dev", "Depends").split(", ")
        self.assertRegex(library, r"\Alibmbk1 \(= ")
        config = next(self.root.rglob("mbkConfig.cmake")).read_text()
        count = len(set(re.findall(r"find_dependency\((?!PkgConfig)(\S+?)[ )]|pkg_check_modules\((\w+)", config)))
        self.assertEqual(len(depends), count, (depends, config))

    def test_it_is_stripped_and_free_of_paths(self):
        self.assertIn(", stripped", ran("file", self.mbk))
        self.assertNotIn("RUNPATH", ran("readelf", "--dynamic", self.mbk))
        self.assertNotIn(str(SOURCE).encode(), self.mbk.read_bytes())

    @unittest.skipUnless(PYTHON, "this build has no package of Python")
    def test_python_finds_the_package_and_its_library(self):
        contents = self.contents("python3-mbk")
        self.assertIn("./usr/lib/python3/dist-packages/mbk/__init__.py", contents)
        self.assertIn("./usr/lib/python3/dist-packages/mbk/schemas/result.schema.json", contents)
        self.assertFalse([path for path in contents if "__pycache__" in path or path.endswith(".pyc") or ".so" in path])
        self.assertEqual(self.field("python3-mbk", "Architecture"), "all")
        depends = self.field("python3-mbk", "Depends")
        self.assertIn("python3-numpy", depends)
        self.assertIn(f"libmbk1 (= {self.field('libmbk1', 'Version')})", depends)
        environment = {**os.environ, "PYTHONPATH": str(self.root / "usr/lib/python3/dist-packages"),
                       "LD_LIBRARY_PATH": str(next(self.root.rglob("libmbk.so.1")).parent)}
        shown = ran("/usr/bin/python3", "-B", "-c", "import mbk; print(mbk.__file__, mbk.__version__)", env=environment)
        self.assertIn(str(self.root), shown)

    def test_a_page_prints(self):
        page = self.root / "usr/share/man/man1/mbk-measure.1.gz"
        self.assertIn(b"\\fB\\-\\-mode\\fR", gzip.decompress(page.read_bytes()))
        if shutil.which("man"):
            self.assertIn("mbk-measure", ran("man", "-l", page, env={**os.environ, "LC_ALL": "C.UTF-8"}))

    def test_the_copyright_file_names_every_library_that_is_compiled_in(self):
        text = (self.root / "usr/share/doc/mbk/copyright").read_text()
        self.assertTrue(text.startswith("Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n"))
        licences = set(re.findall(r"(?m)^License: (\S+)\n ", text))
        for stanza in text.split("\n\n"):
            if stanza.startswith("Files:"):
                self.assertIn(re.search(r"(?m)^License: (\S+)$", stanza).group(1), licences)
        squeezed = re.sub(r"\s+", " ", text)
        system = {"libstdc++-12-dev", "libgcc-12-dev", "libc6-dev", "linux-libc-dev", "zlib1g-dev"}  # no code in headers
        for row in (self.root / "usr/share/doc/mbk/THIRD_PARTY_NOTICES.md").read_text().splitlines():
            if row.startswith("| [") and re.search("headers|static", row.rsplit("|", 2)[1]):
                for package in set(re.findall(r"`([^`]*-dev)`", row)) - system:
                    self.assertRegex(squeezed, rf"package {package}\b")


if __name__ == "__main__":
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if missing:
        print("not here:", *missing)
        sys.exit(SKIPPED)
    unittest.main()
