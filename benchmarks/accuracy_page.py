"""Compares every kernel with the float64 oracle on every OpenCL implementation; prints the page, and writes a file.

python -m benchmarks.accuracy_page [FILE]
python -m benchmarks.accuracy_page --here [--brief]   # the figures of the default device, as JSON; or a few of them
"""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import steady_light
from benchmarks.implementations import Environment, environments
from benchmarks.presentation import markdown
from svgf_cl import Frame, Kalman, Lbf, Sbf, Settings
from svgf_cl.bench import error_to_oracle
from svgf_cl.bench.tables import Table
from svgf_cl.device import devices
from svgf_cl.filters.filter import Filter
from svgf_cl.io.atomic import write_text
from svgf_cl.oracle.accuracy import DECISION, Deviation, deviations, worst
from svgf_cl.oracle.rounding import SCALE_SHARE
from svgf_cl_tracer import Shot, builtin_scene, render_sequence

SHAPE = (36, 64)
FRAMES = 4
ALL_KERNELS = (Settings(taa=True), Kalman(taa=True, standard_error=True))
# These kernels read up to 1089 taps per pixel, which takes a second per pixel on a simulator.
WINDOWS = (Sbf(), Lbf())
SMALL, FEW = (18, 32), 2
WHOLE = (Kalman(), Settings())
PIPELINE_FRAMES = 3
COLUMNS = ("absolute", "relative", "ulps", "decided_otherwise")
HERE, BRIEF = "--here", "--brief"

INTRODUCTION = f"""# Accuracy

Made by `make docs` (`python -m benchmarks.accuracy_page docs/accuracy.md`); do not edit.
`make test-all` prints this page for the machine it runs on.

The oracle (`svgf_cl/oracle/`) computes in float64 what the kernels compute in float32.
This page compares every kernel of SVGF, Kalman, SBF and LBF with the oracle.
Kernel and oracle get the same float32 input.

The input is two sequences of {FRAMES} frames of {SHAPE[1]}x{SHAPE[0]}.
One is the built-in Cornell box with 1 sample per pixel and a moving camera.
The other has random numbers in every field, with pixels that hit nothing, ids, and motion of several pixels.
Direct and indirect light are separate signals, and TAA is on.
The kernels that only SBF and LBF have get {FEW} frames of {SMALL[1]}x{SMALL[0]} of random numbers, without TAA.

The table has the largest error of any pixel in any result of a kernel:

- absolute: in the unit of the result (radiance, its square for a variance, or 1);
- relative: `|got - expected| / (|expected| + {SCALE_SHARE:g} * mean |expected|)`;
  of a colour, `|expected|` is that of its largest channel;
- ulps: the absolute error in units in the last place of that denominator, as float32.

Some kernels decide whether to use a neighbour, and rounding can change this decision.
Such a pixel may have a relative error above {DECISION:g}.
The errors leave these pixels out, and the last column is their share.

The errors are not zero for these reasons:

- float32 rounds by half a unit in the last place, 6e-8.
- Weights multiply this error: by 128 in a normal's cosine, and by up to 80 in an exponent.
- The polynomial for the exponential adds 4e-6.
- The variance sums squares of differences.
- The kernels detect and update divide by a variance that may come from two pixels only.
  If these are alike, almost nothing is left of it but rounding.
"""

WHOLE_FILTER = f"""
The next table has the error of the whole filter after {PIPELINE_FRAMES} frames of the closed-form room, 160x90.
Errors add up through the history.
They are relative to the picture's mean:
"""


def random_frames(shape: tuple[int, int], count: int, seed: int = 1) -> Iterator[Frame]:
    """Frames of random values, which no renderer would make: the fields do not match each other."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        direct, indirect, emission = (rng.exponential(1.0, (*shape, 3)).astype(np.float32) for _ in range(3))
        normal = rng.normal((0.0, 0.0, 1.0), 0.05, (*shape, 3))
        depth = 5.0 + 0.05 * rng.random(shape) + 3.0 * (np.arange(shape[1]) // 7 % 2)
        yield Frame(
            direct=direct,
            indirect=indirect,
            emission=emission * (rng.random((*shape, 1)) < 0.1),
            albedo=rng.random((*shape, 3), np.float32),
            normal=normal.astype(np.float32),
            depth=np.where(rng.random(shape) < 0.05, np.inf, depth).astype(np.float32),
            motion=rng.normal(0.0, (2.0, 2.0, 0.05), (*shape, 3)).astype(np.float32),
            id=rng.integers(1, 3, shape, np.uint32),
        )


def measured(*, brief: bool = False) -> dict[str, Any]:
    """The figures of the default device; with `brief`, only those of the default filter on small frames."""
    queue = devices.default_queue()
    kernels: dict[str, list[Deviation]] = {}
    whole = WHOLE[:1] if brief else WHOLE
    for frames, settings in small_cases() if brief else all_cases():
        for deviation in deviations(frames, settings, queue).values():
            kernels.setdefault(deviation.kernel, []).append(deviation)
    return {
        "device": f"{queue.device.name}, {queue.device.platform.version.strip()}, driver {queue.device.driver_version}",
        "kernels": {name: asdict(worst(stages)) for name, stages in kernels.items()},
        "whole": {each.name: error_to_oracle(each, frames=PIPELINE_FRAMES, queue=queue) for each in whole},
    }


def all_cases() -> Iterator[tuple[list[Frame], Filter]]:
    """The sequences and filters with which every kernel is measured."""
    traced = render_sequence(Shot(builtin_scene("cornell"), SHAPE, FRAMES))
    yield from itertools.product((list(traced), list(random_frames(SHAPE, FRAMES))), ALL_KERNELS)
    yield from itertools.product((list(random_frames(SMALL, FEW)),), WINDOWS)


def small_cases() -> Iterator[tuple[list[Frame], Filter]]:
    """The default filter on a small sequence."""
    yield list(random_frames(SMALL, FEW)), WHOLE[0]


def measured_apart(environment: Environment) -> dict[str, Any]:
    """Run `measured` in a process with another environment."""
    command = [sys.executable, "-m", "benchmarks.accuracy_page", HERE]
    child = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    figures: dict[str, Any] = json.loads(child.stdout.splitlines()[-1])
    return figures


def kernel_table(found: dict[str, dict[str, Any]]) -> Table:
    """The largest errors of each kernel on these implementations, by name."""
    kernels = next(iter(found.values()))["kernels"]
    rows = [
        (kernel, name, *(f"{figures['kernels'][kernel][column]:.1e}" for column in COLUMNS))
        for kernel in kernels
        for name, figures in found.items()
    ]
    heads = ("kernel", "implementation", *(column.replace("_", " ") for column in COLUMNS))
    return Table("largest error of each kernel against the float64 oracle", heads, rows)


def whole_table(found: dict[str, dict[str, Any]]) -> Table:
    """The errors of whole filters on these implementations, by name."""
    rows = [
        (filter_, name, f"{rms:.1e}", f"{largest:.1e}", figures["device"])
        for name, figures in found.items()
        for filter_, (largest, rms) in figures["whole"].items()
    ]
    heads = ("filter", "implementation", "rms", "largest", "device")
    return Table("error of the whole filter, relative to the picture's mean", heads, rows)


def page(found: dict[str, dict[str, Any]]) -> str:
    """The page for these implementations, by name."""
    return "\n".join(
        [
            INTRODUCTION,
            markdown(kernel_table(found)),
            WHOLE_FILTER,
            markdown(whole_table(found)),
            "",
            steady_light.INTRODUCTION,
            steady_light.table(),
            "",
        ]
    )


def main() -> None:
    """Measure on the default device, or on every implementation."""
    if sys.argv[1:2] == [HERE]:
        print(json.dumps(measured(brief=BRIEF in sys.argv)))
        return
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor() as pool:
        processes = environments(Path(folder))
        found = dict(zip(processes, pool.map(measured_apart, processes.values()), strict=True))
    text = page(found)
    print(text)
    for target in map(Path, sys.argv[1:]):
        write_text(target, text)


if __name__ == "__main__":
    main()
