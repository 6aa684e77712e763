"""The filters in float64 NumPy, one file each; the kernels are compared with them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Shape
from svgf_cl.oracle.temporal import FilterOracle


def oracle_of(settings: Filter, shape: Shape) -> FilterOracle[Any]:
    """The oracle of a filter with these settings, for frames of this (height, width)."""
    oracle: FilterOracle[Any] = import_module(f"svgf_cl.oracle.{settings.name}").Oracle(shape, settings)
    return oracle
