"""Checks that motion leads to the same surfaces in the previous frame, and else finds the mistake.

Each usual mistake is corrected; the correction that leads to the same surfaces shows the mistake. Surfaces are compared
by features that stay on them: normal, albedo, and the steps of depth. The difference of the features, divided by their
change from pixel to pixel, is an error in pixels. The sub-pixel jitter of both frames displaces all features by the
same offset, which motion does not contain. So such an offset is allowed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.view import Array, View, Whole, beside, over_channels, sample
from svgf_cl.frame import Shape

SAMPLES = 1500
MOVING = 0.5  # of the fastest motion: slower pixels are not used
ENOUGH = 100  # pixels
BETTER = 0.8  # an error smaller by this factor is clearly better
NOTICED = 0.2  # pixels: motion with a smaller error is right
ALIKE = 1.05  # if the ratio of two errors is below this, the two mistakes cannot be distinguished
SEEN = 0.4  # least share of pixels that were in the picture before
LOST = 0.5  # of the difference between any two places
TURNS = 3  # iterations of the search for the jitter
REACH = 1.5  # pixels, the greatest offset
JITTER = 0.4  # pixels of difference that jitter causes if nothing moves
TILES = 8  # along each side of the picture; each tile may have its own offset


@dataclass(frozen=True)
class Mistake:
    """A mistake in motion, and its correction.

    Parameters
    ----------
    what, cure : str
    scale : (float, float)
        Factors for x and y.
    per_pixel : bool
        Whether x and y are multiplied by the image's width and height, too.
    swapped : bool
        Whether x and y are exchanged first.
    """

    what: str
    cure: str
    scale: tuple[float, float] = (1.0, 1.0)
    per_pixel: bool = False
    swapped: bool = False

    def undone(self, motion: Array, size: Shape) -> Array:
        """Return the corrected motion (N, 2) in an image of this (height, width)."""
        straight = motion[:, ::-1] if self.swapped else motion
        meant: Array = straight * self.scale * ((size[1], size[0]) if self.per_pixel else (1, 1))
        return meant

    def and_also(self, sign: Mistake) -> Mistake:
        """Return both mistakes at once."""
        scale = self.scale[0] * sign.scale[0], self.scale[1] * sign.scale[1]
        return Mistake(f"{self.what}, {sign.what}", f"{self.cure}, {sign.cure}", scale, self.per_pixel, self.swapped)


SIGNS = (
    Mistake("points the other way", "negate it", (-1, -1)),
    Mistake("y points up", "negate y", (1, -1)),
    Mistake("x points to the left", "negate x", (-1, 1)),
)
OTHERS = (
    Mistake("in UV units, 0 to 1 across the image", "multiply by width and height", per_pixel=True),
    Mistake("in NDC, -1 to 1 across the image", "multiply by half the width and height", (0.5, 0.5), per_pixel=True),
    Mistake("x and y are exchanged", "exchange x and y", swapped=True),
)
# Simple ones first: of two that fit equally well, the first is reported.
MISTAKES = (*SIGNS, *OTHERS, *(other.and_also(sign) for other in OTHERS for sign in SIGNS))
AS_GIVEN = Mistake("", "")


def misfits(before: View, now: View) -> Array | None:
    """Return the measurements of a frame in one row.

    They are: whether anything moves; the change of features from pixel to pixel; their difference between any two
    pixels; and their differences from the previous frame: with motion as given, with every correction, and with an
    offset for every tile.
    """
    speed = over_channels(np.maximum, np.abs(now.motion))
    fastest = float(np.percentile(speed[now.hit], 99)) if now.hit.any() else 0.0
    pixels = sample(now.hit & (speed >= MOVING * fastest), SAMPLES)
    if len(pixels) < ENOUGH:
        return None
    y, x = np.divmod(pixels, now.shape[1])
    past, lasting = (features(view) for view in (before, now))
    here, motion = lasting.reshape(-1, lasting.shape[-1])[pixels], now.motion.reshape(-1, 2)[pixels]
    found = []
    for mistake in (AS_GIVEN, *MISTAKES):
        dx, dy = mistake.undone(motion, now.frame.shape).T
        found.append(difference(here, past, x + dx, y + dy, np.zeros_like(x)))
    tile = TILES * (y * TILES // now.shape[0]) + x * TILES // now.shape[1]
    found.append(found[0] if now.is_small else difference(here, past, x + motion[:, 0], y + motion[:, 1], tile))
    slope = bilinear(lasting, x.astype(float), y.astype(float))[1:]
    return np.array([fastest > 0, np.hypot(*slope).sum(axis=-1).mean(), between_any(here), *found])


@lru_cache(maxsize=2)  # for a frame and the previous one
def features(view: View) -> Array:
    """Return features that stay on surfaces, (h, w, C): normal, albedo and depth edges, blurred to be smooth."""
    log_depth = -np.log(np.where(view.hit, view.nearness, np.max(view.nearness, initial=1e-30)))
    steps = np.clip(log_depth - blurred(blurred(log_depth)), -1, 1)
    fields = [np.clip(view.normal, -1, 1), steps[..., None]]
    if view.albedo is not None:
        fields.append(np.clip(view.albedo, 0, 1))
    return blurred(blurred(np.concatenate(fields, axis=-1)))


def blurred(values: Array) -> Array:
    """Return weighted means over 3 x 3 pixels of (h, w, ...)."""
    for axis in (1, 0):
        before, behind = beside(values, axis)
        values = 0.25 * (before + 2 * values + behind)
    return values


def between_any(here: Array) -> float:
    """Return how much two places (N, C) differ on average."""
    return float(np.abs(here - here[::-1]).sum(axis=-1).mean())


def difference(here: Array, past: Array, x: Array, y: Array, tile: Whole) -> float:
    """Return how much the features `here` (N, C) differ from the previous frame at x, y on average.

    Each tile may have one offset of up to `REACH` for all its pixels. The Gauss-Newton method finds the offset with the
    smallest difference.
    """
    height, width = past.shape[:2]
    inside = (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
    if inside.mean() < SEEN:
        return between_any(here)
    here, x, y, tile = here[inside], x[inside], y[inside], tile[inside]
    offset = np.zeros((2, tile.max() + 1))
    for _ in range(TURNS):
        there, along_x, along_y = bilinear(past, x + offset[0, tile], y + offset[1, tile])
        off = here - there
        trust = 1 / (1 + (off / 0.1) ** 2)  # pixels that were hidden hardly count
        a, b = trust * along_x, trust * along_y
        xx, xy, yy = dots(tile, a, along_x) + 1e-3, dots(tile, a, along_y), dots(tile, b, along_y) + 1e-3
        right_x, right_y = dots(tile, a, off), dots(tile, b, off)
        step = np.stack([yy * right_x - xy * right_y, xx * right_y - xy * right_x]) / (xx * yy - xy**2)
        offset = np.clip(offset + step, -REACH, REACH)
    there, *_ = bilinear(past, x + offset[0, tile], y + offset[1, tile])
    return float(np.abs(here - there).sum() / len(here))


def dots(tile: Whole, a: Array, b: Array) -> Array:
    """Return the sum of a b (N, C) over each tile's pixels."""
    total: Array = np.bincount(tile, np.einsum("nc,nc->n", a, b)).astype(np.float64)
    return total


def bilinear(values: Array, x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Return values (h, w, C) between pixels, and their change from pixel to pixel along x and along y: each (N, C)."""
    height, width = values.shape[:2]
    left, top = (np.clip(np.floor(p), 0, max(size - 2, 0)).astype(int) for p, size in ((x, width), (y, height)))
    fx, fy = (np.clip(p - start, 0, 1)[:, None] for p, start in ((x, left), (y, top)))
    right, below = int(width > 1), width * (height > 1)  # steps between pixels of the flattened image
    flat, place = values.reshape(height * width, -1), top * width + left
    a, b, c, d = (flat.take(place + step, axis=0) for step in (0, right, below, below + right))
    across = b - a
    twist = d - c - across
    down = c - a + twist * fx
    return a + across * fx + down * fy, across + twist * fy, down


def judge(sums: Array) -> list[Finding | Unknown]:
    """Report the mistake whose correction fits clearly better; one that fits equally well cannot be excluded."""
    moves, change, *differences = sums.tolist()
    anywhere, given, *cures, local = np.array(differences) / max(change, 1e-12)
    cured = np.array(cures)
    best = int(np.flatnonzero(cured <= ALIKE * cured.min())[0])
    if moves and given > NOTICED and cured[best] < BETTER * given:
        mistake = MISTAKES[best]
        measured = (
            f"the surface is {given:.2g} pixels away from where motion leads, {cured[best]:.2g} after the correction"
        )
        return [Finding("motion", mistake.what, measured, mistake.cure)]
    if not moves and given > JITTER and local < BETTER * given:
        measured = (
            f"motion is 0, but if parts of the picture move, a difference of {given:.2g} pixels becomes {local:.2g}"
        )
        return [Finding("motion", "0, but something moves", measured, "give previous minus current position")]
    if not moves:
        return [Unknown(DIRECTION.topic, "all motion is 0")]
    if given > LOST * anywhere:
        return [Unknown(DIRECTION.topic, f"motion hardly leads to the same surfaces; they are {given:.2g} pixels away")]
    alike = [
        mistake.what for mistake, error in zip(MISTAKES[: len(SIGNS)], cured, strict=False) if given > BETTER * error
    ]
    return [Unknown(DIRECTION.topic, f"there is too little movement to exclude this mistake: {what}") for what in alike]


DIRECTION = Check(
    "motion: direction, axes, unit", misfits, judge, "nothing was hit", frames=2, trusts=("normal", "depth")
)
