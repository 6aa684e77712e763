"""Metrics of a picture against its reference: display-referred (PSNR, SSIM, FLIP), linear (relMSE), and over time.

========  ================  ==========================================================================================
metric    computed on       definition
========  ================  ==========================================================================================
PSNR      display-referred  ``-10 log10(mean((a - b)**2))`` over all pixels and channels, in dB; inf if equal
SSIM      display-referred  mean structural similarity of the channels, Gaussian window of sigma 1.5, as in Wang et
                            al. 2004 (scikit-image's ``structural_similarity``); 1 if equal
FLIP      display-referred  mean difference seen when flipping between the two, at 67 pixels a degree: LDR-FLIP of
                            Andersson et al. 2020 (NVIDIA's ``flip-evaluator``); 0..1, 0 if equal
relMSE    linear HDR        ``mean((a - b)**2 / (b**2 + 0.01))``, `b` is the reference, as in Rousselle et al. 2011; 0
                            if equal; one bright dot can outweigh everything else
trimmed   linear HDR        relMSE without the worst `WORST` per cent of pixels; each pixel is the mean of its channels
temporal  display-referred  ``mean(|(a1 - a0) - (b1 - b0)|)`` over two consecutive frames: flicker and lag; the temporal
                            loss of Chaitanya et al. 2017; 0 if the error does not change
========  ================  ==========================================================================================

Display-referred means exposed, clipped to 0..1 and sRGB-encoded (`svgf_cl.io.display.display`). If a picture contains
NaN, its metrics are NaN.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from svgf_cl.errors import SvgfError, install_extra
from svgf_cl.io.display import Linear, display

# Least height and width of a picture for scikit-image's Gaussian window of sigma 1.5.
SSIM_WINDOW = 11

WORST = 1  # per cent of pixels


@dataclass(frozen=True)
class Metrics:
    """PSNR in dB, SSIM and relMSE of one picture against its reference."""

    psnr: float
    ssim: float
    relmse: float


def measure(picture: Linear, reference: Linear, exposure: float = 0.0) -> Metrics:
    """Compare two (H, W, 3) linear HDR pictures; `exposure` in stops applies to PSNR and SSIM.

    Raises
    ------
    SvgfError
        If the sizes differ, or are too small for SSIM.
    """
    if picture.shape != reference.shape:
        raise SvgfError(f"expected two pictures of one shape, got {picture.shape} and {reference.shape}")
    shown, wanted = display(picture, exposure), display(reference, exposure)
    return Metrics(psnr(shown, wanted), ssim(shown, wanted), relmse(picture, reference))


def psnr(shown: Linear, wanted: Linear) -> float:
    """Return the peak signal-to-noise ratio of two display-referred pictures in dB, peak 1."""
    return decibels(float(np.mean(np.square(shown - wanted))))


def decibels(squared_error: float) -> float:
    """Return the peak signal-to-noise ratio of a mean squared error in dB, peak 1; inf if the error is not above 0."""
    return float("inf") if squared_error <= 0 else float(-10 * np.log10(squared_error))


def ssim(shown: Linear, wanted: Linear) -> float:
    """Return the mean structural similarity of two display-referred pictures."""
    if min(shown.shape[:2]) < SSIM_WINDOW:
        height, width, _ = shown.shape
        raise SvgfError(f"SSIM: expected pictures of at least {SSIM_WINDOW}x{SSIM_WINDOW} pixels, got {width}x{height}")
    require_ssim()
    from skimage.metrics import structural_similarity

    similarity = structural_similarity(
        shown, wanted, channel_axis=-1, data_range=1.0, gaussian_weights=True, sigma=1.5, use_sample_covariance=False
    )
    return float(similarity)


def require_ssim() -> None:
    """Raise `SvgfError`, with the command that installs it, if scikit-image is missing."""
    try:
        import skimage.metrics  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"SSIM needs scikit-image ({error}): {install_extra('metrics')}") from error


def flip(shown: Linear, wanted: Linear) -> float:
    """Return the mean FLIP error of two display-referred pictures."""
    if np.isnan(shown).any() or np.isnan(wanted).any():
        return float("nan")  # the library treats NaN like a colour
    return _flip(shown, wanted, in_colour=False)[1]


def flip_map(shown: Linear, wanted: Linear) -> npt.NDArray[np.uint8]:
    """Return FLIP's error of each pixel of two display-referred pictures as (H, W, 3) colours, dark to bright."""
    colours, _ = _flip(shown, wanted, in_colour=True)
    return np.rint(255 * np.clip(colours, 0, 1)).astype(np.uint8)


def _flip(shown: Linear, wanted: Linear, *, in_colour: bool) -> tuple[npt.NDArray[np.float32], float]:
    """Return the library's map, and the mean error."""
    require_flip()
    import flip_evaluator

    errors, mean_error, _ = flip_evaluator.evaluate(
        np.asarray(wanted, np.float32), np.asarray(shown, np.float32), "LDR", applyMagma=in_colour
    )
    return errors, float(mean_error)


def why_no_flip() -> str:
    """Return why FLIP cannot be measured here; empty if it can."""
    try:
        require_flip()
    except SvgfError as error:
        return str(error)
    return ""


def require_flip() -> None:
    """Raise `SvgfError`, with the command that installs it, if NVIDIA's evaluator is missing."""
    try:
        import flip_evaluator  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"FLIP needs flip-evaluator ({error}): {install_extra('metrics')}") from error


def temporal_error(shown: tuple[Linear, Linear], wanted: tuple[Linear, Linear]) -> float:
    """Return how much the error changes between two consecutive display-referred pictures, earlier one first."""
    change, truth = shown[1] - shown[0], wanted[1] - wanted[0]
    return float(np.mean(np.abs(change - truth)))


def relmse(picture: Linear, reference: Linear) -> float:
    """Return the relative mean squared error of two linear pictures."""
    return float(np.mean(relative_squares(picture, reference)))


def trimmed_relmse(picture: Linear, reference: Linear) -> float:
    """Return the relMSE of two linear pictures (H, W, 3) without the worst `WORST` per cent of pixels; NaN counts."""
    of_pixels = np.sort(relative_squares(picture, reference).mean(axis=-1), axis=None)
    if np.isnan(of_pixels[-1]):  # NaN is sorted last, and would be left out
        return float("nan")
    return float(np.mean(of_pixels[: of_pixels.size - of_pixels.size * WORST // 100]))


def relative_squares(picture: Linear, reference: Linear) -> npt.NDArray[np.float64]:
    """Return the squared error of each value, relative to the reference's square."""
    tested, truth = np.asarray(picture, np.float64), np.asarray(reference, np.float64)
    squares: npt.NDArray[np.float64] = np.square(tested - truth) / (np.square(truth) + 0.01)
    return squares
