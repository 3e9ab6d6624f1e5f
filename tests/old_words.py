#!/usr/bin/env python3
"""Words that mbk once used instead of the field's, and phrases that readers had to translate, do not come back.

usage: old_words.py [ROOT]
"""

import pathlib
import re
import subprocess
import sys

#: (what must not be written, as a regular expression; what to write instead)
OLD = [
    (r"held back|held-back (data|fit|part)", "held-out; validation data"),
    (r"told apart|tells? \w+ apart", "distinguish; not identifiable"),
    (r"\bthinn(ed|ing)\b", "decimated, decimation"),
    (r"every so many", "every Nth"),
    (r"\bk(Most|Fewest|Least)([A-Z]\w*)?\b|\b(least_(bytes|pivot)|most_(trials|sessions))\b", "kMax…, kMin…, max_…, min_…"),
    (r"\b[Aa]breast\b", "sample block, SIMD lanes"),
    (r"\blimited_for\b|\bno living sensor\b", "max_saturation_time; frozen sensor"),
    (r"leav\w+ (it |them )?away|left away|left aside", "omits, omitted, ignored"),
    (r"leaves over|is left over", "residual"),
    (r"how to make (it|this|them) again", "how to reproduce this"),
    (r"Where the numbers come from", "Methods and provenance"),
    (r"In short\b", "Summary"),
    (r"gave more energy than it took", "the hand delivered net energy during this trial; the fitted model can generate energy"),
    (r"speaks? (for|against)\b", "supports, argues against"),
    (r"beyond reasonable doubt", "with 95 % confidence"),
    (r"counts on a passive", "is designed for a passive limb"),
    (r"\bacross that\b", "perpendicular (minor axis)"),
    (r"had no share in", "held-out (validation) data"),
    (r"may be chance", "not significant (95 %)"),
    (r"\bwhat counts\b", "analysed interval"),
    (r"drawn towards", "biased towards"),
    (r"keeps? to its lasting", "in steady state"),
    (r"see to the reason|reason is gone|the person is well", "cause cleared, participant OK"),
    (r"place of the hand", "hand position"),
    (r"is no command\b", "unknown command"),
    (r"where the channels stand|where the file does not say it", "map columns to channels"),
    (r"whose hand is the hand", "which arm to analyse"),
    (r"so many seconds for each", "N times faster than real time"),
    (r"of phases, decisions and noise", "random seed"),
    (r"no such page", "do not serve the console"),
    (r"how many do not is said", "the number excluded is reported"),
    (r"either way\b.*reference|by which the voltage may", "maximum lag between voltage and reference"),
    (r"answers no motion", "the force is constant"),
    (r"no robot that can exist", "physically inconsistent"),
    (r"they are no one table", "have different lengths and cannot form one table"),
    (r"differs significantly by more than the standard error", "the two methods agree within their uncertainty"),
    (r"\b(is|are) (said|asked)(?= *[.;,)\"]| of\b)", "is reported, tested, requested"),
    (r"(fails|@fails) as it likes|All is known of it", "called when the trial is complete; may fail with any error"),
    (r"Said is what|what is no HTTP", "non-HTTP input is logged"),
    (r"calls nothing kept that", "reports untested rules as untested"),
    (r"is asked of the rows", "is computed on the rows"),
    (r"[Oo]f accelerometers", "the robot reports no accelerometer"),
    (r"the answers end before", "input ended before"),
    (r"is none of\b", "is not one of"),
    (r"[Rr]each of the (noise|residual)", "noise correlation time"),
    (r"[Cc]ondition of the regressors", "condition number"),
    (r"no change of \w+ is shown|no change is shown", "no detectable change"),
    (r"speeded up", "accelerated"),
    (r"\| Held by \|", "tested in"),
    (r"Miller and Rabin", "Miller–Rabin"),
    (r"puts? \w+ right\b|\bput right\b", "correct"),
    (r"unless said\b|this one unless", "default"),
    (r"by that of\b|as it is to stand", "say the meaning"),
]
SKIPPED = re.compile(r"(^|/)(old_words\.py|statements_test\.py|package-lock\.json|LICENSE|THIRD_PARTY_NOTICES\.md|build/.*)$")
ENDINGS = {".md", ".cpp", ".h", ".c", ".py", ".mjs", ".ts", ".m", ".toml", ".txt", ".sh", ".cmake", ".html", ".css", ".ipynb", ""}


def old_words(root):
    """Each old word, as "file:line: what; what instead"."""
    listed = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True, check=False)
    names = listed.stdout.splitlines() if listed.returncode == 0 else [
        path.relative_to(root).as_posix() for path in pathlib.Path(root).rglob("*") if path.is_file()]
    either = re.compile("|".join(f"(?:{pattern})" for pattern, _ in OLD))
    for name in sorted(names):
        path = pathlib.Path(root) / name
        if SKIPPED.search(name) or path.suffix not in ENDINGS or not path.is_file():
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), start=1):
            if not either.search(line):
                continue
            for pattern, instead in OLD:
                if found := re.search(pattern, line):
                    yield f"{name}:{number}: '{found[0]}'; write: {instead}"


def main():
    found = list(old_words(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent))
    print("\n".join(found) or "no old words")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
