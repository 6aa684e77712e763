"""Traced scenes whose albedo does not hold all light: coats over saturated paint, metal, dark cloth."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl import Denoiser
from svgf_cl.filters import FILTERS
from svgf_cl.io.display import display
from svgf_cl_tracer import Camera, CameraPath, Scene, Shot, render_frame, render_sequence
from svgf_cl_tracer.builtin.patterns import tiles
from svgf_cl_tracer.builtin.shapes import ball, panel, quad
from svgf_cl_tracer.builtin.surfaces import glazed, lamp, metal
from svgf_cl_tracer.materials import Material

SHAPE, FRAMES = (54, 72), 8
BLACK, WHITE, RED, BLUE = (0, 0, 0), (230, 230, 230), (255, 0, 0), (0, 0, 255)


def glossy_tiles(first: tuple[int, int, int], second: tuple[int, int, int]) -> Material:
    """Tiles under one coat."""
    return Material(base_texture=tiles(8, 8, first, second, first), roughness=0.3, ior=1.5)


def studio() -> Scene:
    """A floor of red and blue tiles, a wall of black and white ones, metal, dark cloth, a black glazed ball."""
    return Scene(
        [
            quad((-2, 0, 2), (4, 0, 0), (0, 0, -4), glossy_tiles(RED, BLUE)),
            quad((-2, 0, -2), (4, 0, 0), (0, 3, 0), glossy_tiles(BLACK, WHITE)),
            ball(0.45, (-0.9, 0.45, 0.0), metal((0.95, 0.6, 0.4), 0.3)),
            ball(0.45, (0.1, 0.45, 0.2), glazed((0.0, 0.0, 0.0))),
            ball(0.45, (1.1, 0.45, 0.0), Material((0.02, 0.02, 0.03))),
            panel((0.0, 3.0, 1.0), (0.0, 0.4, -0.5), (2.0, 2.0), lamp(12, 12, 12)),
        ],
        camera_path=CameraPath((Camera((-0.3, 1.2, 4.0), (0, 0.7, 0)), Camera((0.3, 1.3, 4.0), (0, 0.7, 0)))),
    )


@pytest.mark.parametrize("name", FILTERS)
def test_coats_metal_and_dark_cloth_lose_their_noise(name: str) -> None:
    shot = Shot(studio(), SHAPE, FRAMES)
    truth = display(render_frame(shot, FRAMES - 1, spp=192, seed=1, jitter=False).color)
    with Denoiser(SHAPE, settings=FILTERS[name]()) as denoiser:
        for frame in render_sequence(shot, jitter=False):
            picture = denoiser.denoise(frame)

    def error(shown: np.ndarray) -> float:
        return float(np.sqrt(np.mean((display(shown) - truth) ** 2)))

    assert error(picture) < 0.6 * error(frame.color)
