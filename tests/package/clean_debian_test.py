#!/usr/bin/env python3
"""What a release holds runs in a Debian 12 and a Debian 13 that have nothing else, and what was altered is refused.

MBK_RELEASE names the folder of the artefacts (tools/release runs this test on its own). Roots are made by mmdebstrap.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
LONGEST_S = 60  # from a clean root to a first result
ENVIRONMENT = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C"}
SOURCES = "Types: deb\nURIs: file:/srv/{folder}\nSuites: {suite}\nComponents: main\nSigned-By: /etc/apt/keyrings/mbk.gpg\n"


def ran(*command, code=0, **options):
    process = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, timeout=900, **options)
    if (process.returncode == 0) != (code == 0):
        raise AssertionError(f"{command}\nexit {process.returncode}\n{process.stdout}\n{process.stderr}")
    return process.stdout + (process.stderr if code else "")


class InDebian:
    suite = ""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="mbk-root-")
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name, cls.suite)
        ran("mmdebstrap", "--variant=apt", "--mode=root", cls.suite, cls.root)
        cls.release = pathlib.Path(os.environ["MBK_RELEASE"]).resolve()
        key = {**os.environ, "GNUPGHOME": folder.name}
        ran("gpg", "--batch", "--passphrase", "", "--quick-gen-key", "thrown@away.example", "ed25519", "sign", "never", env=key)
        made = cls.root / "srv/apt"
        ran(SOURCE / "tools/apt-repository", cls.release, made, env={**key, "MBK_GPG_KEY": "thrown@away.example"})
        ran("gpgconf", "--kill", "all", env=key)
        (cls.root / "etc/apt/keyrings").mkdir(exist_ok=True)
        shutil.copy(made / "mbk.gpg", cls.root / "etc/apt/keyrings")

    def inside(self, *command, code=0):
        return ran("chroot", self.root, *command, code=code, env=ENVIRONMENT)

    def measures(self, program):
        """`program` simulates a recording and measures it."""
        self.inside(program, "simulate", "relaxed_sinusoidal", "--quiet", "--overwrite", "--out", "/root/relaxed.mat")
        result = json.loads(self.inside(program, "measure", "--json", "/root/relaxed.mat"))
        self.assertEqual(len(result["model"]["K"]), 2)

    def use(self, folder):
        """apt knows the repository /srv/FOLDER of the root, and no other of mbk."""
        (self.root / "etc/apt/sources.list.d/mbk.sources").write_text(SOURCES.format(folder=folder, suite=self.suite))

    def altered(self, name, alter):
        """A repository like the one of the release but for `alter`, which is given its folder."""
        copy = self.root / "srv" / name
        shutil.copytree(self.root / "srv/apt", copy)
        alter(copy)
        self.use(name)

    def test_the_archive_runs_wherever_it_is_unpacked(self):
        begun = time.monotonic()
        ran("tar", "--extract", "--gzip", "--file", next(self.release.glob("mbk-*-linux-x86_64.tar.gz")), "--directory",
            self.root / "opt")
        unpacked = next((self.root / "opt").glob("mbk-*"))
        self.measures(f"/opt/{unpacked.name}/bin/mbk")
        self.assertLess(time.monotonic() - begun, LONGEST_S)
        version = self.inside(f"/opt/{unpacked.name}/bin/mbk", "--version")
        self.assertRegex(version, r"\Ambk \d+\.\d+\.\d+\ncommit +[0-9a-f]{40}\ncompiler +\S.*\nlibraries +\S")
        self.assertIn("orocos-kdl ", version)
        moved = unpacked.rename(self.root / "srv/a folder")
        self.measures("/srv/a folder/bin/mbk")
        for path in ("lib/libmbk.so.1", "include/mbk.h", "share/man/man1/mbk.1", "share/doc/mbk/licences/orocos-kdl",
                     "share/doc/mbk/licences/texts/LGPL-2.1", "share/mbk/schemas/result.schema.json",
                     "share/bash-completion/completions/mbk"):
            self.assertTrue((moved / path).exists(), path)

    def test_apt_installs_the_program_and_the_python_package(self):
        self.use("apt")
        begun = time.monotonic()
        self.inside("apt-get", "update")
        self.inside("apt-get", "install", "--yes", "--no-install-recommends", "mbk")
        self.measures("mbk")
        self.assertLess(time.monotonic() - begun, LONGEST_S)
        self.inside("apt-get", "install", "--yes", "--no-install-recommends", "python3-mbk")
        self.inside("python3", "-c", "import mbk; assert len(mbk.measure('/root/relaxed.mat').model.K) == 2")
        self.inside("apt-get", "purge", "--yes", "mbk", "python3-mbk", "libmbk1")

    def test_an_altered_package_is_refused(self):
        def alter(folder):
            package = next(folder.rglob("mbk_*.deb"))
            content = bytearray(package.read_bytes())
            content[len(content) // 2] ^= 1
            package.write_bytes(content)

        self.altered("package", alter)
        self.inside("apt-get", "update")
        said = self.inside("apt-get", "install", "--yes", "mbk", code=1)
        self.assertRegex(said, "Hash Sum mismatch|hash sum")
        self.assertFalse((self.root / "usr/bin/mbk").exists())

    def test_an_altered_list_of_packages_is_refused(self):
        def alter(folder):
            release = folder / f"dists/{self.suite}/InRelease"
            release.write_text(release.read_text().replace("Origin: mbk", "Origin: mbx"))

        self.altered("list", alter)
        said = self.inside("apt-get", "update", "--error-on=any", code=1)
        self.assertRegex(said, r"(?i)bad ?sig|not signed|invalid|could not be verified")


class InDebian12(InDebian, unittest.TestCase):
    suite = "bookworm"


class InDebian13(InDebian, unittest.TestCase):
    suite = "trixie"


if __name__ == "__main__":
    missing = [tool for tool in ("mmdebstrap", "reprepro", "gpg", "chroot") if not shutil.which(tool)]
    if not os.environ.get("MBK_RELEASE"):
        missing.append("MBK_RELEASE, the folder of a release")
    if os.geteuid() != 0:
        missing.append("the rights of root")
    if missing:
        print("not here:", ", ".join(missing))
        sys.exit(SKIPPED)
    unittest.main()
