"""Kalman: SVGF with a Kalman gain, and a test for changes of light. Equations: docs/algorithm.md."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from svgf_cl.filters import operations
from svgf_cl.filters.operations import DISTANCE, EXP, LightOperations
from svgf_cl.filters.pipeline import PAST, Access, Life, Number, Pass, Pipeline, Quantity, Resource, access, user
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import BLOCK, CROSS, HERE, footprint, grid
from svgf_cl.filters.temporal import Plane
from svgf_cl.filters.wavelet import WaveletFilter
from svgf_cl.settings import documented, number, switch

SPACING = 2  # pixels: the test for changes runs at every second pixel of every second row
CARRIED = ("color", "spread", "inverse_count", "tone", "residual")  # quantities of the state that the next frame reads
FILTERED = "filtered"  # the name of the last level, whose luminance the next frame reads, for any number of levels
STANDARD_ERROR = "standard_error"  # the name of the stage, and of the channel in files

STEPS = (1, 2, 4)  # coarse pixels between the taps of each pass of the test after the first


@documented
@dataclass(frozen=True, kw_only=True)
class Kalman(WaveletFilter):
    """Parameters of the Kalman filter. Equations: docs/algorithm.md.

    Light accumulates unfiltered, with a gain that depends on its uncertainty. A test over neighbourhoods of growing
    size finds where the light has changed; there the history is corrected and trusted less. The a-trous levels filter
    only the picture that is shown. They use the variance of a mean, not the variance of a sample.
    """

    name: ClassVar[str] = "kalman"

    alpha_color: float = number(
        0.05,
        (0.0, 1.0),
        unit="share of a frame",
        reason="Smallest share of the new frame in the accumulated light. 0.05, not 0.2 as in SVGF: a test finds "
        "changes of light, so the history need not be short to follow them. From 0.02 to 0.1 it hardly "
        "matters.",
    )
    iterations: int = number(
        4,
        (1, 5),
        unit="levels",
        reason="Number of a-trous levels; each doubles the filter's reach. 4: they filter a mean over many frames, "
        "and a fifth level takes a tenth more time and gains nothing.",
    )
    sigma_depth: float = number(
        2.0,
        (1e-3, 1e3),
        unit="slopes of the surface",
        reason="Tolerated depth difference, in units of the surface's own slope. 2: pixels of curved surfaces keep "
        "their neighbours; within a factor of two it hardly matters.",
    )
    sigma_normal: float = number(
        32.0,
        (8, 1024),
        unit="1 / (1 - cosine)",
        reason="How strictly normals are compared: the weight falls to 1/e at a cosine of 1 - 1/sigma_normal. 32 (14 "
        "degrees): the weight for light is so good that bumps of one surface need not be treated as different "
        "surfaces.",
    )
    sigma_luminance: float = number(
        4.5,
        (1e-3, 1e3),
        unit="standard deviations",
        reason="Tolerated luminance difference, in units of the estimated noise of the mean. 4.5: a smaller value "
        "leaves noise, a larger one blurs shadows; from 3 to 5 the picture is within 0.2 dB.",
    )
    change_threshold: float = number(
        2.65,
        (0.0, 1e3),
        unit="standard deviations",
        reason="How much the new frame must differ from the history to count as a change of light. A smaller value "
        "follows moving shadows sooner, a larger one is steadier with fireflies: at 2.65 the filter is as "
        "steady there as SVGF. At 1000, changes are found only in light without any noise.",
    )
    change_sigma_depth: float = number(
        4.0,
        (1e-3, 1e3),
        unit="slopes of the surface",
        reason="As sigma_depth, for the test and for smoothing the guidance. 4: a change of light does not stop "
        "where a surface bends, and a test over more pixels finds smaller changes.",
    )
    change_sigma_normal: float = number(
        8.0,
        (1, 1024),
        unit="1 / (1 - cosine)",
        reason="As sigma_normal, for the test and for smoothing the guidance. 8 (29 degrees), for the same reason.",
    )

    standard_error: bool = switch(
        False,
        reason="Also make the stage standard_error, an estimate of the standard error of each pixel's luminance "
        "before antialiasing. It is 0 where the ray hit nothing, because that light is not filtered. Off, "
        "because it is another pass.",
    )

    @property
    def change_scalars(self) -> dict[str, Number]:
        """The settings by which the test compares surfaces, as arguments of kernels."""
        return {
            "sigma_depth": self.change_sigma_depth,
            "sigma_normal": self.change_sigma_normal,
            "depth_slope_floor": self.depth_slope_floor,
        }

    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame: predict, test, update, levels. The next frame reads the last level's luminance."""
        names = [*(f"level_{level}" for level in range(1, self.iterations)), FILTERED]
        levels = [self.filtered(inputs, name, is_last=name == FILTERED) for name in names]
        passes = (
            self.demodulate_pass(inputs),
            self.predict_pass(inputs, levels[-1]),
            *self.test_passes(inputs),
            self.update_pass(inputs),
            self.guidance_pass(inputs),
            *self.levels(
                inputs,
                [self.state(inputs), *levels],
                {"sigma_luminance": self.sigma_luminance},
                LightOperations(
                    weight=2 + DISTANCE + 1 + EXP[self.precision],  # (l + G) / 2; w_l; w
                    sums=2 * 3 + 1 + 2 + 1,  # w c; w^2 Var; w
                    once=operations.SMOOTH_VARIANCE + 2 + 1 + 3 + 2,  # scale of w_l; the quotients
                ),
                [self.guidance(inputs, "guidance_1"), *[self.guidance(inputs, "guidance")] * (self.iterations - 1)],
            ),
            *self.last_passes(inputs, levels[-1]),
            # at the end, because a later pass could reuse the memory of its input
            *self.confidence_passes(inputs, levels[-1]),
        )
        return Pipeline(passes, inputs.defines | self.macros | {"GUIDED_BY_VARIANCE": 1, "GUIDED_BY_PAST": 1})

    def predict_pass(self, inputs: Inputs, filtered: Resource) -> Pass:
        """Move the state of the previous frame along motion, and compare the new frame with it."""
        guide, state = self.guide(inputs), self.state(inputs)
        taps = footprint(2)
        return Pass(
            "predict",
            "predict",
            scalars={name: getattr(self, name) for name in ("depth_threshold", "normal_threshold", "albedo_threshold")},
            per_frame=("frame_number", *PAST),
            reads=(
                user("motion", channels=inputs.motion),
                access(guide, taps=dict.fromkeys(guide.names, HERE) | {"depth": CROSS}),
                access(self.demodulated(inputs), "illumination"),
                access(guide, taps=dict.fromkeys(guide.names, taps), previous=True),
                access(state, taps=dict.fromkeys(CARRIED, taps), previous=True),
                access(filtered, "filtered", {"color": taps}),
            ),
            writes=(access(self.prediction(inputs)), access(self.innovation(inputs))),
            rarely=(footprint(4),),  # for thin geometry: the nine pixels around the nearest one
            operations=operations.predict(inputs),
        )

    def test_passes(self, inputs: Inputs) -> Iterator[Pass]:
        """Average the innovation over growing neighbourhoods, and decide how much of it is a change of light."""
        signals = len(inputs.signals)
        guide, facets, innovation = self.guide(inputs), self.facets(), self.innovation(inputs)
        changes = [self.change(inputs, scale) for scale in range(1, len(STEPS) + 1)]
        yield Pass(
            "change",
            "innovation_mean",
            scalars=self.change_scalars,
            reads=(
                access(guide, taps={"depth": BLOCK | CROSS, "normal": BLOCK}),
                access(innovation, taps=dict.fromkeys(innovation.names, BLOCK)),
            ),
            writes=(access(facets), access(changes[0], "change")),
            operations=operations.mean_of_change(taps=3, signals=signals) + operations.GRADIENT,
        )
        for step, finer, coarser in zip(STEPS, changes, [*changes[1:], None], strict=True):
            taps = grid(1, step)
            means = (
                access(facets, taps={"depth": taps, "gradient": HERE, "normal": taps}),
                access(finer, "finer", dict.fromkeys(finer.names, taps)),
            )
            common = {"step": step, **self.change_scalars}
            cost = operations.mean_of_change(taps=8, signals=signals)
            if coarser:
                yield Pass(
                    "change",
                    "coarser_mean",
                    common,
                    reads=means,
                    writes=(access(coarser, "change"),),
                    operations=cost,
                    level=step,
                )
            else:
                yield Pass(
                    "change",
                    "detect",
                    scalars={**common, "change_threshold": self.change_threshold},
                    reads=(
                        access(self.prediction(inputs), taps={"tone": HERE}),
                        access(changes[1], "near"),
                        *means,
                    ),
                    writes=(access(self.correction(inputs)),),
                    operations=cost + operations.detect(signals),
                )

    def update_pass(self, inputs: Inputs) -> Pass:
        """Correct the prediction by the change of light, then blend it with the new light by the Kalman gain."""
        state = self.state(inputs)
        return Pass(
            "update",
            "update",
            scalars={
                **self.change_scalars,
                "change_threshold": self.change_threshold,
                "alpha_color": self.alpha_color,
            },
            reads=(
                access(self.guide(inputs), taps={"depth": CROSS, "normal": HERE}),
                access(self.innovation(inputs)),
                access(self.prediction(inputs)),
                access(self.facets(), taps={"depth": BLOCK, "normal": BLOCK}),
                access(self.correction(inputs), taps=dict.fromkeys(self.correction(inputs).names, BLOCK)),
            ),
            writes=(access(state, taps=dict.fromkeys(CARRIED, HERE)), access(self.expected(inputs))),
            rarely=(grid(3),),  # for objects that are too thin to be seen at every second pixel
            operations=operations.update(inputs),
        )

    def guidance_pass(self, inputs: Inputs) -> Pass:
        """Compute the luminance by which the levels compare light, and the variance where history is short."""
        guide, state = self.guide(inputs), self.state(inputs)
        near = grid(1)
        return Pass(
            "guidance",
            "guidance",
            scalars={**self.change_scalars, "albedo_threshold": self.albedo_threshold},
            reads=(
                access(guide, taps={"depth": near, "normal": near}),
                access(self.expected(inputs)),
                access(state, taps={"color": near, "inverse_count": HERE}),
            ),
            writes=(
                access(state, "illumination", {"variance": HERE}),
                access(self.guidance(inputs, "guidance_1"), "first"),
                access(self.guidance(inputs, "guidance")),
            ),
            rarely=(grid(3),),  # where history is short
            operations=operations.guidance(inputs),
        )

    def confidence_passes(self, inputs: Inputs, filtered: Resource) -> Iterator[Pass]:
        """Compute the standard error of the filtered light, if the setting is on."""
        if not self.standard_error:
            return
        albedo = (user("albedo"),) if inputs.divides_by_albedo else ()
        error = Quantity(STANDARD_ERROR, stage=STANDARD_ERROR)
        yield Pass(
            "confidence",
            "standard_error",
            reads=(*albedo, access(filtered, "illumination", {"variance": HERE})),
            writes=(access(Resource("confidence", "confidence", (error,))),),
            operations=operations.standard_error(inputs),
        )

    def age(self, inputs: Inputs) -> Access:
        """The inverse of the number of samples in the history, which antialiasing reads."""
        return access(self.state(inputs), "moments", {"inverse_count": grid(1)})

    def uncertainty(self, stage: Callable[[str], Plane]) -> Plane:
        """As in `TemporalFilter`, but read from the state; with several signals, their mean."""
        return np.asarray(stage("inverse_count").mean(axis=0))

    def state(self, inputs: Inputs) -> Resource:
        """The accumulated light, its variance, and the other quantities that the next frame reads."""
        signals, light, variance = len(inputs.signals), self.light_format, self.variance_format
        quantities = (
            self.color(inputs, "accumulated"),
            Quantity("variance", 1, signals, variance, "variance"),
            Quantity("spread", 1, signals, variance, "sample_variance"),
            Quantity("inverse_count", 1, signals, light, "inverse_count"),
            Quantity("tone", 1, signals, light, "tone"),
            Quantity("residual", 1, signals, light, "residual"),
        )
        return Resource("state", "illumination", quantities, Life.PAIR, over="prediction")

    def prediction(self, inputs: Inputs) -> Resource:
        """The state of the previous frame at the place where the pixel was, and the luminance that was shown there."""
        names = ("spread", "inverse_count", "tone", "luminance")
        signals = len(inputs.signals)
        color = Quantity("color", 3, signals, stage="predicted", is_light=True)
        others = (Quantity(name, 1, signals, stage=f"predicted_{name}") for name in names)
        return Resource("prediction", "prediction", (color, *others))

    def innovation(self, inputs: Inputs) -> Resource:
        """The difference between the new frame and the prediction; the residual is huge if there is no prediction."""
        signals = len(inputs.signals)
        color = Quantity("color", 3, signals, stage="innovation", is_light=True)
        residual = Quantity("residual", 1, signals, stage="innovation_residual")
        return Resource("innovation", "innovation", (color, residual))

    def facets(self) -> Resource:
        """The surface at every second pixel; depth is 0 where there is no prediction."""
        gradient, normal = Quantity("gradient", 2, stage="facet_gradient"), Quantity("normal", 3, stage="facet_normal")
        return Resource("facets", "facets", (Quantity("depth", stage="facet_depth"), gradient, normal), spacing=SPACING)

    def change(self, inputs: Inputs, scale: int) -> Resource:
        """Means of the innovation over a neighbourhood, and their variance as a share of a sample's variance."""
        signals, stage = len(inputs.signals), f"change_{scale}"
        color = Quantity("color", 3, signals, stage=stage, is_light=True)
        names = ("square", "residual", "residual_square")
        others = (Quantity(name, 1, signals, stage=f"{stage}_{name}") for name in names)
        return Resource(stage, "change", (Quantity("share", stage=f"{stage}_share"), color, *others), spacing=SPACING)

    def correction(self, inputs: Inputs) -> Resource:
        """The change of light, its uncertainty, and the variance of the innovation over space."""
        signals = len(inputs.signals)
        color = Quantity("color", 3, signals, stage="correction", is_light=True)
        names = ("residual", "doubt", "spread")
        others = (Quantity(name, 1, signals, stage=f"correction_{name}") for name in names)
        return Resource("correction", "correction", (color, *others), spacing=SPACING)

    def expected(self, inputs: Inputs) -> Resource:
        """The luminance that the picture is expected to have, and the variance of the mean."""
        names = ("luminance", "variance")
        quantities = tuple(Quantity(name, 1, len(inputs.signals), stage=f"expected_{name}") for name in names)
        return Resource("expected", "expected", quantities)

    def guidance(self, inputs: Inputs, name: str) -> Resource:
        """The luminance that a level adds to the luminance of its own light when it compares light."""
        return Resource(name, "guidance", (Quantity("luminance", 1, len(inputs.signals), stage=name),))

    def filtered(self, inputs: Inputs, name: str, *, is_last: bool) -> Resource:
        """The output of a level; the next frame reads the luminance of the last level."""
        spread = Quantity("variance", 1, len(inputs.signals), self.variance_format, f"{name}_variance")
        life = Life.HISTORY if is_last else Life.SCRATCH
        return Resource(name, "illumination", (self.color(inputs, name), spread), life)
