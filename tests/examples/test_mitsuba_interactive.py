"""The example for Mitsuba asks for the layers that are needed, and runs where mitsuba is installed."""

from __future__ import annotations

import re
import runpy
import sys
from importlib.util import find_spec
from pathlib import Path
from unittest.mock import MagicMock

import pytest

from svgf_cl.io.readers.mitsuba import MITSUBA
from tests.examples.running import EXAMPLES, assert_gains


def test_its_layers_are_those_that_the_reader_asks_for(monkeypatch: pytest.MonkeyPatch) -> None:
    mitsuba = MagicMock()
    mitsuba.cornell_box.return_value = {}
    monkeypatch.setitem(sys.modules, "mitsuba", mitsuba)
    example = runpy.run_path(str(EXAMPLES / "mitsuba_interactive.py"), run_name="example")
    asked = {found[1] for text in MITSUBA.switches.values() if (found := re.search(r"add \w+:(\w+) to", text))}
    assert asked == {layer.partition(":")[2] for layer in example["description"]()["integrator"]["aovs"].split(",")}


@pytest.mark.skipif(find_spec("mitsuba") is None, reason="mitsuba is not installed: pip install mitsuba")
def test_it_gains_what_it_says(tmp_path: Path) -> None:
    assert_gains("mitsuba_interactive", 8, tmp_path)
