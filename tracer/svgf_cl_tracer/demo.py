"""The demo: renders the built-in scene at 1 sample per pixel, denoises each frame, and compares it with references.

Every step writes its results to files, from which the next step reads them. Files of an interrupted run are kept if
this run would write the same::

    noisy/frame.0000.exr ...        what the tracer rendered, with its G-buffer
    filtered/frame.0000.exr ...     the filter alone
    denoised/frame.0000.exr ...     after temporal antialiasing too
    reference/reference.0000.exr    for the compared frames only, because references take most of the time
    still.0000.png                  the compared frames side by side, with the detail that differs most
    preview.webp                    noisy and denoised, animated
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

import svgf_cl_tracer
from svgf_cl.compare.metrics import Metrics, measure
from svgf_cl.denoiser import Denoiser
from svgf_cl.filters import DEFAULT
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.atomic import output_folder
from svgf_cl.io.display import Bytes, to_bytes, write_image
from svgf_cl.io.frames import frame_path, kept_frame, write_frame
from svgf_cl.io.panels import still, write_preview
from svgf_cl.io.pictures import is_picture, read_picture, write_picture
from svgf_cl.io.sequence import check_leftovers
from svgf_cl_tracer.references import CHUNK, chunks

# From this frame on, the history is long enough to measure the filter.
WARM = 8
# Rays pass through a different point of the pixel in every frame; antialiasing turns this into smooth edges.
SETTINGS = DEFAULT(taa=True)


@dataclass(frozen=True)
class Demo:
    """One run of the demo; call its steps in the order of the methods.

    Parameters
    ----------
    folder : Path
        The folder of all files.
    frames : int
        Length of the sequence, >= 1.
    shape : (int, int)
        (height, width) in pixels.
    reference_spp : int
        Samples per pixel of a reference, >= 1; rounded up to whole chunks.
    """

    folder: Path
    frames: int
    shape: Shape
    reference_spp: int

    @cached_property
    def shot(self) -> svgf_cl_tracer.Shot:
        """The built-in scene, seen along its own camera path."""
        return svgf_cl_tracer.Shot(svgf_cl_tracer.builtin_scene(), self.shape, self.frames)

    @property
    def compared(self) -> list[int]:
        """Frames that are compared with a reference: the first, one at the end of the warm-up, and two later."""
        last = self.frames - 1
        warm = min(WARM, last)
        return sorted({0, warm, (warm + last) // 2, last})

    def path(self, kind: str, number: int) -> Path:
        """The path of the file of a ``noisy``, ``filtered``, ``denoised`` or ``reference`` frame."""
        return frame_path(self.folder / kind, number, "reference" if kind == "reference" else "frame")

    def still_path(self, number: int) -> Path:
        """The path of the picture that shows a compared frame."""
        return self.folder / f"still.{number:04d}.png"

    def check_leftovers(self) -> None:
        """Raise `FileError` if a folder cannot be written to, or has frames that this run would not replace."""
        written = {
            **{kind: [self.path(kind, n) for n in range(self.frames)] for kind in ("noisy", "filtered", "denoised")},
            "reference": [self.path("reference", n) for n in self.compared],
            ".": [self.still_path(n) for n in self.compared],
        }
        for kind, paths in written.items():
            check_leftovers(output_folder(self.folder / kind), paths)

    def denoise(self, denoiser: Denoiser) -> Iterator[dict[str, float]]:
        """Render, denoise and write one frame after the other; yield the milliseconds of each pass."""
        for number in range(self.frames):
            pictures = {"denoised": denoiser.denoise(self._noisy(number)), "filtered": denoiser.stage("modulated")}
            for kind, picture in pictures.items():
                if not is_picture(self.path(kind, number), picture):
                    write_picture(self.path(kind, number), picture)
            yield denoiser.profile()

    def _noisy(self, number: int) -> Frame:
        """The frame that an earlier run has rendered; if there is none, it is rendered and written now."""
        path, made_from = self.path("noisy", number), svgf_cl_tracer.frame_identity(self.shot, number)
        frame = kept_frame(path, made_from)
        if frame is None:
            frame = svgf_cl_tracer.render_frame(self.shot, number)
            write_frame(path, frame, made_from)
        return frame

    def render_references(self, advance: Callable[[], None]) -> None:
        """Render the references of the compared frames; `advance` is called `chunks` times for each of them."""
        references = svgf_cl_tracer.References(self.shot)
        for number in self.compared:
            estimate = references.render(number, self.reference_spp, advance)
            references.write(self.path("reference", number), number, estimate)

    def measure(self, kind: str) -> dict[int, Metrics]:
        """Measure the compared frames of one kind against the references, by number."""
        return {
            number: measure(read_picture(self.path(kind, number)), read_picture(self.path("reference", number)))
            for number in self.compared
        }

    def write_stills(self) -> None:
        """Write the compared frames side by side as PNG."""
        for number in self.compared:
            labels = {
                "noisy": "noisy, 1 spp",
                "denoised": "denoised" if number else "denoised, first frame: no history",
                "reference": f"reference, {CHUNK * chunks(self.reference_spp)} spp",
            }
            panels = {label: to_bytes(read_picture(self.path(kind, number))) for kind, label in labels.items()}
            write_image(self.still_path(number), still(panels))

    def write_preview(self) -> None:
        """Write the whole sequence as an animation, noisy beside denoised."""
        write_preview(self.folder / "preview.webp", (self._pair(number) for number in range(self.frames)))

    def _pair(self, number: int) -> Bytes:
        return np.hstack([to_bytes(read_picture(self.path(kind, number))) for kind in ("noisy", "denoised")])
