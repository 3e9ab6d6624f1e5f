#!/usr/bin/env python3
"""Relative links in the documentation lead to files that exist.   usage: links.py [ROOT]"""

import pathlib
import re
import sys

LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?[^)]*\)|^\s*\[[^\]]+\]:\s*(\S+)")
OUTSIDE = re.compile(r"^([a-z][a-z0-9+.-]*:|#|//)", re.IGNORECASE)
SKIPPED = re.compile(r"^(build.*|\..*|node_modules)$")


def broken_links(root):
    """Each link that leads nowhere, as "file:line: what"."""
    root = pathlib.Path(root).resolve()
    for path in sorted(root.rglob("*.md")):
        inside = path.relative_to(root)
        if any(SKIPPED.match(part) for part in inside.parts[:-1]):
            continue
        in_code = False
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            if line.lstrip().startswith("```"):
                in_code = not in_code
            if in_code:
                continue
            for match in LINK.finditer(re.sub(r"`[^`]*`", "", line)):
                target = match.group(1) or match.group(2)
                if OUTSIDE.match(target):
                    continue
                found = (path.parent / target.split("#")[0]).resolve()
                if not found.exists() or not found.is_relative_to(root):
                    yield f"{inside}:{number}: '{target}' leads to nothing in this repository; correct the link"


def main():
    problems = list(broken_links(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent))
    print("\n".join(problems) or "every relative link leads to a file")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
