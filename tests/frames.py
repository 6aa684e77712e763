"""Makers of synthetic frames, shared by the tests of the kernels and of the host library."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from svgf_cl.device import devices
from svgf_cl.frame import CHANNELS, Frame, Shape

# Primes: no multiple of any vector width. Fewer on a simulator, which takes a millisecond for every pixel.
SHAPE = (7, 21) if os.environ.get(devices.VARIABLE) == devices.SIMULATOR else (53, 37)
TINY = (7, 9)
FACING = (0.0, 0.0, 1.0)

# Fields beside the surface's. Each set is a compile-time variant of the kernels, so there are few on purpose.
PLAIN = ("color",)
FULL = ("color", "albedo", "id", "emission")
SPLIT = ("direct", "indirect", "albedo", "id", "emission")


def wall(shape: Shape = SHAPE, **given: Any) -> Frame:
    """Return a grey wall facing a resting camera, with any field replaced; numbers and triples fill the image."""
    values = {"color": 0.5, "normal": FACING, "depth": 4.0, "motion": (0.0, 0.0, 0.0)} | given

    def spread(name: str, value: Any) -> np.ndarray:
        value = np.asarray(value, np.uint32 if name == "id" else np.float32)
        channels = value.shape[-1:] if name == "motion" else tuple(n for n in CHANNELS[name] if n)
        return np.array(np.broadcast_to(value, (*shape, *channels)))

    return Frame(**{name: spread(name, value) for name, value in values.items()})


def only(frame: Frame, fields: tuple[str, ...], motion: int = 3) -> Frame:
    """The surface of `frame` and these fields alone, with so many components of motion."""
    values = {name: getattr(frame, name) for name in ("normal", "depth", *fields)}
    return Frame(**values, motion=np.ascontiguousarray(frame.motion[..., :motion]))


def noise(seed: int = 0, shape: Shape = SHAPE) -> np.ndarray:
    """A picture of uniform noise."""
    return np.random.default_rng(seed).random((*shape, 3), np.float32)


def bumpy(rng: np.random.Generator, shape: Shape = SHAPE) -> Frame:
    """A frame with every field: a slanted rough wall of four parts with holes; motion of several pixels."""
    y, x = np.indices(shape)
    hit = rng.random(shape) >= 0.1
    light = rng.lognormal(-1, 1, (3, *shape, 3))
    fields = {
        "albedo": rng.random((*shape, 3)),
        "normal": (FACING + rng.normal(0, 0.07, (*shape, 3))) * hit[..., None],
        "depth": np.where(hit, 4 + 0.02 * x + 0.01 * y + rng.uniform(-0.05, 0.05, shape), np.inf),
        "motion": rng.uniform(-1, 1, 3) * (5, 5, 0.03) + rng.uniform(-1, 1, (*shape, 3)) * (1, 1, 0.03),
        "id": hit * (1 + (x > shape[1] // 2) + 2 * (y > shape[0] // 2)),
        "color": light.sum(axis=0),
        "direct": light[0],
        "indirect": light[1],
        "emission": light[2] * (rng.random((*shape, 1)) < 0.05),
        "diffuse": 0.75 * light[:2].sum(axis=0),
        "specular": 0.25 * light[:2].sum(axis=0),
        "roughness": 0.5,
        "hit_distance": (1.0, 2.0),
    }
    return wall(shape, **fields)


def bumpy_sequence(
    fields: tuple[str, ...], *, count: int = 4, shape: Shape = SHAPE, motion: int = 3, seed: int = 2017
) -> list[Frame]:
    """Bumpy frames with these fields; every frame moves in a direction of its own."""
    rng = np.random.default_rng(seed)
    return [only(bumpy(rng, shape), fields, motion) for _ in range(count)]


def changing_sequence(fields: tuple[str, ...], *, motion: int = 3) -> list[Frame]:
    """Bumpy frames with thin poles, that no pixel of even coordinates shows, in light that changes by strides."""
    rng = np.random.default_rng(2017)
    poles = np.arange(SHAPE[1]) % 6 == 3
    left = np.arange(SHAPE[1])[:, None] < SHAPE[1] // 2

    def lit(frame: Frame, gain: float) -> Frame:
        lights = {name: getattr(frame, name) * np.where(left, gain, 1) for name in ("color", "direct", "indirect")}
        return wall(**frame.present() | lights | {"depth": frame.depth * np.where(poles, 0.5, 1)})

    return [only(lit(bumpy(rng), gain), fields, motion) for gain in (1, 1, 8, 8, 0.1, 1)]
