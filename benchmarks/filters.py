"""The filters beside each other, on the same noisy frames: error, flicker, and how sharp edges stay.

Every filter gets the same frames of a built-in scene, or of a scene file, at 1 sample per pixel with jittered rays, and
light as one signal. All of them accumulate light over time in the same way, so they differ in their spatial part alone:

- "noisy": nothing is done;
- "accumulated": accumulation over time alone (stage "accumulated" of EAW, whose history no spatial filter touches);
- "EAW", "SVGF": the whole filters with their default settings;
- "EAW, TAA", "SVGF, TAA": the same with temporal antialiasing.

What they make of the last two frames is compared with a path-traced truth, each pixel of which is the mean over the
pixel's area. PSNR, SSIM, FLIP, relMSE and the temporal error: `svgf_cl.compare.metrics`.

Rays go through another point of the pixel in every frame, so edges of objects flicker whatever the filter, unless it
has temporal antialiasing. Two figures therefore look at surfaces alone: at pixels around which 5x5 pixels show one
object, turned the same way, of the same colour. What changes there is the light.

- "flicker on surfaces": how much the error there changes from frame to frame, root mean square, of what is shown.
  The truth's own noise, which is most of the temporal error, is not in it;
- "edges" and "shadow edges": how sharp the strongest edges are, everywhere and on surfaces: the picture's gradient
  along that of the truth, sum(g . g_truth) / sum(g_truth . g_truth), of luminance as shown, over the pixels where the
  truth's gradient is strongest (`SHARE` of them). 100 % is as sharp as the truth, 0 % is flat. Noise hardly counts as
  sharpness, as it has no direction in common with the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from benchmarks.command import run
from benchmarks.footage import Footage
from benchmarks.measurements import Quality, quality
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl import Denoiser, Frame
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.compare.metrics import require_flip, require_ssim, ssim
from svgf_cl.device import devices
from svgf_cl.filters import Eaw, Settings
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import LUMINANCE
from svgf_cl.io.atomic import output_folder
from svgf_cl.io.display import Linear, display, to_bytes, write_image
from svgf_cl.io.panels import still
from svgf_cl.oracle.taps import shifted, square
from svgf_cl.oracle.temporal import demodulate, modulate

SCENES = ("cornell", "swing", "static")

NOISY, ACCUMULATED = "noisy", "accumulated"

SHARE = 0.05  # of the pixels looked at, those with the strongest edges
SAME_NORMAL = 0.9  # cosine from which two pixels show one surface
SAME_ALBEDO = 0.02

Mask = NDArray[np.bool_]
Pair = tuple[Linear, Linear]  # of two consecutive frames
Pictures = dict[str, list[Linear]]


@dataclass(frozen=True)
class Findings:
    """How good one filter's picture of a scene is.

    Parameters
    ----------
    quality : Quality
    ssim : float
    flicker : float
        On surfaces, as above.
    edges, shadow_edges : float
        Sharpness, as above.
    """

    quality: Quality
    ssim: float
    flicker: float
    edges: float
    shadow_edges: float

    @property
    def row(self) -> list[str]:
        """As printed."""
        shares = [f"{100 * share:.0f}" for share in (self.edges, self.shadow_edges)]
        errors = [f"{self.quality.psnr:.2f}", f"{self.ssim:.3f}", f"{self.quality.flip:.4f}"]
        return [*errors, f"{self.quality.relmse:.4f}", f"{self.quality.temporal:.5f}", f"{self.flicker:.5f}", *shares]


COLUMNS = (
    *("PSNR dB ↑", "SSIM ↑", "FLIP ↓", "relMSE ↓"),
    *("temporal ↓", "flicker on surfaces ↓", "edges % ↑", "shadow edges % ↑"),
)


def filters(
    scene: Annotated[
        list[str], typer.Argument(metavar="SCENE...", help="Built-in scenes, or glTF, GLB or OBJ files.")
    ] = list(SCENES),  # noqa: B006  # never changed; typer wants the default spelled here
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "640x360",
    frames: Annotated[int, typer.Option(metavar="N", min=2, help="Frames; the last two are judged.")] = 24,
    spp: Annotated[int, typer.Option(metavar="N", min=2, help="Samples per pixel of the truth.")] = 256,
    sigma_color: Annotated[
        list[float], typer.Option(metavar="RADIANCE", help="Try EAW with this instead of its default; may be repeated.")
    ] = [],  # noqa: B006  # never changed; typer wants the default spelled here
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Write a picture of each scene there, too.")
    ] = None,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print tables as markdown.")] = False,
) -> None:
    """Compare the filters' pictures of scenes with path-traced truth.

    PYOPENCL_CTX chooses the device. The truth takes a minute or two a scene to render the first time, and is kept in
    the user's cache folder.
    """
    require_flip()
    require_ssim()
    folder = output_folder(output) if output else None
    footages = [
        Footage("area", True, each, shape=parse_size(size), band=(0, 1), frames=frames, spp=spp) for each in scene
    ]
    chosen = compared_filters([Eaw(sigma_color=each) for each in sigma_color] or [Eaw()])
    for footage in footages:
        with progress_bar(footage.scene, footage.chunks + footage.frames) as advance:
            table, pictures = compared(footage, chosen, advance)
        print(f"{table.title}:\n\n{markdown(table)}") if markdown_ else show(table.title, table.columns, table.rows)
        if folder:
            write_image(
                folder / f"{Path(footage.scene).stem}.png", still({n: to_bytes(p) for n, p in pictures.items()})
            )
    about = provenance(devices.default_device()) | {"size": size, "frames": str(frames), "truth": f"{spp} spp"}
    print("\n".join(f"{key}: {value}" for key, value in about.items()))


def compared_filters(eaws: Sequence[Eaw]) -> dict[str, Filter]:
    """The filters by the names of their rows."""
    named = {"EAW": eaws[0]} if len(eaws) == 1 else {f"EAW {each.sigma_color:g}": each for each in eaws}
    plain: dict[str, Filter] = {**named, "SVGF": Settings()}
    return plain | {f"{name}, TAA": replace(each, taa=True) for name, each in plain.items()}  # type: ignore[call-arg]


def compared(
    footage: Footage, chosen: Mapping[str, Filter], advance: Callable[[], None]
) -> tuple[Table, dict[str, Linear]]:
    """Judge every filter on one footage: a table, and the last picture of each, the truth behind them."""
    halves = footage.halves(advance)
    truth = [0.5 * (first + second) for first, second in halves]
    pictures, surfaces = denoised(footage, chosen, advance)
    rows = [[name, *judged(made, halves, surfaces).row] for name, made in pictures.items()]
    last = {name: made[-1] for name, made in (pictures | {"truth": truth}).items()}
    return Table(footage.scene, ("filter", *COLUMNS), rows), last


def denoised(
    footage: Footage, chosen: Mapping[str, Filter], advance: Callable[[], None]
) -> tuple[Pictures, list[Mask]]:
    """The judged rows of the judged frames, as every filter shows them, and where they show one surface alone."""
    denoisers = {name: Denoiser(footage.shape, settings=settings) for name, settings in chosen.items()}
    accumulating = next(den for den in denoisers.values() if isinstance(den.settings, Eaw))
    pictures: Pictures = {name: [] for name in (NOISY, ACCUMULATED, *denoisers)}
    surfaces = []
    for number, split in enumerate(footage.noisy()):
        frame = replace(split, direct=None, indirect=None)
        made = {name: den.denoise(frame) for name, den in denoisers.items()}
        if number in footage.judged:
            rows = slice(*footage.rows)
            made |= {NOISY: frame.color, ACCUMULATED: accumulated(accumulating, frame)}
            for name, picture in made.items():
                pictures[name].append(picture[rows])
            surfaces.append(one_surface(frame)[rows])
        advance()
    return pictures, surfaces


def accumulated(den: Denoiser, frame: Frame) -> Linear:
    """The picture that accumulation over time alone makes of EAW's last frame."""
    _, guides = demodulate(frame)
    return modulate(den.stage("accumulated").astype(np.float64), guides)


def judged(pictures: Sequence[Linear], halves: Sequence[Pair], surfaces: Sequence[Mask]) -> Findings:
    """Measure two consecutive linear pictures against two independent halves of the truth about each."""
    truth = [0.5 * (first + second) for first, second in halves]
    shown = [(display(picture), display(wanted)) for picture, wanted in zip(pictures, truth, strict=True)]
    (earlier, _), (later, _) = shown
    earlier_halves, later_halves = ((display(first), display(second)) for first, second in halves)
    return Findings(
        quality(pictures, truth),
        float(np.mean([ssim(*pair) for pair in shown])),
        flicker(
            (earlier, later),
            ((earlier_halves[0], later_halves[0]), (earlier_halves[1], later_halves[1])),
            surfaces[0] & surfaces[1],
        ),
        float(np.mean([sharpness(*pair, np.ones(pair[0].shape[:2], np.bool_)) for pair in shown])),
        float(np.mean([sharpness(*pair, surface) for pair, surface in zip(shown, surfaces, strict=True)])),
    )


def flicker(shown: Pair, halves: tuple[Pair, Pair], where: Mask) -> float:
    """Change of the error between two display-referred pictures: root mean square, without the truth's own noise.

    The square is the product of the errors against two independent halves of the truth, whose noise has mean 0. NaN
    where there is nothing to look at.
    """
    first, second = ((shown[1] - shown[0] - (half[1] - half[0]))[where] for half in halves)
    squared = float(np.mean(first * second)) if where.any() else float("nan")
    return float(np.sqrt(np.maximum(squared, 0.0)))


def sharpness(shown: Linear, wanted: Linear, where: Mask) -> float:
    """How sharp the strongest edges of a display-referred picture are there, relative to the truth; NaN without any."""
    found, truth = gradient(shown), gradient(wanted)
    strength = np.where(where, (truth**2).sum(axis=-1), 0)
    strongest = strength >= np.quantile(strength[where], 1 - SHARE) if where.any() else where
    strongest &= strength > 0
    if not strongest.any():
        return float("nan")
    return float((found * truth).sum(axis=-1)[strongest].sum() / strength[strongest].sum())


def gradient(shown: Linear) -> NDArray[np.float64]:
    """Sobel's gradient of luminance, (H, W, 2); 0 at the picture's border."""
    luminance = np.asarray(shown, np.float64) @ np.array(LUMINANCE)
    smooth_down = luminance[:-2] + 2 * luminance[1:-1] + luminance[2:]
    smooth_along = luminance[:, :-2] + 2 * luminance[:, 1:-1] + luminance[:, 2:]
    along, down = smooth_down[:, 2:] - smooth_down[:, :-2], smooth_along[2:] - smooth_along[:-2]
    return np.pad(np.stack((along, down), axis=-1) / 8, ((1, 1), (1, 1), (0, 0)))


def one_surface(frame: Frame) -> Mask:
    """Where a pixel and all 24 around it show the same object, turned the same way, of the same colour."""
    hit: Mask = frame.depth < np.inf
    same: Mask = hit.copy()
    for offset in square(2):
        y, x, inside = shifted(offset, frame.shape)
        same &= inside & hit[y, x] & (frame.id[y, x] == frame.id)
        same &= (frame.normal[y, x] * frame.normal).sum(axis=-1) > SAME_NORMAL
        same &= np.abs(frame.albedo[y, x] - frame.albedo).max(axis=-1) < SAME_ALBEDO
    return same


def main() -> None:
    """Run the command."""
    run(filters, "filters")


if __name__ == "__main__":
    main()
