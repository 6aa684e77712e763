"""Motion: finds the usual mistake whose correction makes motion lead to the same surfaces in the previous frame.

What is looked for is what stays on surfaces: normal, albedo, and the steps of depth. How much it differs, over how much
it changes from pixel to pixel, is an error in pixels. The sub-pixel jitter of both frames displaces everything alike,
though motion leaves it out: that much is allowed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.view import Array, View, Whole, over_channels, sample, shifted
from svgf_cl.frame import Shape

SAMPLES = 1500
MOVING = 0.5  # of the fastest motion: what moves less is not looked at
ENOUGH = 100  # pixels
BETTER = 0.8  # an error that much smaller tells
NOTICED = 0.2  # pixels off: surfaces that are nearer than that to where motion leads have moved as it says
ALIKE = 1.05  # errors nearer to each other than this do not tell two mistakes apart
SEEN = 0.4  # share of pixels that must have been in the picture before
LOST = 0.5  # of the difference between any two places
TURNS = 3  # of the search for the jitter
REACH = 1.5  # pixels
JITTER = 0.4  # pixels of difference that jitter makes where nothing moves
TILES = 8  # along each side of the picture, that may move by themselves


@dataclass(frozen=True)
class Mistake:
    """A mistake in motion, and its correction.

    Parameters
    ----------
    what, cure : str
    scale : (float, float)
        By which x and y that were given are to be multiplied,
    per_pixel : bool
        and then by the image's width and height.
    swapped : bool
        x and y are to be exchanged first.
    """

    what: str
    cure: str
    scale: tuple[float, float] = (1.0, 1.0)
    per_pixel: bool = False
    swapped: bool = False

    def undone(self, motion: Array, size: Shape) -> Array:
        """The corrected motion (N, 2) in an image of this (height, width)."""
        straight = motion[:, ::-1] if self.swapped else motion
        meant: Array = straight * self.scale * ((size[1], size[0]) if self.per_pixel else (1, 1))
        return meant

    def and_also(self, sign: Mistake) -> Mistake:
        """Both mistakes at once."""
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
# Simple ones first: of two that fit alike the first is named.
MISTAKES = (*SIGNS, *OTHERS, *(other.and_also(sign) for other in OTHERS for sign in SIGNS))
AS_GIVEN = Mistake("", "")


def misfits(before: View, now: View) -> Array | None:
    """Whether anything moves; how much features change from pixel to pixel, differ between any two pixels, and differ
    from the frame before: as given, with every cure, and where pieces of the picture may move by themselves.
    """
    speed = over_channels(np.maximum, np.abs(now.motion))
    fastest = float(np.percentile(speed[now.hit], 99)) if now.hit.any() else 0.0
    pixels = sample(now.hit & (speed >= MOVING * fastest), SAMPLES)
    if len(pixels) < ENOUGH:
        return None
    y, x = np.divmod(pixels, now.shape[1])
    lasting, past = (features(view) for view in (now, before))
    here, motion = lasting.reshape(-1, lasting.shape[-1])[pixels], now.motion.reshape(-1, 2)[pixels]
    found = []
    for mistake in (AS_GIVEN, *MISTAKES):
        dx, dy = mistake.undone(motion, now.frame.shape).T
        found.append(difference(here, past, x + dx, y + dy, np.zeros_like(x)))
    tile = TILES * (y * TILES // now.shape[0]) + x * TILES // now.shape[1]
    found.append(found[0] if now.is_small else difference(here, past, x + motion[:, 0], y + motion[:, 1], tile))
    gradient = bilinear(lasting, x.astype(float), y.astype(float))[1]
    return np.array([fastest > 0, np.hypot(*gradient.T).sum(axis=0).mean(), between_any(here), *found])


@lru_cache(maxsize=2)  # of a frame and the one before it
def features(view: View) -> Array:
    """Features that stay on surfaces, (h, w, C): normal, albedo, depth edges; blurred to be smooth between pixels."""
    log_depth = -np.log(np.where(view.hit, view.nearness, np.max(view.nearness, initial=1e-30)))
    steps = np.clip(log_depth - blurred(blurred(log_depth)), -1, 1)
    fields = [np.clip(view.normal, -1, 1), steps[..., None]]
    if view.albedo is not None:
        fields.append(np.clip(view.albedo, 0, 1))
    return blurred(blurred(np.concatenate(fields, axis=-1)))


def blurred(values: Array) -> Array:
    """Weighted means over 3 x 3 pixels of (h, w, ...)."""
    for dx, dy in ((1, 0), (0, 1)):
        values = 0.25 * (shifted(values, -dx, -dy) + 2 * values + shifted(values, dx, dy))
    return values


def between_any(here: Array) -> float:
    """How much, on average, two places (N, C) differ."""
    return float(np.abs(here - here[::-1]).sum(axis=-1).mean())


def difference(here: Array, past: Array, x: Array, y: Array, tile: Whole) -> float:
    """How much, on average, what is seen `here` (N, C) differs from the frame before at x, y.

    All pixels of a tile may be displaced alike, by up to `REACH`: what is left over differs. Gauss-Newton.
    """
    height, width = past.shape[:2]
    inside = (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
    if inside.mean() < SEEN:
        return between_any(here)
    here, x, y, tile = here[inside], x[inside], y[inside], tile[inside]
    offset = np.zeros((tile.max() + 1, 2))
    for _ in range(TURNS):
        there, slope = bilinear(past, x + offset[tile, 0], y + offset[tile, 1])
        off = here - there
        trust = 1 / (1 + (off / 0.1) ** 2)  # what was hidden does not count
        system, right = np.full((len(offset), 2, 2), 1e-3) * np.eye(2), np.zeros_like(offset)
        np.add.at(system, tile, np.einsum("nci,nc,ncj->nij", slope, trust, slope))
        np.add.at(right, tile, np.einsum("nci,nc,nc->ni", slope, trust, off))
        offset = np.clip(offset + np.linalg.solve(system, right[..., None])[..., 0], -REACH, REACH)
    there, _ = bilinear(past, x + offset[tile, 0], y + offset[tile, 1])
    return float(np.abs(here - there).sum(axis=-1).mean())


def bilinear(values: Array, x: Array, y: Array) -> tuple[Array, Array]:
    """Values (h, w, C) between pixels: (N, C), and their gradient (N, C, 2)."""
    height, width = values.shape[:2]
    left, top = (np.clip(np.floor(p), 0, size - 2).astype(int) for p, size in ((x, width), (y, height)))
    fx, fy = (np.clip(x - left, 0, 1)[:, None], np.clip(y - top, 0, 1)[:, None])
    a, b, c, d = values[top, left], values[top, left + 1], values[top + 1, left], values[top + 1, left + 1]
    mean = (a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy
    return mean, np.stack([(b - a) * (1 - fy) + (d - c) * fy, (c - a) * (1 - fx) + (d - b) * fx], axis=-1)


def judge(sums: Array) -> list[Finding | Unknown]:
    """A correction that fits clearly better shows the mistake; one that fits equally well cannot be excluded."""
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
