r"""Writes the pictures of docs/renderers from folders of frames: noisy, denoised and the reference, side by side.

    python -m scripts.renderer_pictures docs/renderers/blender.webp \
        samples/blender cases/blender/metal_glass samples/blender:60,55,128,72
    python -m scripts.renderer_pictures docs/renderers/mitsuba.webp \
        samples/mitsuba:30,0,172,144 cases/mitsuba/materials

Each folder is a row. It has noisy frames in ``noisy`` and references in ``reference``, as rendered by
`scripts/renderers`. The last frame that has a reference is shown, denoised by `svgf-cl denoise` without options. With
``FOLDER:X,Y,W,H``, in pixels, a part of the frame is shown.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image

from benchmarks.renderers import pictures, reference
from svgf_cl.io.atomic import written_whole
from svgf_cl.io.display import Bytes, to_bytes
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.sequence import find_frames, find_numbered, number_of

WIDTH = 320  # of a picture, in pixels; parts are enlarged to it without smoothing
GAP = 4
QUALITY = 82


def main() -> None:
    """Make and write a picture."""
    parser = argparse.ArgumentParser(
        description="Write a picture of frames before and after denoising, beside the reference."
    )
    parser.add_argument("target", type=Path)
    parser.add_argument("folders", nargs="+", metavar="FOLDER[:X,Y,W,H]")
    options = parser.parse_args()
    rows = [row(*parsed(text)) for text in options.folders]
    gap = np.full((GAP, rows[0].shape[1], 3), 255, np.uint8)
    sheet = np.vstack([part for each in rows for part in (gap, each)][1:])
    with written_whole(options.target) as aside:
        Image.fromarray(sheet).save(aside, format="WEBP", quality=QUALITY, method=6)
    print(f"{options.target}: {sheet.shape[1]}x{sheet.shape[0]}, {options.target.stat().st_size / 1000:.0f} kB")


def parsed(text: str) -> tuple[Path, tuple[int, ...]]:
    """A folder, and the part of its frames to show; by default the whole frame."""
    folder, _, part = text.partition(":")
    return Path(folder), tuple(map(int, part.split(","))) if part else ()


def row(folder: Path, part: tuple[int, ...]) -> Bytes:
    """Noisy, denoised and reference side by side, of the last frame in a folder that has a reference."""
    truths = {number_of(path): path for path in find_numbered(folder / "reference", "reference")}
    last = max(truths)
    truth, layer = reference(truths[last])
    paths = [path for path in find_frames([folder / "noisy"]) if number_of(path) <= last]
    *_, (_, before, after) = pictures(paths, ReadAs(view_layer=layer or None))
    shown = [enlarged(to_bytes(picture), part) for picture in (before, after, truth)]
    gap = np.full((shown[0].shape[0], GAP, 3), 255, np.uint8)
    return np.hstack([shown[0], gap, shown[1], gap, shown[2]])


def enlarged(picture: Bytes, part: tuple[int, ...]) -> Bytes:
    """The part of a picture, enlarged to the common width."""
    x, y, width, height = part or (0, 0, picture.shape[1], picture.shape[0])
    cut = Image.fromarray(picture[y : y + height, x : x + width])
    resampling = Image.Resampling.NEAREST if part else Image.Resampling.LANCZOS
    return np.asarray(cut.resize((WIDTH, round(WIDTH * height / width)), resampling))


if __name__ == "__main__":
    main()
