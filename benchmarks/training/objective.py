"""The objective of the training: the filter's relative error over a set of pixels, and its gradient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.training.gradient import Surroundings, filtered
from benchmarks.training.samples import Sample, surroundings
from svgf_cl import Lbf
from svgf_cl.filters.lbf import HIDDEN, INPUTS, OUTPUTS, Network
from svgf_cl.oracle.albedo import OCTAVE
from svgf_cl.oracle.lbf import EXPONENTS
from svgf_cl.oracle.taps import Array, luminance

DARKNESS = 0.1  # as a share of a frame's mean light: errors in darker pixels are relative to this
DECAY = 1e-4  # weight of the squared weights in the objective

SHAPES = {
    "first": (HIDDEN, INPUTS),
    "first_bias": (HIDDEN,),
    "second": (OUTPUTS, HIDDEN),
    "second_bias": (OUTPUTS,),
}


def unpacked(values: Array) -> Network:
    """The network from a vector of all its numbers."""
    ends = np.cumsum([int(np.prod(shape)) for shape in SHAPES.values()])
    parts = np.split(values, ends[:-1])
    return Network(**{name: part.reshape(shape) for (name, shape), part in zip(SHAPES.items(), parts, strict=True)})


def packed(network: Network) -> Array:
    """All numbers of a network as a vector."""
    return np.concatenate([getattr(network, name).ravel() for name in SHAPES])


def untrained(seed: int) -> Network:
    """Small random weights, around parameters that make a moderate filter."""
    random = np.random.default_rng(seed)
    first = random.standard_normal(SHAPES["first"]) / np.sqrt(INPUTS)
    second = 0.1 * random.standard_normal(SHAPES["second"])
    return Network(first, np.zeros(HIDDEN), second, np.array((-4.5, -4.5, -2.5, -2.5)))


@dataclass(frozen=True, eq=False)
class Pixels:
    """Pixels of samples, as the objective reads them.

    Parameters
    ----------
    around : Surroundings
    places : (P, 3)
        Frame, row and column.
    seen : (P, INPUTS)
    truth : (P, 3)
    scale : (P,)
        The denominator of the error.
    """

    around: Surroundings
    places: NDArray[np.int64]
    seen: Array
    truth: Array
    scale: Array

    @classmethod
    def of(cls, samples: Sequence[Sample]) -> Pixels:
        """All pixels that are not misses."""
        places = np.argwhere(np.stack([each.guides.hit for each in samples]))
        index = tuple(places.T)
        truth = np.stack([each.truth for each in samples])
        light = luminance(truth)
        scale = light + DARKNESS * light.mean(axis=(1, 2), keepdims=True)
        around = surroundings(samples, Lbf().depth_slope_floor)
        return cls(around, places, np.stack([each.seen for each in samples])[index], truth[index], scale[index])

    def some(self, count: int, seed: int) -> Pixels:
        """A random choice of `count` pixels."""
        chosen = np.random.default_rng(seed).permutation(len(self.places))[:count]
        parts = (self.places[chosen], self.seen[chosen], self.truth[chosen], self.scale[chosen])
        return Pixels(self.around, *parts)

    def error(self, network: Network) -> tuple[float, Array]:
        """Mean squared relative error, and its gradient by all numbers of the network, in the order of `packed`."""
        bent = self.seen @ network.first.T + network.first_bias
        hidden = bent / (1 + np.abs(bent))
        powers = hidden @ network.second.T + network.second_bias
        parameters = np.exp2(np.clip(powers, *EXPONENTS))
        octaves = int(Lbf().albedo_threshold * OCTAVE)
        light, slopes = filtered(self.around, self.places, parameters.astype(np.float32), octaves)
        off = (light - self.truth) / self.scale[:, None]
        count = off.size
        by_light = 2 * off / self.scale[:, None] / count
        inside = (powers > EXPONENTS[0]) & (powers < EXPONENTS[1])
        by_power = np.einsum("pkc,pc->pk", slopes, by_light) * np.log(2) * parameters * inside
        by_bent = (by_power @ network.second) / np.square(1 + np.abs(bent))
        gradient = Network(by_bent.T @ self.seen, by_bent.sum(axis=0), by_power.T @ hidden, by_power.sum(axis=0))
        return float(np.square(off).sum() / count), packed(gradient)

    def objective(self, values: Array) -> tuple[float, Array]:
        """The error with a penalty on large weights, and its gradient."""
        error, gradient = self.error(unpacked(values))
        return error + DECAY * float(values @ values) / len(values), gradient + 2 * DECAY * values / len(values)
