"""What was measured, on what, when: stands beside every figure."""

from __future__ import annotations

import subprocess
from datetime import date

import pyopencl as cl

from svgf_cl import __version__


def provenance(device: cl.Device) -> dict[str, str]:
    """Device with its driver, version and git revision of svgf_cl, date."""
    revision = subprocess.run(["git", "describe", "--always", "--dirty"], capture_output=True, text=True, check=False)
    return {
        "device": f"{device.name}, {device.platform.version}, driver {device.driver_version}",
        "svgf_cl": f"{__version__}, git {revision.stdout.strip() or 'revision unknown'}",
        "date": date.today().isoformat(),
    }
