#!/usr/bin/env python3
"""pip installs the package into an environment that sees the system's packages; its tag is what its binaries need. A wheel
that is for any Linux runs in a root folder that holds Python, NumPy and the C runtime and nothing else."""

import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bindings/python"))
import build_backend  # noqa: E402

SCRIPT = pathlib.Path(__file__).with_name("in_the_wheel.py").read_text(encoding="utf-8")


def ran(*command, **options):
    process = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, timeout=500, **options)
    if process.returncode != 0:
        raise AssertionError(f"{command}\nexit {process.returncode}\n{process.stdout}\n{process.stderr}")
    return process.stdout


def clean(**more):
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MBK")} | more


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        made = tempfile.TemporaryDirectory(prefix="mbk-wheel-")
        cls.addClassCleanup(made.cleanup)
        cls.folder = pathlib.Path(made.name)
        # What pip leaves in the tree that it builds stays out of the source.
        ran(sys.executable, "-m", "venv", "--system-site-packages", cls.folder / "venv")
        cls.python = cls.folder / "venv/bin/python"
        ran(cls.python, "-m", "pip", "wheel", "--no-build-isolation", "--no-index", "--no-deps", "-w", cls.folder, ROOT,
            env=clean(MBK_BUILD=os.environ["BUILD"]))
        cls.wheel = next(cls.folder.glob("*.whl"))

    def test_pip_installs_it_beside_the_systems_packages(self):
        ran(self.python, "-m", "pip", "install", "--no-index", self.wheel, env=clean())
        shown = ran(self.python, "-c", SCRIPT, cwd=self.folder, env=clean())
        self.assertIn(str(self.folder / "venv"), shown)
        self.assertIn("Requires: numpy", ran(self.python, "-m", "pip", "show", "mbk", env=clean()))
        version = ran(self.folder / "venv/bin/mbk", "--version")
        self.assertEqual(version, ran(os.environ["MBK"], "--version"))
        self.assertTrue((self.folder / "venv/share/man/man1/mbk-measure.1").is_file())
        ran(self.python, "-m", "pip", "uninstall", "-y", "mbk", env=clean())
        with self.assertRaises(AssertionError):
            ran(self.python, "-c", "import mbk", cwd=self.folder, env=clean())

    def test_the_same_tree_gives_the_same_wheel(self):
        os.environ["MBK_BUILD"] = os.environ["BUILD"]
        again = self.folder / "again"
        again.mkdir()
        name = build_backend.build_wheel(str(again))
        self.assertEqual((again / name).read_bytes(), self.wheel.read_bytes())

    def test_it_holds_what_it_should(self):
        with zipfile.ZipFile(self.wheel) as wheel:
            names = wheel.namelist()
            record = wheel.read(next(one for one in names if one.endswith("/RECORD"))).decode()
            metadata = wheel.read(next(one for one in names if one.endswith("/METADATA"))).decode()
        for name in ("mbk/__init__.py", "mbk/_functions.py", "mbk/py.typed", "mbk/_mbk.py", "mbk/libmbk.so.1",
                     "mbk/schemas/result.schema.json"):
            self.assertIn(name, names)
        self.assertEqual([name for name in names if ".so" in name], ["mbk/libmbk.so.1"])
        self.assertTrue(any(name.endswith(".data/scripts/mbk") for name in names))
        self.assertTrue(any(name.endswith("THIRD_PARTY_NOTICES.md") for name in names))
        self.assertFalse([name for name in names if "__pycache__" in name])
        self.assertEqual(len(record.splitlines()), len(names))
        self.assertIn("Requires-Dist: numpy", metadata)

    def test_its_tag_is_what_its_binaries_need(self):
        with zipfile.ZipFile(self.wheel) as wheel:
            names = [name for name in wheel.namelist() if name == "mbk/libmbk.so.1" or ".data/scripts/" in name]
            files = [pathlib.Path(wheel.extract(name, self.folder / "extracted")) for name in names]
            text = wheel.read(next(one for one in wheel.namelist() if one.endswith("/WHEEL"))).decode()
        self.assertIn("mbk/libmbk.so.1", names)
        tag = build_backend.tag(files)
        self.assertTrue(tag.startswith("py3-none-"))
        self.assertIn(f"Tag: {tag}\n", text)
        self.assertTrue(self.wheel.name.endswith(f"-{tag}.whl"))
        glibc = max(build_backend.needed(one)[1] for one in files)
        if platform.libc_ver() <= ("glibc", "2.36"):  # a newer one has newer versions of more symbols
            self.assertLessEqual(glibc, (2, 34))
        for one in files:
            self.assertNotIn("RUNPATH", build_backend.objdump("--private-headers", one))

    def test_a_tag_for_any_linux_needs_the_c_library_alone(self):
        """Of a library that needs one symbol of a known version, and of one that links another library as well."""
        (self.folder / "one.c").write_text(
            "double first(double); __asm__(\".symver first, exp@GLIBC_2.29\");\ndouble f(double x) { return first(x); }\n")
        ran("gcc", "-shared", "-fPIC", self.folder / "one.c", "-o", self.folder / "one.so", "-lm")
        links, glibc = build_backend.needed(self.folder / "one.so")
        self.assertEqual(glibc, (2, 29))
        self.assertIn("libm.so.6", links)
        self.assertRegex(build_backend.tag([self.folder / "one.so"]), r"\Apy3-none-manylinux_2_29_\w+\Z")
        ran("g++", "-shared", "-fPIC", "-Wl,--no-as-needed", self.folder / "one.c", "-o", self.folder / "two.so", "-lstdc++")
        self.assertRegex(build_backend.tag([self.folder / "one.so", self.folder / "two.so"]), r"\Apy3-none-linux_\w+\Z")

    def test_it_runs_where_what_it_links_is_not_installed(self):
        if "-manylinux_" not in self.wheel.name:
            self.skipTest("this build links libraries of the system; cmake -DMBK_STATIC=FOLDER")
        if subprocess.run(["unshare", "--map-root-user", "true"], capture_output=True, check=False).returncode != 0:
            self.skipTest("no root folder of one's own can be had here")
        root = self.folder / "root"
        add_python(root)
        site = root / "site"
        with zipfile.ZipFile(self.wheel) as wheel:
            wheel.extractall(site)
        (root / "tmp").mkdir()
        (root / "script.py").write_text(SCRIPT)
        command = f"cd {root} && exec chroot {root} /usr/bin/python3 -S -c \"import sys; sys.path[:0] = ['/site', '/numpy']; import os; os.chdir('/tmp'); exec(open('/script.py').read())\""
        self.assertIn("/site/mbk/__init__.py", ran("unshare", "--map-root-user", "sh", "-c", command,
                                                   env={"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8"}))


def add_python(root):
    """Python, NumPy, and the shared libraries that these need, as a root folder."""
    import numpy

    interpreter = pathlib.Path(os.path.realpath("/usr/bin/python3"))
    (root / "usr/bin").mkdir(parents=True)
    shutil.copy(interpreter, root / "usr/bin/python3")
    library = pathlib.Path(sysconfig.get_paths()["stdlib"])
    without = shutil.ignore_patterns("__pycache__", "test", "tests", "idlelib", "tkinter", "lib2to3", "dist-packages")
    shutil.copytree(library, root / library.relative_to("/"), ignore=without)
    for name in ("numpy",):
        shutil.copytree(pathlib.Path(numpy.__file__).parent, root / "numpy" / name, ignore=without)
    objects = [interpreter, *root.rglob("*.so")]
    needed = set()
    for one in objects:
        needed |= set(re.findall(r"=> (/\S+)|^\s*(/\S*ld-linux\S+)", subprocess.run(
            ["ldd", one], capture_output=True, text=True, check=False).stdout, re.MULTILINE))
    for found in needed:
        path = pathlib.Path(found[0] or found[1])
        target = root / path.relative_to("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists():
            shutil.copyfile(os.path.realpath(path), target)
            target.chmod(0o755)
    # Debian's libc6 and other systems' glibc bring it along.
    libraries = root / "usr/lib/x86_64-linux-gnu"
    libraries.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(os.path.realpath(ran("gcc", "-print-file-name=libgcc_s.so.1").strip()), libraries / "libgcc_s.so.1")


if __name__ == "__main__":
    if sys.platform != "linux" or not shutil.which("unshare"):
        sys.exit(77)
    unittest.main()
