"""Writes docs/accuracy.md: every kernel against the float64 oracle, on every OpenCL device here that works."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks import steady_light
from svgf_cl import Frame, Settings, devices
from svgf_cl.accuracy import DECISION, SCALE_SHARE, Deviation, deviations
from svgf_cl.bench import error_to_oracle
from svgf_cl.files import written_whole
from tracer import Shot, builtin_scene, render_sequence

SHAPE = (108, 192)
FRAMES = 6

INTRODUCTION = f"""# Accuracy

Made by `make docs` (`python -m benchmarks.accuracy`); do not edit.

Every kernel is given its actual float32 input and held against the same function of `svgf_cl/reference.py` in float64.
An error is relative: `|got - expected| / (|expected| + {SCALE_SHARE:g} * mean |expected|)`; of a
colour the greatest channel counts as its size. Where rounding tips a
decision (a tap just accepted or just refused) a pixel may differ by more than {DECISION:g}; such pixels are counted
apart. "Pipeline" is the whole filter over a sequence, errors building up through the history, relative to the
picture's mean.

"Traced": {FRAMES} frames of the built-in Cornell box, {SHAPE[1]}x{SHAPE[0]}, 1 sample, moving camera, direct and
indirect apart, TAA on. "Random": {FRAMES} frames of unrelated numbers in every field, with misses, ids and motion of
several pixels.

Why not zero: float32 rounds at 6e-8. 128 times a cosine multiplies that by 128, an exponent of up to 80 by as much
again, and the polynomial exponential adds 4e-6; the variance sums squares of differences.
"""


def random_frames(shape: tuple[int, int], count: int, seed: int = 1) -> Iterator[Frame]:
    """Frames that no renderer would make: nothing fits anything else."""
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


def table(results: dict[str, dict[str, Deviation]]) -> str:
    """A markdown table with one row a stage."""
    head = "| stage | " + " | ".join(f"{name}: largest | typical | decided otherwise" for name in results) + " |"
    lines = [head, "|---" * (1 + 3 * len(results)) + "|"]
    for stage in next(iter(results.values())):
        cells = []
        for found in results.values():
            deviation = found[stage]
            cells.append(f"{deviation.largest:.1e} | {deviation.typical:.1e} | {deviation.decided_otherwise:.1e}")
        lines.append(f"| {stage} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def section(report: devices.DeviceReport) -> str:
    """The figures of one device."""
    assert report.handle is not None
    queue = devices.create_queue(report.handle)
    settings = Settings(taa=True)
    traced = render_sequence(Shot(builtin_scene("cornell"), SHAPE, FRAMES))
    results = {
        "traced": deviations(traced, settings, queue),
        "random": deviations(random_frames(SHAPE, FRAMES), settings, queue),
    }
    worst, rms = error_to_oracle(Settings(), queue=queue)
    return (
        f"## {report.platform}\n\n{report.device}, {report.version}, driver {report.driver}\n\n{table(results)}\n\n"
        f"Pipeline (6 frames of the closed-form room, 160x90): rms {rms:.1e}, largest {worst:.1e}.\n\n"
        f"{steady_light.INTRODUCTION}\n{steady_light.table(queue)}\n"
    )


def main() -> None:
    """Write the page."""
    target = Path("docs/accuracy.md")
    working = [report for report in devices.list_devices() if report.works]
    page = "\n".join([INTRODUCTION, *(section(report) for report in working)])
    with written_whole(target) as aside:
        aside.write_text(page, encoding="utf-8")
    print(f"{target}: {len(working)} device(s)")


if __name__ == "__main__":
    main()
