"""A forked process is told so at once; one that was started afresh, or forked before OpenCL was used, is not."""

from __future__ import annotations

import os

import pytest

from svgf_cl import DeviceError
from svgf_cl.device import process


@pytest.fixture(autouse=True)
def untouched(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if nobody had used OpenCL yet."""
    monkeypatch.setattr(process, "_first_user", [])


def test_the_first_process_goes_on() -> None:
    assert not process.is_forked()
    process.check_process()
    process.check_process()
    assert not process.is_forked()


def test_another_process_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    process.check_process()
    monkeypatch.setattr(os, "getpid", lambda: -1)  # as in a child
    assert process.is_forked()
    with pytest.raises(DeviceError, match=r"forked from one that had used OpenCL.*get_context\('spawn'\)"):
        process.check_process()


def test_a_child_of_a_process_that_never_used_opencl_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "getpid", lambda: -1)
    process.check_process()
    assert not process.is_forked()
