"""Documents of mbk against the JSON Schemas that are installed, as a script of a user's own does it."""

import functools
import json
import pathlib
import re

try:
    import jsonschema
except ImportError as error:
    raise SystemExit("there is no Python package jsonschema; Debian's is python3-jsonschema") from error

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "schemas"


@functools.lru_cache(maxsize=None)
def validator(name):
    path = FOLDER / f"{name}.schema.json"
    schema = json.loads(path.read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema, resolver=jsonschema.RefResolver(path.as_uri(), schema))


def check(document, name=None):
    """AssertionError where a document does not fit the schema `name`, by default the one that it names."""
    if name is None:
        name = re.fullmatch(r"mbk\.(\w+)/\d+", document["schema"]).group(1)
    error = jsonschema.exceptions.best_match(validator(name).iter_errors(document))
    if error is not None:
        place = "/".join(map(str, error.absolute_path))
        raise AssertionError(f"{name}.schema.json: at /{place}: {error.message[:600]}")


def check_printed(text):
    """The same of what a program wrote, where it is a document that names its schema."""
    if not text.startswith("{"):
        return
    document = json.loads(text)
    if "schema" in document:
        check(document)
