"""A new process denoises its first frame with the caches it is given."""

from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl import Accumulation, DeviceError
from svgf_cl.bench.startup import first_frame
from svgf_cl.device import devices


@pytest.fixture
def report() -> devices.DeviceReport:
    """The default device."""
    return devices.choose(devices.list_devices())


def test_a_first_frame_fills_the_folder_it_is_given(report: devices.DeviceReport, tmp_path: Path) -> None:
    assert first_frame(report, (9, 16), Accumulation(), tmp_path) > 0
    assert any(path.is_file() for path in tmp_path.rglob("*")), "compiled kernels went elsewhere"


def test_a_process_that_fails_is_told(report: devices.DeviceReport, tmp_path: Path) -> None:
    with pytest.raises(DeviceError, match=r"(?s)could not denoise a frame:\n.*Traceback"):
        first_frame(report, (0, 16), Accumulation(), tmp_path)
