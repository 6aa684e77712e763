"""Writes docs/filters.webp, README's picture: a whole frame, and enlarged parts of frames beside their reference.

Frames and filters are those of `svgf-cl compare SCENE --filters svgf,taps=5x5,kalman`: both filters get the same noise,
from jittered rays, with all light in one signal, and both antialias over time. Only those rows of the references that
are shown are rendered; they are stored in the user's cache folder. The first run takes ten minutes on 2 cores, later
ones two.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont

from svgf_cl.cli.console import progress_bar, tracked
from svgf_cl.cli.options import parse_settings
from svgf_cl.compare.imagery import Piece, encoded
from svgf_cl.compare.rivals import makers, parse_rivals
from svgf_cl.io.atomic import written_whole
from svgf_cl.io.display import Bytes, Linear, to_bytes
from svgf_cl_tracer import BUILTIN, References, Shot, builtin_scene, render_frame
from svgf_cl_tracer.references import chunks

TARGET = Path("docs/filters.webp")
SHAPE = 414, 828  # height and width of a frame: as wide as GitHub shows README
PART = 60, 102  # height and width of a part; four of them, enlarged, are as wide as the frame
SCALE = 2
SPP = 1024  # of the references
NOISY, SVGF, KALMAN, REFERENCE = "1 sample per pixel", "SVGF (paper)", "svgf_cl (Kalman)", "reference"
FILTERS = "svgf,taps=5x5,kalman"
GAP = 4
LABEL_HEIGHT = 30
FONT = ImageFont.truetype(findfont("DejaVu Sans"), 16)
QUALITY = 88  # of the WebP


@dataclass(frozen=True)
class Part:
    """A part of a frame: its top left corner in pixels, and the exposure in stops, the same for all columns."""

    scene: str
    frame: int
    x: int
    y: int
    exposure: float

    @property
    def piece(self) -> Piece:
        """Its rows and columns."""
        return Piece(slice(self.y, self.y + PART[0]), slice(self.x, self.x + PART[1]))

    @cached_property
    def pictures(self) -> Mapping[str, Bytes]:
        """The whole frame as it was rendered, and as each filter shows it."""
        filters = makers(parse_rivals(FILTERS, parse_settings), SHAPE, jitter=True)
        count = self.frame + 1
        for number in tracked(range(count), count, f"{self.scene}: frames"):
            frame = replace(render_frame(self._shot, number), direct=None, indirect=None)
            svgf, kalman = (each.denoise(frame) for each in filters.values())
        return {NOISY: self._shown(frame.color), SVGF: self._shown(svgf), KALMAN: self._shown(kalman)}

    @property
    def columns(self) -> Mapping[str, Bytes]:
        """The part of each picture, and of the reference, enlarged."""
        references = References(self._shot, rows=(self.piece.rows.start, self.piece.rows.stop))
        with progress_bar(f"{self.scene}: reference", chunks(SPP)) as advance:
            band = self._shown(references.picture(references.render(self.frame, SPP, advance)))
        cut = {label: self.piece.of(picture) for label, picture in self.pictures.items()}
        cut[REFERENCE] = band[:, self.piece.columns]
        return {label: picture.repeat(SCALE, axis=0).repeat(SCALE, axis=1) for label, picture in cut.items()}

    @cached_property
    def _shot(self) -> Shot:
        return Shot(builtin_scene(self.scene), SHAPE, BUILTIN[self.scene].frames)

    def _shown(self, picture: Linear) -> Bytes:
        return to_bytes(picture, self.exposure)


PARTS = (  # of the first one the whole frame is shown, too
    Part("swing", 39, 494, 240, 0.25),  # the shadow of the pendulum, which moves
    Part("switch", 15, 312, 222, 1.5),  # a lamp went off three frames before
    Part("sliding", 47, 502, 240, 0.25),  # the tiles move, the shadow on them does not
    Part("glossy", 17, 222, 256, 0.25),  # a reflecting ball, while the camera moves
)


def main() -> None:
    """Compose and write the picture."""
    rows = [part.columns for part in PARTS]
    sheet = np.vstack([whole(PARTS[0]), labels(rows[0]), *(beside(row.values()) for row in rows)])[:-GAP]
    with written_whole(TARGET) as aside:
        aside.write_bytes(encoded(sheet, QUALITY))
    print(f"{TARGET}: {sheet.shape[1]}x{sheet.shape[0]}, {TARGET.stat().st_size / 1000:.0f} kB")


def whole(part: Part) -> Bytes:
    """The whole frame, as it was rendered on the left and denoised on the right; a white line around the part."""
    height, width = SHAPE
    y, x = np.mgrid[:height, :width]
    across = x + 0.25 * y - 0.45 * width  # pixels from a slanted line
    picture = np.where(across[..., None] < 0, part.pictures[NOISY], part.pictures[KALMAN])
    picture[abs(across) < 1.5] = 255
    drawn = Image.fromarray(picture)
    draw = ImageDraw.Draw(drawn)
    for label, side, anchor in ((NOISY, 12, "ls"), (KALMAN, width - 12, "rs")):
        draw.text((side, height - 14), label, "white", FONT, anchor, stroke_width=3, stroke_fill="black")
    draw.rectangle((part.x - 2, part.y - 2, part.x + PART[1] + 1, part.y + PART[0] + 1), outline="white", width=2)
    return np.asarray(drawn)


def labels(columns: Iterable[str]) -> Bytes:
    """A row of labels, each above the middle of its column."""
    drawn = Image.new("RGB", (SHAPE[1], LABEL_HEIGHT))
    for index, label in enumerate(columns):
        x = index * (SCALE * PART[1] + GAP) + SCALE * PART[1] / 2
        ImageDraw.Draw(drawn).text((x, LABEL_HEIGHT / 2), label, "white", FONT, "mm")
    return np.asarray(drawn)


def beside(pictures: Iterable[Bytes]) -> Bytes:
    """Pictures in a row, with a gap between them and below."""
    return np.hstack([np.pad(picture, ((0, GAP), (0, GAP), (0, 0))) for picture in pictures])[:, :-GAP]


if __name__ == "__main__":
    main()
