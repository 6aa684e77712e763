"""``make gpu``: measures one GPU, and writes everything into one folder. See docs/gpu.md."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from benchmarks import command
from benchmarks.gpu import steps
from benchmarks.gpu.choice import chosen
from benchmarks.gpu.report import Outcome, Report
from svgf_cl.cli.console import share_bar, show
from svgf_cl.device import devices
from svgf_cl.io.atomic import output_folder


def gpu(
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="DIR", help="Gets report.md, report.json and the files of all steps."),
    ] = Path("out/gpu"),
    device: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            envvar=devices.VARIABLE,
            help="The device, as named by svgf-cl devices; by default the fastest GPU.",
        ),
    ] = "",
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Take the same steps with small sizes, on any device.")
    ] = False,
) -> None:
    """Test, tune and time a GPU, and write a report.

    It takes less than ten minutes and needs no network. It lists the devices, compares the kernels with the float64
    oracle, finds the fastest tuning and stores it for later runs, and measures times and each kernel's error. If a step
    fails, the reason is reported, the other steps continue, and the exit code is 1.
    """
    if device:
        os.environ[devices.VARIABLE] = device
    folder = output_folder(output.absolute())
    reports = devices.list_devices(refresh=True)
    report = Report(reports, chosen(reports, dry_run=dry_run), dry_run)
    print(f"device: {report.device.device} ({report.device.platform}, driver {report.device.driver})")
    run(report, folder)
    show(report.steps.title, report.steps.columns, report.steps.rows, words=5)
    print(f"{folder}: report.md, report.json")
    if report.failed:
        typer.echo(f"failed: {', '.join(report.failed)}", err=True)
        raise typer.Exit(1)


def run(report: Report, folder: Path) -> None:
    """Run all steps on the report's device, and write the report after each step."""
    report.write(folder)
    plan = steps.dry(folder) if report.dry_run else steps.full(folder)
    environment = os.environ | {devices.VARIABLE: report.device.selector, "PYTHONUNBUFFERED": "1"}
    before = 0
    with share_bar("seconds, at most", sum(step.seconds for step in plan)) as tell:
        tell(0, "")
        for step in plan:

            def tick(seconds: float, step: steps.Step = step, before: int = before) -> None:
                tell(before + min(seconds, step.seconds), step.title)

            report.outcomes.append(Outcome(step, *steps.run(step, folder, environment, tick)))
            report.write(folder)
            before += step.seconds


def main() -> None:
    """Run the command."""
    command.run(gpu, "benchmarks.gpu")


if __name__ == "__main__":
    main()
