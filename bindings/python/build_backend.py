"""Builds the wheel of mbk with CMake for pip (PEP 517). It needs no Python package.

`pip install .` configures and builds in build/wheel, or in the folder of `--config-settings build-dir=…`, with the CMake
options in the environment variable CMAKE_ARGS. If MBK_BUILD names a build folder of this tree, that is used without
building. The wheel contains the shared libraries that the module links, except those of the C and C++ runtimes.
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUNTIME = re.compile(r"^(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+))\.so")
EPOCH = (1980, 1, 1, 0, 0, 0)  # the same tree gives the same wheel


def run(*command):
    subprocess.run(list(map(str, command)), check=True, cwd=ROOT)


def version():
    return re.search(r"project\(mbk VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def metadata():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")

    def field(name):
        return re.search(rf'^{name} = "(.*)"$', project, re.MULTILINE)[1]

    def names(key):
        return re.findall(r'"([^"]+)"', re.search(rf"^{key} = \[(.*)\]$", project, re.MULTILINE)[1])

    lines = ["Metadata-Version: 2.1", "Name: mbk", f"Version: {version()}", f"Summary: {field('description')}",
             "License: BSD-3-Clause", f"Requires-Python: {field('requires-python')}"]
    lines += [f"Requires-Dist: {one}" for one in names("dependencies")]
    lines += ["Provides-Extra: all"] + [f'Requires-Dist: {one}; extra == "all"' for one in names("all")]
    text = (ROOT / "docs/guide/python.md").read_text(encoding="utf-8")
    return "\n".join([*lines, "Description-Content-Type: text/markdown", "", text])


def built(settings):
    """A build folder that contains the package.   settings: --config-settings of pip, or None"""
    given = os.environ.get("MBK_BUILD")
    if given:
        return pathlib.Path(given).resolve()
    folder = ROOT / (settings or {}).get("build-dir", "build/wheel")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    run("cmake", "-S", ROOT, "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DMBK_BUILD_TESTS=OFF",
        "-DMBK_PYTHON=ON", f"-DPython3_EXECUTABLE={getattr(sys, '_base_executable', sys.executable)}",
        *shlex.split(os.environ.get("CMAKE_ARGS", "")))
    run("cmake", "--build", folder, "--parallel", "--target", "mbk_python_package")
    return folder


def staged(build, folder):
    """Installs the package below `folder` and returns its path."""
    run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", folder)
    package = next(folder.rglob("mbk/__init__.py")).parent
    bundle(package)
    return package


def bundle(package):
    """Copies the shared libraries that the module needs, and writes their load order: each after its dependencies."""
    module = next(package.glob("_mbk*.so"))
    paths, order = {}, []
    for name, path in re.findall(r"(\S+) => (/\S+)", subprocess.run(["ldd", module], check=True, capture_output=True,
                                                                   text=True).stdout):
        if not RUNTIME.match(name):
            paths[name] = path

    def add(name):
        if name in order:
            return
        needed = subprocess.run(["ldd", paths[name]], check=True, capture_output=True, text=True).stdout
        for one in re.findall(r"(\S+) => /\S+", needed):
            if one in paths:
                add(one)
        order.append(name)

    for name in sorted(paths):
        add(name)
    libraries = package / "libraries"
    libraries.mkdir()
    for name in order:
        shutil.copyfile(paths[name], libraries / name)
    (libraries / "order.txt").write_text("\n".join(order) + "\n", encoding="utf-8")


# ---- hooks for pip


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    name = f"mbk-{version()}.dist-info"
    folder = pathlib.Path(metadata_directory, name)
    folder.mkdir()
    (folder / "METADATA").write_text(metadata(), encoding="utf-8")
    (folder / "WHEEL").write_text(wheel_text(), encoding="utf-8")
    return name


def wheel_text():
    return f"Wheel-Version: 1.0\nGenerator: mbk {version()}\nRoot-Is-Purelib: false\nTag: {tag()}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name = f"mbk-{version()}-{tag()}.whl"
    info = f"mbk-{version()}.dist-info"
    records = []
    with tempfile.TemporaryDirectory() as staging:
        package = staged(built(config_settings), pathlib.Path(staging))
        with zipfile.ZipFile(pathlib.Path(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as wheel:

            def add(path, content, mode=0o644):
                entry = zipfile.ZipInfo(path, EPOCH)
                entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
                wheel.writestr(entry, content)
                digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                records.append(f"{path},sha256={digest},{len(content)}")

            for file in sorted(one for one in package.rglob("*") if one.is_file()):
                if "__pycache__" not in file.parts:
                    add(f"mbk/{file.relative_to(package).as_posix()}", file.read_bytes(),
                        0o755 if ".so" in file.name else 0o644)
            for text in ("LICENSE", "THIRD_PARTY_NOTICES.md"):
                add(f"{info}/{text}", (ROOT / text).read_bytes())
            add(f"{info}/METADATA", metadata().encode())
            add(f"{info}/WHEEL", wheel_text().encode())
            record = "\n".join([*records, f"{info}/RECORD,,", ""])
            add(f"{info}/RECORD", record.encode())
    return name


def build_sdist(sdist_directory, config_settings=None):
    """An archive of the files in git."""
    name = f"mbk-{version()}"
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout.decode().split("\0")
    with tarfile.open(pathlib.Path(sdist_directory, f"{name}.tar.gz"), "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for file in sorted(filter(None, files)):
            archive.add(ROOT / file, f"{name}/{file}", recursive=False)
        with tempfile.NamedTemporaryFile() as info:
            info.write(metadata().encode())
            info.flush()
            archive.add(info.name, f"{name}/PKG-INFO")
    return f"{name}.tar.gz"
