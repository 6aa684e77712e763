"""Open Image Denoise through pyoidn does what it is asked for."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from benchmarks.oidn import QUALITIES, Filter, Images, require_oidn
from svgf_cl import Frame, SvgfError
from svgf_cl.room import room_frames

SHAPE = (45, 80)


@pytest.fixture(scope="module")
def frame() -> Frame:
    return next(room_frames(SHAPE, 1))


def test_what_to_install_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(SvgfError, match=r"pip install '\.\[oidn\]'"):
        require_oidn()


def test_images_are_filled_in_place(frame: Frame) -> None:
    images = Images(SHAPE)
    held = images.color
    images.load(frame)
    assert images.color is held
    for name in ("color", "albedo", "normal"):
        assert np.array_equal(getattr(images, name), getattr(frame, name))


@pytest.mark.parametrize("quality", QUALITIES)
def test_noise_goes_and_light_stays(frame: Frame, quality: str) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install '.[oidn]'")
    rival = Filter(Images(SHAPE), quality, threads=1)
    clean = rival.denoise(frame)
    light = 0.5 * frame.albedo  # what the room's noise averages to
    assert np.abs(clean - light).mean() < 0.2 * np.abs(frame.color - light).mean()
    assert clean.mean() == pytest.approx(light.mean(), rel=0.1)
    assert "1 threads" in rival.description
    assert rival.nbytes > 0


def test_errors_are_reported(frame: Frame) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install '.[oidn]'")
    images = Images(SHAPE)
    del images.color  # no filter without it
    with pytest.raises(SvgfError, match="Open Image Denoise: "):
        Filter(images, "fast", threads=1)
