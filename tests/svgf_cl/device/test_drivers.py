"""Where drivers are looked for, among files that only pretend."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from svgf_cl.device import drivers
from svgf_cl.device.drivers import AMD, INTEL, NVIDIA, Driver


@pytest.fixture(autouse=True)
def unknown_to_the_linker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ctypes.util.find_library", lambda _: None)


def among(driver: Driver, kernel: Path, *folders: Path) -> Driver:
    return replace(driver, kernel=(str(kernel.parent / "never"), str(kernel)), folders=lambda: iter(folders))


def test_the_first_folder_that_has_it_counts(tmp_path: Path) -> None:
    kernel = tmp_path / "nvidiactl"
    kernel.touch()
    folders = [tmp_path / name for name in ("empty", "first", "second")]
    for folder in folders:
        folder.mkdir()
    for folder in folders[1:]:
        (folder / NVIDIA.library).touch()
    driver = among(NVIDIA, kernel, *folders)
    assert driver.find() == str(tmp_path / "first" / NVIDIA.library)
    assert driver.why_missing() == ""


def test_without_the_systems_part_no_library_is_looked_for(tmp_path: Path) -> None:
    (tmp_path / NVIDIA.library).touch()
    driver = among(NVIDIA, tmp_path / "nvidiactl", tmp_path)
    assert driver.find() is None
    assert driver.why_missing() == ""


def test_what_only_the_linker_knows_goes_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr("ctypes.util.find_library", lambda name: asked.append(name) or "libnvidia-opencl.so.1")
    (tmp_path / "nvidiactl").touch()
    assert among(NVIDIA, tmp_path / "nvidiactl", tmp_path).find() == "libnvidia-opencl.so.1"
    assert asked == ["nvidia-opencl"]


@pytest.mark.parametrize("driver", [NVIDIA, AMD], ids=lambda driver: driver.name)
def test_the_systems_part_alone_is_named_with_the_remedy(driver: Driver, tmp_path: Path) -> None:
    kernel = tmp_path / "kernel"
    kernel.touch()
    reason = among(driver, kernel, tmp_path).why_missing()
    assert reason == f"{kernel} shows that the system has the driver, but {driver.library} is missing: {driver.remedy}"
    assert "install" in driver.remedy


def test_folders_of_a_container_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LD_LIBRARY_PATH", f"/mine{os.pathsep}{os.pathsep}/other")
    folders = list(drivers.of_nvidia())
    assert folders[:2] == [Path("/mine"), Path("/other")]
    assert Path("/usr/local/nvidia/lib64") in folders
    assert Path() not in folders
    assert all(folder.is_absolute() for folder in (*folders, *drivers.of_rocm()))


def test_a_users_site_that_is_out_of_bounds_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    def forbid(path: Path, **_: object) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(os, "stat", forbid)
    assert INTEL.find() is None
