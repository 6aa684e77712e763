"""``svgf-cl formats`` lists each reader with what it reads."""

from __future__ import annotations

import pytest

from svgf_cl.cli.formats import sources
from svgf_cl.io.readers import READERS
from tests.command_line import run


def test_every_renderer_is_listed_with_its_passes(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("formats") == 0
    said = capsys.readouterr().out
    for reader in READERS.values():
        rows = [line for line in said.splitlines() if f" {reader.name} " in line]
        assert len(rows) == len(sources(reader)) == len(reader.passes) + bool(reader.lights)
        assert reader.title.split()[0] in rows[0]


def test_the_picture_without_a_layer_is_written_as_its_channels() -> None:
    assert ("color", "R G B") in sources(READERS["pbrt"])


def test_a_switch_is_told_for_every_field_that_a_renderer_s_files_may_lack() -> None:
    for reader in READERS.values():
        if reader.switches:
            assert {"normal", "depth", "motion"} <= reader.switches.keys()
