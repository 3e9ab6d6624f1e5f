#!/usr/bin/env python3
"""layering.py finds each kind of violation in a small tree, and nothing in a clean one."""

import pathlib
import tempfile
import unittest

import layering

CLEAN = {
    "mbk/CMakeLists.txt": "# the wings\nmbk_wing(base LAYER core LAYER numeric dsp)\nmbk_wing(measure LAYER identify)\n"
                          "mbk_wing(teleop)\n",
    "mbk/base/core/CMakeLists.txt": "mbk_module(core PUBLIC_LIBRARIES Eigen3::Eigen)\n",
    "mbk/base/core/result.h": "#include <string>\n",
    "mbk/base/numeric/CMakeLists.txt": "mbk_module(numeric DEPENDS core)\n",
    "mbk/base/numeric/solve.h": '#include "mbk/base/core/result.h"\n',
    "mbk/base/dsp/CMakeLists.txt": "mbk_module(dsp)\n",
    "mbk/base/dsp/filter.h": "#pragma once\n",
    "mbk/measure/identify/CMakeLists.txt": "mbk_module(identify\n           DEPENDS core  # errors\n"
                                   "                   numeric\n           LIBRARIES fmt::fmt)\n",
    "mbk/measure/identify/fit.h": '#pragma once\n#include "mbk/base/core/result.h"\n',
    "mbk/measure/identify/fit.cpp": '#include "mbk/measure/identify/fit.h"\n\n#include "mbk/base/numeric/solve.h"\n',
    "mbk/teleop/CMakeLists.txt": "mbk_module(teleop DEPENDS identify)\n",
    "mbk/teleop/ports.h": '#include "mbk/measure/identify/fit.h"\n',
    "apps/main.cpp": '#include "mbk/measure/identify/fit.h"\n#include "mbk/base/dsp/filter.h"\n',
}


class Layering(unittest.TestCase):
    def problems(self, **changed):
        """What layering.py says of the clean tree with some files changed, added or (None) taken away."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**CLEAN, **changed.get("files", {})}.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                if text is not None:
                    path.write_text(text)
            return layering.Tree(folder).check()

    def assert_one(self, files, place, *words):
        problems = self.problems(files=files)
        self.assertEqual(len(problems), 1, problems)
        self.assertTrue(problems[0].startswith(place + ": "), problems[0])
        for word in words:
            self.assertIn(word, problems[0])

    def test_passes_a_clean_tree(self):
        self.assertEqual(self.problems(), [])

    def test_finds_an_include_that_is_not_declared(self):
        self.assert_one({"mbk/measure/identify/fit.cpp": '#include "mbk/base/numeric/solve.h"\n\n#include "mbk/base/dsp/filter.h"\n'},
                        "mbk/measure/identify/fit.cpp:3", "does not declare 'dsp'", "add 'dsp' to DEPENDS")

    def test_does_not_count_what_a_dependency_declares(self):
        self.assert_one({"mbk/measure/identify/CMakeLists.txt": "mbk_module(identify DEPENDS numeric)\n"},
                        "mbk/measure/identify/fit.h:2", "does not declare 'core'")

    def test_holds_tests_to_the_same_rule(self):
        self.assert_one({"mbk/measure/identify/fit_test.cpp": '#include <mbk/base/dsp/filter.h>\n'},
                        "mbk/measure/identify/fit_test.cpp:1", "does not declare 'dsp'")

    def test_finds_a_declaration_that_is_not_used(self):
        self.assert_one({"mbk/measure/identify/fit.cpp": ""}, "mbk/measure/identify/CMakeLists.txt:3",
                        "declares 'numeric'", "take 'numeric' out")

    def test_finds_an_include_that_runs_upward(self):
        self.assert_one({"mbk/base/core/result.h": '#include "mbk/base/dsp/filter.h"\n'},
                        "mbk/base/core/result.h:1", "'core' (layer 2) may not use 'dsp' (layer 3)")

    def test_finds_an_include_within_one_layer(self):
        self.assert_one({"mbk/base/dsp/filter.h": '#include "mbk/base/numeric/solve.h"\n'},
                        "mbk/base/dsp/filter.h:1", "'dsp' (layer 3) may not use 'numeric' (layer 3)")

    def test_finds_a_declaration_that_runs_upward(self):
        problems = self.problems(files={"mbk/base/core/CMakeLists.txt": "mbk_module(core DEPENDS identify)\n"})
        self.assertIn("mbk/base/core/CMakeLists.txt:1: 'core' (layer 2) may not use 'identify' (layer 5)", problems[0])

    def test_finds_a_declared_module_that_does_not_exist(self):
        problems = self.problems(files={"mbk/base/dsp/CMakeLists.txt": "mbk_module(dsp DEPENDS nothing)\n"})
        self.assertIn("there is no module 'nothing'", problems[0])

    def test_finds_a_module_in_no_layer(self):
        self.assert_one({"mbk/base/stray/CMakeLists.txt": "mbk_module(stray)\n"}, "mbk/CMakeLists.txt:1",
                        "'mbk/base/stray' stands in no layer")

    def test_finds_a_module_in_another_wing_than_its_own(self):
        self.assert_one({"mbk/measure/dsp/CMakeLists.txt": "mbk_module(dsp)\n"}, "mbk/CMakeLists.txt:1",
                        "'mbk/measure/dsp' stands in no layer")

    def test_finds_a_wing_that_uses_a_later_one(self):
        self.assert_one({"mbk/measure/identify/fit.cpp": '#include "mbk/measure/identify/fit.h"\n\n'
                                                         '#include "mbk/base/numeric/solve.h"\n'
                                                         '#include "mbk/teleop/ports.h"\n'},
                        "mbk/measure/identify/fit.cpp:4", "'identify' (layer 5) may not use 'teleop' (layer 6)")

    def test_finds_an_eleventh_wing(self):
        wings = "".join(f"mbk_wing(more{k})\n" for k in range(8))
        self.assert_one({"mbk/CMakeLists.txt": CLEAN["mbk/CMakeLists.txt"] + wings}, "mbk/CMakeLists.txt:12",
                        "'more7' is wing 11 of at most 10")

    def test_finds_two_headers_of_one_name(self):
        self.assert_one({"mbk/base/numeric/fit.h": "#pragma once\n"}, "mbk/measure/identify/fit.h:1",
                        "mbk/base/numeric/fit.h has the same name")

    def test_finds_a_module_in_two_layers(self):
        self.assert_one({"mbk/CMakeLists.txt": CLEAN["mbk/CMakeLists.txt"] + "mbk_wing(files LAYER dsp)\n"},
                        "mbk/CMakeLists.txt:5", "'dsp' stands in two layers")

    def test_lets_a_layer_name_a_module_that_does_not_stand_yet(self):
        self.assertEqual(self.problems(files={"mbk/CMakeLists.txt":
                                              CLEAN["mbk/CMakeLists.txt"] + "mbk_wing(present LAYER report)\n"}), [])

    def test_finds_a_folder_without_its_module(self):
        self.assert_one({"mbk/base/dsp/CMakeLists.txt": None}, "mbk/base/dsp/CMakeLists.txt:1", "mbk_module(dsp")

    def test_finds_a_file_that_does_not_exist(self):
        self.assert_one({"apps/main.cpp": '#include "mbk/measure/identify/gone.h"\n'}, "apps/main.cpp:1",
                        "there is no mbk/measure/identify/gone.h")

    def test_finds_a_header_named_from_its_own_folder(self):
        self.assert_one({"mbk/base/dsp/filter.cpp": '#include "../dsp/filter.h"\n'}, "mbk/base/dsp/filter.cpp:1",
                        "name it from the root")


if __name__ == "__main__":
    unittest.main()
