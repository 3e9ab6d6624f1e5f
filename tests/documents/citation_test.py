#!/usr/bin/env python3
"""How to cite mbk: one version and one date everywhere; CITATION.cff, codemeta.json, paper and `mbk --cite` agree.

Version and date are set in CMakeLists.txt. For a release, change them there and in the files that this test compares.
"""

import datetime
import json
import os
import pathlib
import re
import subprocess
import tomllib
import unittest

import fastjsonschema
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
CMAKE = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
VERSION = re.search(r"project\(mbk VERSION (\S+)", CMAKE)[1]
RELEASED = re.search(r"set\(MBK_RELEASE_DATE (\S+)\)", CMAKE)[1]
DESCRIPTION = re.search(r'DESCRIPTION "([^"]+)"', CMAKE)[1]

TEXT = {"type": "string", "minLength": 1}
PERSON_OR_ENTITY = {
    "oneOf": [
        {"required": ["name"], "additionalProperties": False, "properties": {"name": TEXT}},
        {"required": ["family-names"], "additionalProperties": False, "properties": {
            "family-names": TEXT, "given-names": TEXT,
            "orcid": {"pattern": r"^https://orcid\.org/\d{4}-\d{4}-\d{4}-\d{3}[\dX]$"}}},
    ]}
AUTHORS = {"type": "array", "minItems": 1, "items": PERSON_OR_ENTITY}
#: The keys of the Citation File Format 1.2.0 that CITATION.cff uses. All values are read as text.
CFF = {
    "type": "object", "additionalProperties": False,
    "required": ["cff-version", "message", "title", "authors", "version", "date-released"],
    "properties": {
        "cff-version": {"const": "1.2.0"}, "type": {"const": "software"}, "message": TEXT, "title": TEXT, "abstract": TEXT,
        "version": TEXT, "date-released": {"pattern": r"^\d{4}-(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])$"},
        "license": {"const": "BSD-3-Clause"}, "authors": AUTHORS, "repository-code": {"pattern": "^https?://"},
        "keywords": {"type": "array", "minItems": 1, "uniqueItems": True, "items": TEXT},
        "references": {"type": "array", "minItems": 1, "items": {
            "type": "object", "additionalProperties": False, "required": ["type", "title", "authors"],
            "properties": {"type": {"const": "thesis"}, "thesis-type": TEXT, "title": TEXT, "authors": AUTHORS,
                           "institution": {"type": "object", "required": ["name"], "additionalProperties": False,
                                           "properties": {"name": TEXT}},
                           "year": {"pattern": r"^\d{4}$"}, "notes": TEXT}}},
    }}
check_cff = fastjsonschema.compile(CFF)


def citation():
    """CITATION.cff with every value as text."""
    return yaml.load((ROOT / "CITATION.cff").read_text(encoding="utf-8"), yaml.BaseLoader)


def codemeta():
    return json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))


class Versions(unittest.TestCase):
    def test_the_date_is_a_day(self):
        self.assertEqual(datetime.date.fromisoformat(RELEASED).isoformat(), RELEASED)

    def test_citation_and_codemeta_have_version_and_date_of_the_project(self):
        self.assertEqual((citation()["version"], citation()["date-released"]), (VERSION, RELEASED))
        self.assertEqual((codemeta()["version"], codemeta()["dateModified"]), (VERSION, RELEASED))

    def test_the_python_package_takes_its_version_from_the_project(self):
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        self.assertTrue("version" in project.get("dynamic", []) or project.get("version") == VERSION)
        self.assertEqual(project["description"], DESCRIPTION)

    def test_the_changelog_begins_with_this_version_or_the_one_in_preparation(self):
        heading = re.search(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)[1]
        number, state = re.fullmatch(r"(\d+\.\d+\.\d+) \((in preparation|\d{4}-\d\d-\d\d)\)", heading).groups()
        if state != "in preparation":
            self.assertEqual((number, state), (VERSION, RELEASED))
        else:
            later, current = (tuple(map(int, one.split("."))) for one in (number, VERSION))
            self.assertGreaterEqual(later, current)


class Citation(unittest.TestCase):
    def test_it_has_the_form_of_the_citation_file_format(self):
        check_cff(citation())

    def test_the_check_can_fail(self):
        for wrong in ({"date-released": "29.11.2026"}, {"authors": []}, {"authors": [{"name": "A", "orcid": "0000"}]},
                      {"licence": "BSD-3-Clause"}):
            with self.subTest(wrong), self.assertRaises(fastjsonschema.JsonSchemaException):
                check_cff({**citation(), **wrong})

    def test_codemeta_says_the_same(self):
        cff, meta = citation(), codemeta()
        self.assertEqual(meta["@context"], "https://w3id.org/codemeta/3.0")
        self.assertEqual(meta["@type"], "SoftwareSourceCode")
        self.assertEqual([one["name"] for one in meta["author"]], [one["name"] for one in cff["authors"]])
        self.assertEqual(meta["license"], "https://spdx.org/licenses/" + cff["license"])
        self.assertEqual(meta["keywords"], cff["keywords"])
        self.assertEqual(meta["description"], DESCRIPTION)
        self.assertEqual(cff["title"], "mbk: " + DESCRIPTION[0].lower() + DESCRIPTION[1:])
        thesis, publication = cff["references"][0], meta["referencePublication"]
        self.assertEqual((publication["name"], publication["datePublished"]), (thesis["title"], thesis["year"]))
        self.assertEqual(publication["author"]["familyName"], thesis["authors"][0]["family-names"])

    @unittest.skipUnless("MBK" in os.environ, "MBK does not name the program")
    def test_the_program_prints_the_same_entries(self):
        printed = subprocess.run([os.environ["MBK"], "--cite"], capture_output=True, text=True, check=True).stdout
        entries = bibtex_entries(printed)
        cff = citation()
        thesis = cff["references"][0]
        self.assertEqual(list(entries), ["mbk", "Dyck2013"])
        program = entries["mbk"]
        self.assertEqual(program["title"], cff["title"])
        self.assertEqual(program["author"], cff["authors"][0]["name"])
        self.assertEqual(program["year"], RELEASED[:4])
        self.assertTrue(program["note"].endswith(f" {VERSION}"), program["note"])
        self.assertEqual(program.get("url"), cff.get("repository-code"))
        self.assertEqual(entries["Dyck2013"], {
            "kind": "mastersthesis", "title": thesis["title"], "school": thesis["institution"]["name"], "year": thesis["year"],
            "author": ", ".join(thesis["authors"][0][part] for part in ("family-names", "given-names"))})


class Paper(unittest.TestCase):
    """paper/paper.md in the form of the Journal of Open Source Software."""

    text = (ROOT / "paper/paper.md").read_text(encoding="utf-8")

    @classmethod
    def setUpClass(cls):
        front, cls.body = re.fullmatch(r"---\n(.*?)\n---\n(.*)", cls.text, re.S).groups()
        cls.front = yaml.load(front, yaml.BaseLoader)
        cls.entries = bibtex_entries((ROOT / "paper/paper.bib").read_text(encoding="utf-8"))

    def test_the_front_matter_agrees_with_the_citation(self):
        cff = citation()
        self.assertEqual(self.front["title"], cff["title"])
        self.assertEqual([one["name"] for one in self.front["authors"]], [one["name"] for one in cff["authors"]])
        self.assertEqual(set(cff["keywords"]) - set(self.front["tags"]), set())
        indices = {one["index"] for one in self.front["affiliations"]}
        self.assertTrue(all(one["affiliation"] in indices for one in self.front["authors"]))
        self.assertTrue((ROOT / "paper" / self.front["bibliography"]).is_file())
        day = datetime.datetime.strptime(self.front["date"], "%d %B %Y").date()
        self.assertEqual(day.isoformat(), RELEASED)

    def test_it_has_the_sections_of_the_journal(self):
        headings = re.findall(r"^# (.*)$", self.body, re.M)
        self.assertEqual(headings, ["Summary", "Statement of need", "State of the field", "Software design",
                                    "Examples and validation", "Acknowledgements", "References"])

    def test_it_is_as_long_as_the_journal_asks(self):
        words = len(self.body.split())
        self.assertTrue(750 <= words <= 1750, f"{words} words")

    def test_each_citation_is_in_the_bibliography_and_each_entry_is_cited(self):
        cited = set(re.findall(r"(?<![\w`])@([A-Za-z]+\d{4}\w?)", self.body))
        self.assertEqual(cited, set(self.entries))

    def test_each_entry_has_what_its_kind_needs(self):
        needed = {"article": "journal", "book": "publisher", "inproceedings": "booktitle", "mastersthesis": "school"}
        for key, entry in self.entries.items():
            with self.subTest(key):
                self.assertLessEqual({"author", "title", "year", needed[entry["kind"]]}, set(entry))
                self.assertTrue(key.endswith(entry["year"]))
                self.assertRegex(entry.get("doi", "10.1/x"), r"^10\.\d+/\S+$")

    def test_its_numbers_are_those_of_the_documents(self):
        for page, numbers in {
                "docs/guide/reproduce.md": ["74 exhibits", "401 printed numbers"],
                "docs/theory/identification.md": ["93.55 to 94.10 %", "93.90 to 95.10 %", "93.95 to 94.55 %"],
                "docs/guide/limits.md": ["5 to 11 % too large"],
                "docs/guide/your_files.md": ["104.0 ± 6.9 N·m/rad", "86 %", "94.94 ± 0.53 kg", "95.11 kg"],
                "CHANGELOG.md": ["About 50 warnings"], "examples/README.md": ["Eleven"]}.items():
            text = (ROOT / page).read_text(encoding="utf-8")
            for number in numbers:
                with self.subTest(page=page, number=number):
                    self.assertIn(number, text)
                    self.assertIn(number.split()[0], self.body)


def bibtex_entries(text):
    """Each entry by its key: its kind and its fields, without braces."""
    entries = {}
    for kind, key, body in re.findall(r"^@(\w+)\{([^,\s]+),\n(.*?)^\}", text, re.S | re.M):
        fields = re.findall(r"^\s*([\w-]+)\s*=\s*\{(.*?)\},?$", body, re.M)
        entries[key] = {"kind": kind, **{name: re.sub(r"[{}]", "", value) for name, value in fields}}
    return entries


if __name__ == "__main__":
    unittest.main()
