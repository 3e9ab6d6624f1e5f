#!/usr/bin/env python3
"""links.py finds the links that lead nowhere, and no others."""

import pathlib
import tempfile
import unittest

import links


class Links(unittest.TestCase):
    def broken(self, text):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "docs").mkdir()
            pathlib.Path(folder, "README.md").write_text("# mbk\n")
            pathlib.Path(folder, "docs", "page.md").write_text(text)
            return list(links.broken_links(folder))

    def test_passes_links_to_files_folders_and_the_web(self):
        self.assertEqual(self.broken("[a](../README.md#mbk) [b](.) [c](https://example.org/x) [d](#here)\n"), [])

    def test_finds_a_link_to_a_file_that_does_not_exist(self):
        self.assertEqual(len(self.broken("[a](../README.md) ![b](gone.svg \"title\")\n")), 1)

    def test_names_the_line(self):
        self.assertTrue(self.broken("\n\n[a]: gone.md\n")[0].startswith("docs/page.md:3: 'gone.md'"))

    def test_finds_a_link_that_leaves_the_repository(self):
        self.assertEqual(len(self.broken("[a](../..)\n")), 1)

    def test_leaves_code_alone(self):
        self.assertEqual(self.broken("`[a](gone.md)`\n```\n[b](gone.md)\n```\n"), [])


if __name__ == "__main__":
    unittest.main()
