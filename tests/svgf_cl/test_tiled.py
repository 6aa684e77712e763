"""Frames in tiles: the same bits as whole frames, within the memory that is given."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from svgf_cl import (
    Accumulation,
    ArgumentError,
    Denoiser,
    DeviceError,
    Eaw,
    Frame,
    FrameError,
    Inputs,
    Kalman,
    Lbf,
    Sbf,
    Settings,
    SvgfError,
    TiledDenoiser,
    denoiser_for,
)
from svgf_cl.device import tiling
from svgf_cl.device.tiling import Tiling
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import Shape
from svgf_cl.tile_plan import TilePlan
from tests.denoising import vector_width
from tests.frames import FULL, PLAIN, SPLIT, bumpy_sequence, noise, only, wall

# Odd, and no multiple of a vector; few tiles cover the smaller one, except those of Kalman, which covers it with one.
SHAPE, SMALLER = (97, 143), (71, 101)
FILTERS: dict[str, Filter] = {
    "kalman": Kalman(iterations=1, taa=True, standard_error=True),
    "two levels": Kalman(iterations=2),
    "svgf": Settings(iterations=1, taa=True, pixel_filter=0.2),
    "16 bits": Settings(iterations=2, half_guides=True, half_history=True, taa=True),
    "eaw": Eaw(iterations=2, taa=True),
    "sbf": Sbf(taa=True),
    "lbf": Lbf(),
    "accumulation": Accumulation(taa=True),
}


@pytest.fixture
def no_slack() -> Iterator[None]:
    """The past of a tile is no larger than the tile, so motion leads out of it more often."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiling, "SLACK", 0)
        yield


def shape_for(chosen: Filter) -> Shape:
    """The least of the two shapes that takes several tiles."""
    return SHAPE if isinstance(chosen, Kalman) else SMALLER


def made(chosen: Filter, frame: Frame, share: float = 1.0) -> TiledDenoiser:
    """One with so much more memory than the least."""
    inputs = Inputs.of(frame)
    cut = Tiling(chosen.pipeline(inputs), frame.shape, 64)
    return TiledDenoiser(frame.shape, inputs, settings=chosen, max_bytes=int(share * cut.least()))


def wild(frames: Sequence[Frame], seed: int = 1) -> list[Frame]:
    """A part of the motion leads anywhere, in the image and out of it, or is no number."""
    rng = np.random.default_rng(seed)

    def with_motion(frame: Frame) -> Frame:
        motion, shape = frame.motion.copy(), frame.shape
        anywhere = rng.random(shape) < 0.3
        motion[anywhere, :2] = rng.uniform(-150, 150, (np.count_nonzero(anywhere), 2))
        motion[rng.random(shape) < 0.1] = 0
        for odd in (np.nan, np.inf, -np.inf, 3e38):
            motion[rng.random(shape) < 0.005, rng.integers(motion.shape[2])] = odd
        return Frame(**frame.present() | {"motion": motion})

    return [with_motion(frame) for frame in frames]


def assert_same(chosen: Filter, frames: Sequence[Frame], tiled: TiledDenoiser, cut_before: int = -1) -> None:
    """Both denoisers give the same bits, frame by frame."""
    whole = Denoiser(frames[0].shape, settings=chosen)
    assert tiled.tiles > 1
    for number, frame in enumerate(frames):
        if number == cut_before:
            whole.reset()
            tiled.reset()
        expected, found = whole.denoise(frame), tiled.denoise(frame)
        assert_array_equal(found.view(np.uint32), expected.view(np.uint32), f"frame {number}")
        for name in tiled.stages:
            assert_array_equal(tiled.stage(name), whole.stage(name))
        assert isinstance(chosen, TemporalFilter)
        assert_array_equal(chosen.uncertainty(tiled.stage), chosen.uncertainty(whole.stage))


@pytest.mark.usefixtures("no_slack")
@pytest.mark.parametrize("is_wild", [False, True], ids=["moving", "wild"])
@pytest.mark.parametrize("chosen", FILTERS.values(), ids=FILTERS)
def test_every_filter_gives_the_same_bits(chosen: Filter, is_wild: bool) -> None:
    frames = bumpy_sequence(FULL, count=3, shape=shape_for(chosen))
    frames = wild(frames) if is_wild else frames
    assert_same(chosen, frames, made(chosen, frames[0]))


@pytest.mark.parametrize("name", ["kalman", "16 bits"])
def test_two_signals_a_cut_and_short_motion(name: str) -> None:
    chosen = FILTERS[name]
    frames = bumpy_sequence(SPLIT, count=4, shape=shape_for(chosen), motion=2)
    assert_same(chosen, frames, made(chosen, frames[0], 1.2), cut_before=2)


@pytest.mark.parametrize("width", [1, 16])
def test_other_vector_widths(width: int) -> None:
    frames = wild(bumpy_sequence(PLAIN, count=2, shape=SHAPE))
    with vector_width(width):
        assert_same(FILTERS["kalman"], frames, made(FILTERS["kalman"], frames[0]))


@settings(max_examples=12, deadline=None)
@given(
    st.tuples(st.integers(1, 150), st.integers(1, 150)).filter(lambda shape: max(shape) > 75),
    st.floats(1.0, 1.6),
    st.sampled_from([0, 5, 64]),
    st.sampled_from([Accumulation(taa=True), Settings(iterations=1, taa=True, pixel_filter=0.2)]),
    st.integers(0, 2**32),
)
def test_frames_and_tiles_of_any_size(shape: Shape, share: float, slack: int, chosen: Filter, seed: int) -> None:
    frames = wild(bumpy_sequence(FULL, count=2, shape=shape, seed=seed), seed)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiling, "SLACK", slack)
        tiled = made(chosen, frames[0], share)
        if tiled.tiles > 1:
            assert_same(chosen, frames, tiled)


@pytest.mark.parametrize("chosen", FILTERS.values(), ids=FILTERS)
def test_it_takes_no_more_than_it_is_given(chosen: Filter, monkeypatch: pytest.MonkeyPatch) -> None:
    shape = shape_for(chosen)
    frames = wild(bumpy_sequence(FULL, count=2, shape=shape))
    monkeypatch.setattr(tiling, "SLACK", 0)
    tiled = made(chosen, frames[0], 1.1)
    for frame in frames:
        tiled.denoise(frame)
    cut = Tiling(chosen.pipeline(Inputs.of(frames[0])), shape, 64)
    window = cut.window(int(1.1 * cut.least()), 2**31)
    assert window is not None
    user = sum(cut.pipeline.user_nbytes.values()) * window[0] * window[1]
    assert tiled.nbytes + user <= 1.1 * cut.least()


@pytest.mark.usefixtures("no_slack")
def test_the_right_one_is_made() -> None:
    frame = only(wall(SHAPE), PLAIN)
    inputs, chosen = Inputs.of(frame), Accumulation()
    needed = sum(Tiling(chosen.pipeline(inputs), SHAPE, 64).whole())
    assert isinstance(denoiser_for(SHAPE, inputs), Denoiser)
    assert isinstance(denoiser_for(SHAPE, inputs, settings=chosen, max_bytes=2 * needed), Denoiser)
    tiled = denoiser_for(SHAPE, inputs, settings=chosen, max_bytes=needed // 2)
    assert isinstance(tiled, TiledDenoiser)
    assert "143x97 frames need" in tiled.reason
    assert f"working in {tiled.tiles} tiles" in tiled.reason


def test_too_little_memory_says_how_much_it_takes() -> None:
    with pytest.raises(DeviceError, match=r"no room for tiles of 143x97 frames: expected at least .* MiB, got 0.0 MiB"):
        TiledDenoiser(SHAPE, Inputs(), max_bytes=1000)
    for wrong in (0, -1, 1.5, True, "1G"):
        with pytest.raises(SvgfError, match="max_bytes: expected a whole number of bytes"):
            TiledDenoiser(SHAPE, Inputs(), max_bytes=wrong)  # type: ignore[arg-type]


def test_a_frame_that_breaks_off_leaves_the_past_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    frames = bumpy_sequence(FULL, count=3, shape=SHAPE)
    chosen = Accumulation(taa=True)
    tiled, whole = made(chosen, frames[0]), Denoiser(SHAPE, settings=chosen)
    assert_array_equal(tiled.denoise(frames[0]), whole.denoise(frames[0]))
    run, calls = TilePlan.run, iter(range(100))

    def fails_at_the_third_tile(*given: object) -> object:
        if next(calls) == 2:
            raise RuntimeError("gone")
        return run(*given)  # type: ignore[arg-type]

    with monkeypatch.context() as patch:
        patch.setattr(TilePlan, "run", fails_at_the_third_tile)
        with pytest.raises(RuntimeError, match="gone"):
            tiled.denoise(frames[1])
    for frame in frames[1:]:
        assert_array_equal(tiled.denoise(frame), whole.denoise(frame))


def test_calls_that_cannot_be_right_are_refused() -> None:
    frame = only(wall(SHAPE, color=noise(shape=SHAPE)), PLAIN)
    tiled = made(Accumulation(), frame)
    out = np.empty((*SHAPE, 3), np.float32)
    assert tiled.denoise(frame, out=out) is out
    with pytest.raises(ArgumentError, match="memory of its own, got that of color"):
        tiled.denoise(frame, out=frame.color)
    with pytest.raises(ArgumentError, match="expected the fields color"):
        tiled.denoise(wall(SHAPE, albedo=0.5))
    with pytest.raises(FrameError, match="expected shape"):
        tiled.denoise(wall((5, 5)))
    with pytest.raises(SvgfError, match="expected a Frame"):
        tiled.denoise(out)  # type: ignore[arg-type]
    with pytest.raises(SvgfError, match=r"stage: expected one of .*history_length.* in tiles"):
        tiled.stage("variance")
    tiled.close()
    with pytest.raises(SvgfError, match="got one after close"):
        tiled.denoise(frame)


def test_passes_are_timed_over_all_tiles() -> None:
    frame = only(wall(SHAPE), PLAIN)
    tiled = made(Accumulation(), frame)
    tiled.denoise(frame)
    assert list(tiled.profile()) == ["demodulate", "temporal", "modulate"]
    assert all(time >= 0 for time in tiled.profile().values())
