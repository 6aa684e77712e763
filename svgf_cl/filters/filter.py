"""The base class of all filters: checked settings that make a pipeline."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from svgf_cl.filters.pipeline import Pipeline
from svgf_cl.filters.signals import Inputs
from svgf_cl.settings import SettingsBase


@dataclass(frozen=True, kw_only=True)
class Filter(SettingsBase, ABC):
    """A filter with its settings; `svgf_cl.oracle.<name>.Oracle` is the same filter in float64."""

    name: ClassVar[str]

    @abstractmethod
    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame with the fields `inputs`."""
