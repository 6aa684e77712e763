"""``svgf-cl render``: renders noisy EXR frames with their G-buffers from a scene."""

from __future__ import annotations

from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from svgf_cl.cli.console import kept_of, share_bar, tracked
from svgf_cl.cli.options import MAX_FRAMES, Output, Size, parse_size
from svgf_cl.io.atomic import output_folder
from svgf_cl.io.frames import frame_path, kept_frame, write_frame
from svgf_cl.io.sequence import check_leftovers
from svgf_cl.scheduling import Map, scheduled
from svgf_cl_tracer.cli.scenes import open_scene, read_sky, require_tracer

if TYPE_CHECKING:
    from svgf_cl_tracer import Goal, References

CAMERA_HELP = (
    "Position, point looked at, vertical field of view in degrees and, if it is not +Y, the direction that is up: "
    "px,py,pz/lx,ly,lz/fov[/ux,uy,uz]. Given several times, the camera moves from one to the next. "
    "By default the scene's own."
)
SKY_HELP = (
    "Light from everywhere outside the scene: linear radiance, for example 0.4,0.5,0.7, or a .hdr or .exr image of all "
    "directions. In place of the scene's own sky."
)
SCENE_HELP = "A folder with a scene.json; a glTF, GLB or OBJ file; or a built-in scene, which svgf-cl scenes lists."
FRAMES_HELP = "Number of frames. By default 24, or as many as show what a built-in scene is made for."
ALTERNATIVE_HELP = "Light the scene by the alternative_lights of its scene.json."
REFERENCE_HELP = "Also write a reference of each frame, with at least this many samples per pixel; 0: none."
ERROR_HELP = (
    "Also write a reference of each frame whose relative error (the root of relMSE) is estimated to be at most this, "
    "for example 0.01; of at least 64 samples per pixel unless --reference-spp is given."
)
SCHEDULER_HELP = "Render on the workers of the Dask scheduler there, for example tcp://10.0.0.7:8786."


def render(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help=SCENE_HELP)],
    output: Output,
    frames: Annotated[int | None, typer.Option(metavar="N", min=1, max=MAX_FRAMES, help=FRAMES_HELP)] = None,
    spp: Annotated[int, typer.Option(metavar="N", min=1, help="Samples per pixel of a frame.")] = 1,
    size: Size = "640x360",
    camera: Annotated[list[str], typer.Option(metavar="TEXT", help=CAMERA_HELP)] = [],  # noqa: B006
    sky: Annotated[str | None, typer.Option(metavar="R,G,B|FILE", help=SKY_HELP)] = None,
    alternative_lights: Annotated[bool, typer.Option("--alternative-lights", help=ALTERNATIVE_HELP)] = False,
    jitter: Annotated[
        bool, typer.Option(help="Move the rays within the pixel, with a new offset in each frame.")
    ] = True,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the noise.")] = 0,
    bounces: Annotated[int, typer.Option(metavar="N", min=0, help="Surfaces a path visits after the first.")] = 1,
    reference_spp: Annotated[int, typer.Option(min=0, metavar="SPP", help=REFERENCE_HELP)] = 0,
    until_error: Annotated[float | None, typer.Option(metavar="ERROR", help=ERROR_HELP)] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help=SCHEDULER_HELP)] = None,
) -> None:
    """Render a sequence with the built-in path tracer.

    Writes frame.0000.exr and so on: noisy radiance and all fields that the denoiser uses, as named channels. With
    --reference-spp or --until-error it also writes reference.0000.exr and so on. References are stored in the user's
    cache folder while they are rendered. After an interruption the same command continues: it keeps complete frames
    that were made from the same scene with the same options and version.

    \b
    Examples:
      svgf-cl render cornell -o out/box
      svgf-cl render my_scene --alternative-lights -o out/evening
      svgf-cl render sponza.glb --camera 8,3,0/0,3,0/60 --camera 6,2,1/0,3,0/60 --sky 0.8,0.9,1 -o out/sponza
      svgf-cl render cornell --frames 4 --size 320x180 --reference-spp 256 -o out/box
      svgf-cl render cornell --frames 4 --until-error 0.02 --scheduler tcp://10.0.0.7:8786 -o out/box
    """
    require_tracer()
    from svgf_cl_tracer import (
        BUILTIN,
        Camera,
        CameraPath,
        Goal,
        References,
        Shot,
        frame_identity,
        render_frame,
        tracer_version,
    )

    frames = frames or (BUILTIN[scene].frames if scene in BUILTIN else 24)
    shape = parse_size(size)
    cameras = [Camera.parse(text) for text in camera]
    world = open_scene(scene, read_sky(sky) if sky else None, alternative_lights=alternative_lights)
    shot = Shot(world, shape, frames, CameraPath.through(cameras) if cameras else None)
    goal = None
    if reference_spp or until_error is not None:
        goal = Goal(reference_spp or Goal.spp, inf if until_error is None else until_error)
    folder, written = output_folder(output), ("frame", "reference") if goal else ("frame",)
    check_leftovers(folder, [frame_path(folder, n, stem) for stem in written for n in range(frames)])
    settings: dict[str, Any] = {"spp": spp, "seed": seed, "jitter": jitter, "bounces": bounces}
    made_from = {number: frame_identity(shot, number, **settings) for number in range(frames)}
    missing = [n for n in range(frames) if kept_frame(frame_path(folder, n), made_from[n]) is None]
    with scheduled(scheduler, tracer_version) as run:
        rendered = tracked(run(partial(render_frame, **settings), shot, missing), len(missing), "rendering")
        for number, frame in zip(missing, rendered, strict=True):
            write_frame(frame_path(folder, number), frame, made_from[number])
        if goal:
            write_references(folder, References(shot, seed, jitter, bounces), goal, run)
    print(f"{frames} frames in {output}{kept_of(frames - len(missing))}")


def write_references(folder: Path, references: References, goal: Goal, run: Map) -> None:
    """Render and write the reference of each frame, and print their errors."""
    frames = references.shot.frames
    reached = []
    with share_bar("references", frames) as report:
        for number in range(frames):
            for estimate in references.refine(number, goal, run):
                report(number + goal.share(estimate), f"{estimate.spp} spp, error {estimate.error:.2g}")
            references.write(frame_path(folder, number, "reference"), number, estimate)
            reached.append((estimate.spp, estimate.error))
    samples, errors = zip(*reached, strict=True)
    print(f"references: at least {min(samples)} spp, error at most {max(errors):.2g}")
