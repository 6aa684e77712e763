"""Fields that are upside down, or of another frame."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from svgf_cl.check.alignment import FIELDS, PUNCTUAL, UPRIGHT
from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding
from tests.tracer.check.scenes import asked, good

FRAMES = [taken.frame for taken in good("cornell")]


@pytest.mark.parametrize("field", FIELDS)
def test_a_field_that_is_upside_down(field: str) -> None:
    wrong = [replace(frame, **{field: np.flipud(getattr(frame, field))}) for frame in FRAMES]
    assert [(found.field, found.what[:11]) for found in asked(UPRIGHT, wrong)] == [(field, "upside down")]


@pytest.mark.parametrize("field", FIELDS)
def test_a_field_of_the_frame_before(field: str) -> None:
    wrong = [replace(frame, **{field: getattr(before, field)}) for before, frame in pairwise(FRAMES)]
    assert [found.field for found in asked(PUNCTUAL, wrong)] == [field]


@pytest.mark.parametrize("check", [UPRIGHT, PUNCTUAL])
def test_fields_as_they_should_be(check: Check) -> None:
    assert not [verdict for verdict in asked(check, FRAMES) if isinstance(verdict, Finding)]
