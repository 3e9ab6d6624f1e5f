"""The processes that work on jobs below a folder."""

import contextlib
import os
import pathlib
import signal


def commands():
    """The words of every process, by its id."""
    for process in pathlib.Path("/proc").iterdir():
        if process.name.isdigit():
            with contextlib.suppress(OSError):
                yield int(process.name), (process / "cmdline").read_bytes().split(b"\0")


def workers_of(folder):
    """Process ids of `mbk work` on jobs below `folder`."""
    return [number for number, words in commands()
            if len(words) > 2 and words[1] == b"work" and words[2].startswith(bytes(folder))]


def processes_of(folder):
    """Process ids of all that has a path below `folder` among its words: workers, and what would begin another."""
    return [number for number, words in commands() if any(word.startswith(bytes(folder)) for word in words)]


def ended_by_kill(process):
    """Whether there was such a process to be killed."""
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True
