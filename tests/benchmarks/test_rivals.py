"""Every filter takes part, with antialiasing too where it is asked for, and each as it is."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import rivals
from svgf_cl import Denoiser, Eaw, Settings, SvgfError
from svgf_cl.filters import FILTERS
from svgf_cl.io.synthetic import room_frames

SHAPE = (40, 64)


def test_every_filter_and_the_papers_take_part() -> None:
    chosen = rivals.parse_filters(rivals.USUAL)
    assert list(chosen) == ["svgf,taps=5x5", *FILTERS]
    assert chosen["svgf,taps=5x5"] == Settings(taps="5x5")
    assert all(chosen[name] == kind() for name, kind in FILTERS.items())


def test_each_filter_gets_a_double_that_is_antialiased() -> None:
    texts = rivals.antialiased(["svgf,taps=5x5", "eaw,sigma_color=0.5", "svgf,taa=on"])
    assert texts == [
        "svgf,taps=5x5",
        "eaw,sigma_color=0.5",
        "svgf,taa=on",
        "svgf,taps=5x5,taa=on",
        "eaw,sigma_color=0.5,taa=on",
    ]
    assert rivals.parse_filters(texts)["eaw,sigma_color=0.5,taa=on"] == Eaw(sigma_color=0.5, taa=True)


def test_what_is_no_filter_or_none_of_its_settings_is_refused() -> None:
    with pytest.raises(SvgfError, match="--filter: expected kalman or svgf or"):
        rivals.parse_filters(["nlm"])
    with pytest.raises(SvgfError, match="--set"):
        rivals.parse_filters(["svgf,colour=red"])
    with pytest.raises(SvgfError, match="once"):
        rivals.parse_filters(["svgf", "svgf"])


def test_accumulation_alone_is_what_comes_in_on_the_first_frame_and_a_mean_then() -> None:
    first, second = room_frames(SHAPE, 2)
    maker = rivals.Accumulated(SHAPE)
    np.testing.assert_allclose(maker.denoise(first), first.color, rtol=1e-4, atol=1e-5)
    picture = maker.denoise(second)
    assert not np.allclose(picture, second.color, rtol=0.1)
    assert np.var(picture) < np.var(second.color)


def test_rivals_make_their_own_pictures_and_note_their_times() -> None:
    taking_part = rivals.rivals({"a": Settings(), "b": Settings(iterations=1)}, SHAPE, oidn=False)
    assert list(taking_part) == [rivals.NOISY, rivals.ACCUMULATED, "a", "b"]
    (frame,) = room_frames(SHAPE, 1)
    pictures = {name: rival.denoise(frame) for name, rival in taking_part.items()}
    assert pictures[rivals.NOISY] is frame.color
    np.testing.assert_array_equal(pictures["b"], Denoiser(SHAPE, settings=Settings(iterations=1)).denoise(frame))
    assert [len(rival.device) for rival in taking_part.values()] == [0, 0, 1, 1]
    assert all(len(rival.call) == 1 for rival in taking_part.values())


def test_open_image_denoise_takes_part_where_it_is_installed() -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install '.[oidn]'")
    taking_part = rivals.rivals({"a": Settings()}, SHAPE, oidn=True)
    (frame,) = room_frames(SHAPE, 1)
    assert list(taking_part)[-1] == rivals.OIDN
    assert taking_part[rivals.OIDN].denoise(frame).var() < frame.color.var()
