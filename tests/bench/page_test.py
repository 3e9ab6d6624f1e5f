#!/usr/bin/env python3
"""bench/README.md holds the table of every benchmark, with every row that it prints, as it printed it."""

import pathlib
import re
import sys
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))

import page

TEXT = page.PAGE.read_text(encoding="utf-8")
#: What times nothing by itself; `mbk reproduce`, of which docs/guide/reproduce.md speaks; and the campaign of the engines,
#: which takes hours (docs/guide/cluster.md).
NO_TABLE = {"cluster.py", "reproduce.py", "against.py", "callgrind.py", "commands.py", "function_order.py", "instructions.py",
            "joblib_pipeline.py", "numpy_measure.py", "numpy_pipeline.py", "plain_closed_loop.py", "pipeline.cpp",
            "transfer_function.cpp", "floor.cpp", "plant.cpp"}


class Page(unittest.TestCase):
    def test_every_benchmark_has_its_table_and_every_table_its_benchmark(self):
        self.assertEqual(sorted(page.tables(TEXT)), sorted(one.name for one in page.BENCHMARKS))

    def test_every_program_of_the_folder_has_a_table_or_makes_none(self):
        sources = {path.name for path in BENCH.iterdir() if path.suffix in (".py", ".cpp")}
        self.assertEqual(sources, NO_TABLE | {one.source for one in page.BENCHMARKS})

    def test_every_row_of_a_benchmark_is_on_the_page(self):
        tables = page.tables(TEXT)
        for one in page.BENCHMARKS:
            rows = page.rows_of(one.source)
            if one.name not in ("floods",):
                self.assertGreater(len(rows), 1, one.name)
            for row in rows:
                self.assertRegex(tables[one.name], rf"(?m)^ *{row}", one.name)

    def test_each_table_says_when_and_where_it_was_measured(self):
        for name, text in page.tables(TEXT).items():
            self.assertRegex(text, r"(?s)\A(A short run, [^\n]*)?Measured on 20\d\d-\d\d-\d\d[;,].*\n```\n.+\n```\n\Z", name)

    def test_what_stands_beside_the_tables_has_no_measured_times(self):
        beside = page.BLOCK.sub("", TEXT)
        self.assertEqual(re.findall(r"\b\d[\d.,]* (?:ms|µs|times as fast)\b", beside), [])

    def test_what_tools_bench_runs_is_what_the_target_builds(self):
        lists = (BENCH / "CMakeLists.txt").read_text(encoding="utf-8")
        for one in page.BENCHMARKS:
            if one.program:
                self.assertIn(one.program, lists.partition("DEPENDS")[2])


class Tables(unittest.TestCase):
    TABLE = "Measured on 2026-01-01.\n```\n  a row   1.0\n```\n"

    def empty(self, name="one"):
        return f"before\n<!-- bench: {name} -->\nold\n<!-- end of bench: {name}, 000000000000 -->\nafter\n"

    def test_a_table_is_put_between_its_comments_and_read_again(self):
        text = page.with_table(self.empty(), "one", self.TABLE)
        self.assertEqual(page.tables(text), {"one": self.TABLE})
        self.assertTrue(text.startswith("before\n<!--") and text.endswith("-->\nafter\n"))
        self.assertEqual(page.with_table(text, "one", self.TABLE), text)

    def test_a_first_table_needs_no_checksum(self):
        text = self.empty().replace(", 000000000000", "")
        self.assertEqual(page.tables(page.with_table(text, "one", self.TABLE)), {"one": self.TABLE})

    def test_a_table_that_somebody_changed_is_found(self):
        text = page.with_table(self.empty(), "one", self.TABLE).replace("1.0", "0.5")
        with self.assertRaisesRegex(ValueError, "not what the benchmark wrote"):
            page.tables(text)

    def test_a_page_without_a_place_is_refused(self):
        for text in ("before\n", 2 * self.empty()):
            with self.assertRaisesRegex(ValueError, "tables 'one'"):
                page.with_table(text, "one", self.TABLE)

    def test_only_the_table_of_that_name_changes(self):
        text = self.empty("two") + self.empty() + self.empty("three").replace(", 000000000000", "")
        changed = page.with_table(text, "one", self.TABLE)
        self.assertEqual(changed.replace(page.with_table(self.empty(), "one", self.TABLE), self.empty()), text)

    def test_a_table_that_does_not_end_is_found(self):
        text = page.with_table(self.empty(), "one", self.TABLE) + "<!-- bench: two -->\n"
        with self.assertRaises(ValueError):
            page.tables(text)

    def test_rows_are_read_from_the_sources(self):
        self.assertIn(re.escape("mbk measure, CPU"), page.rows_of("whole_command.py"))
        self.assertIn(".+?:" + re.escape(" filters"), page.rows_of("pipeline.py"))
        self.assertIn("prepare/default_mode", page.rows_of("stages.cpp"))
        self.assertIn("observer_step", page.rows_of("robot_dynamics.cpp"))
        self.assertIn(re.escape("of it the loop itself"), page.rows_of("session.cpp"))


if __name__ == "__main__":
    unittest.main()
