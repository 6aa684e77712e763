"""Converts pydantic's errors to one line: the field, what was expected, what was found."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

MANUAL = "docs/scene_description.md"
LONGEST = 80  # the most characters of a found value that are shown


def complaint(error: ValidationError, text: bytes) -> str:
    """One line that says what is wrong with the JSON `text`."""
    # If a value may have one of two forms, both report errors; the form that was parsed further is the intended one.
    detail = max(error.errors(include_url=False), key=lambda one: len(one["loc"]))
    if detail["type"] == "json_invalid":
        return detail["msg"]
    place = _path(json.loads(text), detail["loc"])
    if detail["type"] == "missing":
        name = detail["loc"][-1]
        place += f"[{name}]" if isinstance(name, int) else f".{name}"
    return f"{place.removeprefix('.') or 'the file'}: {_reason(detail)}"


def _reason(detail: ErrorDetails) -> str:
    context = detail.get("ctx", {})
    if detail["type"] == "missing":
        return f"expected a value, found none; {MANUAL} describes it"
    if detail["type"] == "extra_forbidden":
        return f"expected a field that is known, found one that is not; {MANUAL} has them all"
    if detail["type"] == "union_tag_not_found":
        return f"expected a field {context['discriminator']}, found none; {MANUAL} has its values"
    if detail["type"] == "union_tag_invalid":
        return f"expected {context['discriminator']} to be one of {context['expected_tags']}, found '{context['tag']}'"
    if detail["type"] == "value_error":
        return detail["msg"].removeprefix("Value error, ")
    expected = re.sub("^(Input|List) should (be |have )?| after validation.*", "", detail["msg"])
    return f"expected {expected}, found {_shown(detail['input'])}"


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 4] + " ..."


def _path(document: Any, location: Sequence[int | str]) -> str:
    """A place in the file as one would write it, ``lights[1].radiance``, without pydantic's names of variants."""
    path, here = "", document
    for step in location:
        if isinstance(here, list) and isinstance(step, int) and step < len(here):
            path, here = f"{path}[{step}]", here[step]
        elif isinstance(here, dict) and step in here:
            path, here = f"{path}.{step}", here[step]
    return path
