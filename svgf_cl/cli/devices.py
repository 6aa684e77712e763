"""``svgf-cl devices``: lists the OpenCL devices, and tests whether they work."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from svgf_cl.cli.console import screen
from svgf_cl.device.devices import DeviceReport, choose, list_devices
from svgf_cl.device.tuning import stored_tuning


def devices() -> None:
    """List every OpenCL device and test whether it works.

    A device works if it builds and runs a small kernel; otherwise the reason is shown. Other commands use the
    default, marked *; PYOPENCL_CTX chooses another one by its name in the first column. A tuned device uses the
    settings that svgf-cl tune found.

    \b
    Examples:
      svgf-cl devices
      PYOPENCL_CTX=1:0 svgf-cl devices
    """
    reports = list_devices(refresh=True)
    _show(reports)
    choose(reports)  # if there is no default, this raises an error that says why


def _show(reports: Sequence[DeviceReport]) -> None:
    table = Table("", "works", "device", show_lines=True)
    table.columns[-1].overflow = "fold"
    for report in reports:
        mark = f"{report.selector}{' *' if report.is_default else ''}"
        # As Text, because names and reasons may contain text that rich would read as markup.
        table.add_row(mark, "yes" if report.works else "no", Text(_description(report)))
    screen().print(table)


def _description(report: DeviceReport) -> str:
    # Only "OpenCL 3.0" of "OpenCL 3.0 <vendor's text>": the driver's version is shorter than the rest.
    version = " ".join(report.version.split()[:2])
    driver = f"driver {report.driver}" if report.handle else ""
    implementation = ", ".join(part for part in (report.platform, version, driver) if part)
    lines = (report.device, implementation, report.reason, _tuning(report))
    return "\n".join(line for line in lines if line)


def _tuning(report: DeviceReport) -> str:
    if not report.works or report.handle is None:
        return ""
    tuning = stored_tuning(report.handle)
    return f"tuned: {tuning}" if tuning else "untuned; 'svgf-cl tune' finds the fastest settings"
