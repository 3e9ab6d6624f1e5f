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

    def test_a_header_is_compiled_by_itself_where_nothing_else_of_ours_stands_before_it(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {"low.h": "", "alone.h": "#include <map>\n", "top.h": '#include "low.h"\n',
                               "top.cpp": '#include "top.h"\n#include "low.h"\n#include "alone.h"\n'}.items():
                pathlib.Path(folder, name).write_text(text)
            pathlib.Path(folder, "alone.cpp").write_text('#include <vector>\n#include "alone.h"\n')
            tree = headers.Tree(folder)
            self.assertEqual(tree.compiled_by_themselves([["top.cpp"]]), {"low.h", "top.h"})
            self.assertEqual(tree.compiled_by_themselves([["top.cpp", "alone.cpp"]]), {"low.h", "top.h"})
            self.assertEqual(tree.compiled_by_themselves([["top.cpp"], ["alone.cpp"]]), {"low.h", "top.h", "alone.h"})


if __name__ == "__main__":
    unittest.main()
