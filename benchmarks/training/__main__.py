"""Trains the network of LBF on random rooms, and writes it together with its origin.

docs/lbf.md says what is learned, and how good the result is.
"""

from __future__ import annotations

import json
import platform
import shlex
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from benchmarks.command import run
from benchmarks.provenance import provenance
from benchmarks.training.objective import Pixels, packed, unpacked, untrained
from benchmarks.training.rooms import room
from benchmarks.training.samples import Sample, Shots
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import parse_size
from svgf_cl.device import devices
from svgf_cl.filters import lbf
from svgf_cl.filters.lbf import Network
from svgf_cl.io.atomic import output_file, read_json, write_text
from svgf_cl.oracle.taps import Array
from svgf_cl_tracer import Scene
from svgf_cl_tracer.cli.scenes import open_scene

HELD_OUT = range(10_000, 10_004)  # seeds of rooms that are not used for training
SHIPPED = Path(lbf.__file__).with_name(lbf.FILE)
STEPS = 25  # steps of the optimiser in a round
DIGITS = 6  # digits of a weight in the file


@dataclass(frozen=True)
class Course:
    """The parameters of a training, which must be the same when a run is resumed.

    Parameters
    ----------
    rooms, rounds, pixels : int
        The number of scenes, of draws of pixels, and of pixels in a draw.
    size : str
    spp : int
        Samples per pixel of a truth.
    scenes : tuple of str
        Scenes for training in addition to the rooms.
    """

    rooms: int
    rounds: int
    pixels: int
    size: str
    spp: int
    scenes: tuple[str, ...]


@dataclass(frozen=True)
class Progress:
    """The state of a training after some rounds: its checkpoint.

    Parameters
    ----------
    course : dict
    errors : list of float
        The error of each round over its own pixels, at its end.
    seconds : float
        Time in the optimiser, in all runs.
    values : list of float
        The weights of the network.
    """

    course: dict[str, Any]
    errors: list[float]
    seconds: float
    values: list[float]


def train(
    scenes: Annotated[
        list[str], typer.Argument(metavar="[SCENE]...", help="Scenes for training in addition to the rooms.")
    ] = [],  # noqa: B006  # never changed; typer wants the default spelled here
    held_out: Annotated[
        list[str],
        typer.Option(metavar="SCENE", help="A held-out scene, may be repeated; four held-out rooms are always used."),
    ] = [],  # noqa: B006
    rooms: Annotated[int, typer.Option(metavar="N", min=1, help="Random rooms to train on.")] = 40,
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Rounds, each on other pixels.")] = 16,
    pixels: Annotated[int, typer.Option(metavar="N", min=1, help="Pixels of a round.")] = 60_000,
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "240x136",
    spp: Annotated[int, typer.Option(metavar="N", min=1, help="Samples per pixel of a truth.")] = 128,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="Where to write the network.")
    ] = SHIPPED,
) -> None:
    """Train LBF's network, and write it with the data and time of the training and its error on held-out scenes.

    Each round minimises the error over another draw of pixels (L-BFGS). After each round the
    state is stored beside the output as FILE.part. After an interruption, the same command continues from there, and
    gives the same numbers.
    """
    course = Course(rooms, rounds, pixels, size, spp, tuple(scenes))
    shots = Shots(parse_size(size), spp)
    output_file(output)
    scenes_to_learn = [*(room(seed) for seed in range(rooms)), *(open_scene(name, None) for name in scenes)]
    learned = Pixels.of(gathered(shots, scenes_to_learn, "frames to train on"))
    begun = resumed(output.with_suffix(".part"), course)
    progress = optimised(learned, course, begun, output.with_suffix(".part"))
    network = unpacked(np.array(progress.values))
    judged = {"rooms": [room(seed) for seed in HELD_OUT], **{name: [open_scene(name, None)] for name in held_out}}
    found = {name: errors(network, gathered(shots, those, name)) for name, those in judged.items()}
    write(output, network, progress, found)
    output.with_suffix(".part").unlink(missing_ok=True)
    show("relative error, mean square", ("held out", "accumulated", "LBF"), rows(found))


def gathered(shots: Shots, scenes: Sequence[Scene], title: str) -> list[Sample]:
    """The samples of all scenes; truths are stored in the user's cache."""
    with progress_bar(title, shots.chunks(len(scenes))) as advance:
        return [each for scene in scenes for each in shots.samples(scene, advance)]


def resumed(path: Path, course: Course) -> Progress:
    """The state of an earlier run of the same course; if there is none, the initial state."""
    start = Progress(jsonable(course), [], 0.0, packed(untrained(0)).tolist())
    if not path.exists():
        return start
    kept = Progress(**read_json(path))
    return kept if kept.course == start.course else start


def jsonable(course: Course) -> dict[str, Any]:
    """The course as JSON."""
    return dict(json.loads(json.dumps(asdict(course))))


def optimised(learned: Pixels, course: Course, progress: Progress, checkpoint: Path) -> Progress:
    """The network after all rounds."""
    from scipy.optimize import minimize

    with progress_bar("training", course.rounds) as advance:
        for _ in progress.errors:
            advance()
        for number in range(len(progress.errors), course.rounds):
            begin = time.perf_counter()
            drawn = learned.some(course.pixels, seed=number)
            step = minimize(
                drawn.objective, np.array(progress.values), jac=True, method="L-BFGS-B", options={"maxiter": STEPS}
            )
            error, _ = drawn.error(unpacked(step.x))
            spent = progress.seconds + time.perf_counter() - begin
            progress = Progress(progress.course, [*progress.errors, error], spent, step.x.tolist())
            write_json(checkpoint, asdict(progress))
            advance()
    return progress


def errors(network: Network, samples: Sequence[Sample]) -> dict[str, float]:
    """Mean squared relative error of the filter's input, and of its result."""
    pixels = Pixels.of(samples)
    raw = np.concatenate([each.light[each.guides.hit] for each in samples])
    return {"accumulated": relative(raw, pixels), "LBF": pixels.error(network)[0]}


def relative(light: Array, pixels: Pixels) -> float:
    """Mean squared relative error of light (P, 3)."""
    return float(np.mean(np.square((light - pixels.truth) / pixels.scale[:, None])))


def rows(found: dict[str, dict[str, float]]) -> Iterable[tuple[str, ...]]:
    """A row for each held-out set."""
    return [(name, *(f"{value:.4f}" for value in values.values())) for name, values in found.items()]


def write(path: Path, network: Network, progress: Progress, found: dict[str, dict[str, float]]) -> None:
    """Write the network, together with its origin."""
    about = {
        "command": shlex.join(["python", "-m", "benchmarks.training", *sys.argv[1:]]),
        **provenance(devices.default_device()),
        "machine": f"{platform.machine()}, Python {platform.python_version()}, NumPy {version('numpy')}",
        "seconds of training": round(progress.seconds),
        "error of each round": [round(error, 5) for error in progress.errors],
        "error on held-out scenes": {
            name: {who: round(value, 5) for who, value in values.items()} for name, values in found.items()
        },
    }
    numbers = {name: np.round(getattr(network, name), DIGITS).tolist() for name in Network.__dataclass_fields__}
    write_json(path, {"about": about, "network": numbers})


def write_json(path: Path, record: object) -> None:
    """Write a record, completely or not at all."""
    write_text(path, json.dumps(record, indent=1) + "\n")


def main() -> None:
    """Run the command."""
    run(train, "benchmarks.training")


if __name__ == "__main__":
    main()
