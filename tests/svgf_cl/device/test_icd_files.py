"""Drivers that a loader passes over are named, with the reason; so are those that would end the process."""

from __future__ import annotations

import ctypes.util
import os
from pathlib import Path

import pyopencl
import pytest

from svgf_cl.device import apart, icd_files
from svgf_cl.device.devices import default_device

NO_DRIVER = ctypes.util.find_library("c") or "libc.so.6"


@pytest.fixture
def vendors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of ``.icd`` files that the loader is pointed at."""
    folder = tmp_path / "vendors"
    folder.mkdir()
    monkeypatch.setenv(icd_files.VARIABLE, f"{folder}/")
    return folder


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        ("libmissing.so\n", "names libmissing.so, which cannot be loaded: libmissing.so: cannot open shared object"),
        ("{folder}/no library\n", "names {folder}/no library, which cannot be loaded: "),
        (NO_DRIVER, f"names {NO_DRIVER}, which is no OpenCL driver: it lacks clGetExtensionFunctionAddress"),
        ("", "names no library"),
        (" \n", "names no library"),
    ],
    ids=["missing", "text", "no driver", "empty", "blank"],
)
def test_a_driver_that_cannot_be_loaded_is_named_with_the_reason(content: str, fault: str, vendors: Path) -> None:
    (vendors / "no library").write_text("hello " * 100)
    icd = vendors / "a.icd"
    icd.write_text(content.format(folder=vendors))
    ((name, found),) = icd_files.faults()
    assert name == str(icd)
    assert found.startswith(fault.format(folder=vendors))


def test_a_file_that_cannot_be_read_hides_no_other(vendors: Path) -> None:
    (vendors / "dangling.icd").symlink_to(vendors / "nowhere")
    (vendors / "folder.icd").mkdir()
    (vendors / "missing.icd").write_text("libmissing.so\n")
    reasons = {os.path.basename(name): fault for name, fault in icd_files.faults()}
    assert reasons["dangling.icd"] == "cannot be read (No such file or directory)"
    assert reasons["folder.icd"] == "cannot be read (Is a directory)"
    assert reasons["missing.icd"].startswith("names libmissing.so")


def test_a_variable_that_leads_nowhere_is_named(vendors: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ((name, fault),) = icd_files.faults()
    assert name == f"{icd_files.VARIABLE}={vendors}/"
    assert fault == "has no .icd file; unset it for those in /etc/OpenCL/vendors"
    for place, words in ((vendors / "absent", "cannot be loaded"), (vendors / "absent.icd", "cannot be read")):
        monkeypatch.setenv(icd_files.VARIABLE, str(place))
        ((name, fault),) = icd_files.faults()
        assert str(place) in name
        assert words in fault


def test_a_driver_that_crashes_ends_only_the_process_that_asks(vendors: Path) -> None:
    """A library that was not copied whole: behind its end there is nothing to read."""
    cut = vendors / "cut.so"
    cut.write_bytes(Path(pyopencl._cl.__file__).read_bytes()[:100_000])
    (vendors / "a.icd").write_text(f"{cut}\n")
    with pytest.raises(apart.NoAnswerError, match=rf"{cut}: when it is loaded, the driver crashes \(SIG"):
        icd_files.faults()


def test_nothing_is_wrong_with_the_driver_in_use(monkeypatch: pytest.MonkeyPatch) -> None:
    assert default_device()
    assert not [fault for name, fault in icd_files.faults() if "intel" in name or "pocl" in name]
