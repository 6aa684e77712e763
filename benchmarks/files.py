"""Times frames from file to file: reading, filtering and writing, one after the other and overlapped.

``svgf-cl denoise`` reads and writes frames while others are filtered. The shot is the built-in room. It is written as
files of svgf_cl (17 channels of 32 bits) and as files of Blender (16 and 32 bits, with as many passes that `svgf_cl`
does not read as passes that it reads), with zip compression. "at once" is the whole of `svgf_cl.job.run`, with no files
from an earlier run.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl.bench.tables import Table
from svgf_cl.device.devices import default_queue
from svgf_cl.filters import DEFAULT
from svgf_cl.frame import Frame
from svgf_cl.io.exr import write_channels, write_image
from svgf_cl.io.frames import channels_of, frame_path
from svgf_cl.io.image import Plane
from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.io.synthetic import room_frames
from svgf_cl.job import Chunk, Job, result
from svgf_cl.job import run as run_job
from svgf_cl.lights import Denoised
from svgf_cl.shot_denoiser import Method, ShotDenoiser

UNREAD = 24  # channels of 16 bits that pass through unread, such as Cryptomatte's


def main(
    width: Annotated[int, typer.Option(min=16)] = 1280,
    height: Annotated[int, typer.Option(min=16)] = 720,
    frames: Annotated[int, typer.Option(min=4, help="Frames of the shot.")] = 24,
) -> None:
    """Time the parts of a frame's way from file to file, and the whole way."""
    kinds: dict[str, Callable[[Path, Frame], Mapping[str, Plane]]] = {"ours": channels_of, "Blender": blender}
    rows = []
    for name, channels in kinds.items():
        with tempfile.TemporaryDirectory() as folder:
            paths = written(Path(folder), channels, (height, width), frames)
            rows.append([name, *(f"{1e3 * seconds:.0f}" for seconds in timed(paths, Path(folder) / "out"))])
    columns = ("files", "read", "filter", "write", "one after the other", "at once")
    print(markdown(Table("ms a frame", columns, rows)))
    for what, value in provenance(default_queue().device).items():
        print(f"{what}: {value}")


def blender(path: Path, frame: Frame) -> dict[str, Plane]:
    """A frame's channels with Blender's names; direct and indirect light are separate passes."""
    albedo = np.maximum(frame.albedo, 0.02)
    pictures: dict[str, Any] = {
        "Combined": frame.color,
        "Denoising Albedo": frame.albedo,
        "DiffCol": albedo,
        "DiffDir": frame.direct / albedo,
        "DiffInd": frame.indirect / albedo,
    }
    planes: dict[str, Plane] = {}
    for name, picture in pictures.items():
        planes |= {f"ViewLayer.{name}.{c}": picture[..., at].astype(np.float16) for at, c in enumerate("RGB")}
    vector = frame.motion[..., [0, 1, 0, 1]]
    planes |= {f"ViewLayer.Normal.{c}": frame.normal[..., at] for at, c in enumerate("XYZ")}
    planes |= {f"ViewLayer.Vector.{c}": vector[..., at] for at, c in enumerate("XYZW")}
    planes["ViewLayer.Depth.Z"] = np.where(np.isfinite(frame.depth), frame.depth, np.float32(1e10))
    planes["ViewLayer.IndexOB.X"] = frame.id.astype(np.float32)
    for at in range(UNREAD):
        planes[f"ViewLayer.Pass{at:02d}.V"] = frame.color[..., at % 3].astype(np.float16)
    return planes


def written(
    folder: Path, channels: Callable[[Path, Frame], Mapping[str, Plane]], shape: tuple[int, int], frames: int
) -> list[Path]:
    """Write a shot."""
    paths = [frame_path(folder, number) for number in range(frames)]
    for path, frame in zip(paths, room_frames(shape, frames, signals=2), strict=True):
        write_channels(path, channels(path, frame))
    return paths


def timed(paths: list[Path], out: Path) -> tuple[float, ...]:
    """Seconds per frame for reading, filtering, writing, all three one after the other, and all at once."""
    out.mkdir()
    method, shot = Method(DEFAULT()), Shot(paths)
    denoiser = ShotDenoiser(shot.shape, method, len(shot.reading.lights))
    spent = np.zeros(3)
    for index, path in enumerate(paths):
        spent += step(shot, denoiser, index, out / path.name) if index else warmed(shot, denoiser)
    targets = tuple(out / f"again.{path.name}" for path in paths)
    begin = time.perf_counter()
    for _ in run_job(Job(tuple(paths), targets, method), Chunk(0, range(len(paths)), len(paths))):
        pass
    whole = (time.perf_counter() - begin) / len(paths)
    parts = spent / (len(paths) - 1)
    return (*parts, parts.sum(), whole)


def warmed(shot: Shot, denoiser: ShotDenoiser) -> np.ndarray:
    """Build the kernels with a first frame, which is not timed."""
    source = shot.read(0)
    denoiser.denoise(source.frame, source.lights)
    return np.zeros(3)


def step(shot: Shot, denoiser: ShotDenoiser, index: int, target: Path) -> np.ndarray:
    """Seconds for reading, filtering and writing a frame."""
    times = [time.perf_counter()]
    source: ShotFrame = shot.read(index)
    times.append(time.perf_counter())
    made: Denoised = denoiser.denoise(source.frame, source.lights)
    times.append(time.perf_counter())
    write_image(target, result(shot, source, made, Job((), (), Method(DEFAULT())).style))
    return np.diff([*times, time.perf_counter()])


if __name__ == "__main__":
    run(main, "benchmarks.files")
