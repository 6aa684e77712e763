"""The example of a renderer on the device runs as it stands."""

from __future__ import annotations

from pathlib import Path

from tests.examples.running import assert_gains


def test_it_gains_what_it_says(tmp_path: Path) -> None:
    assert_gains("pyopencl_renderer", 12, tmp_path)
