"""What every filter is: checked settings that make a pipeline."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from svgf_cl.filters.pipeline import Pipeline
from svgf_cl.filters.signals import Inputs
from svgf_cl.settings import SettingsBase


@dataclass(frozen=True, kw_only=True)
class Filter(SettingsBase, ABC):
    """A filter with its settings; its float64 oracle is `Oracle` in the module of its name in `svgf_cl.oracle`."""

    name: ClassVar[str]

    @abstractmethod
    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame that supplies `inputs`."""
