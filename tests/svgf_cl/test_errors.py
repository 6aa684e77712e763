"""Errors that a worker process raises arrive whole in the one that waits for it."""

from __future__ import annotations

import pickle

import pytest

from svgf_cl import ArgumentError, DeviceError, FileError, FrameError, SchedulerError, SettingsError, SvgfError


@pytest.mark.parametrize(
    "error",
    [
        FrameError("depth", "shape (3, 4)", "shape (4, 3)"),
        ArgumentError("out", "float32", "float64"),
        *(kind("a message") for kind in (SvgfError, SettingsError, DeviceError, FileError, SchedulerError)),
    ],
)
def test_an_error_is_sent_to_another_process_whole(error: SvgfError) -> None:
    """One that cannot be leaves `multiprocessing.Pool` waiting for ever."""
    sent = pickle.loads(pickle.dumps(error))
    assert (type(sent), str(sent), vars(sent)) == (type(error), str(error), vars(error))


def test_an_error_says_what_was_expected_and_what_came() -> None:
    assert str(FrameError("depth", "3", "4")) == "Frame.depth: expected 3, got 4"
    assert str(ArgumentError("out", "3", "4")) == "out: expected 3, got 4"
