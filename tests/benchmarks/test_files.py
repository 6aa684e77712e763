"""Both kinds of files are read as what they are, and all parts of a frame's way take some time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks import files
from benchmarks.files import blender, timed, written
from svgf_cl import Eaw
from svgf_cl.io.frames import channels_of
from svgf_cl.io.shot import Shot


@pytest.mark.parametrize(("channels", "reader"), [(channels_of, "svgf_cl"), (blender, "blender")])
def test_each_part_is_timed(channels: Callable, reader: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "DEFAULT", Eaw)  # of few kernels
    paths = written(tmp_path, channels, (18, 32), 4)
    shot = Shot(paths)
    assert shot.reading.reader.name == reader
    assert len(shot.reading.lights) >= 2
    *parts, total, whole = timed(paths, tmp_path / "out")
    assert min(*parts, whole) > 0
    assert total == pytest.approx(sum(parts))
    assert len(list((tmp_path / "out").iterdir())) == 3 + 4
