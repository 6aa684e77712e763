"""``svgf-cl devices``: what OpenCL offers here, and what of it really works."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from svgf_cl.devices import list_devices


def devices() -> None:
    """List every OpenCL device and whether it really works.

    A device works if it builds and runs a small kernel; if not, the reason is shown. The default, marked *, is what
    the other commands use; PYOPENCL_CTX picks another by its name in the first column.

    \b
    Examples:
      svgf-cl devices
      PYOPENCL_CTX=1:0 svgf-cl devices
    """
    table = Table("", "device", "platform", "version", "works")
    for column in table.columns:
        column.overflow = "fold"
    for report in list_devices():
        mark = f"{report.selector}{' *' if report.is_default else ''}"
        # "OpenCL 3.0 <what the vendor likes to add>": the driver's version says the rest in fewer words.
        version = f"{' '.join(report.version.split()[:2])}, driver {report.driver}"
        table.add_row(mark, report.device, report.platform, version, "yes" if report.works else f"no: {report.reason}")
    Console().print(table)
