"""`plan.json` follows its schema, names nothing that is not there, and says who has memory when."""

from __future__ import annotations

import itertools
import json
from importlib import resources
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as effort

from svgf_cl import Inputs, Kalman, Lbf, Settings
from svgf_cl.device.layout import Layout
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.export.document import SCHEMA, constant_arrays, data_files, document
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import SPLITS
from svgf_cl.filters.temporal import UNKNOWN
from svgf_cl.schedule import Schedule
from tests.frames import SHAPE
from tests.svgf_cl.filters.strategies import every_filter, every_inputs

VALIDATOR = jsonschema.Draft202012Validator(
    json.loads((resources.files("svgf_cl.export") / SCHEMA).read_text(encoding="utf-8"))
)
SPLIT = Inputs(signals=SPLITS[0], albedo=True)


def schedule_of(settings: Filter, inputs: Inputs) -> Schedule:
    return Schedule(settings.pipeline(inputs), Layout(*SHAPE), GPU_TUNING)


def document_of(settings: Filter, inputs: Inputs) -> dict[str, Any]:
    """As it is read from its file."""
    found = json.loads(json.dumps(document(schedule_of(settings, inputs), settings)))
    assert isinstance(found, dict)
    return found


def test_the_schema_is_one() -> None:
    VALIDATOR.check_schema(VALIDATOR.schema)


@effort(deadline=None, max_examples=25)
@given(every_filter, every_inputs)
def test_it_follows_its_schema_and_names_what_is_there(settings: Filter, inputs: Inputs) -> None:
    plan = document_of(settings, inputs)
    VALIDATOR.validate(plan)
    lists = {"memory": plan["memory"], "array": plan["arrays"], "constant": plan["constants"]}
    for launch in plan["launches"]:
        assert launch["program"] < len(plan["programs"])
        for argument in launch["arguments"]:
            kind = argument["kind"]
            if kind in lists:
                assert np.max(argument[kind]) < len(lists[kind])
    for fill in plan["cut"]:
        assert all(fill["offset"] + fill["bytes"] <= plan["memory"][piece]["bytes"] for piece in fill["memory"])
    *inputs_, output = plan["arrays"]
    assert output["is_output"]
    assert not any(array["is_output"] for array in inputs_)


@effort(deadline=None, max_examples=25)
@given(every_filter, every_inputs)
def test_buffers_that_share_memory_have_it_one_after_another(settings: Filter, inputs: Inputs) -> None:
    """Or the one is written where the other is read, pixel by pixel, in one launch."""
    buffers = document_of(settings, inputs)["buffers"]
    for one, other in itertools.combinations(buffers, 2):
        if one["memory"][0] == other["memory"][0]:
            earlier, later = sorted((one, other), key=lambda buffer: buffer["launches"])
            assert earlier["launches"][1] <= later["launches"][0]


def test_floats_are_the_floats_that_kernels_are_given() -> None:
    plan = document_of(Kalman(alpha_color=0.1), Inputs())
    found = {each["name"]: each for launch in plan["launches"] for each in launch["arguments"]}["alpha_color"]
    assert found["value"] != 0.1
    assert np.float32(found["value"]) == np.float32(0.1)
    assert found["value"] == float(np.float32(0.1))


@pytest.mark.parametrize("settings", [Settings(taa=True), Kalman(taa=True, half_history=True)], ids=str)
def test_a_cut_has_the_bytes_of_what_is_unknown(settings: Filter) -> None:
    (fill,) = document_of(settings, SPLIT)["cut"]
    assert bytes(fill["pattern"]) == np.array(UNKNOWN, "<f4").tobytes()
    assert np.float32(fill["value"]) == np.float32(UNKNOWN)


def test_files_are_those_that_it_names() -> None:
    schedule = schedule_of(Lbf(), SPLIT)
    plan = document(schedule, Lbf())
    files = data_files(schedule)
    assert {*files} == {*plan["programs"], *(each["file"] for each in plan["constants"])}
    for each, values in zip(plan["constants"], constant_arrays(schedule.pipeline).values(), strict=True):
        found = np.frombuffer(files[each["file"]], "<f4").reshape(each["shape"])
        np.testing.assert_array_equal(found, values)
        assert len(files[each["file"]]) == each["bytes"]
