"""Every filter takes part, and so does Open Image Denoise; each as it is asked for."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Denoiser, Eaw, Frame, Settings, SvgfError
from svgf_cl.cli.options import parse_settings
from svgf_cl.compare import rivals
from svgf_cl.compare.rivals import OIDN, OIDN_ACCUMULATED, Noisy, Rival, makers, parse_rivals, usual_rivals
from svgf_cl.filters import FILTERS, Accumulation
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.io.synthetic import room_frames

SHAPE = (40, 64)


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if Open Image Denoise were there."""
    monkeypatch.setattr(rivals, "require_oidn", lambda: None)


def parsed(text: str) -> list[Rival]:
    return parse_rivals(text, parse_settings)


@pytest.mark.usefixtures("installed")
def test_settings_belong_to_the_filter_before_them() -> None:
    assert parsed("svgf,taps=5x5,iterations=4,eaw,oidn,svgf,oidn+accumulation") == [
        Rival("svgf,taps=5x5,iterations=4", Settings(taps="5x5", iterations=4)),
        Rival("eaw", Eaw()),
        Rival(OIDN, None),
        Rival("svgf", Settings()),
        Rival(OIDN_ACCUMULATED, None),
    ]


@pytest.mark.usefixtures("installed")
def test_all_that_is_there_takes_part_by_default() -> None:
    assert [each.name for each in parsed(usual_rivals())] == [*FILTERS, OIDN, OIDN_ACCUMULATED]


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "expected names among kalman, .*, oidn.accumulation, got ''"),
        ("svgf,", "got ''"),
        (",svgf", "got ''"),
        ("nlm", "got 'nlm'"),
        ("taps=5x5,svgf", "got 'taps=5x5'"),
        ("svgf,svgf", "each filter once"),
        ("svgf,taps=5x5,eaw,svgf,taps=5x5", "each filter once"),
        ("svgf,colour=red", "expected NAME=VALUE with a name among"),
        ("svgf,iterations=many", "iterations: expected"),
        ("eaw,oidn,quality=fast", "no settings of oidn, got quality=fast"),
    ],
)
def test_what_is_no_list_of_filters_is_refused(text: str, complaint: str) -> None:
    with pytest.raises(SvgfError, match=f"--filters.*{complaint}"):
        parsed(text)


def test_without_open_image_denoise_it_is_left_out_and_who_asks_for_it_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    assert usual_rivals() == ",".join(FILTERS)
    with pytest.raises(SvgfError, match=r"pip install 'svgf-cl\[oidn\]'"):
        parsed("svgf,oidn+accumulation")


@pytest.mark.parametrize("jitter", [False, True])
def test_filters_antialias_where_rays_move(jitter: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[object] = []
    monkeypatch.setattr(rivals, "Filtered", lambda shape, settings: made.append((shape, settings)))
    wanted = parsed(",".join((*FILTERS, "eaw,taa=off", "svgf,taa=on")))
    assert list(makers(wanted, SHAPE, jitter=jitter)) == [each.name for each in wanted]
    temporal = [kind for kind in FILTERS.values() if issubclass(kind, TemporalFilter)]
    assert {Settings, Accumulation} <= {*temporal}
    assert made[:-2] == [
        (SHAPE, kind(taa=True) if jitter and issubclass(kind, TemporalFilter) else kind()) for kind in FILTERS.values()
    ]
    assert made[-2:] == [(SHAPE, Eaw()), (SHAPE, Settings(taa=True))]


def test_rivals_make_their_own_pictures_and_note_their_times() -> None:
    taking_part = {"noisy": Noisy(), **makers(parsed("svgf,iterations=1,accumulation"), SHAPE, jitter=False)}
    (frame,) = room_frames(SHAPE, 1)
    made = {name: each.denoise(frame) for name, each in taking_part.items()}
    assert made["noisy"] is frame.color
    alone = Denoiser(SHAPE, settings=Settings(iterations=1)).denoise(frame)
    np.testing.assert_array_equal(made["svgf,iterations=1"], alone)
    assert taking_part.pop("noisy").milliseconds is None
    assert all(each.milliseconds > 0 for each in taking_part.values())


def test_accumulation_alone_is_what_comes_in_on_the_first_frame_and_a_mean_then() -> None:
    first, second = room_frames(SHAPE, 2)
    (maker,) = makers(parsed("accumulation"), SHAPE, jitter=False).values()
    np.testing.assert_allclose(maker.denoise(first), first.color, rtol=1e-4, atol=1e-5)
    picture = maker.denoise(second)
    assert not np.allclose(picture, second.color, rtol=0.1)
    assert np.var(picture) < np.var(second.color)


class Doubling:
    """Stands for Open Image Denoise: twice what comes in."""

    milliseconds = 1000.0

    def __init__(self, shape: Sequence[int]) -> None:
        assert shape == SHAPE

    def denoise(self, frame: Frame) -> np.ndarray:
        return 2 * frame.color


@pytest.mark.parametrize("signals", [1, 2])
def test_accumulated_pictures_are_those_of_open_image_denoise(signals: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever signals the frame has beside its colour."""
    monkeypatch.setattr(rivals, "FrameByFrame", Doubling)
    maker = Rival(OIDN_ACCUMULATED, None).maker(SHAPE, jitter=False)
    same = Denoiser(SHAPE, settings=Accumulation())
    for frame in room_frames(SHAPE, 2, signals=signals):
        wanted = same.denoise(replace(frame, color=2 * frame.color, direct=None, indirect=None))
        np.testing.assert_array_equal(maker.denoise(frame), wanted)
    assert maker.milliseconds > Doubling.milliseconds, "its own, and that of accumulation"


def test_an_infinite_pixel_spoils_no_other() -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    (frame,) = room_frames(SHAPE, 1)
    color = frame.color.copy()
    color[5, 6] = np.inf
    picture = Rival(OIDN, None).maker(SHAPE, jitter=False).denoise(replace(frame, color=color))
    light = 0.5 * frame.albedo
    assert np.abs(picture - light).mean() < 0.3 * np.abs(frame.color - light).mean()


@pytest.mark.parametrize("name", [OIDN, OIDN_ACCUMULATED])
def test_open_image_denoise_takes_part_where_it_is_installed(name: str) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    (maker,) = makers(parsed(name), SHAPE, jitter=True).values()
    (frame,) = room_frames(SHAPE, 1)
    picture = maker.denoise(frame)
    light = 0.5 * frame.albedo
    assert np.abs(picture - light).mean() < 0.3 * np.abs(frame.color - light).mean()
    assert maker.milliseconds > 0
