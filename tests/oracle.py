"""Comparison of every kernel, one at a time, with the float64 oracle on the same input: cases and tolerances."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from svgf_cl import Accumulation, Denoiser, Eaw, Frame, Kalman, Lbf, Sbf, Settings
from svgf_cl.filters.filter import Filter
from svgf_cl.oracle import oracle_of
from svgf_cl.oracle.accuracy import deviations
from tests.denoising import vector_width
from tests.frames import FULL, PLAIN, SPLIT, bumpy_sequence, changing_sequence

# Largest error of any pixel, relative as defined in svgf_cl.oracle.rounding; about three times what was measured.
# float32 rounds by 2^-24 = 6e-8 of a value. Where an error exceeds a few of these, something amplifies it.
TOLERANCES = {
    "normal": 4e-7,  # a handful of roundings
    "depth": 0.0,  # copied
    "demodulated": 4e-7,
    "modulated": 1e-5,  # green is a difference of luminance and the rest
    "history_length": 4e-7,
    "accumulated": 2e-5,  # a dim mean of bright taps, each off by a rounding: noisy ones, or of a darker albedo
    "mean": 2e-5,
    "moment_variance": 4e-5,  # squares of differences
    "variance": 2e-4,  # 128 times the cosine, and exp of up to -80 amplify a rounding that often
    "level": 1.5e-4,
    "level_variance": 2e-4,  # the same weights squared
    "scale": 1e-4,  # as of a level; a sum over up to 1089 taps
    "risk": 2e-3,  # the square of a difference of nearly the same
    "parameters": 1e-3,  # powers of two, from deviations that are differences of squares
    "filtered": 1e-3,  # exponents of 60 octaves times a parameter
    "antialiased": 1e-6,
    "resolved": 5e-6,  # dim green under bright red and blue is a small difference
}

KALMAN_TOLERANCES = TOLERANCES | {
    "predicted": 3e-6,  # weighted means
    "predicted_spread": 1e-5,
    "predicted_inverse_count": 1e-6,
    "predicted_tone": 1e-6,
    "predicted_luminance": 3e-6,
    "innovation": 2e-6,  # a difference, as all that are of both signs it is held against its mean size too
    "innovation_residual": 5e-6,
    "facet": 0.0,  # copied
    "change": 3e-4,  # weights of exp of up to -80, squared for the share; means of both signs cancel
    # How much is believed goes by a variance, <E^2> - <E>^2, of as few as two pixels: where they are nearly alike, or
    # count for little beside the middle one, that cancels.
    "correction": 1e-3,
    "correction_residual": 1e-3,
    "correction_doubt": 1e-3,
    "correction_spread": 1e-3,
    "accumulated": 1e-3,
    "sample_variance": 1e-3,
    "inverse_count": 1e-3,
    "tone": 1e-3,
    "residual": 1e-3,
    "expected_luminance": 1e-3,
    "expected_variance": 1e-3,
    "guidance_1": 1e-3,  # a difference of nearly the same
    "guidance": 1.5e-4,
    "standard_error": 1e-6,
    "filtered": TOLERANCES["level"],
    "filtered_variance": TOLERANCES["level_variance"],
}

# Share of pixels that may be decided otherwise, where a tap lies within rounding of a threshold. None was, on PoCL.
DECIDED_OTHERWISE = 5e-4
KALMAN_DECIDED_OTHERWISE = 2e-3  # two of the 1000 that a coarse stage has; measured on all devices

# The whole pipeline over a sequence against the whole oracle: errors of one frame are the next frame's input, yet they
# do not build up, as the filter is an average. Measured: 3e-5, and 1e-4 with sigma_normal 1024.
PIPELINE_TOLERANCE = 3e-4


@dataclass(frozen=True)
class Case:
    """A sequence, how to filter it, the width of the vectors that do it, and of such the exponential."""

    frames: Callable[[], Sequence[Frame]]
    settings: Filter = field(default_factory=Settings)
    width: int | None = None
    exponential: str = "polynomial"


# No two settings alike, so that no two can be mixed up.
UNUSUAL = Settings(
    iterations=3,
    sigma_depth=2.0,
    sigma_luminance=3.0,
    depth_slope_floor=4e-3,
    alpha_color=0.6,
    alpha_moments=0.7,
    depth_threshold=0.03,
    normal_threshold=0.8,
    taa=True,
    alpha_taa=0.3,
    pixel_filter=0.15,
)

CASES = {
    "plain": Case(partial(bumpy_sequence, PLAIN)),
    "full": Case(partial(bumpy_sequence, FULL), Settings(taps="5x5")),
    "split": Case(partial(bumpy_sequence, SPLIT)),
    "split, unusual settings": Case(partial(bumpy_sequence, SPLIT), UNUSUAL),
    "albedo alone": Case(partial(bumpy_sequence, ("color", "albedo")), width=1),
    "emission alone": Case(partial(bumpy_sequence, ("color", "emission"), motion=2), Settings(sigma_normal=16), 8),
    "ids alone": Case(partial(bumpy_sequence, ("color", "id"), motion=2), Settings(sigma_normal=32), 1, "exp2"),
    "plain split": Case(partial(bumpy_sequence, SPLIT[:2], motion=2), Settings(taa=True, taps="5x5"), 4, "exp2"),
}

# Tolerant enough of differences in light that even the last levels find something to average.
UNUSUAL_EAW = Eaw(
    iterations=3,
    sigma_color=3.0,
    sigma_depth=2.0,
    depth_slope_floor=4e-3,
    alpha_color=0.6,
    depth_threshold=0.03,
    normal_threshold=0.8,
    taa=True,
    alpha_taa=0.3,
    pixel_filter=0.15,
)
EAW_CASES = {
    "EAW, plain": Case(partial(bumpy_sequence, PLAIN), Eaw(sigma_color=10)),
    "EAW, full": Case(partial(bumpy_sequence, FULL), Eaw(taps="5x5", sigma_color=20)),
    "EAW, split, unusual settings": Case(partial(bumpy_sequence, SPLIT), UNUSUAL_EAW),
    "EAW, split, antialiased": Case(partial(bumpy_sequence, SPLIT), Eaw(taa=True, taps="5x5")),
    "EAW, albedo alone": Case(partial(bumpy_sequence, ("color", "albedo"), motion=2), Eaw(sigma_color=5), 1, "exp2"),
}

UNUSUAL_KALMAN = Kalman(
    iterations=3,
    sigma_depth=3.0,
    sigma_normal=24.0,
    sigma_luminance=6.0,
    depth_slope_floor=4e-3,
    alpha_color=0.1,
    depth_threshold=0.03,
    normal_threshold=0.8,
    change_threshold=1.5,
    change_sigma_depth=5.0,
    change_sigma_normal=6.0,
    standard_error=True,
    taa=True,
    alpha_taa=0.3,
    pixel_filter=0.15,
)
KALMAN_CASES = {
    "Kalman, plain": Case(partial(changing_sequence, PLAIN), Kalman(), 8),
    "Kalman, full": Case(partial(changing_sequence, FULL), Kalman(taps="5x5", standard_error=True)),
    "Kalman, split, unusual settings": Case(partial(changing_sequence, SPLIT), UNUSUAL_KALMAN),
    "Kalman, split": Case(partial(changing_sequence, SPLIT), Kalman()),
    "Kalman, albedo alone": Case(partial(changing_sequence, ("color", "albedo"), motion=2), Kalman(), 1, "exp2"),
    "Kalman, ids alone": Case(partial(changing_sequence, ("color", "id"), motion=2), Kalman(taa=True), 4),
}

# A pixel of these has a thousand taps, so there are two frames, which is all that Oclgrind can do in half a minute.
BILATERAL_CASES = {
    "SBF, plain": Case(partial(bumpy_sequence, PLAIN, count=2), Sbf(), 1, "exp2"),
    "SBF, split": Case(
        partial(bumpy_sequence, SPLIT, count=2),
        Sbf(gamma_depth=3.0, gamma_normal=1.5, alpha_color=0.6, depth_slope_floor=4e-3, sigma_depth=2.0),
        4,
    ),
    "SBF, full": Case(partial(bumpy_sequence, FULL, count=2), Sbf(taa=True)),
    "LBF, plain": Case(partial(bumpy_sequence, PLAIN, count=2), Lbf(), 1, "exp2"),
    "LBF, split": Case(
        partial(bumpy_sequence, SPLIT, count=2),
        Lbf(alpha_color=0.6, depth_slope_floor=4e-3, albedo_threshold=1.0, taa=True),
        4,
    ),
    "LBF, full": Case(partial(bumpy_sequence, FULL, count=2), Lbf()),
    "accumulation": Case(partial(bumpy_sequence, SPLIT), Accumulation(alpha_color=0.1, taa=True)),
}

# The longest first, so that processes in parallel end at the same time.
ALL_CASES = BILATERAL_CASES | KALMAN_CASES | CASES | EAW_CASES


def assert_follows_oracle(case: Case) -> None:
    """Check that every stage is within its tolerance, and that it has one."""
    of_kalman = isinstance(case.settings, Kalman)
    tolerances = KALMAN_TOLERANCES if of_kalman else TOLERANCES
    allowed = KALMAN_DECIDED_OTHERWISE if of_kalman else DECIDED_OTHERWISE
    with vector_width(case.width, case.exponential):
        found = deviations(case.frames(), case.settings)
    found["resolved" if case.settings.taa else "modulated"] = found.pop("out")
    for name, deviation in found.items():
        assert deviation.relative <= tolerances[kind(name)], (name, deviation)
        assert deviation.decided_otherwise <= allowed, (name, deviation)


def kind(stage: str) -> str:
    """The name of a stage's tolerance."""
    group = stage.partition("_")[0]
    return group if group in ("facet", "change") else re.sub(r"^(level|scale|risk)_\d", r"\1", stage)


@functools.cache
def pictures(frames: Callable[[], Sequence[Frame]], settings: Filter) -> list[np.ndarray]:
    """The oracle's pictures of a sequence."""
    sequence = frames()
    return list(map(oracle_of(settings, sequence[0].shape).denoise, sequence))


def error_to_oracle(frames: Callable[[], Sequence[Frame]], exact: Filter, **choice: Any) -> float:
    """Root-mean-square error of a sequence if these settings are changed, relative to each exact picture's mean."""
    expected = pictures(frames, exact)
    den = Denoiser(expected[0].shape[:2], settings=replace(exact, **choice))
    squares = [
        np.mean(np.square(den.denoise(frame) - picture)) / np.square(picture.mean())
        for frame, picture in zip(frames(), expected, strict=True)
    ]
    return float(np.sqrt(np.mean(squares)))
