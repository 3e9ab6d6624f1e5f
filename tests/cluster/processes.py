"""The processes that work on jobs below a folder."""

import os
import pathlib
import signal


def workers_of(folder):
    """Process ids of `mbk work` on jobs below `folder`."""
    found = []
    for process in pathlib.Path("/proc").iterdir():
        if not process.name.isdigit():
            continue
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if len(words) > 2 and words[1] == b"work" and words[2].startswith(bytes(folder)):
            found.append(int(process.name))
    return found


def ended_by_kill(process):
    """Whether there was such a process to be killed."""
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True
