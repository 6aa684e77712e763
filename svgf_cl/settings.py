"""`Settings`: everything a user can tune, each with its unit, range, default and the reason for it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from numbers import Integral, Real

from svgf_cl.errors import SettingsError, shown

# (least, greatest) allowed value of each numeric setting.
RANGES: dict[str, tuple[float, float]] = {
    "iterations": (1, 5),
    "sigma_depth": (1e-3, 1e3),
    "sigma_normal": (16, 1024),
    "sigma_luminance": (1e-3, 1e3),
    "depth_slope_floor": (1e-6, 1.0),
    "alpha_color": (0.0, 1.0),
    "alpha_moments": (0.0, 1.0),
    "depth_threshold": (0.0, 1.0),
    "normal_threshold": (-1.0, 1.0),
    "alpha_taa": (0.0, 1.0),
}

# What each setting that is a word may be.
CHOICES: dict[str, tuple[str, ...]] = {
    "precision": ("precise", "fast"),
    "taps": ("5x5", "3x3"),
}


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Parameters of the filter. Equations: docs/algorithm.md.

    Parameters
    ----------
    iterations : int, levels, 1..5
        A-trous levels; each doubles the filter's reach. 5 as in the paper: taps up to 62 pixels away, enough for 1 spp.
    sigma_depth : float, 1e-3..1e3
        Tolerated depth difference in units of the surface's own slope. 1 as in the paper (section 4.4).
    sigma_normal : float, 16..1024
        How sharply normals are told apart: the weight falls to 1/e at a cosine of 1 - 1/sigma_normal. 128, 7 degrees:
        for such angles the same as the paper's cosine to the power of 128.
    sigma_luminance : float, standard deviations, 1e-3..1e3
        Tolerated luminance difference, in units of its estimated noise. 4 as in the paper (section 4.4).
    depth_slope_floor : float, depth per depth and pixel, 1e-6..1
        Least slope that still counts as one surface. 1e-3 bridges rounding and the faint relief of a wall that faces
        the camera, and is far below the step to anything behind it.
    alpha_color, alpha_moments : float, 0..1
        Least share of the new frame in the accumulated colour and luminance moments. 0.2 as in the paper (section 4.1).
        Less is steadier and lags more. Colour is fed back filtered, so that detail in the light itself (not in the
        albedo) softens with every frame it is kept: 0 is no way to converge on a still picture.
    depth_threshold : float, relative to depth, 0..1
        Reprojection: how far a tap may lie off the expected depth, beside one pixel of the surface's slope. 0.02
        forgives curvature between the frames' sample positions and still tells objects a hand apart across a room.
    normal_threshold : float, cosine, -1..1
        Reprojection: least cosine between the normals of pixel and tap. 0.9, 26 degrees, as much as a small ball's
        surface turns within a pixel or two.
    taa : bool
        Temporal antialiasing after the filter; off, because a renderer often has its own. For radiance up to about 1e4:
        brighter light loses precision, and nothing above 1e6 comes back.
    alpha_taa : float, 0..1
        Share of the new frame in the antialiased picture. 0.2: on the moving demo 0.8 dB better than the usual 0.1, for
        each resampling of the history softens it; less suits a still camera.
    taps : "5x5" or "3x3"
        Of an a-trous level: the paper's cubic B-spline, or the linear one, which sees a third of the neighbours. 3x3:
        over five levels it takes 0.6 of the time and blurs less, 0.8 to 1.3 dB better in an evenly lit box and as good
        in Sponza, where it leaves 7 % more flicker.
    precision : "precise" or "fast"
        Weights of the a-trous filter and the spatial variance: exponentials to 4e-6, or with straight lines between the
        powers of two, up to 6 % larger. Fast takes a sixth less time and looks the same, to 0.07 dB; yet single pixels
        are off the exact filter by up to a tenth of the picture's mean. Precise, so that a picture is the same to 1e-6
        wherever it is made.
    half_guides : bool
        Keep normals as 16-bit whole numbers: 6 of the guide's 16 bytes less a pixel, an error of 2^-16. Off: no faster
        on a CPU, where the time saved on memory is spent on converting.
    half_history : bool
        Keep illumination, its history and its moments as 16-bit floats: half their memory, an error of 2^-12, of light
        that stands still up to 2^-11 / alpha_color (or 2^-6: an alpha below 1/32 counts as that), and illumination that
        saturates at 65504. Off: no faster on a CPU.
    """

    iterations: int = 5
    sigma_depth: float = 1.0
    sigma_normal: float = 128.0
    sigma_luminance: float = 4.0
    depth_slope_floor: float = 1e-3
    alpha_color: float = 0.2
    alpha_moments: float = 0.2
    depth_threshold: float = 0.02
    normal_threshold: float = 0.9
    taa: bool = False
    alpha_taa: float = 0.2
    taps: str = "3x3"
    precision: str = "precise"
    half_guides: bool = False
    half_history: bool = False

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in RANGES:
                check_number(field.name, value, whole=isinstance(field.default, int))
            elif field.name in CHOICES:
                if not isinstance(value, str) or value not in CHOICES[field.name]:
                    raise SettingsError(
                        f"Settings.{field.name}: expected {describe_choice(field.name)}, got {shown(value)}"
                    )
            elif not isinstance(value, bool):
                raise SettingsError(f"Settings.{field.name}: expected True or False, got {shown(value)}")

    @property
    def defines(self) -> dict[str, int]:
        """The kernels' macros; every other setting is an argument, so that tuning it compiles nothing."""
        return {"FAST": int(self.precision == "fast"), "RADIUS": self.radius, "TAA": int(self.taa)} | {
            "HALF_GUIDES": int(self.half_guides),
            "HALF_HISTORY": int(self.half_history),
        }

    @property
    def radius(self) -> int:
        """Taps of an a-trous level to either side of the middle one."""
        return {"5x5": 2, "3x3": 1}[self.taps]


def describe_choice(name: str) -> str:
    """The values of a setting that is a word: ``'precise' or 'fast'``."""
    return " or ".join(repr(choice) for choice in CHOICES[name])


def check_number(name: str, value: object, *, whole: bool) -> None:
    """Raise `SettingsError` unless `value` is a number (a whole one where asked) within the setting's range."""
    low, high = RANGES[name]
    kind = "a whole number" if whole else "a number"
    number = isinstance(value, Integral if whole else Real) and not isinstance(value, bool)
    if not number or not low <= value <= high:  # type: ignore[operator]
        raise SettingsError(f"Settings.{name}: expected {kind} in {low:g}..{high:g}, got {shown(value)}")
