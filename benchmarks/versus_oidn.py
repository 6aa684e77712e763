"""Compares svgf_cl with Open Image Denoise in one run: same frames, same number of threads; speed, memory and error.

Speed: in every round, each denoiser filters the same frame of the built-in room once, after a warm-up.

- "svgf_cl ...": the host clock times the whole call of `Denoiser.denoise` from numpy arrays to a numpy array, with all
  copies; the event clock sums the passes of that call, from OpenCL events. "5x5" is SVGF with the paper's taps, "SVGF"
  is SVGF with 3x3 taps, and "default" is the default filter, or that filter with other settings.
- "OIDN ...": ``oidnExecuteFilter`` alone, HDR, with albedo and normal, in place on images that are filled beforehand.

A ratio compares two times of the same round; the result is the median over the rounds. Memory is that of a denoiser
without its input and output images: `Denoiser.nbytes`, and the growth of the process while OIDN is set up and runs
once.

Error: that of one footage of `benchmarks.footage` at the same size, with jittered rays, compared with the path-traced
truth. OIDN uses one frame; svgf_cl uses the earlier ones, too.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import pyopencl as cl
import typer

from benchmarks.bars import bar_table
from benchmarks.command import run
from benchmarks.footage import FOOTAGE, Footage
from benchmarks.measurements import Quality, quality
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from benchmarks.race import Times, race, results
from benchmarks.versus_tables import error_table, ratio_table, time_table
from svgf_cl import Denoiser, Settings
from svgf_cl.bench.report import Section
from svgf_cl.bench.results import Result
from svgf_cl.bench.tables import Table
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.cli.options import SettingTexts, parse_settings, parse_size
from svgf_cl.compare.metrics import require_flip
from svgf_cl.compare.oidn import QUALITIES, OidnFilter, threads_beside
from svgf_cl.device import devices
from svgf_cl.filters import DEFAULT
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Shape, extent
from svgf_cl.io.atomic import write_text
from svgf_cl.io.display import Linear

AREA, _ = FOOTAGE

TITLE = "Against Open Image Denoise"

# Filters that are compared in addition to the default one: SVGF as in the paper, and with 3x3 taps.
OTHERS = {"5x5": Settings(taps="5x5"), "SVGF": Settings()}


@dataclass(frozen=True)
class Comparison:
    """The results.

    Parameters
    ----------
    times : Times
    memory : mapping from str to int, bytes
        By denoiser.
    errors : mapping from str to Quality
    about : dict of str to str
        What was measured, on which device, and when.
    results : tuple of Result
        The times as results of the benchmark.
    """

    times: Times
    memory: Mapping[str, int]
    errors: Mapping[str, Quality]
    about: dict[str, str]
    results: tuple[Result, ...]

    @property
    def tables(self) -> list[Table]:
        """Times, ratios and errors."""
        return [time_table(self.times, self.memory), ratio_table(self.times), error_table(self.errors)]

    @property
    def remarks(self) -> list[str]:
        """Notes that explain the figures."""
        return [f"{key}: {value}" for key, value in self.about.items()]

    @property
    def section(self) -> Section:
        """The section of the benchmark's report."""
        return Section(TITLE, tables=self.tables, notes=self.remarks)

    def write(self, path: Path) -> None:
        """Write everything, including all samples, as JSON."""
        record: dict[str, Any] = {"about": self.about, "bytes": self.memory}
        record["seconds"] = {f"{name}, {clock}": seconds for (name, clock), seconds in self.times.items()}
        record["error"] = {name: asdict(found) for name, found in self.errors.items()}
        write_text(path, json.dumps(record, indent=1))


def versus_oidn(
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the frames.")] = "1280x720",
    rounds: Annotated[int, typer.Option(metavar="N", min=1, help="Timed frames of each denoiser.")] = 20,
    clean_aux: Annotated[
        bool, typer.Option("--clean-aux", help="Tell OIDN that albedo and normal are free of noise.")
    ] = False,
    set_: SettingTexts = [],  # noqa: B006  # never changed; typer wants the default spelled here
    json_: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write all samples there, too.")] = None,
    markdown_: Annotated[bool, typer.Option("--markdown", help="Print tables as markdown.")] = False,
) -> None:
    """Time svgf_cl and Open Image Denoise in turns, compare the ratios with the bars, and compare the errors.

    svgf_cl runs SVGF with 5x5 and with 3x3 taps, and its default filter, to which --set applies. PYOPENCL_CTX chooses
    its device. OIDN gets as many CPU threads as that device has, or all threads if it is not a CPU. Rendering the truth
    takes a minute or two; it is stored in the user's cache folder.
    """
    found = compared(parse_size(size), parse_settings(DEFAULT.name, set_), rounds, clean_aux=clean_aux)
    device = devices.choose(devices.list_devices())
    for table in [*found.tables, bar_table(found.results, {device.selector: device.platform})]:
        print(f"{table.title}:\n\n{markdown(table)}") if markdown_ else show(table.title, table.columns, table.rows)
    print("\n".join(found.remarks))
    if json_:
        found.write(json_)


def compared(shape: Shape, settings: Filter, rounds: int, *, clean_aux: bool = False) -> Comparison:
    """Time `OTHERS` and svgf_cl with `settings` beside OIDN, and compare the pictures of all with the truth."""
    require_flip()
    chosen = {**OTHERS, "default": settings}
    denoisers = {f"svgf_cl {name}": Denoiser(shape, settings=each) for name, each in chosen.items()}
    device = next(iter(denoisers.values())).queue.device
    filters = oidn_filters(shape, device, clean_aux)
    with progress_bar("speed", rounds) as advance:
        times = race(denoisers, filters, rounds, advance)
    footage = replace(AREA, shape=shape)
    with progress_bar("error", footage.chunks + footage.frames) as advance:
        errors = qualities(denoisers, filters, footage, advance)
    about = provenance(device) | {
        "svgf_cl default": "as shipped" if settings == DEFAULT() else str(settings),
        "OIDN": filters["OIDN high"].description + (", clean aux" if clean_aux else ""),
        "size": extent(shape),
        "rounds": str(rounds),
        "truth": f"{footage.spp} spp",
    }
    memory = {name: each.nbytes for name, each in (denoisers | filters).items()}
    selector = devices.choose(devices.list_devices()).selector
    return Comparison(times, memory, errors, about, tuple(results(times, selector, shape)))


def oidn_filters(shape: Shape, device: cl.Device, clean_aux: bool) -> dict[str, OidnFilter]:
    """OIDN at every quality, with as many threads as a CPU device has; with all threads if `device` is not a CPU."""
    threads = threads_beside(device)
    return {f"OIDN {quality}": OidnFilter(shape, quality, threads, clean_aux=clean_aux) for quality in QUALITIES}


def qualities(
    denoisers: Mapping[str, Denoiser], filters: Mapping[str, OidnFilter], footage: Footage, advance: Callable[[], None]
) -> dict[str, Quality]:
    """Compare each denoiser's pictures of a footage, with one signal, with the truth; also the noise of the truth."""
    truth = [0.5 * (first + second) for first, second in footage.halves(advance)]
    pictures: dict[str, list[Linear]] = {name: [] for name in ("noisy", *denoisers, *filters)}
    for den in denoisers.values():
        den.reset()
    for number, split in enumerate(footage.noisy()):
        frame = replace(split, direct=None, indirect=None)
        clean = {name: den.denoise(frame) for name, den in denoisers.items()}
        if number in footage.judged:
            alone = {name: rival.denoise(frame) for name, rival in filters.items()}
            for name, picture in {"noisy": frame.color, **clean, **alone}.items():
                pictures[name].append(picture[slice(*footage.rows)])
        advance()
    return {name: quality(made, truth) for name, made in pictures.items()}


def main() -> None:
    """Run the command."""
    run(versus_oidn, "benchmarks.versus_oidn")


if __name__ == "__main__":
    main()
