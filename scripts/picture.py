"""Writes docs/demo.png, the README's picture, from what `svgf-cl demo` left in out/demo: left noisy, right denoised."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from svgf_cl.io.atomic import written_whole
from svgf_cl.io.display import to_bytes
from svgf_cl.io.frames import frame_path
from svgf_cl.io.pictures import read_picture

DEMO = Path("out/demo")
TARGET = Path("docs/demo.png")
FRAME = 20
NOISY_SHARE = 0.42


def main() -> None:
    """Compose and write the picture, the noise in 16 steps a channel: it does not compress otherwise."""
    noisy, denoised = (to_bytes(read_picture(frame_path(DEMO / kind, FRAME))) for kind in ("noisy", "denoised"))
    seam = round(NOISY_SHARE * noisy.shape[1])
    picture = np.hstack([noisy[:, :seam] // 17 * 17, np.full_like(noisy[:, :2], 255), denoised[:, seam + 2 :]])
    with written_whole(TARGET) as aside:
        Image.fromarray(picture).save(aside, format="PNG", optimize=True)
    print(f"{TARGET}: {TARGET.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
