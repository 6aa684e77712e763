"""Filters that accumulate light over time: their settings, buffers and passes, from demodulation to antialiasing.

Equations: docs/algorithm.md, sections 1, 2, 5 and 6.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl.errors import SettingsError
from svgf_cl.filters import operations
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.formats import Format
from svgf_cl.filters.pipeline import OUT, PAST, Access, Life, Pass, Quantity, Resource, access, user
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import CROSS, HERE, footprint, grid
from svgf_cl.settings import number, switch

Plane = NDArray[np.float32]

UNKNOWN = -1e30  # TAA's history before the first frame; less than KNOWN of taa.cl, and finite, so that 0 times it is 0


@dataclass(frozen=True, kw_only=True)
class TemporalFilter(Filter):
    """A filter that accumulates noisy light along motion."""

    alpha_color: float = number(
        0.2,
        (0.0, 1.0),
        unit="share of a frame",
        reason="Smallest share of the new frame in the accumulated colour. 0.2 as in SVGF's paper (section 4.1). A "
        "smaller value is steadier and lags more. SVGF's history is filtered again in every frame, which "
        "blurs detail of the light (but not of the albedo), so even at 0 a still picture does not converge.",
    )
    depth_threshold: float = number(
        0.02,
        (0.0, 1.0),
        unit="relative to depth",
        reason="Reprojection: how much the depth of a tap may differ from the expected depth, in addition to one "
        "pixel of the surface's slope. 0.02 tolerates curvature between the samples of two frames, and still "
        "distinguishes objects a hand's width apart across a room.",
    )
    normal_threshold: float = number(
        0.9,
        (-1.0, 1.0),
        unit="cosine",
        reason="Reprojection: smallest cosine between the normals of pixel and tap. 0.9 (26 degrees): the surface of "
        "a small ball turns this much within a pixel or two.",
    )
    albedo_threshold: float = number(
        1.75,
        (0.0, 8.0),
        unit="octaves",
        reason="Light is mixed only between pixels whose albedos differ by at most this many factors of two in every "
        "channel. Light that is not multiplied by albedo, such as a reflection on black paint, would become "
        "far too bright or too dark with another albedo. 1.75 (a factor of 3.4): tiles of any albedos under a "
        "coat have less error in the result than in the input, and most textures keep their neighbours. At 8, "
        "albedo has no effect, as in the papers.",
    )
    taa: bool = switch(False, reason="Temporal antialiasing after the filter; off, as a renderer often has its own.")
    alpha_taa: float = number(
        0.2,
        (0.0, 1.0),
        unit="share of a frame",
        reason="Share of the new frame in the antialiased picture, a mean of radiance. 0.2 is 0.8 dB better than the "
        "usual 0.1 on the moving demo, because each resampling of the history blurs it; with a still camera, "
        "a smaller value is better.",
    )
    pixel_filter: float = number(
        0.0,
        (0.0, 0.25),
        unit="share of a pixel",
        reason="Share that a pixel takes from each of its two neighbours in a row, and in a column, of the new frame "
        "in antialiasing; needs taa. At 0, a pixel is the mean over its own square. Above 0 it imitates the "
        "pixel filter of a renderer, for frames without such a filter: 0.15 is close to Blender's default.",
    )
    half_guides: bool = switch(
        False,
        reason="Store normals as 16-bit integers: saves 6 of the guide's 16 bytes a pixel, with an error of 2^-16. "
        "Off, because on a CPU it is no faster: conversions take the time that less memory saves.",
    )
    half_history: bool = switch(
        False,
        reason="Store illumination, its history and its moments as 16-bit floats: half the memory, an error of "
        "2^-12, and in still light up to 2^-11 / alpha_color (at most 2^-6, because an alpha below 1/32 is "
        "treated as 1/32). Illumination is limited to 65504. Off, because on a CPU it is no faster.",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.pixel_filter and not self.taa:
            raise SettingsError(
                f"{type(self).__name__}.pixel_filter: expected 0 without taa, got {self.pixel_filter}; set taa=on too"
            )

    @property
    def macros(self) -> dict[str, int]:
        """The macros that these settings set."""
        return {"TAA": int(self.taa), "HALF_GUIDES": int(self.half_guides), "HALF_HISTORY": int(self.half_history)}

    @property
    def light_format(self) -> Format:
        """The format of light, of its mean, and of the length of its history."""
        return Format.HALF if self.half_history else Format.FLOAT

    @property
    def variance_format(self) -> Format:
        """The format of a variance of light."""
        return Format.ROOT if self.half_history else Format.FLOAT

    def guide(self, inputs: Inputs) -> Resource:
        """The surface that a pixel shows; its depth is 0 at a miss."""
        depth = Quantity("depth", stage="depth")
        id_ = (Quantity("id"),) if inputs.id else ()
        albedo = (Quantity("albedo"),) if inputs.divides_by_albedo else ()
        normal = Quantity("normal", 3, format=Format.SNORM if self.half_guides else Format.FLOAT, stage="normal")
        return Resource("guide", "guide", (depth, *id_, *albedo, normal), Life.PAIR)

    def color(self, inputs: Inputs, stage: str) -> Quantity:
        """Light divided by albedo."""
        return Quantity("color", 3, len(inputs.signals), self.light_format, stage, is_light=True)

    def demodulated(self, inputs: Inputs) -> Resource:
        """The frame's noisy light."""
        return Resource("demodulated", "illumination", (self.color(inputs, "demodulated"),))

    def moments(self, inputs: Inputs) -> Resource:
        """The length of the history in frames, and the moments of each signal's luminance."""
        known = {"mean": (self.light_format, "mean"), "variance": (self.variance_format, "moment_variance")}
        carried = {signal.carries for signal in inputs.signals}
        if len(carried) > 1:
            raise ValueError(f"expected signals that carry the same, as kernels index all alike, got {carried}")
        quantities = [Quantity(name, 1, len(inputs.signals), *known[name]) for name in carried.pop()]
        length = Quantity("length", format=self.light_format, stage="history_length")
        return Resource("moments", "moments", (length, *quantities), Life.PAIR)

    def demodulate_pass(self, inputs: Inputs) -> Pass:
        """Replace invalid values in the user's arrays, divide light by albedo, and write planes."""
        light = tuple(user(signal.field, f"radiance_{number}") for number, signal in enumerate(inputs.signals))
        given = (("albedo", inputs.divides_by_albedo), ("emission", inputs.emission_signal >= 0))
        optional = [name for name, read in given if read]
        surface = ("normal", "depth", "id") if inputs.id else ("normal", "depth")
        return Pass(
            "modulate",
            "demodulate",
            reads=(*light, *map(user, optional), *map(user, surface)),
            writes=(access(self.guide(inputs)), access(self.demodulated(inputs), "illumination")),
            operations=operations.demodulate(inputs),
        )

    def temporal_pass(self, inputs: Inputs, history: Resource, accumulated: Resource, *, alpha_moments: float) -> Pass:
        """Accumulate along motion: `history` of the previous frame and the new light become `accumulated`."""
        guide, moments = self.guide(inputs), self.moments(inputs)
        taps = footprint(2)
        return Pass(
            "temporal",
            "temporal",
            scalars={
                "alpha_color": self.alpha_color,
                "alpha_moments": alpha_moments,
                "depth_threshold": self.depth_threshold,
                "normal_threshold": self.normal_threshold,
                "albedo_threshold": self.albedo_threshold,
            },
            per_frame=("frame_number", *PAST),
            reads=(
                user("motion", channels=inputs.motion),
                access(guide, taps=dict.fromkeys(guide.names, HERE) | {"depth": CROSS}),
                access(self.demodulated(inputs), "illumination"),
                access(guide, taps=dict.fromkeys(guide.names, taps), previous=True),
                access(history, "history", {"color": taps}, previous=history.life is Life.PAIR),
                access(moments, taps=dict.fromkeys(moments.names, taps), previous=True),
            ),
            writes=(access(accumulated, "accumulated", {"color": HERE}), access(moments)),
            rarely=(footprint(4),),  # for thin geometry: the nine pixels around the nearest one
            operations=operations.temporal(inputs),
        )

    def last_passes(self, inputs: Inputs, filtered: Resource) -> tuple[Pass, ...]:
        """Multiply filtered light by albedo, and write the user's array; antialias first, if `taa` is on."""
        given = (("albedo", inputs.divides_by_albedo), ("emission", inputs.emission))
        optional = [name for name, read in given if read]
        picture = Resource("modulated", "picture", (Quantity("color", 3, stage="modulated"),))
        modulate = Pass(
            "modulate",
            "modulate",
            reads=(*map(user, optional), access(filtered, "illumination", {"color": HERE})),
            writes=(access(picture, OUT) if self.taa else user(OUT),),
            operations=operations.modulate(inputs),
        )
        return (modulate, self.taa_pass(inputs, picture)) if self.taa else (modulate,)

    def age(self, inputs: Inputs) -> Access:
        """The length of the history, which antialiasing reads."""
        return access(self.moments(inputs), taps={"length": grid(1)})

    def uncertainty(self, stage: Callable[[str], Plane]) -> Plane:
        """The variance of each pixel's accumulated light, in units of the variance of a sample, (H, W).

        Parameters
        ----------
        stage : callable
            Reads a stage of the last frame, as `Denoiser.stage` does.
        """
        # the variance of a mean in which the newest sample always has the weight alpha
        least = self.alpha_color / (2 - self.alpha_color)
        variance: Plane = np.maximum(1 / np.maximum(stage("history_length"), 1), np.float32(least))
        return variance

    def taa_pass(self, inputs: Inputs, picture: Resource) -> Pass:
        """Temporal antialiasing."""
        color = Quantity("color", 3, stage="antialiased", unknown=UNKNOWN)
        antialiased = Resource("antialiased", "picture", (color,), Life.PAIR)
        return Pass(
            "taa",
            "taa",
            scalars={"alpha_taa": self.alpha_taa, "pixel_filter": self.pixel_filter},
            per_frame=PAST,
            reads=(
                user("motion", channels=inputs.motion),
                access(self.guide(inputs), taps={"depth": grid(1)}),
                self.age(inputs),
                access(picture, "picture", {"color": grid(1)}),
                access(antialiased, "history", {"color": footprint(4)}, previous=True),
            ),
            writes=(access(antialiased, "next_history"), user(OUT)),
            rarely=(grid(1),),  # motion of a neighbour, beside an edge
            operations=operations.taa(filters_pixels=self.pixel_filter > 0),
        )
