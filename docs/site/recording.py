"""A recording of the first two commands in a terminal (asciicast version 2), which the first page plays.

The output is the program's own, of a pseudo-terminal. Only the times are set: typing and scrolling at a pace to read along.
"""

import fcntl
import html
import json
import os
import pathlib
import pty
import re
import struct
import subprocess
import tempfile
import termios

COMMANDS = ("mbk simulate relaxed_sinusoidal --out trial.h5", "mbk measure trial.h5")
COLUMNS, ROWS = 80, 30
KEY, THINKING, LINE, READING = 0.05, 0.8, 0.12, 4.0  # s
PROMPT = "$ "
LAST_LINE = re.compile(r"^  stiffness K .*\n", re.MULTILINE)  # of the table; the picture before it plays shows it


def said(command, folder, environment):
    """What a command prints in a terminal."""
    own, its = pty.openpty()
    fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    with subprocess.Popen(command.split(), cwd=folder, env=environment, stdin=its, stdout=its, stderr=its,
                          start_new_session=True) as process:
        os.close(its)
        parts = []
        try:
            while part := os.read(own, 65536):
                parts.append(part)
        except OSError:  # so Linux says that the last program has closed the terminal
            pass
        os.close(own)
    if process.returncode != 0:
        raise SystemExit(f"{command}: exit {process.returncode}")
    return b"".join(parts).decode()


def recorded(mbk):
    """(time [s], output) of both commands, one after the other."""
    events, now = [], 0.0
    with tempfile.TemporaryDirectory(prefix="mbk-recording-") as name:
        (pathlib.Path(name) / "bin").mkdir()
        (pathlib.Path(name) / "bin/mbk").symlink_to(pathlib.Path(mbk).resolve())
        environment = {**os.environ, "TERM": "xterm-256color",
                       "PATH": f"{name}/bin{os.pathsep}{os.environ['PATH']}"}
        environment.pop("COLUMNS", None)
        work = pathlib.Path(name) / "work"
        work.mkdir()
        for command in COMMANDS:
            events.append((now, PROMPT))
            now += THINKING
            for key in command:
                events.append((now, key))
                now += KEY
            events.append((now, "\r\n"))
            now += THINKING
            for line in said(command, work, environment).splitlines(keepends=True):
                events.append((now, line))
                now += LINE
            now += THINKING
    events.append((now, PROMPT))
    events.append((now + READING, ""))
    return events


def cast(events):
    """The file: a header, then a line for each event."""
    header = {"version": 2, "width": COLUMNS, "height": ROWS, "title": "The first two commands of mbk"}
    lines = [header, *([round(time, 2), "o", output] for time, output in events)]
    return "\n".join(json.dumps(line, ensure_ascii=False) for line in lines) + "\n"


def text(events):
    """What the terminal shows in the end, without its width."""
    return "".join(output for _, output in events).replace("\r\n", "\n").removesuffix(PROMPT).rstrip() + "\n"


def block(mbk, with_player):
    """HTML: a player where there is one, which docs/site/site.js starts, and the same as text for all others."""
    events = recorded(mbk)
    parts = [f"<details open class=\"recorded\"><summary>As text</summary>\n\n<pre>{html.escape(text(events))}</pre>\n\n</details>"]
    if with_player:
        table = max(time for time, output in events if LAST_LINE.match(output.replace("\r\n", "\n")))
        data = cast(events).replace("</", "<\\/")
        parts.insert(0, f'<div class="terminal" data-poster="npt:{table + LINE:.2f}"></div>\n\n'
                     f'<script type="application/x-asciicast" id="first-commands">\n{data}</script>\n\n'
                     '<link rel="stylesheet" href="_static/asciinema-player.css">\n\n'
                     '<script src="_static/asciinema-player.min.js"></script>')
    return "\n\n".join(parts) + "\n"
