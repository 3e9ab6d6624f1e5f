"""What a command executes, function by function: valgrind's callgrind, run and read.

Valgrind shows a program a processor of its own making (that of an AVX2 machine, with fixed sizes of caches), whatever
the machine is, so that mbk, Eigen and the C library choose the same loops everywhere. What it counts are instructions
of the program: neither the kernel's (reading, writing, clearing pages) nor time lost to caches.
"""

import functools
import os
import re
import subprocess
import tempfile
from pathlib import Path


OPERATOR = re.compile(r"\boperator\s*(\(\)|<=>|<<=?|>>=?|->\*?|<=?|>=?)")


# Valgrind's processor has no SHA instructions, which nearly every real one has: what takes their place is left out.
NOT_RUN_ELSEWHERE = ("mbk::recording::compress_portable",)


class Failed(Exception):
    """A command did not do what it should have done."""


class Counted:
    """Instructions of one run.

    total      of the process without NOT_RUN_ELSEWHERE
    whole      of the process with it, as callers' inclusive costs hold it too
    functions  short name: (inclusive, self). Inclusive is what the function and all that it calls execute; where
               functions call each other in a ring, or several have the same short name, it may count twice what is
               executed within, and is never more than the whole.
    """

    def __init__(self, total, whole, functions):
        self.total, self.whole, self.functions = total, whole, functions


def short_name(name):
    """A function without its template arguments, parameters and the compiler's suffixes: those that share it are one."""
    name = re.sub(r"\[(clone|abi:)[^]]*\]", "", name).replace("(anonymous namespace)::", "")
    name = re.sub(r"(\.(isra|constprop|part|cold|lto_priv)(\.\d+)?|'\d+)+$", "", name)
    out, depth, k = [], 0, 0
    while k < len(name):
        character = name[k]
        if character == "o" and (operator := OPERATOR.match(name, k)):
            out.append(operator[0] if depth == 0 else "")
            k = operator.end()
            continue
        if character in "<(":
            depth += 1
        elif character in ">)":
            depth -= 1 if depth > 0 and name[k - 1:k + 1] != "->" else 0
        elif depth == 0:
            out.append(character)
        k += 1
    # The type that a template's instance returns stands before its name.
    words = [word for word in "".join(out).split() if word not in ("const", "volatile")]
    start = next((i for i, word in enumerate(words) if word.endswith("operator")), len(words) - 1)
    return " ".join(words[start:]) or name


def read(text):
    """What a file of callgrind says (its manual, "Callgrind Format Specification"), as Counted; raises Failed."""
    names, own, calls = {}, {}, {}
    total, function, callee, called = None, None, None, False

    def named(value):
        match = re.match(r"\((\d+)\)(?: (.*))?$", value)
        if not match:
            return short_name(value)
        if match[2] is not None:
            names[match[1]] = short_name(match[2])
        if match[1] not in names:
            raise Failed(f"callgrind's file uses function {match[1]} before it names it")
        return names[match[1]]

    for line in text.splitlines():
        if not line or line[0] == "#":
            continue
        if line[0] in "0123456789+-*":
            fields = line.split()
            if function is None:
                raise Failed("callgrind's file has a cost that belongs to no function")
            cost = int(fields[1]) if len(fields) > 1 else 0
            if called:
                if callee != function:
                    calls[function] = calls.get(function, 0) + cost
                called = False
            else:
                own[function] = own.get(function, 0) + cost
        elif line.startswith("fn="):
            function = named(line[3:])
        elif line.startswith("cfn="):
            callee = named(line[4:])
        elif line.startswith("calls="):
            called = True
        elif line.startswith("events:"):
            if line.split()[1] != "Ir":
                raise Failed(f"callgrind counted {line.split()[1:]} and not instructions first")
        elif line.startswith(("totals:", "summary:")):
            total = int(line.split()[1])
    if not total or not own:
        raise Failed("callgrind's file holds no total or no function: it was not written to its end")
    functions = {name: (min(total, own.get(name, 0) + calls.get(name, 0)), own.get(name, 0))
                 for name in own.keys() | calls.keys() if name not in NOT_RUN_ELSEWHERE}
    return Counted(total - sum(own.get(name, 0) for name in NOT_RUN_ELSEWHERE), total, functions)


def version():
    """Valgrind's, or None where there is none."""
    try:
        said = subprocess.run(["valgrind", "--version"], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return said.stdout.strip().removeprefix("valgrind-") if said.returncode == 0 else None


def environment(folder):
    """All that a counted program sees of the caller's."""
    return {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "HOME": str(folder), "TMPDIR": str(folder), "TZ": "UTC"}


@functools.lru_cache(maxsize=None)
def with_fixed_addresses():
    """What has a program begin at the same addresses each time; nothing where a container forbids it."""
    fixed = ["setarch", os.uname().machine, "-R"]
    try:
        return fixed if subprocess.run([*fixed, "true"], capture_output=True, check=False).returncode == 0 else []
    except OSError:
        return []


def profile(command, folder, *options):
    """What callgrind says of one run of a command in a folder. Raises Failed where its exit code is not 0."""
    with tempfile.NamedTemporaryFile(prefix="callgrind-", suffix=".out") as out:
        ran = subprocess.run([*with_fixed_addresses(), "valgrind", "--tool=callgrind", f"--callgrind-out-file={out.name}",
                              "--dump-line=no", *options, *map(str, command)], cwd=folder, env=environment(folder),
                             stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                             check=False)
        if ran.returncode != 0:
            raise Failed(f"exit code {ran.returncode} of: {' '.join(map(str, command))}\n{ran.stderr.strip()[-2000:]}")
        return Path(out.name).read_text(encoding="utf-8", errors="replace")


def count(command, folder):
    """Counts one run of a command in a folder. Raises Failed where its exit code is not 0."""
    return read(profile(command, folder))
