"""Compiles every variant for every target, and finds violations."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from benchmarks.builds import Build
from benchmarks.gpu_static import amd, nvidia, spirv
from benchmarks.gpu_static.occupancy import LIMITS
from benchmarks.gpu_static.tools import Tools
from benchmarks.gpu_static.usage import Compiled, Instructions, RejectedError, Usage
from svgf_cl.device.tuning import GPU_TUNING

ARCHITECTURES = (*nvidia.ARCHITECTURES, *amd.ARCHITECTURES)
# Targets that share what clang writes: NVIDIA's are assembled from the same PTX.
TOGETHER = (nvidia.ARCHITECTURES, *((name,) for name in amd.ARCHITECTURES), (spirv.NAME,))
TARGETS = tuple(chain(*TOGETHER))
WORK_GROUP = GPU_TUNING.work_group[0] * GPU_TUNING.work_group[1]


@dataclass(frozen=True)
class Outcome:
    """The result of one build on one target: its kernels by name (none for SPIR-V), or why it was refused."""

    build: Build
    target: str
    kernels: Mapping[str, Compiled] = field(default_factory=dict)
    fault: str = ""


@dataclass(frozen=True)
class Row:
    """A kernel of a build on one architecture."""

    source: str
    kernel: str
    variant: str
    architecture: str
    usage: Usage
    instructions: Instructions

    @property
    def name(self) -> str:
        """The names of the file and the kernel."""
        return f"{self.source}/{self.kernel}"

    @property
    def occupancy(self) -> float:
        """Occupancy with the default work-groups for GPUs, 0..1."""
        return LIMITS[self.architecture].occupancy(self.usage, WORK_GROUP)

    @property
    def place(self) -> str:
        """The kernel, variant and architecture, for messages."""
        return f"kernel {self.kernel} of {self.source}.cl on {self.architecture} ({self.variant})"

    def faults(self) -> Iterator[str]:
        """Violations of limits that hold on every architecture."""
        if self.usage.spills:
            unit = "bytes of registers" if self.architecture in nvidia.ARCHITECTURES else "registers"
            yield (
                f"{self.place}: expected no registers spilled, found {self.usage.spills} {unit} spilled; "
                "keep fewer values alive at a time"
            )
        if self.usage.scratch:
            yield (
                f"{self.place}: expected no scratch memory, found {self.usage.scratch} bytes a work-item; "
                "unroll loops whose index picks elements of an array (UNROLLED_FOR)"
            )


def compile_all(tools: Tools, builds: Sequence[Build], advance: Callable[[], None]) -> list[Outcome]:
    """Compile every build for every target, in as many threads as processors.

    Results are in the order of the builds.
    """

    def compiled(job: tuple[Build, tuple[str, ...]]) -> list[Outcome]:
        outcomes = compile_together(tools, *job)
        for _ in outcomes:
            advance()
        return outcomes

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(chain(*pool.map(compiled, ((build, targets) for build in builds for targets in TOGETHER))))


def compile_together(tools: Tools, build: Build, targets: tuple[str, ...]) -> list[Outcome]:
    """Compile a build for targets that share a compiler's output."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            found = kernels(tools, build, targets, Path(folder))
        except RejectedError as error:
            return [refused(build, target, error) for target in targets]
    return [Outcome(build, target, found[target]) for target in targets]


def refused(build: Build, target: str, error: RejectedError) -> Outcome:
    """The outcome of a build that a compiler refused."""
    expected = "a valid module" if target == spirv.NAME else "kernels that compile"
    place = f"{build.source}.cl on {target} ({build.variant})"
    return Outcome(build, target, fault=f"{place}: expected {expected}; {error}")


def kernels(tools: Tools, build: Build, targets: tuple[str, ...], folder: Path) -> dict[str, dict[str, Compiled]]:
    """The kernels of a build by target; for SPIR-V only the validity is checked."""
    if targets == nvidia.ARCHITECTURES:
        return nvidia.compiled(tools, build, folder)
    (target,) = targets
    if target != spirv.NAME:
        return {target: amd.compiled(tools, target, build, folder)}
    spirv.validate(tools, build, folder)
    return {target: {}}


def rows(tools: Tools, outcomes: Sequence[Outcome]) -> list[Row]:
    """A row for every compiled kernel, architecture by architecture."""
    found = []
    for architecture in ARCHITECTURES:
        every = [
            (outcome.build, name, kernel)
            for outcome in outcomes
            if outcome.target == architecture
            for name, kernel in outcome.kernels.items()
        ]
        counts = instructions(tools, architecture, [kernel.code for _, _, kernel in every])
        for (build, name, kernel), counted in zip(every, counts, strict=True):
            found.append(Row(build.source, name, build.variant, architecture, kernel.usage, counted))
    return found


def instructions(tools: Tools, architecture: str, codes: Sequence[bytes]) -> list[Instructions]:
    """Count the instructions of kernels on an architecture."""
    if architecture in nvidia.ARCHITECTURES:
        return nvidia.instructions(tools, architecture, codes)
    return amd.instructions(codes)
