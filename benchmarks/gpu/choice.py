"""Chooses the device of a run."""

from __future__ import annotations

import os
from collections.abc import Sequence

from svgf_cl.device import devices
from svgf_cl.device.devices import DeviceReport
from svgf_cl.errors import DeviceError

KINDS = ("GPU", "accelerator")
WHAT_TO_DO = (
    "Install the GPU's driver with OpenCL, and see 'svgf-cl devices'; or take the same steps on a CPU with small "
    "sizes: python -m benchmarks.gpu --dry-run"
)


def chosen(reports: Sequence[DeviceReport], *, dry_run: bool) -> DeviceReport:
    """The device that ``PYOPENCL_CTX`` names, or else the fastest GPU that works; in a dry run, the fastest device.

    Raises
    ------
    DeviceError
        If none works or the named one does not, or if it is no GPU and this is not a dry run.
    """
    if dry_run:
        return devices.choose(reports)
    if devices.VARIABLE in os.environ:
        named = devices.choose(reports)
        if named.kind not in KINDS:
            raise DeviceError(f"--device: expected a GPU, got the {named.kind} {named.device!r}. {WHAT_TO_DO}")
        return named
    gpus = [report for report in reports if report.works and report.kind in KINDS]
    if not gpus:
        raise DeviceError(
            "\n".join(["no GPU works with OpenCL. These devices were found:", *listed(reports), WHAT_TO_DO])
        )
    return devices.choose(gpus)


def listed(reports: Sequence[DeviceReport]) -> list[str]:
    """A line for each device."""
    return [f"  {report}" for report in reports] or ["  no device at all"]
