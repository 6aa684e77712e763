"""Open Image Denoise through pyoidn does what it is asked for."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from svgf_cl import Frame, SvgfError
from svgf_cl.compare import oidn
from svgf_cl.compare.oidn import QUALITIES, OidnFilter, require_oidn
from svgf_cl.io.synthetic import room_frames

SHAPE = (45, 80)


@pytest.fixture(scope="module")
def frame() -> Frame:
    return next(room_frames(SHAPE, 1))


def test_what_to_install_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(SvgfError, match=r"pip install 'svgf-cl\[oidn\]'"):
        require_oidn()


@pytest.mark.parametrize("quality", QUALITIES)
def test_noise_goes_and_light_stays(frame: Frame, quality: str) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    rival = OidnFilter(SHAPE, quality, threads=1)
    clean = rival.denoise(frame)
    light = 0.5 * frame.albedo  # what the room's noise averages to
    assert np.abs(clean - light).mean() < 0.2 * np.abs(frame.color - light).mean()
    assert clean.mean() == pytest.approx(light.mean(), rel=0.1)
    assert "1 threads" in rival.description


def test_errors_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    monkeypatch.setattr(oidn, "INPUTS", ("albedo", "normal"))  # no filter without a color
    with pytest.raises(SvgfError, match="Open Image Denoise: "):
        OidnFilter(SHAPE, "fast", threads=1)


def test_memory_is_that_of_the_network() -> None:
    """Its activations outweigh the images. In a process of its own: here it might get memory that others gave back."""
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    script = "from svgf_cl.compare.oidn import OidnFilter; print(OidnFilter((360, 640), 'fast', threads=1).nbytes)"
    nbytes = int(subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout)
    assert 100 < nbytes / (640 * 360) < 2000
