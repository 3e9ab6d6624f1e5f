"""The reference of the JSON documents, from the schemas that the build makes: a page for each, a table for each type."""

import json


def cell(text):
    return str(text).replace("|", "\\|").replace("<", "\\<").replace("*", "\\*").replace("_", "\\_").replace("\n", " ")


def joined(kinds):
    return " or ".join(dict.fromkeys(kinds))


def kind(schema):
    """What a field is: "number or null", "list of Reach", "one of …"."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "enum" in schema:
        return joined("null" if one is None else f"`{json.dumps(one, ensure_ascii=False)}`" for one in schema["enum"])
    for key in ("anyOf", "oneOf"):
        if key in schema:
            return joined(map(kind, schema[key]))
    types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    if types == ["array"]:
        count = f"{schema['minItems']} of " if "minItems" in schema else ""
        return f"list of {count}{kind(schema['items'])}"
    if types == ["object"] and isinstance(schema.get("additionalProperties"), dict):
        return f"object: name → {kind(schema['additionalProperties'])}"
    return joined(types)


def rows(schema, before=""):
    """A row for each field; those of an object that has no name stand below it as "interval.low"."""
    for name, field in schema.get("properties", {}).items():
        always = "" if name in schema.get("required", ()) else "may be absent"
        yield f"| `{before}{name}` | {kind(field)} | {cell(field.get('description', ''))} | {always} |"
        inner = field.get("items", field)
        yield from rows(inner, f"{before}{name}{'[].' if inner is not field else '.'}")


def body(schema):
    fields = "\n".join(rows(schema))
    if fields:
        return f"| Field | Type | Meaning | Presence |\n|---|---|---|---|\n{fields}\n"
    return f"{kind(schema)}\n"


def pages(schemas):
    """Names of pages and their text.   schemas: the folder of the build"""
    made, listed = {}, []
    files = sorted(schemas.glob("*.schema.json"))
    if not files:
        raise SystemExit(f"{schemas} holds no schemas; build the target mbk_schema_files")
    for file in files:
        schema = json.loads(file.read_text(encoding="utf-8"))
        name, meaning = file.name.removesuffix(".schema.json"), cell(schema.get("description", ""))
        text = [f"# {name}\n\n{meaning}\n\n{body(schema)}"]
        for title, one in sorted(schema.get("definitions", {}).items()):
            text.append(f"## {title}\n\n{cell(one.get('description', ''))}\n\n{body(one)}")
        made[f"documents/{name}"] = "\n".join(text)
        listed.append(f"| [{name}]({name}.md) | {meaning} |\n")
    names = "\n".join(page.split("/")[1] for page in made)
    made["documents/index"] = (
        "# JSON documents\nEvery document that mbk writes, field by field, from its [schema](../guide/reference.md#json-documents).\n\n"
        f"| Schema | Of |\n|---|---|\n{''.join(listed)}\n```{{toctree}}\n:hidden:\n\n{names}\n```\n")
    return made
