"""A camera that dollies, rolls or cuts."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Frame
from svgf_cl_tracer import Camera, CameraPath, Shot, builtin_scene, render_sequence
from tests.frames import only
from tests.hard.variants import Variant, on

# Where history is found depends on stored normals, and TAA looks for its own; the levels' weights (fast) come after.
variants = on("precise", "precise, two signals, TAA", "fp16, two signals, TAA")
# The length of history is kept, and TAA and the signals share it.
of_lengths = on("precise", "fp16")
# What is forgotten is the same however it was kept; TAA has a past of its own.
of_forgetting = on("precise", "precise, two signals, TAA")

SHAPE = (54, 96)
MIDDLE = (0.0, 0.95, -0.6)  # of the box
DISTANCE = 3.6

# Per frame: units towards the middle of the box, degrees about the view.
MOVES = {
    "dolly in": (0.2, 0),
    "dolly out": (-0.2, 0),
    "roll": (0, 5),
    "quarter turn": (0, 90),
    "upside down": (0, 180),
}


@functools.cache
def filmed(*cameras: Camera) -> tuple[Frame, ...]:
    """The open box, one frame a camera."""
    return tuple(render_sequence(Shot(builtin_scene(), SHAPE, len(cameras), CameraPath(cameras))))


def seen_from(angle: float, distance: float = DISTANCE, roll: float = 0) -> Camera:
    """A camera so many degrees to the right of the box's front, rolled by so many degrees."""
    turn, lean = math.radians(angle), math.radians(roll)
    eye = (distance * math.sin(turn), 1.05, MIDDLE[2] + distance * math.cos(turn))
    up = (math.sin(lean) * math.cos(turn), math.cos(lean), -math.sin(lean) * math.sin(turn))
    return Camera(eye, MIDDLE, up, fov_y=42.0)


def moved(name: str) -> tuple[Frame, ...]:
    closer, roll = MOVES[name]
    return filmed(*(seen_from(0, DISTANCE - closer * number, roll * number) for number in range(5)))


class TestMove:
    @pytest.mark.parametrize("move", MOVES)
    @variants
    def test_follows_the_oracle(self, variant: Variant, move: str) -> None:
        variant.assert_follows_oracle([only(frame, variant.fields) for frame in moved(move)], SHAPE)

    @pytest.mark.parametrize("move", MOVES)
    @of_lengths
    def test_keeps_the_history_of_what_was_in_the_frame(self, variant: Variant, move: str) -> None:
        """All but what the ball, the blocks and the bars covered: 96 to 100 % of the pixels were measured."""
        frames = moved(move)
        den = variant.denoiser(SHAPE)
        for frame in frames:
            den.denoise(only(frame, variant.fields))
        y, x = np.indices(SHAPE)
        past = np.stack((x, y), axis=-1) + frames[-1].motion[..., :2]
        inside = ((past >= 0) & (past <= (SHAPE[1] - 1, SHAPE[0] - 1))).all(axis=-1)
        assert np.mean(den.stage("history_length")[inside] > 1) >= 0.95


# A shot from the front, then one of these. Motion within a shot knows nothing of the shot before.
BEFORE = [seen_from(angle) for angle in range(-16, -10)]
AFTER = {
    "side": [seen_from(40 + angle, 3.2) for angle in range(8)],
    "closer": [seen_from(-10 + angle, 2.0) for angle in range(8)],
}


def lit(variant: Variant, frame: Frame, light: tuple[float, float, float]) -> Frame:
    """What the frame shows, evenly lit."""
    return variant.wall(light, shape=SHAPE, normal=frame.normal, depth=frame.depth, motion=frame.motion, id=frame.id)


@pytest.mark.parametrize("after", AFTER)
class TestCut:
    @of_forgetting
    def test_after_reset_nothing_is_left(self, variant: Variant, after: str) -> None:
        den = variant.denoiser(SHAPE)
        for frame in filmed(*BEFORE):
            den.denoise(only(frame, variant.fields))
        den.reset()
        shot = [only(frame, variant.fields) for frame in filmed(*AFTER[after])]
        for frame, expected in zip(shot, variant.pictures(shot, SHAPE), strict=True):
            assert_array_equal(den.denoise(frame), expected)

    @of_forgetting
    def test_without_reset_red_light_stays_where_the_same_surface_seems_to_be_seen(
        self, variant: Variant, after: str
    ) -> None:
        """In a few pixels depth, normal and id happen to agree: 0.5 % of the picture, and less in every frame."""
        den = variant.denoiser(SHAPE)
        for frame in filmed(*BEFORE):
            den.denoise(lit(variant, frame, (1, 0, 0)))
        red = [den.denoise(lit(variant, frame, (0, 0, 1)))[..., 0].mean() for frame in filmed(*AFTER[after])]
        assert red[0] <= 0.01
        assert red[-1] <= 0.001
