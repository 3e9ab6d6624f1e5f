#!/usr/bin/env python3
"""The subjects of the last commits have at most 72 characters and no full stop.   usage: commits.py [ROOT]

Where there is no history (a tarball), the test is skipped.
"""

import pathlib
import subprocess
import sys

LONGEST = 72
LOOKED_AT = 40
SKIPPED = 77


def problems(subjects):
    for subject in subjects:
        if len(subject) > LONGEST:
            yield f"{len(subject)} characters, at most {LONGEST}: {subject}"
        elif subject.endswith("."):
            yield f"ends with a full stop: {subject}"


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    log = subprocess.run(["git", "-C", root, "log", f"-{LOOKED_AT}", "--no-merges", "--format=%s"], capture_output=True,
                         text=True, check=False)
    if log.returncode != 0:
        print("there is no history here")
        sys.exit(SKIPPED)
    assert len(list(problems(["x" * 73, "docs: one idea.", "docs: one idea"]))) == 2, "the check itself can fail"
    found = list(problems(log.stdout.splitlines()))
    print("\n".join(found) or f"{LOOKED_AT} subjects are short enough")
    if found:
        print("reword the last one with: git commit --amend")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
