"""Denoisers that share a device: each with a past of its own, and in tiles where its share of the memory is small."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl import Denoiser, Frame, Inputs, Kalman, SvgfError
from svgf_cl import denoisers as module
from svgf_cl.denoisers import Denoisers
from svgf_cl.device.tiling import Tiling
from svgf_cl.filters.filter import Filter
from tests.frames import PLAIN, bumpy_sequence

SHAPE = (193, 211)  # windows of tiles are smaller
SETTINGS = Kalman(iterations=1, standard_error=True)


@pytest.fixture(scope="module")
def frames() -> list[Frame]:
    return bumpy_sequence(PLAIN, count=3, shape=SHAPE)


@pytest.fixture
def little_room(frames: list[Frame], monkeypatch: pytest.MonkeyPatch) -> None:
    """The device has room for one whole frame, and half of it for tiles alone."""
    tiling = Tiling(SETTINGS.pipeline(Inputs.of(frames[0])), SHAPE, 64)
    assert tiling.least() < sum(tiling.whole())
    monkeypatch.setattr(module, "check_max_bytes", lambda limit, device: tiling.least() + sum(tiling.whole()))


def alone(frames: list[Frame], settings: Filter = SETTINGS) -> tuple[np.ndarray, np.ndarray]:
    """The last picture of a sequence, and its standard error."""
    den = Denoiser(SHAPE, settings=settings)
    return [den.denoise(frame) for frame in frames][-1], den.stage("standard_error")


def test_each_has_a_past_of_its_own(frames: list[Frame]) -> None:
    denoisers = Denoisers(SHAPE, SETTINGS)
    assert "one" not in denoisers
    for frame in frames:
        one = denoisers.denoise("one", frame)
    other = denoisers.denoise("other", frames[-1])
    np.testing.assert_array_equal(one, alone(frames)[0])
    np.testing.assert_array_equal(other, alone(frames[-1:])[0])
    assert {"one", "other"} == {key for key in ("one", "other", "third") if key in denoisers}
    denoisers.reset()
    np.testing.assert_array_equal(denoisers.denoise("one", frames[-1]), other)


def test_other_settings_are_those_of_all_and_keep_the_past(frames: list[Frame]) -> None:
    other = Kalman(iterations=2)
    denoisers = Denoisers(SHAPE, SETTINGS)
    denoisers.denoise("one", frames[0])
    denoisers.update(other)
    with Denoiser(SHAPE, settings=SETTINGS) as den:
        den.denoise(frames[0])
        den.update(other)
        np.testing.assert_array_equal(denoisers.denoise("one", frames[1]), den.denoise(frames[1]))
    np.testing.assert_array_equal(
        denoisers.denoise("new", frames[1]), Denoiser(SHAPE, settings=other).denoise(frames[1])
    )


@pytest.mark.usefixtures("little_room")
def test_what_is_denoised_in_tiles_begins_anew_with_other_settings(frames: list[Frame]) -> None:
    other = Kalman(iterations=1, sigma_luminance=2.0)
    denoisers = Denoisers(SHAPE, SETTINGS, share=0.5)
    with pytest.warns(UserWarning, match="tiles"):
        denoisers.denoise("one", frames[0])
    denoisers.update(other)
    assert "one" not in denoisers
    with pytest.warns(UserWarning, match="tiles"):
        picture = denoisers.denoise("one", frames[1])
    np.testing.assert_array_equal(picture, Denoiser(SHAPE, settings=other).denoise(frames[1]))


@pytest.mark.usefixtures("little_room")
def test_all_of_the_memory_is_enough_for_whole_frames(frames: list[Frame], recwarn: pytest.WarningsRecorder) -> None:
    Denoisers(SHAPE, SETTINGS).denoise("one", frames[0])
    assert not recwarn.list


@pytest.mark.usefixtures("little_room")
def test_half_of_it_is_used_in_tiles_with_the_same_result_and_one_warning(frames: list[Frame]) -> None:
    denoisers = Denoisers(SHAPE, SETTINGS, share=0.5)
    with pytest.warns(UserWarning, match=r"working in \d+ tiles") as told:
        pictures = [denoisers.denoise(key, frame) for frame in frames for key in ("one", "other")]
    assert len(told) == 1
    picture, error = alone(frames)
    np.testing.assert_array_equal(pictures[-1], picture)
    np.testing.assert_array_equal(pictures[-2], picture)
    np.testing.assert_array_equal(denoisers.stage("other", "standard_error"), error)


@pytest.mark.usefixtures("little_room")
@pytest.mark.parametrize("share", [1.0, 0.5])
def test_what_looking_ahead_weighs_by_is_there_whole_and_in_tiles(share: float, frames: list[Frame]) -> None:
    denoisers = Denoisers(SHAPE, SETTINGS, share)
    if share == 1.0:
        denoisers.denoise("one", frames[0])
    else:
        with pytest.warns(UserWarning, match="tiles"):
            denoisers.denoise("one", frames[0])
    found = SETTINGS.uncertainty(lambda name: denoisers.stage("one", name))
    assert found.shape == SHAPE


def test_stages_are_those_of_the_filter(frames: list[Frame]) -> None:
    denoisers = Denoisers(SHAPE, Kalman(iterations=1))
    assert not denoisers.has_stage("one", "inverse_count")
    denoisers.denoise("one", frames[0])
    assert denoisers.has_stage("one", "inverse_count")
    assert not denoisers.has_stage("one", "standard_error")
    with pytest.raises(SvgfError, match="standard_error"):
        denoisers.stage("one", "standard_error")


def test_times_are_added_up(frames: list[Frame]) -> None:
    denoisers = Denoisers(SHAPE, SETTINGS)
    assert denoisers.profile() == {}
    denoisers.denoise("one", frames[0])
    one = denoisers.profile()
    denoisers.denoise("other", frames[0])
    both = denoisers.profile()
    assert both.keys() == one.keys()
    assert all(both[name] > one[name] for name in one)
