#!/usr/bin/env python3
"""What is built is hardened as cmake/MbkHardening.cmake says.   usage: hardening.py BUILD PROGRAM...

Every compile command of BUILD/compile_commands.json has the flags, and nothing behind them takes one back. Every
program and plug-in in BUILD/bin and BUILD/tests, and each PROGRAM, which has to be there, is position independent, has
tables that are read-only before main begins and a stack that is not executable, and calls the checks that the flags
put in. Each line that it prints says where and what is missing; exit 1 where there is one.
"""

import json
import pathlib
import platform
import re
import shlex
import subprocess
import sys

# what has to be there, and what behind it takes it back
FLAGS = [
    ("-fstack-protector-strong", ("-fno-stack-protector", "-fstack-protector")),
    ("-fstack-clash-protection", ("-fno-stack-clash-protection",)),
    ("-D_FORTIFY_SOURCE=2", ("-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=0", "-D_FORTIFY_SOURCE=1", "-O0")),
]
if platform.machine() in ("x86_64", "AMD64"):
    FLAGS.append(("-fcf-protection", ("-fcf-protection=none",)))
POSITION_INDEPENDENT = {"-fPIC", "-fPIE"}
OPTIMISED = {"-O1", "-O2", "-O3", "-Os"}  # without, _FORTIFY_SOURCE does nothing
COMPILED = (".c", ".cpp", ".cxx")


def missing_flags(words):
    """What one compile command lacks."""
    for flag, undone_by in FLAGS:
        at = [k for k, word in enumerate(words) if word == flag]
        if not at:
            yield f"{flag} is missing"
        for word in words[at[-1] + 1:] if at else ():
            if word in undone_by:
                yield f"{word} takes {flag} back"
    if not POSITION_INDEPENDENT & set(words):
        yield "neither -fPIE nor -fPIC"
    if not OPTIMISED & set(words):
        yield "it is not optimised, so that _FORTIFY_SOURCE does nothing"


def command_problems(build):
    commands = json.loads((build / "compile_commands.json").read_text())
    compiled = [one for one in commands if one["file"].endswith(COMPILED)]
    if not compiled:
        yield f"{build}/compile_commands.json: it names nothing that is compiled"
    for one in compiled:
        for problem in missing_flags(shlex.split(one["command"])):
            yield f"{one['file']}: {problem}"


def readelf(*options):
    environment = {"LC_ALL": "C", "PATH": "/usr/bin:/bin:/usr/local/bin"}
    return subprocess.run(["readelf", "--wide", *options], capture_output=True, text=True, env=environment,
                          check=True).stdout


def program_problems(path, calls_checks=False):
    """What a program or plug-in lacks.   calls_checks: it is large enough to call a checked function of the C library"""
    head = readelf("--file-header", "--program-headers", "--dynamic", path)
    if not re.search(r"Type:\s+DYN", head):
        yield f"{path}: its place in memory is fixed (no PIE)"
    if "GNU_RELRO" not in head:
        yield f"{path}: no GNU_RELRO"
    if not re.search(r"\(FLAGS(_1)?\).*\b(BIND_NOW|NOW)\b", head):
        yield f"{path}: functions are looked up late (no BIND_NOW)"
    stack = re.search(r"GNU_STACK.*", head)
    if not stack or re.search(r"\sR?W?E\s", stack[0]):
        yield f"{path}: its stack is executable"
    symbols = readelf("--dyn-syms", path)
    # a plug-in of a few lines may have no array to protect; its commands are looked at like all others
    if path.suffix != ".so" and "__stack_chk_fail" not in symbols:
        yield f"{path}: no stack protector (__stack_chk_fail)"
    if calls_checks and not re.search(r"\b__\w+_chk@", symbols):
        yield f"{path}: no checked function of the C library (_FORTIFY_SOURCE)"


def is_elf(path):
    if not path.is_file() or path.is_symlink():
        return False
    with open(path, "rb") as file:
        return file.read(4) == b"\x7fELF"


def problems(build, programs):
    yield from command_problems(build)
    for path in programs:
        if not is_elf(path):
            yield f"{path}: no program; was it built?"
    others = {path for folder in ("bin", "tests", "examples") for path in (build / folder).rglob("*") if is_elf(path)
              and path.suffix in ("", ".so")}
    for path in sorted(others | {path for path in programs if is_elf(path)}):
        yield from program_problems(path, path in programs)


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1]).resolve(), [pathlib.Path(name).resolve() for name in sys.argv[2:]]))
    for problem in found:
        print(problem)
    sys.exit(1 if found else 0)
