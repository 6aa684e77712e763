"""Kalman: SVGF with a Kalman gain and a test for changes of light. Equations: docs/algorithm.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from svgf_cl.filters import operations
from svgf_cl.filters.formats import Format
from svgf_cl.filters.operations import DISTANCE, EXP, LightOperations
from svgf_cl.filters.pipeline import Life, Number, Pass, Pipeline, Quantity, Resource, access, user
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import CROSS, HERE, Taps, footprint, grid
from svgf_cl.filters.wavelet import WaveletFilter
from svgf_cl.settings import documented, number

SPACING = 2  # of the pixels at which light is tested for change
SCALES = 4


@documented
@dataclass(frozen=True, kw_only=True)
class Kalman(WaveletFilter):
    """Parameters."""

    name: ClassVar[str] = "kalman"

    alpha_color: float = number(0.05, (0.0, 1.0), unit="share of a frame", reason="x")
    iterations: int = number(4, (1, 5), unit="levels", reason="x")
    sigma_depth: float = number(2.0, (1e-3, 1e3), unit="slopes of the surface", reason="x")
    sigma_normal: float = number(32.0, (8, 1024), unit="1 / (1 - cosine)", reason="x")
    sigma_luminance: float = number(5.0, (1e-3, 1e3), unit="standard deviations", reason="x")
    change_threshold: float = number(2.2, (0.0, 100.0), unit="standard deviations", reason="x")
    change_sigma_depth: float = number(4.0, (1e-3, 1e3), unit="slopes of the surface", reason="x")
    change_sigma_normal: float = number(8.0, (1, 1024), unit="1 / (1 - cosine)", reason="x")

    def pipeline(self, inputs: Inputs) -> Pipeline:
        state = self.state(inputs)
        prediction, innovation = self.prediction(inputs), self.innovation(inputs)
        facets = Resource("facets", "facets", (Quantity("depth"), Quantity("gradient", 2), Quantity("normal", 3)), spacing=SPACING)
        changes = [self.change(inputs, scale) for scale in range(1, SCALES)]
        correction = self.correction(inputs)
        first, guidance = (self.guidance(inputs, *names) for names in (("first_guidance",), ("guidance", "expected")))
        n = len(inputs.signals)
        expected = Resource("expected", "expected", (Quantity("luminance", 1, n, stage="expected"), Quantity("spread", 1, n, stage="spread_over_space")))
        levels = [self.illumination(inputs, f"level_{level}", Life.HISTORY if level == self.iterations else Life.SCRATCH) for level in range(1, self.iterations + 1)]
        guide = self.guide(inputs)
        taps = footprint(2)
        near = grid(1)
        loose: dict[str, Number] = {"sigma_depth": self.change_sigma_depth, "sigma_normal": self.change_sigma_normal, "depth_slope_floor": self.depth_slope_floor}
        predict = Pass(
            "predict", "predict",
            scalars={name: getattr(self, name) for name in ("depth_threshold", "normal_threshold", "albedo_threshold")},
            per_frame=("frame_number",),
            reads=(
                user("motion", channels=inputs.motion),
                access(guide, taps=dict.fromkeys(guide.names, HERE) | {"depth": CROSS}),
                access(self.demodulated(inputs), "illumination"),
                access(guide, taps=dict.fromkeys(guide.names, taps), previous=True),
                access(state, taps=dict.fromkeys([n for n in state.names if n != "variance"], taps), previous=True),
                access(levels[-1], "filtered", {"color": taps}),
            ),
            writes=(access(prediction), access(innovation)),
        )
        near_guide = {name: near for name in ("depth", "normal")}
        block = Taps(frozenset({(0, 0), (1, 0), (0, 1), (1, 1)}))
        mean = Pass("change", "innovation_mean", scalars=loose,
            reads=(access(guide, taps={"depth": block | CROSS, "normal": block}), access(innovation, taps=dict.fromkeys(innovation.names, block))),
            writes=(access(facets), access(changes[0], "change")))
        coarser = []
        for step, (finer, coarse) in enumerate(zip(changes, changes[1:]), 1):
            t = grid(1, step)
            coarser.append(Pass("change", "coarser_mean", scalars={"step": step, **loose},
                reads=(access(facets, taps={"depth": t, "gradient": HERE, "normal": t}), access(finer, "finer", dict.fromkeys(finer.names, t))),
                writes=(access(coarse, "change"),), level=step + 1))
        t = grid(1, 4)
        detect = Pass("change", "detect", scalars={"step": 4, **loose, "change_threshold": self.change_threshold},
            reads=(access(prediction, taps={"tone": HERE}), access(facets, taps={"depth": t, "gradient": HERE, "normal": t}), access(changes[1]), access(changes[2], taps=dict.fromkeys(changes[2].names, t))),
            writes=(access(correction),))
        update = Pass("update", "update", scalars={**loose, "change_threshold": self.change_threshold, "alpha_color": self.alpha_color},
            reads=(access(guide, taps={"depth": CROSS, "normal": HERE}), access(self.demodulated(inputs), "illumination"), access(innovation),
                access(prediction), access(facets, taps={"depth": HERE, "normal": HERE}), access(correction)),
            writes=(access(state, taps=dict.fromkeys([n for n in state.names if n != "variance"], HERE)), access(expected)))
        guide_pass = Pass("guidance", "guidance", scalars={**loose, "albedo_threshold": self.albedo_threshold} if False else {"sigma_depth": self.change_sigma_depth, "sigma_normal": self.change_sigma_normal, "albedo_threshold": self.albedo_threshold, "depth_slope_floor": self.depth_slope_floor},
            reads=(access(guide, taps=near_guide), access(expected), access(state, taps={"color": near, "spread": HERE, "inverse_count": HERE})),
            writes=(access(state, "illumination", {"variance": HERE}), access(first, "first"), access(guidance)))
        smooth = 9 * (2 + 1 + 1) + 1 + 1 + 4 + 1
        passes = (
            self.demodulate_pass(inputs), predict, mean, *coarser, detect, update, guide_pass,
            *self.levels(inputs, [state, *levels], {"sigma_luminance": self.sigma_luminance},
                LightOperations(weight=DISTANCE + 3 + EXP[self.precision], sums=2 * 3 + 1 + 2 + 1, once=smooth + 2 + 1 + 3 + 2),
                [first] + [guidance] * (self.iterations - 1)),
            *self.last_passes(inputs, levels[-1]),
        )
        return Pipeline(passes, inputs.defines | self.macros | {"GUIDED_BY_VARIANCE": 1, "GUIDED_BY_PAST": 1})

    def illumination(self, inputs, name, life=Life.SCRATCH):
        spread = Quantity("variance", 1, len(inputs.signals), self.variance_format, f"{name}_variance")
        return Resource(name, "illumination", (self.color(inputs, name), spread), life)

    def state(self, inputs):
        n = len(inputs.signals)
        return Resource("state", "illumination", (
            self.color(inputs, "accumulated"),
            Quantity("variance", 1, n, self.variance_format, "variance"),
            Quantity("spread", 1, n, self.variance_format, "moment_variance"),
            Quantity("inverse_count", 1, n, self.light_format, "inverse_count"),
            Quantity("tone", 1, n, self.light_format, "tone"),
            Quantity("residual", 1, n, self.light_format, "residual"),
        ), Life.PAIR, over="prediction")

    def prediction(self, inputs):
        n = len(inputs.signals)
        return Resource("prediction", "prediction", (
            Quantity("color", 3, n, stage="predicted", is_light=True),
            Quantity("spread", 1, n), Quantity("inverse_count", 1, n), Quantity("tone", 1, n), Quantity("luminance", 1, n)))

    def innovation(self, inputs):
        n = len(inputs.signals)
        return Resource("innovation", "innovation", (Quantity("depth", stage="known_depth"), Quantity("color", 3, n, stage="innovation", is_light=True), Quantity("residual", 1, n, stage="innovation_residual")))

    def change(self, inputs, scale):
        n = len(inputs.signals)
        return Resource(f"change_{scale}", "change", (Quantity("share"), Quantity("color", 3, n, stage=f"change_{scale}", is_light=True), Quantity("square", 1, n), Quantity("residual", 1, n), Quantity("residual_square", 1, n)), spacing=SPACING)

    def correction(self, inputs):
        n = len(inputs.signals)
        return Resource("correction", "correction", (Quantity("color", 3, n, stage="correction", is_light=True), Quantity("residual", 1, n), Quantity("doubt", 1, n, stage="doubt"), Quantity("spread", 1, n)), spacing=SPACING)

    def guidance(self, inputs, name, over=""):
        return Resource(name, "guidance", (Quantity("luminance", 1, len(inputs.signals), stage=name),), over=over)
