"""A run is for a GPU, unless it is a dry one; without any, the error lists what was found and what to do."""

from __future__ import annotations

import pytest

from benchmarks.gpu.choice import chosen
from svgf_cl.device import devices
from svgf_cl.device.devices import DeviceReport, list_devices
from svgf_cl.errors import DeviceError


@pytest.fixture(autouse=True)
def free_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(devices.VARIABLE, raising=False)


def report(name: str, kind: str = "CPU", reason: str = "") -> DeviceReport:
    return DeviceReport("9:0", "A", "OpenCL 3.0", name, "1.0", kind, reason)


@pytest.fixture
def ranked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Devices that only pretend are ranked by their names."""
    monkeypatch.setattr(devices, "_rank", lambda report: report.device)


@pytest.mark.usefixtures("ranked")
def test_the_fastest_gpu_that_works_is_chosen() -> None:
    found = [report("a CPU"), report("b", "GPU", "it is broken"), report("d", "GPU"), report("c", "GPU")]
    assert chosen(found, dry_run=False).device == "c"
    assert chosen(found, dry_run=True).device == "a CPU"


def test_without_a_gpu_the_error_lists_what_there_is_and_what_to_do() -> None:
    found = [report("a CPU"), report("b", "GPU", "it is broken")]
    with pytest.raises(DeviceError, match="no GPU works with OpenCL") as error:
        chosen(found, dry_run=False)
    for words in ("a CPU (A, 1.0): works", "b (A, 1.0): it is broken", "--dry-run", "svgf-cl devices"):
        assert words in str(error.value)
    with pytest.raises(DeviceError, match="no device at all"):
        chosen([], dry_run=False)


def test_a_cpu_by_name_is_for_dry_runs_only(monkeypatch: pytest.MonkeyPatch) -> None:
    found = list_devices()
    cpu = next(each for each in found if each.works and each.kind == "CPU")
    monkeypatch.setenv(devices.VARIABLE, cpu.selector)
    assert chosen(found, dry_run=True) == cpu
    with pytest.raises(DeviceError, match="--device: expected a GPU, got the CPU ") as error:
        chosen(found, dry_run=False)
    assert cpu.device in str(error.value)
