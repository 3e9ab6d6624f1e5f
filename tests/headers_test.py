#!/usr/bin/env python3
"""headers.py finds what a header names and does not include, and nothing where another header of ours brings it."""

import pathlib
import tempfile
import unittest

import headers


class Headers(unittest.TestCase):
    def problems(self, **texts):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in texts.items():
                path = pathlib.Path(folder, "mbk", f"{name}.h")
                path.parent.mkdir(exist_ok=True)
                path.write_text(text)
            return list(headers.Tree(folder).check())

    def test_what_is_missing_is_said_once(self):
        self.assertEqual(self.problems(words="#include <string>\n\nstd::map<int, std::string> f();\nstd::map<int, int> g();\n"),
                         ["mbk/words.h:3: names std::map; add #include <map>"])

    def test_what_another_header_of_ours_brings_is_there(self):
        self.assertEqual(self.problems(low="#include <map>\n", middle='#include "mbk/low.h"\n',
                                       top='#include "mbk/middle.h"\nstd::map<int, int> f();\n'), [])

    def test_words_in_comments_and_strings_need_nothing(self):
        self.assertEqual(self.problems(said='/// like std::map\nconst char* k = "std::map"; // std::vector\n'), [])


if __name__ == "__main__":
    unittest.main()
