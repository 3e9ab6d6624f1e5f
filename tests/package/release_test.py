#!/usr/bin/env python3
"""tools/release begins nothing that is no release, and signs what it has made so that a changed byte is found."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77


def ran(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300, check=False, **options)


class Release(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="mbk-release-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.clone = self.folder / "mbk"
        ran("git", "clone", "--quiet", "--no-hardlinks", SOURCE, self.clone)
        for path in ("tools", "CMakeLists.txt", "CHANGELOG.md"):  # as they are now
            source, target = SOURCE / path, self.clone / path
            (shutil.copytree if source.is_dir() else shutil.copy)(source, target, **({"dirs_exist_ok": True} if source.is_dir() else {}))
        (self.clone / "CMakeLists.txt").write_text("project(mbk VERSION 3.2.1 LANGUAGES C)\n")
        for path in ("CITATION.cff", "codemeta.json"):
            (self.clone / path).unlink(missing_ok=True)
        self.changelog("## 3.2.1 (2030-01-31)")

    def changelog(self, heading):
        (self.clone / "CHANGELOG.md").write_text(f"# Changelog\n\n{heading}\n- all\n")
        self.commit()

    def commit(self):
        ran("git", "-C", self.clone, "add", "--all")
        done = ran("git", "-C", self.clone, "-c", "user.name=a", "-c", "user.email=a@b.example", "-c", "core.hooksPath=/dev/null",
                   "commit", "--allow-empty", "--message", "all")
        self.assertEqual(done.returncode, 0, done.stderr)

    def release(self, *arguments, **environment):
        """What tools/release says, and whether it went well. Nothing is installed, and nothing is built."""
        environment = {**os.environ, "MBK_SKIP_PACKAGES": "1", "MBK_GPG_KEY": "", "MBK_MINISIGN_KEY": "", **environment}
        done = ran(self.clone / "tools/release", *arguments, env=environment)
        return done.returncode == 0, done.stdout + done.stderr

    def refused(self, why, *arguments):
        well, said = self.release(*(arguments or ("3.2.1",)))
        self.assertFalse(well, said)
        self.assertIn(why, said)
        self.assertFalse((self.clone / "build/mbk-3.2.1").exists())

    def test_another_version_is_refused(self):
        self.refused("CMakeLists.txt has version 3.2.1", "3.2.2")

    def test_a_version_without_its_date_is_refused(self):
        self.changelog("## 3.2.1 (in preparation)")
        self.refused("CHANGELOG.md begins with")

    def test_a_tree_with_changes_is_refused(self):
        (self.clone / "README.md").write_text("changed\n")
        self.refused("not committed")

    def test_a_tag_on_another_commit_is_refused(self):
        ran("git", "-C", self.clone, "tag", "v3.2.1")
        self.commit()
        self.refused("v3.2.1 is another commit")

    def test_without_keys_nothing_is_begun(self):
        self.refused("MBK_GPG_KEY and MBK_MINISIGN_KEY")

    def test_a_folder_that_is_there_is_not_overwritten(self):
        self.assertFalse(self.release("3.2.1", "--to", self.folder)[0])

    @unittest.skipUnless(shutil.which("minisign") and shutil.which("gpg") and os.geteuid() == 0, "needs minisign, gpg and root")
    def test_every_artefact_is_signed_and_a_failing_step_ends_it(self):
        """With tools that only leave a file, or fail."""
        def leaves(tool, what):
            (self.clone / "tools" / tool).write_text(f"#!/bin/sh\n{what}\n")

        programs = self.folder / "bin"
        programs.mkdir()
        for name in ("cmake", "python3"):
            (programs / name).write_text("#!/bin/sh\nexit 0\n")
            (programs / name).chmod(0o755)
        (self.clone / "tools/release").write_text((SOURCE / "tools/release").read_text().replace("/usr/bin/python3", "python3"))
        leaves("third-party", "mkdir -p build/third_party/x86_64-linux-gnu/sources; echo 1 >build/third_party/x86_64-linux-gnu/sources/a")
        leaves("tarball", 'echo archive >"$4/mbk.tar.gz"')
        leaves("package", 'echo package >"$4/mbk.deb"')
        leaves("windows", 'echo zip >"$6/mbk.zip"')
        leaves("sbom", "echo {}")
        leaves("lint", "exit 0")
        leaves("apt-repository", 'mkdir "$2"')
        self.commit()
        made, path = self.folder / "made", f"{programs}:{os.environ['PATH']}"
        well, said = self.release("3.2.1", "--dry-run", "--to", made, PATH=path)
        self.assertTrue(well, said)
        artefacts = {one.name for one in made.iterdir() if one.is_file()}
        for name in ("mbk.tar.gz", "mbk.deb", "mbk.zip", "mbk-3.2.1.tar.gz", "mbk-3.2.1-third-party-sources.tar.gz", "mbk-3.2.1.spdx.json",
                     "SHA256SUMS"):
            self.assertLessEqual({name, f"{name}.minisig"}, artefacts)
        verify = ("minisign", "-V", "-p", made / "minisign.pub", "-m", made / "mbk.deb")
        self.assertEqual(ran(*verify).returncode, 0)
        (made / "mbk.deb").write_text("altered\n")
        self.assertNotEqual(ran(*verify).returncode, 0)
        self.assertNotEqual(ran("sha256sum", "--check", "SHA256SUMS", cwd=made).returncode, 0)

        leaves("lint", "echo an error; exit 1")
        self.commit()
        well, said = self.release("3.2.1", "--dry-run", "--to", self.folder / "again", PATH=path)
        self.assertFalse(well)
        self.assertIn("an error", said)
        self.assertFalse((self.folder / "again/SHA256SUMS").exists())


if __name__ == "__main__":
    if not shutil.which("git"):
        print("not here: git")
        sys.exit(SKIPPED)
    unittest.main()
