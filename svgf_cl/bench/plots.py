"""Draws the plots of a run. Each function draws on given axes, so that report and summary show the same plots."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.results import DeviceRecord, Result, Run
from svgf_cl.bench.rig import EVENT
from svgf_cl.bench.scaling import Series, series

Draw = Callable[[Axes], None]

# Okabe and Ito's colours: colour-blind people can distinguish them, on dark and light backgrounds.
COLORS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#CC79A7", "#F0E442", "#999999")


def plots(run: Run) -> dict[str, Draw]:
    """Return the functions that draw a run's plots, by title."""
    found: dict[str, Draw] = {}
    if bars := frame_parts(run):
        found["A frame, pass by pass"] = lambda axes: draw_frames(axes, bars)
    for device in run.devices:
        if device.ceilings and (rows := roofline_rows(run, device)):
            found[f"Roofline: {device.platform}"] = bind(draw_roofline, device.ceilings, rows)
    for over, draw in (("pixels", draw_pixels), ("iterations", draw_iterations), ("cores", draw_cores)):
        if lines := series(run, over):
            found[f"Scaling over {over}"] = bind(draw, lines)
    return found


def bind(draw: Callable[..., None], *arguments: object) -> Draw:
    """Return a function that draws these arguments on the axes that it gets."""
    return lambda axes: draw(axes, *arguments)


def frame_parts(run: Run) -> dict[str, dict[tuple[str, str], float]]:
    """Return milliseconds per megapixel by size and implementation, and then by each pass's kernel and name."""
    found: dict[str, dict[tuple[str, str], float]] = {}
    for device in run.devices:
        for result in run.of(device, clock=EVENT, variant=""):
            facts = result.facts
            if facts["kernel"] is None:  # a whole frame, or all levels
                continue
            bar = found.setdefault(f"{device.platform}\n{facts['width']}x{facts['height']}", {})
            bar[facts["kernel"], facts["row"]] = 1e9 * result.median / (facts["width"] * facts["height"])
    return found


def draw_frames(axes: Axes, bars: dict[str, dict[tuple[str, str], float]]) -> None:
    """Draw a stacked bar for each size; bars of equal length mean that time is linear in pixels."""
    passes = list(dict.fromkeys(each for bar in bars.values() for each in bar))
    kernels = list(dict.fromkeys(kernel for kernel, _ in passes))  # all levels in one colour
    left = np.zeros(len(bars))
    for kernel, name in passes:
        width = np.array([bar.get((kernel, name), 0.0) for bar in bars.values()])
        color = COLORS[kernels.index(kernel) % len(COLORS)]
        axes.barh(list(bars), width, left=left, color=color, edgecolor="white", linewidth=0.5, label=name)
        left += width
    axes.invert_yaxis()
    axes.tick_params(axis="y", labelsize="small")
    axes.set_xlabel("ms per megapixel, event time")
    axes.legend(fontsize="small", ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.18), frameon=False)


def roofline_rows(run: Run, device: DeviceRecord) -> list[Result]:
    """Return the results that have a bound, at the largest size, with all levels of a pass together."""
    found = [r for r in run.of(device, clock=EVENT, variant="") if r.roofline and r.facts["level"] is None]
    largest = max((r.facts["width"] * r.facts["height"] for r in found), default=0)
    return [r for r in found if r.facts["width"] * r.facts["height"] == largest]


def draw_roofline(axes: Axes, ceilings: Ceilings, rows: Sequence[Result]) -> None:
    """Draw operations per second over operations per byte, and the roofline of bandwidth and peak."""
    intensity = np.logspace(-1.5, 2.5, 100)
    peak = ceilings.flops
    working_set = rows[0].facts["bytes"]
    roofs = {
        "copy, in cache": max(speed for _, speed in ceilings.bandwidth),
        "copy, out of cache": ceilings.bandwidth_at(working_set),
    }
    for (label, speed), style in zip(roofs.items(), ("--", "-"), strict=True):
        roof = np.minimum(intensity * speed, peak)
        axes.loglog(intensity, 1e-9 * roof, style, color=COLORS[-1], label=f"{label}: {1e-9 * speed:.0f} GB/s")
    for index, row in enumerate(rows):
        facts, best = row.facts, min(row.seconds)
        label = f"{facts['row']}: {100 * (row.roofline or 0):.0f} %, bound by {facts['binds']}"
        axes.plot(
            facts["flops"] / facts["bytes"], 1e-9 * facts["flops"] / best, "o", color=COLORS[index % 7], label=label
        )
    axes.set_xlabel("operations per byte")
    axes.set_ylabel("GFLOP/s")
    width, height = rows[0].facts["width"], rows[0].facts["height"]
    title = f"{width}x{height}, peak {1e-9 * peak:.0f} GFLOP/s"
    axes.legend(fontsize="small", frameon=False, title=title, title_fontsize="small", alignment="left")


def draw_pixels(axes: Axes, lines: Sequence[Series]) -> None:
    """Draw time per pixel; a flat line means that time is linear in pixels."""
    axes.set_prop_cycle(color=COLORS)
    for line in lines:
        per = 1e9 * np.array(line.seconds) / np.array(line.over)
        axes.semilogx(1e-6 * np.array(line.over), per, "o-", label=line.device.platform)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("megapixels")
    axes.set_ylabel("ms per megapixel")
    axes.legend(fontsize="small", frameon=False)


def draw_iterations(axes: Axes, lines: Sequence[Series]) -> None:
    """Draw time over the number of a-trous levels."""
    axes.set_prop_cycle(color=COLORS)
    for line in lines:
        axes.plot(line.over, 1e3 * np.array(line.seconds), "o-", label=line.device.platform)
    axes.set_ylim(bottom=0)
    axes.set_xticks(lines[0].over)
    axes.set_xlabel("a-trous levels")
    axes.set_ylabel("ms a frame")
    axes.legend(fontsize="small", frameon=False)


def draw_cores(axes: Axes, lines: Sequence[Series]) -> None:
    """Draw speed over the number of cores, beside the ideal."""
    axes.set_prop_cycle(color=COLORS)
    most = max(line.over[-1] for line in lines)
    axes.plot([1, most], [1, most], ":", color=COLORS[-1], label="ideal")
    for line in lines:
        axes.plot(line.over, line.seconds[0] / np.array(line.seconds), "o-", label=line.device.platform)
    axes.set_xticks(sorted({count for line in lines for count in line.over}))
    axes.set_xlabel("cores")
    axes.set_ylabel("times faster than one")
    axes.legend(fontsize="small", frameon=False)


def summary(run: Run) -> Figure:
    """Return a figure with all plots."""
    drawings = plots(run)
    columns = 2
    rows = max(1, -(-len(drawings) // columns))
    figure = Figure(figsize=(7 * columns, 4.5 * rows), layout="constrained")
    for index, (title, draw) in enumerate(drawings.items()):
        axes = figure.add_subplot(rows, columns, index + 1)
        draw(axes)
        axes.set_title(title)
        axes.grid(alpha=0.2)
    return figure
