"""Caches of pyopencl and PoCL that cannot be written are done without; those that can are left alone."""

from __future__ import annotations

import os
from pathlib import Path

import pyopencl as cl
import pytest

from svgf_cl.device import driver_caches
from svgf_cl.device.driver_caches import POCL_VARIABLE, do_without


@pytest.fixture
def caches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, untold: None) -> Path:
    """The folder of the user's caches; nothing is set, and temporary folders are not deleted."""
    folder = tmp_path / "caches"
    monkeypatch.setattr(driver_caches, "users_folder", lambda name: folder / name)
    monkeypatch.setattr(driver_caches, "temporary_folder", lambda: tmp_path / "instead")
    monkeypatch.setattr(cl, "_PYOPENCL_NO_CACHE", False)
    monkeypatch.setenv(POCL_VARIABLE, "to be restored")
    monkeypatch.delenv(POCL_VARIABLE)
    return folder


def test_caches_that_can_be_written_are_left_alone(caches: Path) -> None:
    do_without()
    assert not cl._PYOPENCL_NO_CACHE
    assert POCL_VARIABLE not in os.environ
    assert not caches.exists()


@pytest.mark.parametrize(
    ("broken", "without", "elsewhere"),
    [("pyopencl", True, False), ("pytools", True, False), ("pocl", False, True), (".", True, True)],
)
def test_each_is_done_without_by_itself(
    broken: str, without: bool, elsewhere: bool, caches: Path, tmp_path: Path
) -> None:
    if broken == ".":
        caches.touch()  # a file where a folder should be
    else:
        caches.mkdir()
        (caches / broken).touch()
    do_without()
    assert without == cl._PYOPENCL_NO_CACHE
    assert os.environ.get(POCL_VARIABLE) == (str(tmp_path / "instead" / "pocl") if elsewhere else None)


def test_the_users_own_folder_for_pocl_is_tried_too(
    caches: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(POCL_VARIABLE, str(tmp_path / "mine"))
    do_without()
    assert os.environ[POCL_VARIABLE] == str(tmp_path / "mine")
    monkeypatch.setenv(POCL_VARIABLE, "/dev/null/mine")
    do_without()
    assert os.environ[POCL_VARIABLE] == str(tmp_path / "instead" / "pocl")


def test_without_a_temporary_folder_pocl_is_left_to_itself(caches: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> Path:
        raise FileNotFoundError("No usable temporary directory found")

    caches.touch()
    monkeypatch.setattr(driver_caches, "temporary_folder", none)
    do_without()
    assert POCL_VARIABLE not in os.environ
