"""``svgf-cl demo``: everything from a scene to denoised pictures, with measured results."""

from __future__ import annotations

import shlex
import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.cli.console import progress_bar, show, show_times, tracked
from svgf_cl.cli.options import MAX_FRAMES, Output, Size, parse_measured_size
from svgf_cl.compare.metrics import Metrics, require_ssim
from svgf_cl.denoiser import Denoiser
from svgf_cl_tracer.cli.scenes import require_tracer


def demo(
    output: Output = Path("out/demo"),
    frames: Annotated[int, typer.Option(metavar="N", min=1, max=MAX_FRAMES, help="Number of frames.")] = 24,
    size: Size = "640x360",
    reference_spp: Annotated[
        int,
        typer.Option(min=1, metavar="SPP", help="Samples per pixel of the references, which take most of the time."),
    ] = 256,
) -> None:
    """Render the built-in scene, denoise it and measure the gain.

    Renders a moving camera at 1 sample per pixel, denoises each frame at once, renders references of a few frames,
    and writes the sequences (EXR), still pictures side by side (PNG) and an animated preview (WebP).

    \b
    Examples:
      svgf-cl demo
      svgf-cl demo --frames 8 --size 320x180 --reference-spp 64 -o out/quick
    """
    require_ssim()  # before `require_tracer` announces that it compiles
    require_tracer()
    from svgf_cl_tracer.demo import SETTINGS, Demo
    from svgf_cl_tracer.references import chunks

    run = Demo(output, frames, parse_measured_size(size), reference_spp)
    run.check_leftovers()
    denoiser = Denoiser(run.shape, settings=SETTINGS)
    print(f"device: {denoiser.queue.device.name.strip()} ({denoiser.queue.device.platform.name})")
    profiles = list(tracked(run.denoise(denoiser), frames, "rendering and denoising"))
    with progress_bar("references", total=len(run.compared) * chunks(reference_spp)) as advance:
        run.render_references(advance)
    run.write_stills()
    run.write_preview()
    show_gain(*(run.measure(kind) for kind in ("noisy", "filtered", "denoised")))
    show_times(profiles)
    show_files(output, [f"still.{number:04d}.png" for number in run.compared])
    print(f"to see it in motion: {shlex.join(viewing(output))}")


def viewing(folder: Path) -> list[str]:
    """The command that plays the frames in a folder."""
    reference = str(folder / "reference")
    called = Path(sys.argv[0])  # as `make` calls it, the command is not on the PATH
    program = str(called) if called.name == "svgf-cl" and not shutil.which("svgf-cl") else "svgf-cl"
    return [program, "view", str(folder / "noisy"), "--reference", reference, "--set", "taa=on"]


def show_gain(noisy: Mapping[int, Metrics], svgf: Mapping[int, Metrics], antialiased: Mapping[int, Metrics]) -> None:
    """Print the measures of each stage's pictures against the reference, one row for each frame."""
    rows = []
    for number, before in noisy.items():
        stages = (before, svgf[number], antialiased[number])
        psnr = [f"{stage.psnr:.2f}" for stage in stages]
        ssim = [f"{stage.ssim:.3f}" for stage in stages]
        rows.append((str(number), *psnr, f"{stages[-1].psnr - before.psnr:+.2f}", *ssim))
    columns = (
        "\nframe",
        "noisy\ndB",
        "filter\ndB",
        "+TAA\ndB",
        "gain\ndB",
        "noisy\nSSIM",
        "filter\nSSIM",
        "+TAA\nSSIM",
    )
    show("against the reference", columns, rows)


def show_files(folder: Path, stills: Sequence[str]) -> None:
    """Print where the results are, and what they show; the files to look at first come first."""
    meanings = {
        "preview.webp": "all frames, noisy beside denoised",
        **dict.fromkeys(stills, "noisy, denoised, reference; below, the part with the largest error, enlarged"),
        "noisy": "EXR: 1 sample per pixel, and all that the filter reads",
        "filtered": "EXR: the filter's pictures before antialiasing (filter)",
        "denoised": "EXR: the same with antialiasing over time (+TAA)",
        "reference": "EXR: the compared frames with many samples",
    }
    paths = {str(folder / name): meaning for name, meaning in meanings.items()}
    width = max(map(len, paths))
    print("files:")
    for path, meaning in paths.items():
        print(f"  {path:{width}}  {meaning}")
