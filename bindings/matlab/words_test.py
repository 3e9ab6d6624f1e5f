#!/usr/bin/env python3
"""The package +mbk as MATLAB reads it: no word, operator or sign that is Octave's alone, and functions called as their
files. MATLAB itself is not asked."""

import pathlib
import re
import unittest

PACKAGE = pathlib.Path(__file__).parent / "+mbk"
OCTAVE_ALONE = re.compile(r"\b(end(if|for|while|function|switch|_\w+)|unwind_protect\w*|printf|puts|fdisp|until"
                          r"|argv|program_name|ostrsplit|merge|ifelse)\b(?!\s*[=.)\]])|[-+*/]=|!|#|\"|\+\+|\*\*|\)[({]")
TEXTS = re.compile(r"(?<![\w)\]}'.])'(?:[^'\n]|'')*'")  # a quote behind a value transposes it


def code(text):
    """Without comments and texts."""
    return "\n".join(TEXTS.sub("''", line).split("%")[0] for line in text.splitlines())


class Words(unittest.TestCase):
    def test_none_is_octaves_alone(self):
        files = sorted(PACKAGE.rglob("*.m"))
        self.assertGreater(len(files), 25)
        for file in files:
            for number, line in enumerate(code(file.read_text(encoding="utf-8")).splitlines(), 1):
                found = OCTAVE_ALONE.search(line)
                self.assertIsNone(found, f"{file.name}:{number}: {line.strip()}")

    def test_each_file_has_the_function_that_it_is_called_after(self):
        for file in sorted(PACKAGE.rglob("*.m")):
            first = re.match(r"function (?:.*= *)?(\w+)", file.read_text(encoding="utf-8"))
            self.assertEqual(first[1], file.stem)

    def test_what_is_octaves_alone_is_found(self):
        for line in ("if a != b", "x += 1", "y = f(x)(1)", "endif", "printf('a')", "s = \"a\"", "# a comment"):
            self.assertRegex(code(line), OCTAVE_ALONE)
        for line in ("x = a' * b'; % it's a comment!", "s = 'a \"b\" # c'", "y = [a', b'];"):
            self.assertNotRegex(code(line), OCTAVE_ALONE)


if __name__ == "__main__":
    unittest.main()
