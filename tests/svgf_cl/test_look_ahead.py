"""Looking ahead: what it gains, where it must not look, and what it holds."""

from __future__ import annotations

import tempfile
import weakref
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import ArgumentError, Denoiser, FileError, Frame, FrameError, Kalman, Settings, look_ahead
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.io.synthetic import room_frame, room_frames
from svgf_cl.look_ahead import Estimate, mean
from tests.frames import FULL, SPLIT, bumpy_sequence, noise, wall

SMALL = (24, 40)
ROOM = list(room_frames(SMALL, 9))


def pictures(frames: Sequence[Frame], settings: Filter | None = None, **chosen: Any) -> list[np.ndarray]:
    """All pictures of a sequence."""
    forward, backward = (Denoiser(frames[0].shape, settings=settings or Kalman()) for _ in range(2))
    return list(look_ahead(frames, forward, backward, **chosen))


def alone(frames: Sequence[Frame], settings: Filter | None = None) -> list[np.ndarray]:
    """The pictures of the forward run alone."""
    den = Denoiser(frames[0].shape, settings=settings or Kalman())
    return [den.denoise(frame) for frame in frames]


def error(found: Sequence[np.ndarray], frames: Sequence[Frame]) -> float:
    """Mean squared error of pictures of the room, whose light is half the albedo."""
    return float(np.mean([(picture - 0.5 * frame.albedo) ** 2 for picture, frame in zip(found, frames, strict=True)]))


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))


class TestGain:
    @pytest.mark.parametrize("name", sorted(FILTERS))
    def test_every_filter_gains_where_the_camera_moves(self, name: str) -> None:
        settings = FILTERS[name]()
        assert error(pictures(ROOM, settings), ROOM) < 0.8 * error(alone(ROOM, settings), ROOM)

    def test_the_more_frames_ahead_the_better(self) -> None:
        errors = [error(pictures(ROOM, ahead=ahead), ROOM) for ahead in (1, 3, None)]
        assert errors == sorted(errors, reverse=True)
        assert errors[0] < error(alone(ROOM), ROOM)

    def test_two_signals_and_antialiasing(self) -> None:
        split = list(room_frames(SMALL, 6, signals=2))
        settings = Kalman(taa=True)
        truth = [replace(frame, albedo=2 * frame.albedo) for frame in split]  # a light of a half each
        assert error(pictures(split, settings), truth) < error(alone(split, settings), truth)


class TestSymmetry:
    def test_a_sequence_at_rest_is_the_same_backward(self) -> None:
        frames = [wall(SMALL, color=noise(seed, SMALL)) for seed in range(5)]
        for one, other in zip(pictures(frames), reversed(pictures(frames[::-1])), strict=True):
            assert_allclose(one, other, rtol=1e-5, atol=1e-6)

    def test_what_both_runs_agree_on_passes_through(self) -> None:
        """Lamps and sky, and a shot of one frame."""
        sky = np.arange(SMALL[1]) < 10
        glow = noise(7, SMALL) * sky[:, None]
        light = np.where(sky[:, None], glow, 0.25)
        depth = np.where(np.broadcast_to(sky, SMALL), np.inf, 4.0)
        frames = [wall(SMALL, color=light, emission=glow, depth=depth) for _ in range(4)]
        for picture in pictures(frames):
            assert_array_equal(picture[:, sky], glow[:, sky])
        assert_array_equal(pictures(ROOM[:1]), alone(ROOM[:1]))

    @given(data=st.data())
    def test_a_mean_lies_between_and_is_finite(self, data: st.DataObject) -> None:
        values = st.floats(0, 1e10, width=32)
        shape = (2, 3)
        one, other = (
            Estimate(data.draw(arrays(np.float32, (*shape, 3), elements=values)), uncertainty)
            for uncertainty in data.draw(arrays(np.float32, (2, *shape), elements=st.floats(0, 1e3, width=32)))
        )
        found = mean(one, other)
        low, high = np.minimum(one.picture, other.picture), np.maximum(one.picture, other.picture)
        assert np.all((found >= low * (1 - 1e-6)) & (found <= high * (1 + 1e-6)))
        assert_array_equal(mean(one, replace(other, picture=one.picture)), one.picture)

    def test_the_more_certain_one_counts_more(self) -> None:
        black, white = (np.full((1, 1, 3), value, np.float32) for value in (0, 1))
        share = mean(Estimate(black, np.float32([[0.75]])), Estimate(white, np.float32([[0.25]])))
        assert_allclose(share, 0.75)


class TestShots:
    @pytest.mark.parametrize("ahead", [None, 1, 2])
    def test_no_run_crosses_a_cut(self, ahead: int | None) -> None:
        apart = [*pictures(ROOM[:4], ahead=ahead), *pictures(ROOM[4:5], ahead=ahead), *pictures(ROOM[5:], ahead=ahead)]
        assert_array_equal(pictures(ROOM, ahead=ahead, cuts={5, 4}), apart)

    def test_fields_may_change_at_a_cut(self) -> None:
        frames = [*bumpy_sequence(FULL, count=2), *bumpy_sequence(SPLIT, count=2)]
        assert np.isfinite(pictures(frames, cuts=[2])).all()

    def test_far_ahead_is_the_whole_shot(self) -> None:
        assert_array_equal(pictures(ROOM, ahead=len(ROOM)), pictures(ROOM))

    @pytest.mark.parametrize("ahead", [1, 2, 4])
    def test_a_frame_sees_so_many_ahead(self, ahead: int) -> None:
        """One that lies farther than a block and `ahead` changes nothing, one `ahead` frames later does."""
        frames = [wall(SMALL, color=noise(seed, SMALL)) for seed in range(3 * ahead + 1)]
        found = pictures(frames, ahead=ahead)
        for changed in (ahead, 2 * ahead):
            others = [*frames[:changed], wall(SMALL, color=5.0), *frames[changed + 1 :]]
            assert np.array_equal(pictures(others, ahead=ahead)[0], found[0]) == (changed == 2 * ahead)

    def test_no_frames(self) -> None:
        assert list(look_ahead([], Denoiser(SMALL), Denoiser(SMALL))) == []

    def test_motion_may_be_given(self) -> None:
        asked = []

        def known(index: int) -> np.ndarray:
            asked.append(index)
            return room_frame(SMALL, index, index + 1).motion

        exact = pictures(ROOM, next_motion=known)
        assert asked == list(range(len(ROOM) - 1))[::-1]
        assert error(exact, ROOM) == pytest.approx(error(pictures(ROOM), ROOM), rel=0.02)


class Read(Sequence[Frame]):
    """Frames that are made when they are asked for; knows how often, and the most that were alive at a time."""

    def __init__(self, count: int) -> None:
        self.count, self.asked, self.most = count, Counter[int](), 0
        self._alive: weakref.WeakSet[Frame] = weakref.WeakSet()

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: Any) -> Any:
        frame = room_frame(SMALL, index, index - 1)
        self.asked[index] += 1
        self._alive.add(frame)
        self.most = max(self.most, len(self._alive))
        return frame


class TestMemory:
    @pytest.mark.parametrize(("ahead", "times"), [(None, 2), (3, 3)])
    def test_few_frames_are_held_and_none_is_read_often(self, ahead: int | None, times: int) -> None:
        frames = Read(12)
        for _ in look_ahead(frames, Denoiser(SMALL), Denoiser(SMALL), ahead=ahead):
            pass
        assert frames.most <= 2
        assert set(frames.asked) == set(range(12))
        assert max(frames.asked.values()) == times

    def test_files_of_a_block_alone_are_there_and_none_are_left(self, tmp_path: Path) -> None:
        shots = look_ahead(ROOM, Denoiser(SMALL), Denoiser(SMALL), ahead=3)
        next(shots)
        assert len(list(tmp_path.rglob("*.parts"))) == 3
        shots.close()
        assert not list(tmp_path.iterdir())

    def test_a_full_disk_is_said(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def full(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(np, "save", full)
        with pytest.raises(FileError, match=r"parts: cannot be written \(No space left on device\); set TMPDIR"):
            pictures(ROOM[:2])


class TestWrongInput:
    @pytest.mark.parametrize("ahead", [0, -1, 1.5, True, "8"])
    def test_ahead(self, ahead: Any) -> None:
        with pytest.raises(ArgumentError, match=r"look_ahead\(ahead\): expected a whole number of at least 1, or None"):
            look_ahead(ROOM, Denoiser(SMALL), Denoiser(SMALL), ahead=ahead)

    @pytest.mark.parametrize("cuts", [[0], [9], [-1, 3]])
    def test_cuts(self, cuts: list[int]) -> None:
        with pytest.raises(ArgumentError, match=r"look_ahead\(cuts\): expected indices in 1\.\.8"):
            look_ahead(ROOM, Denoiser(SMALL), Denoiser(SMALL), cuts=cuts)

    @pytest.mark.parametrize(
        "other",
        [
            lambda den: den,
            lambda den: Denoiser((40, 24), queue=den.queue),
            lambda den: Denoiser(SMALL, settings=Settings(), queue=den.queue),
            lambda den: Denoiser(SMALL, settings=Kalman(iterations=2), queue=den.queue),
        ],
    )
    def test_denoisers(self, other: Callable[[Denoiser], Denoiser]) -> None:
        den = Denoiser(SMALL)
        with pytest.raises(ArgumentError, match=r"look_ahead\(backward\): expected"):
            look_ahead(ROOM, den, other(den))

    def test_a_frame_of_another_size(self) -> None:
        with pytest.raises(FrameError, match="expected shape"):
            pictures([*ROOM[:2], wall((9, 7))])
