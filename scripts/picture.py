"""Writes docs/demo.png, the README's picture, from the output of `svgf-cl demo` in out/demo.

Left: noisy. Middle: SVGF as in its paper. Right: the default filter. The last two have temporal antialiasing.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from svgf_cl import Denoiser, Settings
from svgf_cl.io.atomic import written_whole
from svgf_cl.io.display import Bytes, Linear, to_bytes
from svgf_cl.io.frames import frame_path, read_frame
from svgf_cl.io.pictures import read_picture

DEMO = Path("out/demo")
TARGET = Path("docs/demo.png")
FRAME = 20
PAPER = Settings(taps="5x5", taa=True)


def main() -> None:
    """Make and write the picture; its noise has only 16 steps per channel, because it would not compress otherwise."""
    noisy, denoised = (read_picture(frame_path(DEMO / kind, FRAME)) for kind in ("noisy", "denoised"))
    width = noisy.shape[1]
    stripes = [to_bytes(noisy) // 17 * 17, to_bytes(as_in_the_paper()), to_bytes(denoised)]
    edges = [round(share * width) for share in (0, 0.28, 0.64, 1)]
    picture = np.hstack([line_before(s[:, a:b]) for s, a, b in zip(stripes, edges, edges[1:], strict=False)])
    with written_whole(TARGET) as aside:
        Image.fromarray(picture[:, 2:]).save(aside, format="PNG", optimize=True)
    print(f"{TARGET}: {TARGET.stat().st_size / 1000:.0f} kB")


def as_in_the_paper() -> Linear:
    """The demo's frame, denoised by SVGF as in its paper."""
    paths = [frame_path(DEMO / "noisy", number) for number in range(FRAME + 1)]
    with Denoiser(read_picture(paths[0]).shape[:2], settings=PAPER) as denoiser:
        pictures = [np.asarray(denoiser.denoise(read_frame(path))) for path in paths]
    return pictures[-1]


def line_before(stripe: Bytes) -> Bytes:
    """A part of the picture with a white line of two pixels on its left."""
    return np.hstack([np.full_like(stripe[:, :2], 255), stripe])


if __name__ == "__main__":
    main()
