"""What is timed, and under which name.

Names: ``svgf.<stage>.<width>x<height>``, where the stage is a pass (``demodulate``, ``atrous.3``), ``atrous`` (all
levels), ``frame``, ``frame.numpy``, ``enqueue``, or ``start.cold`` and ``start.warm``. A frame with other settings says
which: ``svgf.frame.iterations3.1280x720``. A device's ceilings are ``ceiling.copy.<bytes>`` and ``ceiling.multiply``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import pyopencl as cl

from svgf_cl.bench.cores import core_counts
from svgf_cl.bench.cost import Cost, cost
from svgf_cl.filters.pipeline import Inputs, Pass, pipeline
from svgf_cl.frame import Shape, extent
from svgf_cl.settings import RANGES, Settings

SHAPES: tuple[Shape, ...] = ((180, 320), (720, 1280), (1080, 1920), (2160, 3840))
# Where it is not the size that varies: cores, iterations, signals, the first frame of a process.
USUAL_SHAPE: Shape = (720, 1280)

STARTS = ("start cold", "start warm")

# What `there_and_back` supplies.
ROOM = Inputs(signals=1, motion=3, albedo=True, emission=False, id=True)


@dataclass(frozen=True)
class Case:
    """One denoiser to be timed.

    Parameters
    ----------
    shape : (int, int)
    settings : Settings
    signals : int, 1 or 2
    cores : int, optional
        The machine's cores to use; all where None.
    variant : str
        What is unusual about it, for its names; only its whole frame is timed. Empty for the usual, timed by pass.
    """

    shape: Shape
    settings: Settings
    signals: int = 1
    cores: int | None = None
    variant: str = ""

    @property
    def inputs(self) -> Inputs:
        """The fields of its frames."""
        return replace(ROOM, signals=self.signals)

    @property
    def stages(self) -> list[str]:
        """All that a `Rig` samples of it."""
        if self.variant:
            return ["frame"]
        return [*(entry.name for entry in self.passes), "atrous", "frame", "frame numpy", "enqueue"]

    def name(self, stage: str) -> str:
        """The benchmark's name."""
        words = ["svgf", *stage.split(), self.variant, extent(self.shape)]
        return ".".join(word for word in words if word)

    def costs(self) -> dict[str, Cost]:
        """What each pass costs."""
        pixels = self.shape[0] * self.shape[1]
        return {entry.name: cost(entry, self.inputs, self.settings) * pixels for entry in self.passes}

    @property
    def passes(self) -> tuple[Pass, ...]:
        """Its pass table."""
        return pipeline(self.inputs, self.settings)


def cases(device: cl.Device, shapes: Sequence[Shape], settings: Settings) -> Iterator[Case]:
    """All that is timed on a device: every size, and what else a frame's time is followed over."""
    for shape in shapes:
        yield Case(shape, settings)
    for iterations in range(int(RANGES["iterations"][0]), int(RANGES["iterations"][1]) + 1):
        yield Case(USUAL_SHAPE, replace(settings, iterations=iterations), variant=f"iterations{iterations}")
    for signals in (1, 2):
        yield Case(USUAL_SHAPE, settings, signals, variant=f"signals{signals}")
    for cores in core_counts() if device.type & cl.device_type.CPU else ():
        yield Case(USUAL_SHAPE, settings, cores=cores, variant=f"cores{cores}")
