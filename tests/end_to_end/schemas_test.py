#!/usr/bin/env python3
"""The JSON Schemas that are installed: each is one, says what it is of, and refuses what it should. What mbk prints or
writes is held to them wherever a test runs it (command.py)."""

import copy
import json
import re

import schemas
from command import Case, main, make_log, run


def every(schema):
    """Each schema within a schema."""
    yield schema
    for key, value in schema.items():
        if key in ("properties", "definitions"):
            for one in value.values():
                yield from every(one)
        elif key in ("items", "additionalProperties") and isinstance(value, dict):
            yield from every(value)
        elif key in ("anyOf", "oneOf"):
            for one in value:
                yield from every(one)


NAMES = sorted(path.name.removesuffix(".schema.json") for path in schemas.FOLDER.iterdir())


class Schemas(Case):
    def test_each_says_what_it_is_of_and_closes_its_objects(self):
        for name in NAMES:
            with self.subTest(name):
                schema = schemas.validator(name).schema
                self.assertTrue(schema["description"])
                for one in every(schema):
                    if one.get("type") == "object":
                        self.assertIn("additionalProperties", one)
                        self.assertLessEqual(set(one.get("required", ())), set(one.get("properties", ())))

    def test_there_is_one_of_each_document_that_the_help_names(self):
        said = set()
        for command in re.findall(r"^  (\w+) {2,}", run("--help").out, re.MULTILINE):
            helped = run(command, "--help").out
            said.update(re.findall(r"mbk\.\w+/\d+", helped))
            for inner in re.findall(r"^  (\w+) {2,}", helped, re.MULTILINE):
                said.update(re.findall(r"mbk\.\w+/\d+", run(command, inner, "--help").out))
        self.assertGreater(len(said), 12, said)
        for name in said:
            word = name.removeprefix("mbk.").split("/")[0]
            self.assertIn(f'"{name}"', (schemas.FOLDER / f"{word}.schema.json").read_text(encoding="utf-8"))

    def test_a_document_of_mbk_fits_and_a_changed_one_does_not(self):
        result = self.fine("measure", "--json", make_log().path).json
        schemas.check(result)
        self.assertTrue(schemas.validator("result").is_valid(result))
        for change in (lambda one: one.pop("model"), lambda one: one["model"].pop("K"),
                       lambda one: one.update(of_my_own=1), lambda one: one["passivity"]["trial"].update(verdict="maybe"),
                       lambda one: one["model"]["M"].append("1"), lambda one: one.update(usable=None)):
            wrong = copy.deepcopy(result)
            change(wrong)
            with self.assertRaises(AssertionError):
                schemas.check(wrong)
            self.assertFalse(schemas.validator("result").is_valid(wrong))

    def test_a_file_that_is_no_recording_is_listed_as_a_schema_says(self):
        table = self.file("table.csv", "alpha,beta\n" + "1,2\n" * 20)
        self.assertEqual(self.fine("info", "--json", table).json["schema"], "mbk.contents/1")


if __name__ == "__main__":
    main()
