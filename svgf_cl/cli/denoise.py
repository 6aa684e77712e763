"""``svgf-cl denoise``: reads EXR frames and writes EXR pictures, one frame at a time."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl.chunks import CHUNK, WARM_UP, cut, denoise_on_cluster
from svgf_cl.cli.console import counted, kept_of, progress_bar, show_times
from svgf_cl.cli.options import AllowGaps, Exposure, FilterName, Frames, SettingTexts, parse_settings
from svgf_cl.cli.reading import reads_frames
from svgf_cl.cli.remarks import Remarks, look_at_surfaces
from svgf_cl.errors import SvgfError, shown
from svgf_cl.filters import DEFAULT
from svgf_cl.io.atomic import output_folder
from svgf_cl.io.patterns import has_number, parse_range
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.separate import SeparateFiles
from svgf_cl.io.sequence import check_leftovers, find_frames, number_of
from svgf_cl.io.shot import Shot
from svgf_cl.job import Chunk, Done, Job, Style, png_of, run, steps, target_paths
from svgf_cl.prefilter import EFFORTS, Effort
from svgf_cl.shot_denoiser import Method

SEPARATE_HELP = "Read this field from separate files."
Separate = Annotated[Path | None, typer.Option(metavar="FILES", help=SEPARATE_HELP)]

TIMED = 1000  # number of the last frames for which times are shown

CHUNK_HELP = (
    "Denoise the shot in chunks of N frames, each with its own warm-up. "
    f"Default: {CHUNK} with --scheduler; else the shot is one chunk."
)
PREFILTER_HELP = (
    "Denoise albedo first. If depth is noisy, for example because of depth of field, also denoise depth and the color "
    "passes that light passes are multiplied by, and fill holes in normals. on: assume that depth is noisy. off: do "
    "none of this."
)
SCHEDULER_HELP = "Denoise chunks on the workers of this Dask scheduler, for example tcp://10.0.0.7:8786."


@reads_frames
def denoise(
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Folder to write to, made if missing, or a pattern: out/####.exr."
        ),
    ],
    frames: Frames = [],  # noqa: B006  # never changed; typer needs the default here
    filter_: FilterName = DEFAULT.name,
    set_: SettingTexts = [],  # noqa: B006
    span: Annotated[str | None, typer.Option("--frames", metavar="FIRST-LAST", help="Only these frames.")] = None,
    warm_up: Annotated[
        int,
        typer.Option(
            min=0,
            metavar="N",
            help="Also filter, but do not write, the N frames before the first of --frames or of a chunk.",
        ),
    ] = WARM_UP,
    chunk: Annotated[int | None, typer.Option(min=1, metavar="N", help=CHUNK_HELP)] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help=SCHEDULER_HELP)] = None,
    look_ahead: Annotated[
        str | None,
        typer.Option(
            metavar="N|all",
            help="Also use the next N frames for each picture, or all later ones: steadier, but three times as slow.",
        ),
    ] = None,
    lights: Annotated[
        bool,
        typer.Option(
            "--passes/--no-passes",
            help="Denoise each light pass, so that they still add up to the picture, or only the picture.",
        ),
    ] = True,
    prefilter: Annotated[
        str,
        typer.Option(
            metavar="on|off|auto",
            help=PREFILTER_HELP,
        ),
    ] = "auto",
    layer: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Add the result as a new layer, and keep the noisy channels."),
    ] = None,
    plain: Annotated[
        bool, typer.Option("--plain", help="Write only the picture, as R G B, and no other channel.")
    ] = False,
    png: Annotated[bool, typer.Option("--png", help="Also write every picture tone-mapped as PNG.")] = False,
    exposure: Exposure = 0.0,
    allow_gaps: AllowGaps = False,
    check: Annotated[bool, typer.Option(help="Check the first frames and warn of mistakes in them.")] = True,
    color: Annotated[
        Path | None,
        typer.Option(metavar="FILES", help="The same as FRAMES: the picture, if each pass has its own files."),
    ] = None,
    albedo: Separate = None,
    normal: Separate = None,
    depth: Separate = None,
    motion: Separate = None,
    id_: Annotated[Path | None, typer.Option("--id", metavar="FILES", help=SEPARATE_HELP)] = None,
    *,
    how: ReadAs,
) -> None:
    """Denoise a shot: the EXR frames of a renderer.

    The frames may come from Blender, Mitsuba, pbrt, Arnold, V-Ray or our own tracer. The first file shows which
    renderer wrote them (svgf-cl formats lists what is read). One line says which passes were found. The command writes
    one EXR file for each frame. It denoises the picture (linear HDR, 32-bit floats) and the light passes that add up
    to it. Everything else in the file is unchanged: other channels, Cryptomatte, windows, attributes. All frames must
    be of one shot, because each uses the frames before it.

    If it is interrupted, run the same command again. All frames are then filtered again, because each picture depends
    on all frames before it, but existing files with the same content are kept.

    \b
    Examples:
      svgf-cl denoise 'shot/####.exr' -o 'out/####.exr'
      svgf-cl denoise shot -o out --layer Denoised              # beside the noisy passes
      svgf-cl denoise shot -o out --frames 101-150              # a part; other machines can do the others
      svgf-cl denoise shot -o out --scheduler tcp://10.0.0.7:8786
      svgf-cl denoise --color 'beauty.####.exr' --albedo 'albedo.####.exr' --normal 'N.####.exr' --depth 'Z.####.exr' \\
                      --motion 'mv.####.exr' -o out
      svgf-cl denoise out/box -o out/box-sure --set standard_error=on   # and the channel standard_error
      svgf-cl denoise out/box -o out/box-eaw --filter eaw --set sigma_color=2
    """
    if layer is not None and not re.fullmatch(r"[^.\s][^.]*", layer):
        raise SvgfError(f"--layer: expected a name without dots, got {shown(layer)}")
    if plain and layer:
        raise SvgfError("--layer: expected no --plain, which writes only the picture")
    fields = {"albedo": albedo, "normal": normal, "depth": depth, "motion": motion, "id": id_}
    if bool(frames) == bool(color):
        raise SvgfError(f"denoise: expected either FRAMES or --color, got {'both' if color else 'neither'}")
    sources = find_frames([*frames, *([color] if color else [])], allow_gaps=allow_gaps)
    selected = chosen(sources, span)
    folder = output.parent if has_number(output) else output
    output_folder(folder)
    targets = target_paths(sources, output)
    job = Job(
        tuple(sources),
        tuple(targets),
        Method(parse_settings(filter_, set_), lights, parse_effort(prefilter)),
        how,
        SeparateFiles.of({name: path for name, path in fields.items() if path}),
        Style(plain, layer, png, exposure),
        parse_look_ahead(look_ahead),
    )
    check_leftovers(folder, [*targets, *(png_of(target) for target in targets if png)])
    chunks = cut(job, selected, chunk or (CHUNK if scheduler else len(selected)), warm_up)
    total, kept = len(selected), 0
    times: deque[Mapping[str, float]] = deque(maxlen=TIMED)
    count = total if scheduler else sum(steps(job, each) for each in chunks)
    with progress_bar("denoising", count) as advance:
        for done in frames_done(job, chunks, scheduler, advance, check=check):
            kept += done.kept
            times.append(done.times)
    show_times(times)
    print(f"{counted(total, 'frame')} in {folder}{kept_of(kept)}")


def parse_effort(text: str) -> Effort:
    """Read the value of --prefilter."""
    for effort in EFFORTS:
        if text == effort:
            return effort
    raise SvgfError(f"--prefilter: expected {' or '.join(EFFORTS)}, got {shown(text)}")


def parse_look_ahead(text: str | None) -> int | None:
    """Read the value of --look-ahead: a number of frames, or ``all``, which becomes 0."""
    if text is None or text == "all":
        return None if text is None else 0
    if not re.fullmatch(r"[1-9]\d{,5}", text, re.ASCII):
        raise SvgfError(f"--look-ahead: expected a number of frames, or all, got {shown(text)}")
    return int(text)


def frames_done(
    job: Job, chunks: list[Chunk], scheduler: str | None, advance: Callable[[], None], *, check: bool
) -> Iterator[Done]:
    """Denoise chunks here or on a cluster, with remarks on the first frames.

    `advance` is called after each frame that is filtered here, or that the cluster has written.
    """
    places = range(chunks[0].first, chunks[-1].written.stop)
    remarks = Remarks(len(places), check=check)
    if len(chunks) == 1 and not scheduler and job.look_ahead is None:
        yield from run(job, chunks[0], remarks.look, advance)
        return
    # The first frames may be filtered later than others.
    remarks.look_at_first(Shot(job.paths, job.how, job.separate), places)
    if scheduler:
        for done in denoise_on_cluster(scheduler, job, chunks, look_at_surfaces):
            advance()
            yield done
        return
    for chunk in chunks:
        yield from run(job, chunk, look_at_surfaces, advance)


def chosen(sources: list[Path], span: str | None) -> range:
    """Return the indices of the frames of --frames; raise `SvgfError` if there are none."""
    if span is None:
        return range(len(sources))
    first, last = parse_range(span)
    places = [place for place, path in enumerate(sources) if first <= number_of(path) <= last]
    if not places:
        numbers = f"{number_of(sources[0])}-{number_of(sources[-1])}"
        raise SvgfError(f"--frames: expected frames among {numbers}, got {span}")
    return range(places[0], places[-1] + 1)
