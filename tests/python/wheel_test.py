#!/usr/bin/env python3
"""pip installs the package into an environment that sees the system's packages, and its wheel runs where the libraries
that mbk links are not installed: in a root folder that holds Python, NumPy and the C and C++ runtimes and nothing else."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
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
        ran(self.python, "-m", "pip", "uninstall", "-y", "mbk", env=clean())
        with self.assertRaises(AssertionError):
            ran(self.python, "-c", "import mbk", cwd=self.folder, env=clean())

    def test_the_same_tree_gives_the_same_wheel(self):
        sys.path.insert(0, str(ROOT / "bindings/python"))
        import build_backend
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
        for name in ("mbk/__init__.py", "mbk/_functions.py", "mbk/py.typed", "mbk/_mbk.pyi", "mbk/libraries/order.txt",
                     "mbk/schemas/result.schema.json"):
            self.assertIn(name, names)
        self.assertTrue(any(name.startswith("mbk/_mbk.") and name.endswith(".so") for name in names))
        self.assertTrue(any(name.endswith("THIRD_PARTY_NOTICES.md") for name in names))
        self.assertFalse([name for name in names if "__pycache__" in name or "libc.so" in name or "libstdc++" in name])
        self.assertEqual(len(record.splitlines()), len(names))
        self.assertIn("Requires-Dist: numpy", metadata)

    def test_it_runs_where_what_it_links_is_not_installed(self):
        if subprocess.run(["unshare", "--map-root-user", "true"], capture_output=True, check=False).returncode != 0:
            self.skipTest("no root folder of one's own can be had here")
        root = self.folder / "root"
        module = next(pathlib.Path(os.environ["BUILD"], "python/mbk").glob("_mbk*.so"))
        linked = set(re.findall(r"(\S+) => /", ran("ldd", module)))
        allowed = re.compile(r"lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+|gfortran|quadmath|blas|lapack|z|expat|ffi|bz2|lzma)\.so")
        add_python(root)
        site = root / "site"
        with zipfile.ZipFile(self.wheel) as wheel:
            wheel.extractall(site)
        present = {path.name for path in root.rglob("*.so*") if site not in path.parents}
        missing = {name for name in linked if name not in present}
        self.assertGreater(len(missing), 3, "the root folder has what it should lack")
        self.assertTrue(all(not allowed.match(name) for name in missing), missing)
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
    # Of the C++ runtime: whoever installs a wheel that is compiled has it.
    for name in ("libstdc++.so.6", "libgcc_s.so.1"):
        path = pathlib.Path(ran("g++", f"-print-file-name={name}").strip())
        target = root / "usr/lib/x86_64-linux-gnu" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists():
            shutil.copyfile(os.path.realpath(path), target)


if __name__ == "__main__":
    if sys.platform != "linux" or not shutil.which("unshare"):
        sys.exit(77)
    unittest.main()
