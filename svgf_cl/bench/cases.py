"""Lists the cases to time, and names their benchmarks.

A name is ``<filter>.<row>.<width>x<height>``. The row is a pass (``demodulate``, ``atrous.3``), ``atrous`` (all
levels), ``frame``, ``frame.numpy``, ``enqueue``, or ``start.cold`` and ``start.warm``. For a frame with other settings
the name contains them: ``svgf.frame.iterations3.1280x720``. A device's ceilings are ``ceiling.copy.<bytes>``,
``ceiling.load.<offset>`` and ``ceiling.multiply``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pyopencl as cl

from svgf_cl.bench.cores import core_counts
from svgf_cl.bench.cost import Cost, cost
from svgf_cl.bench.rig import ENQUEUE, FRAME, FRAME_NUMPY, Row, levels_together
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import Pass
from svgf_cl.filters.signals import DIRECT, INDIRECT, Inputs
from svgf_cl.frame import Shape, extent
from svgf_cl.settings import Range, domains

SHAPES: tuple[Shape, ...] = ((180, 320), (720, 1280), (1080, 1920), (2160, 3840))
# The size for cases that vary something else: cores, iterations, signals, the first frame of a process.
USUAL_SHAPE: Shape = (720, 1280)

STARTS: tuple[Row, ...] = (("start", "cold"), ("start", "warm"))

# The fields that `there_and_back` supplies.
ROOM = Inputs(motion=3, albedo=True, id=True)
ROOM_SPLIT = replace(ROOM, signals=(DIRECT, INDIRECT))


@dataclass(frozen=True)
class Case:
    """One denoiser to time.

    Parameters
    ----------
    shape : (int, int)
    settings : Filter
    inputs : Inputs
        The fields of its frames.
    cores : int, optional
        Number of the machine's cores to use; None for all.
    variant : str
        The name of its special setting, for the benchmark's name; only the whole frame is timed then. Empty for the
        usual case, of which every pass is timed.
    """

    shape: Shape
    settings: Filter
    inputs: Inputs = ROOM
    cores: int | None = None
    variant: str = ""

    @property
    def rows(self) -> list[Row]:
        """All rows that a `Rig` samples: passes, all levels of a pass together, and whole frames."""
        if self.variant:
            return [FRAME]
        paths = [entry.path for entry in self.passes]
        return [*paths, *levels_together(paths), FRAME, FRAME_NUMPY, ENQUEUE]

    def name(self, row: Row) -> str:
        """Return the benchmark's name."""
        words = [self.settings.name, *row, self.variant, extent(self.shape)]
        return ".".join(word for word in words if word)

    def costs(self) -> dict[Row, Cost]:
        """Return the cost of each pass for the whole image."""
        pixels = self.shape[0] * self.shape[1]
        return {entry.path: cost(entry) * pixels for entry in self.passes}

    @property
    def passes(self) -> tuple[Pass, ...]:
        """The filter's passes."""
        return self.settings.pipeline(self.inputs).passes


def cases(device: cl.Device, shapes: Sequence[Shape], settings: Filter) -> Iterator[Case]:
    """Yield all cases for a device: every size, then iterations, signals and cores."""
    for shape in shapes:
        yield Case(shape, settings)
    span = domains(type(settings)).get("iterations")
    if isinstance(span, Range):
        for iterations in range(int(span.least), int(span.greatest) + 1):
            fewer: dict[str, Any] = {"iterations": iterations}
            yield Case(USUAL_SHAPE, replace(settings, **fewer), variant=f"iterations{iterations}")
    for inputs in (ROOM, ROOM_SPLIT):
        yield Case(USUAL_SHAPE, settings, inputs, variant=f"signals{len(inputs.signals)}")
    for cores in core_counts() if device.type & cl.device_type.CPU else ():
        yield Case(USUAL_SHAPE, settings, cores=cores, variant=f"cores{cores}")
