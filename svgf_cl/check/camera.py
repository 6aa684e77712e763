"""Computes the camera's path from motion, and finds offsets in motion that no camera causes, such as jitter.

If only the camera moves, a point at pixel (x, y) with depth z moves to

    (x', y') = (A1 . (x, y, 1) + b1 / z, A2 . (x, y, 1) + b2 / z) / (A3 . (x, y, 1) + b3 / z),   A = K R K^-1,

where x and y are pixels from the middle of the image, and K contains the focal length. R is a rotation, so rows 1 and 2
of A K are at a right angle to row 3. An offset that is added to all motion changes rows 1 and 2 of A, and this angle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from svgf_cl.check.check import Check
from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.noise import has_noisy_depth
from svgf_cl.check.view import Array, View, pixel_centers, sample

SAMPLES = 2000
ENOUGH = 100  # pixels
FLAT = 0.02  # least deviation of one over depth, relative to its median, from a plane; else A and b are not separable
TURNS = 20  # iterations of a fit in which a pixel counts less the worse it fits
STEADY = 0.02  # pixels by which motion may differ from a camera's
FOLLOW = 0.4  # least share of pixels that move as the camera does
FOCAL_LENGTHS = np.geomspace(0.3, 6.0, 400)  # in image heights
NOTICED = 0.08  # least offset, in pixels, that is reported
SAME = 0.8  # length of the mean offset over the length of a single one; above it, offsets are the same in all frames


@dataclass(frozen=True, eq=False)
class Path:
    """The camera's movement from one frame to the next.

    Parameters
    ----------
    matrix : (3, 3)
        A, for x and y in pixels from the middle of the image.
    """

    matrix: Array

    def turn(self, focal: float) -> float:
        """Return the approximate rotation in radians, for a focal length in pixels."""
        a = self.matrix
        return float(focal * np.hypot(*a[2, :2]) + abs(a[0, 1] - a[1, 0]) / 2)

    def offset(self, focal: Array) -> Array:
        """Return the offset of all motion, (n, 2) in pixels, for focal lengths (n) in pixels."""
        rows = self.matrix * np.stack([focal, focal, np.ones_like(focal)], axis=-1)[:, None]
        added: Array = (rows[:, :2] @ rows[:, 2, :, None])[..., 0] / (rows[:, 2:] ** 2).sum(axis=-1)
        return added


@lru_cache(maxsize=1)  # several checks need it for the same frame
def path(view: View) -> Path | None:
    """Return the camera's movement, computed from motion; None if most pixels move differently, or all are coplanar."""
    pixels = sample(view.hit, SAMPLES)
    if len(pixels) < ENOUGH:
        return None
    unit = 0.5 * view.shape[1]  # in this unit all numbers are about 1
    x, y = (axis.ravel()[pixels] / unit for axis in pixel_centers(view.shape))
    near = view.nearness.ravel()[pixels] * typical_depth(view)
    flat = np.stack([x, y, np.ones_like(x)], axis=-1)
    if np.std(near - flat @ np.linalg.lstsq(flat, near, rcond=None)[0]) < FLAT:
        return None
    here = np.column_stack([flat, near])
    past = flat[:, :2] + view.motion.reshape(-1, 2)[pixels] / unit
    nothing = np.zeros_like(here)
    system = np.concatenate(
        [
            np.column_stack([here, nothing, -past[:, :1] * here[:, [0, 1, 3]]]),
            np.column_stack([nothing, here, -past[:, 1:] * here[:, [0, 1, 3]]]),
        ]
    )
    right, weight = past.T.ravel(), np.ones(len(pixels))
    for _ in range(TURNS):
        weighted = system * np.tile(weight, 2)[:, None]
        a = np.linalg.lstsq(weighted.T @ system, weighted.T @ right, rcond=None)[0]
        off = np.hypot(*(system @ a - right).reshape(2, -1)) * unit
        weight = 1 / (1 + (off / max(float(np.median(off)), 1e-5)) ** 2)
    if np.mean(off < STEADY) < FOLLOW:
        return None
    scale = np.diag([unit, unit, 1.0])
    return Path(scale @ np.array([a[:3], a[4:7], [a[8], a[9], 1.0]]) @ np.linalg.inv(scale))


def typical_depth(view: View) -> float:
    """Return the median depth of the pixels that hit a surface."""
    return float(np.median(view.depth[view.hit]))


def offsets(before: View, now: View) -> Array | None:
    """Return the number of frames, the offset's x and y in pixels, and its square for `FOCAL_LENGTHS`: (4, n)."""
    del before  # not needed, but the first frame has no valid motion
    if has_noisy_depth(now.frame):  # an error in depth that a camera's path cannot explain looks like an offset
        return None
    camera = path(now)
    if camera is None:
        return None
    offset = camera.offset(FOCAL_LENGTHS * now.shape[0]) * now.step
    return np.array([np.ones(len(offset)), *offset.T, (offset**2).sum(axis=-1)])


def judge(sums: Array) -> list[Finding | Unknown]:
    """Report jitter if motion has an offset for every focal length, and the offset changes in every frame."""
    frames, x, y, square = sums[:, np.argmin(sums[3])].tolist()
    length = np.sqrt(square / frames)
    if length < NOTICED:
        return []
    if np.hypot(x, y) / frames > SAME * length:
        return [
            Unknown(
                JITTER.topic,
                "all motion has the same offset in every frame, which a large moving object may cause, too",
            )
        ]
    measured = (
        f"all motion has an offset of {length:.2f} pixels, which changes in every frame; no camera moves like this"
    )
    cure = "project with both frames' unjittered matrices, or subtract this frame's offset and add the previous one's"
    return [Finding("motion", "contains jitter", measured, cure)]


JITTER = Check(
    "motion: free of jitter",
    offsets,
    judge,
    "too many objects move, everything is on one plane, or depth is noisy",
    frames=2,
    trusts=("normal", "depth", "motion"),
)
