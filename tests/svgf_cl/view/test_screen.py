"""Pictures as they are drawn: as `to_bytes` makes them, and measured against the reference."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from svgf_cl.compare.metrics import psnr, temporal_error
from svgf_cl.io.display import display, to_bytes
from svgf_cl.view.clip import Item, Picture
from svgf_cl.view.player import Filtered
from svgf_cl.view.screen import DENOISED, NOISY, REFERENCE, Screen, View, fast_bytes
from tests.frames import noise, wall

SHAPE = (12, 16)


@pytest.mark.parametrize("exposure", [0.0, -3.7, 5.0, 64.0])
def test_fast_bytes_are_bytes(exposure: float) -> None:
    rng = np.random.default_rng(1)
    picture = (2.0 ** rng.uniform(-20, 10, (100_000, 1, 3)) * 2.0**-exposure).astype(np.float32)
    steps = fast_bytes(picture, exposure).astype(int) - to_bytes(picture, exposure)
    assert np.abs(steps).max() <= 1
    assert (steps != 0).mean() < 0.01


def test_values_that_no_light_has_are_shown_as_ever() -> None:
    odd = [np.nan, -np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 1e-45, 1e-38, 3e38, 1.0, 1.0001, 0.0031308]
    picture = np.array(odd, np.float32).reshape(-1, 1, 1).repeat(3, axis=2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.array_equal(fast_bytes(picture, 0.0), to_bytes(picture))


def test_a_picture_of_any_memory_order_is_shown() -> None:
    picture = noise(3, SHAPE)
    assert np.array_equal(fast_bytes(np.asfortranarray(picture), 0.0), fast_bytes(picture, 0.0))
    assert np.array_equal(fast_bytes(picture[::-1, ::2], 0.0), fast_bytes(picture, 0.0)[::-1, ::2])


def item(seed: int, reference: Picture | None) -> Item:
    return Item(wall(SHAPE, color=noise(seed, SHAPE)), reference=reference)


def frames(count: int, reference: bool = True) -> list[tuple[Item, Filtered]]:
    """Frames, and what stands for denoised ones."""
    wanted = [noise(50 + seed, SHAPE) if reference else None for seed in range(count)]
    return [(item(seed, wanted[seed]), Filtered(noise(90 + seed, SHAPE), {})) for seed in range(count)]


def test_measures_are_those_of_what_is_shown() -> None:
    (first, made), (second, later) = frames(2)
    screen = Screen()
    views = [screen.show(7, first, made, -1.0), screen.show(8, second, later, -1.0)]
    assert views[0].temporal == {}
    light = [{NOISY: i.noisy, DENOISED: m.picture, REFERENCE: i.reference} for i, m in ((first, made), (second, later))]
    shown = [{name: display(picture, -1.0) for name, picture in each.items()} for each in light]
    for name in (NOISY, DENOISED):
        assert views[1].psnr[name] == pytest.approx(psnr(shown[1][name], shown[1][REFERENCE]), abs=0.02)
        pairs = ((shown[0][each], shown[1][each]) for each in (name, REFERENCE))
        assert views[1].temporal[name] == pytest.approx(temporal_error(*pairs), rel=0.01)


def temporal(first: tuple[int, float], second: tuple[int, float]) -> bool:
    """Whether the second of two frames, given by index and exposure, has a temporal error."""
    screen, ((one, made), (other, later)) = Screen(), frames(2)
    screen.show(first[0], one, made, first[1])
    return bool(screen.show(second[0], other, later, second[1]).temporal)


def test_only_the_neighbour_of_the_frame_before_has_a_temporal_error() -> None:
    assert temporal((3, 0.0), (4, 0.0))
    assert not temporal((3, 0.0), (3, 0.0))
    assert not temporal((3, 0.0), (5, 0.0))
    assert temporal((4, 0.0), (3, 0.0)), "it is the same in both directions"
    assert not temporal((3, 0.0), (4, 1.0)), "shown otherwise"


def test_a_frame_without_reference_has_no_measures_nor_has_the_next_a_temporal_error() -> None:
    screen, with_one, without = Screen(), frames(3), frames(1, reference=False)
    screen.show(0, *with_one[0], 0.0)
    bare: View = screen.show(1, *without[0], 0.0)
    assert (list(bare.pictures), bare.psnr, bare.temporal) == ([NOISY, DENOISED], {}, {})
    assert screen.show(2, *with_one[2], 0.0).temporal == {}
