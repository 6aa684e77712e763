"""``svgf-cl compare``: compares filters on scenes or on a user's frames, or pictures with their references."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from svgf_cl import __version__
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import STDOUT, Exposure, check_files, parse_measured_size, parse_settings
from svgf_cl.cli.reading import reads_frames, refuse_reading
from svgf_cl.cli.verdict import leave_with
from svgf_cl.errors import SvgfError, install_extra
from svgf_cl.io.atomic import output_folder, require, write_text
from svgf_cl.io.reading import ReadAs

if TYPE_CHECKING:
    from svgf_cl.compare.footage import Footage
    from svgf_cl.compare.page import Entry, Page, Scene
    from svgf_cl.compare.rivals import Rival

SCENE_FILES = (".gltf", ".glb", ".obj")
PICTURES = "pictures"  # the rival's name for finished pictures


@dataclass(frozen=True)
class Preset:
    """The extent of a comparison on scenes: the defaults of the options, or those with --quick."""

    scenes: tuple[str, ...]
    size: str
    frames: int | None
    judged: int | None
    spp: int


USUAL = Preset(
    ("cornell", "glossy", "swing", "switch", "sliding", "fence", "fireflies", "static"), "640x360", None, None, 128
)
QUICK = Preset(("cornell", "swing", "switch"), "320x180", 32, 12, 64)


@reads_frames
def compare(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="SCENE|FRAMES|A B",
            help="Scenes to render; or, with --reference, the frames of one shot; or two pictures or folders of them, "
            "of which the second is the reference of the first. By default built-in scenes.",
        ),
    ] = [],  # noqa: B006  # never changed; typer needs the default here
    filters: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Filters to compare, each followed by its settings, such as svgf,taps=5x5,eaw,oidn. oidn is Open "
            "Image Denoise frame by frame, oidn+accumulation the same accumulated over time. --fail-below and "
            "--fail-above test the first one. By default all that are installed.",
        ),
    ] = None,
    reference: Annotated[
        Path | None, typer.Option(metavar="REF", help="References of the frames: a picture, or a folder of them.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Folder for index.html, results.json, results.csv and figures; by default out/compare for scenes "
            "and frames.",
        ),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Three small scenes with few samples: minutes instead of an hour.")
    ] = False,
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of rendered frames [640x360].")] = "",
    frames: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Number of frames to render [the scene's own].")
    ] = None,
    judged: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="How many of the last frames are measured [all from the ninth on]."),
    ] = None,
    spp: Annotated[
        int | None, typer.Option(metavar="N", min=2, help="Samples per pixel of the reference [128].")
    ] = None,
    jitter: Annotated[
        bool, typer.Option(help="Move rays within the pixel and antialias over time, or do neither.")
    ] = True,
    exposure: Exposure = 0.0,
    fail_below: Annotated[
        str,
        typer.Option(
            metavar="MEASURE=X,...", help="Exit code 1 if the first filter has less, such as psnr=30,ssim=0.9."
        ),
    ] = "",
    fail_above: Annotated[
        str,
        typer.Option(
            metavar="MEASURE=X,...", help="Exit code 1 if the first filter has more, such as relmse=0.1,ghost=0.2."
        ),
    ] = "",
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Also write these checks as JUnit XML.")] = None,
    json: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Also write all values there as JSON; '-' prints them on stdout instead of tables."
        ),
    ] = None,
    *,
    how: ReadAs,
) -> None:
    """Compare filters on scenes or on frames, or compare pictures.

    Scenes are rendered at 1 sample per pixel, filtered, and compared with a path-traced reference, which is stored in
    the user's cache folder. Frames are files that svgf-cl denoise reads. Pictures are EXR files (R, G, B). The page
    index.html shows pictures, error maps, clips, temporal profiles, curves and tables, and needs no other file.
    Finished scenes are stored in DIR/parts: after an interruption the same command continues.

    PSNR, SSIM, FLIP and everything visible are measured as shown: exposed, clipped to 0..1, in sRGB. relMSE and bias
    are measured in linear light. docs/comparing.md explains every measure. Frames of two folders are paired by
    number; every reference needs a picture. With two pictures or folders, every frame must keep the limits.

    \b
    Examples:
      svgf-cl compare --quick
      svgf-cl compare swing switch --filters kalman,svgf,oidn -o out/compare
      svgf-cl compare my/frames --reference my/references
      svgf-cl compare out/demo/denoised out/demo/reference --fail-below psnr=30,ssim=0.9
    """
    needs_packages()
    from svgf_cl.compare.limits import Limits

    limits = Limits.parse(fail_below, fail_above)
    if junit and not limits:
        raise SvgfError("--junit: expected --fail-below or --fail-above too, got none")
    check_files(json, junit)
    is_made = reference is None and are_pictures(inputs)
    if reference is None:
        refuse_reading(how, "finished pictures" if is_made else "scenes")
    if is_made or reference is not None:
        refuse_rendering({"--quick": quick, "--size": size, "--frames": frames, "--judged": judged, "--spp": spp})
    if is_made:
        footages, rivals = [of_pictures(inputs, filters)], []
    else:
        rivals = chosen_rivals(filters)
        output = output or Path("out/compare")
        if reference is not None:
            footages = [of_frames(inputs, reference, how, jitter=jitter)]
        else:
            preset = QUICK if quick else USUAL
            footages = of_scenes(inputs or preset.scenes, preset, (size, frames, judged, spp), jitter=jitter)
    folder = output_folder(output) if output else None
    scenes = [judge(footage, rivals, exposure, folder) for footage in footages]
    page = page_of(scenes, exposure)
    report(page, by_frame=is_made, to_stdout=json == STDOUT)
    write_files(page, folder, json)
    tested = [(scene, scene.entries[0].rival) for scene in scenes]
    checks = [check for each in tested for check in limits.checks(*each, each_frame=is_made)]
    leave_with(checks, "svgf-cl compare", junit)


def needs_packages() -> None:
    """Raise `SvgfError` if a package that every comparison needs is missing."""
    from svgf_cl.compare.metrics import require_ssim, why_no_flip

    require_ssim()
    try:
        import jinja2  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"compare needs more ({error}): {install_extra('metrics')}") from error
    if missing := why_no_flip():
        typer.echo(f"FLIP is not measured: {missing}", err=True)


def are_pictures(inputs: Sequence[str]) -> bool:
    """Whether these are EXR files or folders of them, rather than scenes."""
    pictures = [text for text in inputs if not is_scene(text)]
    for text in pictures:
        require(Path(text))
    if pictures and len(pictures) < len(inputs):
        scene = next(text for text in inputs if text not in pictures)
        raise SvgfError(f"expected scenes or pictures, got both: {scene} is a scene, {pictures[0]} is not")
    return bool(pictures)


def is_scene(text: str) -> bool:
    """Whether this is a scene's name or file, rather than an EXR file or a folder of them."""
    path = Path(text)
    is_described = path.is_dir() and (path / "scene.json").exists()
    is_name = not path.exists() and len(path.parts) == 1 and not path.suffix
    return is_described or is_name or path.suffix.lower() in SCENE_FILES


def refuse_rendering(options: Mapping[str, object]) -> None:
    """Raise `SvgfError` if an option for rendering is given, but nothing is rendered."""
    for name, value in options.items():
        if value:
            raise SvgfError(f"{name}: expected scenes to render, got finished pictures or frames")


def of_pictures(inputs: Sequence[str], filters: str | None) -> Footage:
    """Return the footage of two pictures, or of two folders of them."""
    from svgf_cl.compare.recorded import open_pictures

    if len(inputs) != 2:
        raise SvgfError(
            f"expected two pictures or folders, of which the second is the reference of the first, got {len(inputs)}; "
            "to filter frames, add --reference"
        )
    if filters is not None:
        raise SvgfError("--filters: expected scenes, or frames with --reference, got finished pictures")
    return open_pictures(Path(inputs[0]), Path(inputs[1]))


def of_frames(inputs: Sequence[str], reference: Path, how: ReadAs, *, jitter: bool) -> Footage:
    """Return the footage of a user's frames with references."""
    from svgf_cl.compare.recorded import open_frames

    if not inputs:
        raise SvgfError("--reference: expected frames too, got none")
    return open_frames([Path(text) for text in inputs], reference, how, jitter=jitter)


def of_scenes(
    names: Sequence[str],
    preset: Preset,
    given: tuple[str, int | None, int | None, int | None],
    *,
    jitter: bool,
) -> list[Footage]:
    """Return the footage of scenes; `given` has the options size, frames, judged and spp."""
    from svgf_cl.compare.footage import Choice, opener

    size, frames, judged, spp = given
    shape = parse_measured_size(size or preset.size)
    choice = Choice(shape, frames or preset.frames, judged or preset.judged, spp or preset.spp, jitter)
    open_footage = opener()
    return [open_footage(name, choice) for name in names]


def chosen_rivals(text: str | None) -> list[Rival]:
    """Return the rivals of --filters, or all that are installed."""
    from svgf_cl.compare.rivals import parse_rivals, usual_rivals

    return parse_rivals(usual_rivals() if text is None else text, parse_settings)


def judge(footage: Footage, rivals: Sequence[Rival], exposure: float, folder: Path | None) -> Scene:
    """Return one scene's results: those that an earlier run stored, or new ones, which are stored."""
    from svgf_cl.compare.contest import NOISY, compete
    from svgf_cl.compare.record import part_name, read_part, write_part
    from svgf_cl.compare.rivals import Noisy, makers
    from svgf_cl.device.devices import default_device

    part = None
    if folder and rivals:
        names = [each.name for each in rivals]
        part = folder / "parts" / f"{part_name(footage.identity, names, exposure, default_device().name)}.json"
    if part and (kept := read_part(part)):
        return kept
    with progress_bar(footage.name, footage.steps + len(footage.numbers)) as advance:
        if rivals:
            working = {**makers(rivals, footage.shape, jitter=footage.jitter), NOISY: Noisy()}
        else:
            working = {PICTURES: Noisy()}
        scene = compete(footage, working, exposure, advance)
    if part:
        output_folder(part.parent)
        write_part(part, scene)
    return scene


def page_of(scenes: Sequence[Scene], exposure: float) -> Page:
    """Return the page of all scenes."""
    from svgf_cl.compare.page import Page
    from svgf_cl.compare.record import measured
    from svgf_cl.device.devices import default_device

    about = {
        "command": shlex.join(["svgf-cl", *sys.argv[1:]]),
        "svgf_cl": __version__,
        "date": date.today().isoformat(),
        "shown and measured": f"exposed by {exposure:g} stops, clipped to 0..1, in sRGB",
    }
    if any(entry.milliseconds for scene in scenes for entry in scene.entries):
        device = default_device()
        about["device"] = f"{device.name}, {device.platform.version}, driver {device.driver_version}"
    return Page("Comparison of filters", about, measured(scenes), scenes)


def report(page: Page, *, by_frame: bool, to_stdout: bool) -> None:
    """Print a table for each scene; the rows are filters, or frames for finished pictures."""
    from svgf_cl.compare.record import results
    from svgf_cl.compare.tables import frame_table, scene_table

    for scene in page.scenes:
        broken = [each.rival for each in scene.entries if each.values and not is_measured(each)]
        if broken:
            typer.echo(
                f"{scene.name}: most measures are missing, because pixels are NaN: {', '.join(broken)}", err=True
            )
    if to_stdout:
        print(results(page), end="")
        return
    for scene in page.scenes:
        if by_frame:
            show(scene.name, *frame_table(page, scene))
        else:
            show(f"{scene.name}: {scene.note}", *scene_table(page, scene))


def is_measured(entry: Entry) -> bool:
    """Whether an error was measured; it is NaN if pixels are NaN."""
    psnr = entry.values.get("psnr")
    return psnr is not None and psnr == psnr


def write_files(page: Page, folder: Path | None, json: Path | None) -> None:
    """Write the page, all values, and the figures."""
    from svgf_cl.compare import page as pages
    from svgf_cl.compare.figures import figure, file_name
    from svgf_cl.compare.record import results, table
    from svgf_cl.io.display import write_image

    if json and json != STDOUT:
        write_text(json, results(page))
    if folder is None:
        return
    pages.write(page, folder / "index.html")
    write_text(folder / "results.json", results(page))
    write_text(folder / "results.csv", table(page))
    for number, scene in enumerate(page.scenes, 1):
        write_image(output_folder(folder / "figures") / file_name(number, scene.name), figure(scene))
    typer.echo(f"{folder}: index.html, results.json, results.csv, figures", err=json == STDOUT)
