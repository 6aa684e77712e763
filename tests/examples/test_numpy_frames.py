"""The example of numpy arrays runs as it stands."""

from __future__ import annotations

from pathlib import Path

from tests.examples.running import assert_gains


def test_it_gains_what_it_says(tmp_path: Path) -> None:
    assert_gains("numpy_frames", 20, tmp_path)
