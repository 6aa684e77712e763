"""Denoise frames of an OpenCL renderer on the device: noisy pixels are never copied to the host."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl import Denoiser, Frame
from svgf_cl.compare.metrics import psnr
from svgf_cl.io.display import display, to_bytes, write_image

HEIGHT, WIDTH = 216, 384
FRAMES = 24
TRUTH_SAMPLES = 128  # per pixel
CHANNELS = 16


class Renderer:
    """Balls on a floor; the camera and one ball move."""

    def __init__(self, queue: cl.CommandQueue) -> None:
        source = Path(__file__).with_suffix(".cl").read_text(encoding="utf-8")
        self._queue = queue
        self._kernel = cl.Kernel(cl.Program(queue.context, source).build(["-cl-std=CL1.2"]), "render")
        # All AOVs are in one image, as in many renderers; ids have their own buffer.
        self._stack = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 4 * HEIGHT * WIDTH * CHANNELS)
        self.aovs = cl_array.Array(queue, (HEIGHT, WIDTH, CHANNELS), np.float32, data=self._stack)
        self.ids = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 4 * HEIGHT * WIDTH)

    def render(self, number: int, samples: int = 1) -> None:
        """Put a frame on the queue; its noise depends on the frame's number and on the number of samples per pixel."""
        moments = (*moment(number), *moment(number - 1))
        numbers = np.int32(samples), np.uint32(number + (samples << 16))
        self._kernel(self._queue, (WIDTH, HEIGHT), None, *moments, *numbers, self._stack, self.ids)


def moment(number: int) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """The positions of the camera and the ball in a frame."""
    t = number / 24
    eye = (-0.5 + 0.8 * t, 1.3, 0.5 - 0.5 * t, 0)
    ball = (-2 + 3 * t, 0.5 + abs(math.sin(4 * t)), -4, 0)
    return np.array(eye, np.float32), np.array(ball, np.float32)


def main(folder: Path) -> None:
    """Render and denoise some frames; write the last one, and print its difference from a frame with many samples."""
    den = Denoiser((HEIGHT, WIDTH))  # or Denoiser(shape, queue=...) with a queue of your own
    renderer = Renderer(den.queue)
    aovs = renderer.aovs

    # Views say where each field is, without a copy. They are made once, and serve for all frames.
    frame = Frame.of(
        color=aovs[..., 0:4],  # with alpha, so the result has alpha, too
        normal=aovs[..., 4:7],
        depth=aovs[..., 7],
        motion=aovs[..., 8:11],
        albedo=aovs[..., 11:14],
        id=(renderer.ids, (HEIGHT, WIDTH)),  # a bare buffer has no shape
    )
    clean = cl_array.empty(den.queue, (HEIGHT, WIDTH, 4), np.float32)
    for number in range(FRAMES):
        renderer.render(number)
        # This does not wait: the queue runs one command after the other. If your renderer has its own queue, pass the
        # event of its last kernel as wait_for=[event].
        den.denoise(frame, out=clean)

    noisy, denoised = aovs.get()[..., :3], clean.get()[..., :3]
    renderer.render(FRAMES - 1, TRUTH_SAMPLES)
    truth = display(aovs.get()[..., :3])
    print(f"PSNR of the last frame: noisy {psnr(display(noisy), truth):.1f} dB, ", end="")
    print(f"denoised {psnr(display(denoised), truth):.1f} dB")
    folder.mkdir(parents=True, exist_ok=True)
    write_image(folder / "pyopencl_renderer.png", to_bytes(np.hstack([noisy, denoised])))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/examples"))
