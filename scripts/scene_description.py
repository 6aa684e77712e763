"""Writes docs/scene_description.md from the models that check a scene.json."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from svgf_cl.io.atomic import write_text
from svgf_cl_tracer.description import SceneDescription

TARGET = Path("docs/scene_description.md")

INTRODUCTION = """# scene.json

Made by `make docs` (`python scripts/scene_description.py`) from `tracer/svgf_cl_tracer/description`; do not edit.

A file `scene.json` beside a model describes what the model's own file does not contain.
This may be a camera, lights, materials and animation.
`svgf-cl render FOLDER` reads both.

Numbers and booleans have no quotes.
A field that is not listed here is an error.
Colours are linear, with the primaries of sRGB.
Radiance has no absolute unit, but all radiance in a scene has the same unit.
"""

# Fields that say which kind of object this is.
TAGS = ("type", "kind")

QUOTE = '"'


def page() -> str:
    """The whole page."""
    schema = SceneDescription.model_json_schema()
    parts = schema.pop("$defs")
    in_order = dict.fromkeys(re.findall(r'"\$ref": "#/\$defs/(\w+)"', json.dumps(schema)))
    return INTRODUCTION + "".join(section(part, parts) for part in [schema, *(parts[name] for name in in_order)])


def section(part: dict[str, Any], parts: dict[str, Any]) -> str:
    """One object: a sentence, and a table with a row for each field; the kind of object comes first."""
    fields = sorted(part["properties"].items(), key=lambda item: item[0] not in TAGS)
    rows = [
        f"| `{name}` | {field.get('description', 'The kind of object.')} | {values(field, parts)} | {default(field)} |"
        for name, field in fields
    ]
    head = ["| field | meaning | values | default |", "|---|---|---|---|"]
    return "\n".join([f"\n## {part['title']}\n{part['description']}\n", *head, *rows]) + "\n"


def default(field: dict[str, Any]) -> str:
    """The default, or that the field is required."""
    if "default" not in field:
        return "required"
    value = field["default"]
    return "-" if value in (None, "", [], {}) else f"`{json.dumps(value).strip(QUOTE)}`"


def values(field: dict[str, Any], parts: dict[str, Any]) -> str:
    """Which values a field may have."""
    text = " or ".join(alternatives(field, parts))
    return f"{text}, {field['unit']}" if "unit" in field else text


def alternatives(field: dict[str, Any], parts: dict[str, Any]) -> Iterator[str]:
    """Each form that a value may have."""
    for name in ("anyOf", "oneOf"):
        for form in field.get(name, []):
            if form.get("type") != "null":
                yield values(form, parts)
    if "$ref" in field:
        title = parts[field["$ref"].rpartition("/")[2]]["title"]
        yield f"[{title}](#{title.lower().replace(' ', '-')})"
    elif "const" in field or "enum" in field:
        yield from (f"`{json.dumps(value).strip(QUOTE)}`" for value in field.get("enum", [field.get("const")]))
    elif "prefixItems" in field:
        yield f"{len(field['prefixItems'])} of: {values(field['prefixItems'][0], parts)}"
    elif "items" in field:
        yield f"a list of: {values(field['items'], parts)}"
    elif "additionalProperties" in field:
        yield f"by name: {values(field['additionalProperties'], parts)}"
    elif "type" in field:
        yield f"{field['type']}{limits(field)}"


def limits(field: dict[str, Any]) -> str:
    """The range of a number."""
    if {"minimum", "maximum"} <= field.keys():
        low, high = field["minimum"], field["maximum"]
        return f" in {low}..{high}" if low < high else f", {low}"
    signs = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}
    return " and".join(f" {sign} {field[name]}" for name, sign in signs.items() if name in field)


def main() -> None:
    """Write the page."""
    write_text(TARGET, page())
    print(TARGET)


if __name__ == "__main__":
    main()
