"""Measures the cost of tiles: the time of a frame in tiles divided by the time of the same frame as a whole.

Both filter the same frames of the built-in room in turns, from numpy arrays to numpy arrays. The ratio compares two
times of the same round; its median is shown.
"""

from __future__ import annotations

import time
from typing import Annotated

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.race import Spread
from svgf_cl import Denoiser, Frame, Inputs, TiledDenoiser
from svgf_cl.device.opencl_errors import mebibytes
from svgf_cl.device.tiling import Tiling
from svgf_cl.errors import SvgfError
from svgf_cl.filters import DEFAULT
from svgf_cl.frame import extent
from svgf_cl.io.synthetic import PERIOD, room_frames


def main(
    width: Annotated[int, typer.Option(min=64)] = 1280,
    height: Annotated[int, typer.Option(min=64)] = 720,
    tiles: Annotated[int, typer.Option(min=2, help="Number of tiles.")] = 4,
    rounds: Annotated[int, typer.Option(min=1)] = 10,
) -> None:
    """Compare the time of a frame in tiles with that of the whole frame, with the default filter."""
    frames = list(room_frames((height, width), PERIOD))
    whole = Denoiser((height, width))
    tiling = Tiling(DEFAULT().pipeline(Inputs.of(frames[0])), (height, width), whole.tuning.row_alignment)
    tiled = TiledDenoiser((height, width), Inputs.of(frames[0]), queue=whole.queue, max_bytes=limit(tiling, tiles))
    for frame in frames:
        whole.denoise(frame)
        tiled.denoise(frame)
    times = [(seconds(whole, frame), seconds(tiled, frame)) for frame in (frames * rounds)[:rounds]]
    print(tiled.reason)
    for name, samples in zip(("at once", "in tiles"), zip(*times, strict=True), strict=True):
        print(f"{name:10}{Spread.of([1e3 * sample for sample in samples]):.1f} ms")
    print(f"ratio     {Spread.of([second / first for first, second in times]):.2f}")
    print(
        f"device memory: {mebibytes(whole.nbytes)} at once, {mebibytes(tiled.nbytes)} in tiles, both without the arrays"
    )
    print(f"host memory for the past of {extent(whole.shape)}: {mebibytes(tiled.host_nbytes)}")


def limit(tiling: Tiling, tiles: int) -> int:
    """The largest memory limit that divides a frame into this many tiles."""
    whole = sum(tiling.whole())
    for share in np.linspace(1, 0, 200, endpoint=False):
        window = tiling.window(int(share * whole), whole)
        if window and len(tiling.tiles(window)) == tiles:
            return int(share * whole)
    raise SvgfError(f"--tiles: expected a number that {extent(tiling.shape)} frames can be cut into, got {tiles}")


def seconds(denoiser: Denoiser | TiledDenoiser, frame: Frame) -> float:
    """Seconds for one call."""
    begin = time.perf_counter()
    denoiser.denoise(frame)
    return time.perf_counter() - begin


if __name__ == "__main__":
    run(main, "benchmarks.tiled")
