"""Documents of mbk against the JSON Schemas that are installed, as a script of a user's own does it."""

import functools
import json
import os
import pathlib
import re

try:
    import fastjsonschema
    import jsonschema
except ImportError as error:
    raise SystemExit(f"{error}; Debian's packages are python3-fastjsonschema and python3-jsonschema") from error

FOLDER = pathlib.Path(os.environ["MBK"]).resolve().parents[1] / "schemas"


@functools.lru_cache(maxsize=None)
def validator(name):
    schema = json.loads((FOLDER / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


@functools.lru_cache(maxsize=None)
def quick(name):
    """Does the same in less time, and says little of what is wrong."""
    return fastjsonschema.compile(validator(name).schema)


def check(document, name=None):
    """AssertionError where a document does not fit the schema `name`, by default the one that it names."""
    if name is None:
        name = re.fullmatch(r"mbk\.(\w+)/\d+", document["schema"]).group(1)
    try:
        quick(name)(document)
    except fastjsonschema.JsonSchemaValueException as refused:
        error = jsonschema.exceptions.best_match(validator(name).iter_errors(document))
        if error is None:
            raise AssertionError(f"{name}.schema.json: {refused}, which jsonschema takes") from refused
        place = "/".join(map(str, error.absolute_path))
        raise AssertionError(f"{name}.schema.json: at /{place}: {error.message[:600]}") from None


def check_printed(text):
    """The same of what a program wrote, where it is a document that names its schema."""
    if not text.startswith("{"):
        return
    document = json.loads(text)
    if "schema" in document:
        check(document)
