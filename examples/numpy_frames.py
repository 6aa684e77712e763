"""Denoise a sequence of numpy arrays: each call takes the arrays of one frame and returns a clean picture."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from svgf_cl import Denoiser, Frame
from svgf_cl.compare.metrics import psnr
from svgf_cl.io.display import display, to_bytes, write_image
from svgf_cl.io.synthetic import room_frames

HEIGHT, WIDTH = 360, 640
FRAMES = 16


def main(folder: Path) -> None:
    """Denoise some frames, write the last one noisy and denoised, and print the PSNR of both."""
    with Denoiser((HEIGHT, WIDTH)) as den:
        # This replaces your renderer: a camera in a tiled room, with the noise of one sample per pixel.
        for made in room_frames((HEIGHT, WIDTH), FRAMES):
            frame = Frame.of(
                color=made.color,  # (H, W, 3) noisy linear radiance; (H, W, 4) with alpha gives (H, W, 4)
                normal=made.normal,  # (H, W, 3) in world space
                depth=made.depth,  # (H, W) along the camera's axis
                # (H, W, 2) in pixels, previous minus current; or (H, W, 3) with the change of depth
                motion=made.motion,
                albedo=made.albedo,  # (H, W, 3), optional; keeps textures sharp
                id=made.id,  # (H, W) integers, optional; separates objects
            )
            clean = den.denoise(frame)  # (H, W, 3) float32, also linear radiance
            # At a cut to another view, call den.reset()

    truth = display(0.5 * made.albedo)  # the room is evenly lit
    print(f"PSNR of the last frame: noisy {psnr(display(made.color), truth):.1f} dB, ", end="")
    print(f"denoised {psnr(display(clean), truth):.1f} dB")
    folder.mkdir(parents=True, exist_ok=True)
    write_image(folder / "numpy_frames.png", to_bytes(np.hstack([made.color, clean])))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/examples"))
