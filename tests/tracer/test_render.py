from __future__ import annotations

import os

import numpy as np
import pytest

from tracer import CameraPath, SceneError, builtin_scene, render_frame, render_reference, render_sequence
from tracer.render import TILE

SHAPE = (45, 80)
ROOM = builtin_scene()
VIEW = ROOM.camera_path.at(0.5)


@pytest.mark.parametrize("spp", [1, 3])
def test_a_frame_is_whole(spp: int) -> None:
    frame = render_frame(ROOM, VIEW, None, SHAPE, spp=spp)
    frame.check(SHAPE)
    assert len(frame.present()) == 9
    for name, value in frame.present().items():
        assert value.flags.c_contiguous
        assert value.dtype == (np.uint32 if name == "id" else np.float32)
    np.testing.assert_allclose(frame.color, frame.direct + frame.indirect + frame.emission, rtol=1e-6)
    assert np.isfinite(frame.color).all()
    assert frame.direct.max() > 0
    assert frame.indirect.max() > 0
    assert frame.emission.max() > 0


def test_an_image_does_not_hang_on_the_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    shape = (200, 200)
    assert shape[0] * shape[1] > 2 * TILE
    images = []
    for threads in (1, 5):
        monkeypatch.setattr(os, "cpu_count", lambda threads=threads: threads)
        frame = render_frame(ROOM, VIEW, None, shape, frame_index=2, spp=2, seed=9)
        images.append((frame.color, frame.motion, frame.id, render_reference(ROOM, VIEW, shape, spp=2, seed=9)))
    for one, many in zip(*images, strict=True):
        np.testing.assert_array_equal(one, many)


def test_noise_differs_by_seed_and_by_frame() -> None:
    def color(**key: int) -> np.ndarray:
        return np.asarray(render_frame(ROOM, VIEW, None, SHAPE, jitter=False, **key).color)

    first = color(seed=1, frame_index=1)
    np.testing.assert_array_equal(first, color(seed=1, frame_index=1))
    assert not np.array_equal(first, color(seed=2, frame_index=1))
    assert not np.array_equal(first, color(seed=1, frame_index=2))


def test_the_gbuffer_is_the_first_samples() -> None:
    one, many = (render_frame(ROOM, VIEW, None, SHAPE, frame_index=3, spp=spp) for spp in (1, 4))
    for name in ("albedo", "normal", "depth", "motion", "id"):
        np.testing.assert_array_equal(getattr(one, name), getattr(many, name))


def test_more_samples_are_less_noisy() -> None:
    few, many = (render_frame(ROOM, VIEW, None, SHAPE, spp=spp, jitter=False) for spp in (1, 16))
    reference = render_frame(ROOM, VIEW, None, SHAPE, spp=64, jitter=False, seed=1).color
    assert np.square(many.color - reference).mean() < np.square(few.color - reference).mean() / 6


def test_a_reference_is_what_frames_converge_to_and_shares_no_noise_with_them() -> None:
    reference = render_reference(ROOM, VIEW, SHAPE, spp=64)
    frame = render_frame(ROOM, VIEW, None, SHAPE, spp=64).color
    assert reference.dtype == np.float32
    assert reference.shape == (*SHAPE, 3)
    assert reference.flags.c_contiguous
    np.testing.assert_allclose(reference.mean((0, 1)), frame.mean((0, 1)), rtol=0.01)
    single = render_frame(ROOM, VIEW, None, SHAPE, jitter=False).color
    assert not np.array_equal(single, render_reference(ROOM, VIEW, SHAPE, spp=1))


def test_a_reference_without_jitter_is_what_frames_without_jitter_converge_to() -> None:
    reference = render_reference(ROOM, VIEW, SHAPE, spp=64, jitter=False)
    frame = render_frame(ROOM, VIEW, None, SHAPE, spp=64, jitter=False).color
    area = render_reference(ROOM, VIEW, SHAPE, spp=64, seed=1)
    assert np.square(reference - frame).mean() < 0.7 * np.square(reference - area).mean()


def test_rows_of_a_reference_are_those_of_the_whole() -> None:
    # Within the first tile the noise is the same where the first row is; elsewhere only the mean is.
    whole = render_reference(ROOM, VIEW, SHAPE, spp=32)
    np.testing.assert_array_equal(render_reference(ROOM, VIEW, SHAPE, spp=32, rows=(0, 45)), whole)
    band = render_reference(ROOM, VIEW, SHAPE, spp=32, rows=(20, 30))
    assert band.shape == (10, 80, 3)
    errors = {first: np.square(band - whole[first : first + 10]).mean() for first in (19, 20, 21)}
    assert min(errors, key=errors.__getitem__) == 20
    for rows in ((-1, 5), (5, 5), (40, 46)):
        with pytest.raises(SceneError, match="rows: expected 0 <= first < end <= 45"):
            render_reference(ROOM, VIEW, SHAPE, spp=1, rows=rows)


def test_a_reference_reports_its_progress() -> None:
    seen: list[tuple[int, int]] = []
    render_reference(ROOM, VIEW, (170, 200), spp=3, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_a_sequence_runs_along_the_whole_path() -> None:
    path = ROOM.camera_path
    frames = list(render_sequence(ROOM, path, SHAPE, 3, seed=4))
    assert not frames[0].motion.any()
    for index, previous in ((1, 0.0), (2, 0.5)):
        alone = render_frame(ROOM, path.at(index / 2), path.at(previous), SHAPE, frame_index=index, seed=4)
        for name, value in alone.present().items():
            np.testing.assert_array_equal(getattr(frames[index], name), value)


def test_a_sequence_of_one_frame_starts_the_path() -> None:
    (frame,) = render_sequence(ROOM, CameraPath.static(VIEW), (1, 1), 1)
    frame.check((1, 1))


@pytest.mark.parametrize("wrong", [{"spp": 0}, {"bounces": -1}, {"seed": -1}, {"frame_index": -1}])
def test_numbers_out_of_range_are_named(wrong: dict[str, int]) -> None:
    with pytest.raises(SceneError, match=next(iter(wrong))):
        render_frame(ROOM, VIEW, None, SHAPE, **wrong)
    with pytest.raises(SceneError, match="shape"):
        render_reference(ROOM, VIEW, (0, 5), spp=1)
