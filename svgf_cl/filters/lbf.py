"""LBF: a bilateral filter whose parameters a small network chooses (Kalantari et al. 2015), over accumulated light."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from svgf_cl.filters import operations
from svgf_cl.filters.bilateral import BilateralFilter
from svgf_cl.filters.operations import EXP
from svgf_cl.filters.pipeline import Pass, Pipeline, Quantity, Resource, access
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import HERE, grid
from svgf_cl.settings import documented

INPUTS = 31  # statistics of a neighbourhood
HIDDEN = 10
OUTPUTS = 4  # the filter's parameters: for distance, depth, normal and light
WINDOW = 10  # pixels to either side
WIDE = 3  # pixels to either side, for the larger neighbourhood of the statistics
FILE = "lbf.json"  # beside this module; `python -m benchmarks.training` writes it

Weights = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Network:
    """A perceptron of one hidden layer: ``second @ softsign(first @ x + first_bias) + second_bias``.

    Parameters
    ----------
    first : (HIDDEN, INPUTS)
    first_bias : (HIDDEN,)
    second : (OUTPUTS, HIDDEN)
    second_bias : (OUTPUTS,)
    """

    first: Weights
    first_bias: Weights
    second: Weights
    second_bias: Weights

    @classmethod
    def of(cls, lists: Mapping[str, Any]) -> Network:
        """Read lists of numbers, by the names of the parameters."""
        return cls(**{name: np.array(lists[name], np.float64) for name in cls.__dataclass_fields__})

    @classmethod
    @cache
    def shipped(cls) -> Network:
        """The network that comes with the library; `FILE` also says which data and command made it."""
        text = (resources.files("svgf_cl.filters") / FILE).read_text(encoding="utf-8")
        return cls.of(json.loads(text)["network"])

    def flat(self) -> NDArray[np.float32]:
        """All numbers in the order in which the kernel reads them."""
        parts = (self.first.T, self.first_bias, self.second.T, self.second_bias)
        return np.concatenate([part.ravel() for part in parts]).astype(np.float32)


@documented
@dataclass(frozen=True, kw_only=True)
class Lbf(BilateralFilter):
    """Parameters of the learning-based filter (Kalantari et al. 2015). Equations: docs/algorithm.md, section 8.

    A small network reads statistics of each pixel's neighbourhood, and sets the parameters of a bilateral filter
    there. It was trained on frames of this project's tracer (docs/lbf.md). LBF is for comparison.
    """

    name: ClassVar[str] = "lbf"

    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame: accumulation, then the network, then the window."""
        exponents = Quantity("exponents", OUTPUTS, len(inputs.signals), stage="parameters")
        parameters = Resource("parameters", "parameters", (exponents,))
        passes = (
            *self.first_passes(inputs),
            self.network_pass(inputs, parameters),
            self.bilateral_pass(inputs, parameters),
            *self.last_passes(inputs, self.filtered(inputs)),
        )
        macros = {"LEARNED": 1, "WINDOW": WINDOW, "INPUTS": INPUTS, "HIDDEN": HIDDEN}
        return Pipeline(passes, inputs.defines | self.macros | macros)

    def network_pass(self, inputs: Inputs, parameters: Resource) -> Pass:
        """The parameters of every pixel."""
        taps = grid(WIDE)
        return Pass(
            "network",
            "network",
            arrays={"network": Network.shipped().flat()},
            reads=(
                self.surface(inputs, taps),
                access(self.accumulated(inputs), "source", {"color": taps, "variance": grid(1)}),
                access(self.moments(inputs), taps={"length": HERE}),
            ),
            writes=(access(parameters),),
            operations=operations.network(inputs, len(taps.offsets), (INPUTS, HIDDEN, OUTPUTS), EXP[self.precision]),
        )

    def bilateral_pass(self, inputs: Inputs, parameters: Resource) -> Pass:
        """The mean over the window."""
        taps = grid(WINDOW)
        return Pass(
            "bilateral",
            "bilateral",
            scalars={"albedo_threshold": self.albedo_threshold, "depth_slope_floor": self.depth_slope_floor},
            reads=(
                self.surface(inputs, taps),
                access(self.accumulated(inputs), "source", {"color": taps, "variance": grid(1)}),
                access(parameters),
            ),
            writes=(access(self.filtered(inputs), "target"),),
            operations=operations.window(inputs, len(taps.offsets) - 1, EXP[self.precision]),
        )
