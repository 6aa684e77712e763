"""``svgf-cl denoise``: EXR frames in, EXR pictures out, one frame at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import typer

from svgf_cl.cli.console import kept_of, show_times, tracked
from svgf_cl.cli.options import AllowGaps, Exposure, FilterName, Frames, Output, SettingTexts, parse_settings
from svgf_cl.cli.remarks import FirstFrames, reading, require_surfaces
from svgf_cl.denoiser import Denoiser
from svgf_cl.errors import FileError
from svgf_cl.filters import DEFAULT
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.kalman import STANDARD_ERROR
from svgf_cl.io.atomic import output_folder
from svgf_cl.io.display import to_bytes, write_image
from svgf_cl.io.exr import write_image as write_exr
from svgf_cl.io.image import Image
from svgf_cl.io.pictures import holds, picture_file
from svgf_cl.io.sequence import after_gaps, check_leftovers, find_frames
from svgf_cl.io.shot import read_shot, shared_window
from svgf_cl.io.window import placed

Plane = npt.NDArray[np.float32]


def denoise(
    frames: Frames,
    output: Output,
    filter_: FilterName = DEFAULT.name,
    set_: SettingTexts = [],  # noqa: B006  # never changed; typer wants the default spelled here
    png: Annotated[bool, typer.Option("--png", help="Also write every picture tone-mapped as PNG.")] = False,
    exposure: Exposure = 0.0,
    plain: Annotated[bool, typer.Option("--plain", help="Write no other channel of the frame's file.")] = False,
    allow_gaps: AllowGaps = False,
    check: Annotated[bool, typer.Option(help="Check the first frames and warn of what is wrong with them.")] = True,
) -> None:
    """Denoise a sequence of EXR frames.

    Writes one EXR a frame under the frame's own name. R, G and B are denoised (linear HDR, 32-bit floats); all else in
    the frame's file passes through: other channels, windows, attributes. It needs the channels R G B, normal.X Y Z,
    depth.Z and motion.X Y, and also reads motion.Z, albedo.R G B, id, emission.R G B, direct.R G B and indirect.R G B
    where they are there. One line says which of them were found. All frames count as one shot: each uses the ones
    before it.

    If it is interrupted, run the same command again. All frames are then filtered again, because each picture depends
    on all frames before it, but pictures that are there already and are the same are kept.

    \b
    Examples:
      svgf-cl denoise out/box -o out/box-denoised
      svgf-cl denoise out/box -o out/box-denoised --set iterations=3 --set alpha_color=0.1 --png
      svgf-cl denoise out/box -o out/box-sure --set standard_error=on   # and the channel standard_error
      svgf-cl denoise out/box -o out/box-eaw --filter eaw --set sigma_color=2
    """
    settings = parse_settings(filter_, set_)
    sources = find_frames(frames, allow_gaps=allow_gaps)
    targets = target_paths(sources, output_folder(output))
    shown = [target.with_suffix(".png") for target in targets if png]
    check_leftovers(output, [*targets, *shown])
    profiles, kept = [], 0
    results = tracked(denoised(sources, settings, check=check), len(sources), "denoising")
    for target, (source, picture, others, profile) in zip(targets, results, strict=True):
        image = picture_file(picture, source, plain=plain, others=others)
        if holds(target, image):
            kept += 1
        else:
            write_exr(target, image)
        if png:
            shown_part = placed(picture, source.windows.data, source.windows.display, 0.0)
            write_image(target.with_suffix(".png"), to_bytes(shown_part, exposure))
        profiles.append(profile)
    show_times(profiles)
    print(f"{len(profiles)} frames in {output}{kept_of(kept)}")


def target_paths(sources: Sequence[Path], folder: Path) -> list[Path]:
    """Name the picture of each source; `FileError` where one would replace a source."""
    targets = [folder / f"{s.stem if s.suffix.lower() == '.exr' else s.name}.exr" for s in sources]
    read = {os.path.realpath(source) for source in sources}
    for target, source in zip(targets, sources, strict=True):
        if os.path.realpath(target) in read:
            raise FileError(f"{target}: expected an output folder other than the input's, got {source.parent}")
    return targets


def denoised(
    sources: Sequence[Path], settings: Filter, *, check: bool
) -> Iterator[tuple[Image, Plane, dict[str, Plane], dict[str, float]]]:
    """Read and denoise one frame after the other: its file, picture, further channels, and milliseconds per pass."""
    window, cuts = shared_window(sources), after_gaps(sources)
    first = FirstFrames(len(sources) if check else 0)
    denoiser = None
    for path, (image, frame) in zip(sources, read_shot(sources, window), strict=True):
        require_surfaces(path, frame)
        if denoiser is None:
            print(reading(image.planes))
            denoiser = Denoiser(frame.shape, settings=settings)
        if path in cuts:
            denoiser.reset()
        first.look(frame, after_cut=path in cuts)
        picture = denoiser.denoise(frame)
        others = {name: denoiser.stage(name) for name in denoiser.stages if name == STANDARD_ERROR}
        own = image.windows.data
        cut = {name: placed(plane, window, own, 0.0) for name, plane in others.items()}
        yield image, placed(picture, window, own, 0.0), cut, denoiser.profile()
