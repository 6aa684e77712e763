"""Every kernel takes the arguments that the host gives it, by name and in that order: buffers have one type, so that
two that changed places would be taken for each other without a word.
"""

from __future__ import annotations

import functools
import itertools
import tempfile
from collections.abc import Iterator
from dataclasses import replace

import pyopencl as cl
import pytest

from svgf_cl.device import programs
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.filters import FILTERS
from svgf_cl.filters.pipeline import Pass, Pipeline
from svgf_cl.filters.signals import SPLITS, Inputs
from svgf_cl.settings import domains

pytestmark = pytest.mark.filterwarnings("ignore::pyopencl.CompilerWarning")  # Intel's reports success

# Each field of a frame has arguments of its own: none of the fields, each alone, and all.
OPTIONAL = ("albedo", "emission", "id")
CHOICES = (*[{name: True} for name in OPTIONAL], {}, dict.fromkeys(OPTIONAL, True))
INPUTS = [Inputs(signals=split, **fields) for split, fields in itertools.product(SPLITS, CHOICES)]


def pipeline_of(name: str, inputs: Inputs, *, taa: bool) -> Pipeline:
    """Of one a-trous level, as all take the same."""
    kind = FILTERS[name]
    return kind(taa=taa, **{"iterations": 1} if "iterations" in domains(kind) else {}).pipeline(inputs)


def options(entry: Pass, pipeline: Pipeline) -> tuple[str, ...]:
    return programs.options_of(entry.source, GPU_TUNING.defines | pipeline.defines)


@functools.cache
def kernels(context: cl.Context, source: str, flags: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """The kernels of a source, and the names of their arguments as the device's compiler sees them."""
    with tempfile.TemporaryDirectory() as fresh:  # a program out of pyopencl's cache of binaries knows no names
        program = cl.Program(context, programs.source(source)).build([*flags, "-cl-kernel-arg-info"], cache_dir=fresh)
    return {kernel.function_name: tuple(names(kernel)) for kernel in program.all_kernels()}


def names(kernel: cl.Kernel) -> Iterator[str]:
    for number in range(kernel.num_args):
        try:
            name = kernel.get_arg_info(number, cl.kernel_arg_info.NAME)
        except cl.Error:
            name = ""
        if not name:
            pytest.skip("this device reports no names of arguments")
        yield name.removeprefix("_cl_")  # PoCL's, of all that is called like a function of OpenCL C: step


def disagreement(context: cl.Context, entry: Pass, pipeline: Pipeline) -> str:
    """What a pass declares and what its kernel takes, or nothing where that is the same."""
    taken = kernels(context, entry.source, options(entry, pipeline))[entry.kernel]
    return "" if taken == entry.arguments else f"{entry.label}: declared {entry.arguments}, taken {taken}"


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("taa", [False, True], ids=["no taa", "taa"])
@pytest.mark.parametrize("inputs", INPUTS, ids=str)
def test_are_those_that_are_declared(context: cl.Context, name: str, taa: bool, inputs: Inputs) -> None:
    pipeline = pipeline_of(name, inputs, taa=taa)
    assert not [found for entry in pipeline.passes if (found := disagreement(context, entry, pipeline))]


def test_buffers_that_changed_places_are_found(context: cl.Context) -> None:
    pipeline = pipeline_of("svgf", INPUTS[-1], taa=True)
    for entry in pipeline.passes:
        for field in ("reads", "writes"):
            given = getattr(entry, field)
            for first, second in itertools.combinations(range(len(given)), 2):
                swapped = list(given)
                swapped[first], swapped[second] = given[second], given[first]
                assert disagreement(context, replace(entry, **{field: tuple(swapped)}), pipeline)


def test_numbers_that_changed_places_are_found(context: cl.Context) -> None:
    pipeline = pipeline_of("eaw", Inputs(), taa=False)
    (temporal,) = (entry for entry in pipeline.passes if entry.kernel == "temporal")
    swapped = replace(temporal, scalars=dict(reversed(temporal.scalars.items())))
    assert disagreement(context, swapped, pipeline)
