"""Builds the wheel of mbk with CMake for pip (PEP 517). It needs no Python package.

`pip install .` configures and builds in build/wheel, or in the folder of `--config-settings build-dir=…`, with the CMake
options in the environment variable CMAKE_ARGS. If MBK_BUILD names a build folder of this tree, that is used without
building. The wheel has the package, its library, the program with its manual pages, and serves every Python. If library and
program need nothing but the C library (CMAKE_ARGS=-DMBK_STATIC=FOLDER), its tag says from which version on; otherwise it is
for the machine that it was built on. If MBK_WINDOWS names a folder with mbk.exe and mbk.dll, the wheel has these (tools/windows).
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
OF_C = re.compile(r"^(ld-linux.*|lib(c|m|dl|rt|pthread|gcc_s))\.so")  # what every Linux has
WINDOWS = os.environ.get("MBK_WINDOWS")
EPOCH = (1980, 1, 1, 0, 0, 0)  # the same tree gives the same wheel


def run(*command):
    subprocess.run(list(map(str, command)), check=True, cwd=ROOT)


def version():
    return re.search(r"project\(mbk VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def needed(binary):
    """Libraries that a binary links, and the newest version of glibc that its symbols ask for: (2, 34)."""
    links = re.findall(r"NEEDED\s+(\S+)", objdump("--private-headers", binary))
    symbols = re.findall(r"\bGLIBC_([\d.]+)", objdump("--dynamic-syms", binary))
    return links, max(tuple(map(int, one.split("."))) for one in symbols)


def objdump(option, binary):
    return subprocess.run(["objdump", option, binary], check=True, capture_output=True, text=True).stdout


def tag(binaries):
    """Tag of a wheel with these binaries."""
    if WINDOWS:
        return "py3-none-win_amd64"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    found = [needed(one) for one in binaries]
    if all(OF_C.match(link) for links, _ in found for link in links):
        major, minor = max(version for _, version in found)
        platform = platform.replace("linux_", f"manylinux_{major}_{minor}_", 1)
    return f"py3-none-{platform}"


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
    run("cmake", "--build", folder, "--parallel", "--target", "mbk_python_package", "mbk_texts", "mbk_misbehaving_robot")
    return folder


def staged(build, folder):
    """Installs what the wheel has below `folder`. Returns {path in the wheel: file}."""
    for component in ("c", "program", "python"):
        run("cmake", "--install", build, "--component", component, "--strip", "--prefix", folder)
    package = next(folder.rglob("mbk/__init__.py")).parent
    files = {f"mbk/{one.relative_to(package).as_posix()}": one for one in package.rglob("*")}
    scripts = f"mbk-{version()}.data/scripts"  # with the commands of Python
    if WINDOWS:
        files.pop("mbk/libmbk.so.1", None)
        files["mbk/mbk.dll"] = pathlib.Path(WINDOWS, "mbk.dll")
        files[f"{scripts}/mbk.exe"] = pathlib.Path(WINDOWS, "mbk.exe")
    else:
        files["mbk/libmbk.so.1"] = next(one for one in folder.rglob("libmbk.so.1") if one.exists())
        # `man` looks for pages beside the commands. The robot that misbehaves (`mbk validate faults --link udp`) is 10 MB
        # that few would miss.
        files[f"{scripts}/mbk"] = folder / "bin/mbk"
        files |= {f"mbk-{version()}.data/data/share/man/man1/{one.name}": one for one in folder.glob("share/man/man1/mbk[-.]*")}
    return {path: file for path, file in files.items() if file.is_file() and "__pycache__" not in file.parts}


def binaries(files):
    return [file for path, file in files.items() if path in ("mbk/libmbk.so.1", "mbk/mbk.dll") or ".data/scripts/" in path]


# ---- hooks for pip


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def wheel_text(its_tag):
    return f"Wheel-Version: 1.0\nGenerator: mbk {version()}\nRoot-Is-Purelib: false\nTag: {its_tag}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    info = f"mbk-{version()}.dist-info"
    records = []
    with tempfile.TemporaryDirectory() as staging:
        files = staged(built(config_settings), pathlib.Path(staging))
        its_tag = tag(binaries(files))
        name = f"mbk-{version()}-{its_tag}.whl"
        with zipfile.ZipFile(pathlib.Path(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as wheel:

            def add(path, content, mode=0o644):
                entry = zipfile.ZipInfo(path, EPOCH)
                entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
                wheel.writestr(entry, content)
                digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                records.append(f"{path},sha256={digest},{len(content)}")

            executable = binaries(files)
            for path, file in sorted(files.items()):
                add(path, file.read_bytes(), 0o755 if file in executable else 0o644)
            for text in ("LICENSE", "THIRD_PARTY_NOTICES.md", "packaging/copyright"):
                add(f"{info}/{pathlib.Path(text).name}", (ROOT / text).read_bytes())
            add(f"{info}/METADATA", metadata().encode())
            add(f"{info}/WHEEL", wheel_text(its_tag).encode())
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
