"""The player without a browser: which past a picture is made from, wherever one steps, and whatever is changed."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl import Denoiser, Frame, Kalman, Settings, SvgfError
from svgf_cl.errors import FileError
from svgf_cl.filters.filter import Filter
from svgf_cl.io.synthetic import room_frames
from svgf_cl.view import player as module
from svgf_cl.view.player import Player
from tests.svgf_cl.view.clips import SHAPE, Listed

COUNT = 7
USUAL = Kalman()


@pytest.fixture(scope="module")
def frames() -> list[Frame]:
    return list(room_frames(SHAPE, COUNT))


@pytest.fixture(autouse=True)
def short_run_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "WARM_UP", 3)
    monkeypatch.setattr(module, "SETTLED", 2)


def expected(frames: list[Frame], settings: Filter = USUAL) -> np.ndarray:
    """The last picture of a denoiser that begins with the first of these frames."""
    with Denoiser(SHAPE, settings=settings) as den:
        return [den.denoise(frame) for frame in frames][-1]


def shown(player: Player, index: int, settings: Filter = USUAL) -> np.ndarray:
    return player.show(index, settings)[1].picture


def test_playing_is_what_a_denoiser_does(frames: list[Frame]) -> None:
    player = Player(Listed(frames), USUAL)
    for index in range(COUNT):
        assert np.array_equal(shown(player, index), expected(frames[: index + 1])), index


def test_the_first_frame_begins_anew(frames: list[Frame]) -> None:
    player = Player(Listed(frames), USUAL)
    for index in (0, 1, 2, 0):
        picture = shown(player, index)
    assert np.array_equal(picture, expected(frames[:1]))
    assert np.array_equal(shown(player, 1), expected(frames[:2]))


def test_a_step_back_shows_the_picture_as_it_was(frames: list[Frame]) -> None:
    player = Player(Listed(frames), USUAL)
    pictures = [player.show(index, USUAL)[1] for index in range(5)]
    assert player.show(3, USUAL)[1] is pictures[3]
    assert player.show(1, USUAL)[1] is pictures[1]
    assert player.show(4, USUAL)[1] is pictures[4]
    assert np.array_equal(shown(player, 5), expected(frames[:6])), "the past is that of frame 4"


def test_a_step_back_to_what_is_no_longer_in_memory_takes_a_run_up(
    frames: list[Frame], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MEMORY", 2 * 12 * SHAPE[0] * SHAPE[1])
    player = Player(Listed(frames), USUAL)
    for index in range(COUNT):
        picture = shown(player, index)
    assert np.array_equal(shown(player, 5), expected(frames[:6])), "one of two that are kept"
    assert np.array_equal(shown(player, 4), expected(frames[1:5]))
    assert not np.array_equal(picture, expected(frames[3:7]))


def test_a_jump_takes_a_run_up(frames: list[Frame]) -> None:
    clip = Listed(frames)
    assert np.array_equal(shown(Player(clip, USUAL), 5), expected(frames[2:6]))
    assert clip.read_so_far == [5, 2, 3, 4]
    assert np.array_equal(shown(Player(clip, USUAL), 2), expected(frames[:3])), "no more frames than there are"


def test_a_step_back_into_a_run_up_shows_no_picture_of_short_past(frames: list[Frame]) -> None:
    clip = Listed(frames)
    player = Player(clip, USUAL)
    shown(player, 6)
    clip.read_so_far.clear()
    assert np.array_equal(shown(player, 5), expected(frames[3:6])), "a past of two frames"
    assert clip.read_so_far == [5]
    assert np.array_equal(shown(player, 4), expected(frames[1:5])), "not of one"


def test_a_run_up_from_the_first_frame_is_as_good_as_playing(frames: list[Frame]) -> None:
    clip = Listed(frames)
    player = Player(clip, USUAL)
    shown(player, 2)
    clip.read_so_far.clear()
    assert np.array_equal(shown(player, 1), expected(frames[:2]))
    assert clip.read_so_far == [1]


def test_a_cut_begins_anew_and_no_run_up_leads_over_it(frames: list[Frame]) -> None:
    clip = Listed(frames, cuts=(4,))
    player = Player(clip, USUAL)
    for index in range(6):
        picture = shown(player, index)
    assert np.array_equal(picture, expected(frames[4:6]))
    clip.read_so_far.clear()
    assert np.array_equal(shown(Player(clip, USUAL), 5), expected(frames[4:6]))
    assert clip.read_so_far == [5, 4]


def test_another_setting_keeps_the_past(frames: list[Frame]) -> None:
    player, other = Player(Listed(frames), USUAL), Kalman(sigma_luminance=2.0)
    for index in range(3):
        shown(player, index)
    with Denoiser(SHAPE) as den:
        for frame in frames[:3]:
            den.denoise(frame)
        den.update(other)
        assert np.array_equal(shown(player, 3, other), den.denoise(frames[3]))


def test_another_setting_for_the_frame_that_is_shown_takes_a_run_up(frames: list[Frame]) -> None:
    player, other = Player(Listed(frames), USUAL), Kalman(iterations=2)
    for index in range(6):
        shown(player, index)
    assert np.array_equal(shown(player, 5, other), expected(frames[2:6], other))


def test_another_filter_begins_anew(frames: list[Frame]) -> None:
    player = Player(Listed(frames), USUAL)
    shown(player, 0)
    shown(player, 1)
    assert np.array_equal(shown(player, 2, Settings()), expected(frames[2:3], Settings()))
    assert np.array_equal(shown(player, 3, Settings()), expected(frames[2:4], Settings()))


def test_a_damaged_frame_is_told_and_the_next_one_begins_anew(frames: list[Frame]) -> None:
    player = Player(Listed(frames, damaged=(3,)), USUAL)
    for index in range(3):
        shown(player, index)
    with pytest.raises(FileError, match=r"frame\.103\.exr: expected an EXR file"):
        player.show(3, USUAL)
    assert np.array_equal(shown(player, 4), expected(frames[4:5]))
    assert np.array_equal(shown(player, 5), expected(frames[4:6]))


def test_no_run_up_leads_to_a_damaged_frame(frames: list[Frame]) -> None:
    clip = Listed(frames, damaged=(5,))
    with pytest.raises(FileError):
        Player(clip, USUAL).show(5, USUAL)
    assert clip.read_so_far == [5]


def test_what_the_filter_refuses_leaves_no_past_and_the_next_frame_is_shown(frames: list[Frame]) -> None:
    odd = Frame(color=frames[2].color, normal=frames[2].normal, depth=frames[2].depth, motion=frames[2].motion)
    player = Player(Listed([*frames[:2], odd, *frames[3:]]), USUAL)
    shown(player, 0)
    shown(player, 1)
    with pytest.raises(SvgfError, match="the fields"):
        player.show(2, USUAL)


@pytest.mark.parametrize("index", [-1, COUNT])
def test_a_frame_that_is_not_there_is_refused(index: int, frames: list[Frame]) -> None:
    with pytest.raises(SvgfError, match=f"index: expected 0 to 6, got {index}"):
        Player(Listed(frames), USUAL).show(index, USUAL)


def test_times_are_those_of_the_device(frames: list[Frame]) -> None:
    times = Player(Listed(frames), USUAL).show(0, USUAL)[1].times
    assert "demodulate" in times
    assert all(time >= 0 for time in times.values())
