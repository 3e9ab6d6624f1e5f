"""The tree of commands as --help shows it, read from the printed text alone."""

import functools
import re

from command import run


class Help:
    """One command: its path ("springs", "field"), what stands below it, its options with their placeholders."""

    def __init__(self, path):
        self.path = path
        self.text = run(*path, "--help").out
        heading = None
        self.commands, self.options, self.positionals = [], {}, []
        for line in self.text.splitlines():
            if match := re.match(r"(\w[^.]*):$", line):
                heading = match.group(1)
            elif heading == "Subcommands" and (match := re.match(r"  ([a-z]\S*)", line)):
                self.commands.append(match.group(1))
            elif heading == "Positionals" and (match := re.match(r"  ([A-Za-z]\S*)", line)):
                self.positionals.append(match.group(1))
            elif match := re.match(r"  (-[-\w,]+)(?: (\S+))?", line):
                for name in match.group(1).split(","):
                    self.options[name] = match.group(2) or ""

    @property
    def name(self):
        return "-".join(("mbk", *self.path))


@functools.lru_cache(maxsize=None)
def every_command(path=()):
    """The command at `path` and all that stand below it."""
    here = Help(path)
    return [here] + [one for below in here.commands for one in every_command((*path, below))]
