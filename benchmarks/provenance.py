"""Where figures are from: device, versions and date, which are shown beside all figures."""

from __future__ import annotations

from datetime import date

import pyopencl as cl

from svgf_cl.bench.results import commit_info


def provenance(device: cl.Device) -> dict[str, str]:
    """Device with its driver, version and git revision of svgf_cl, date."""
    commit = commit_info()
    dirty = "-dirty" if commit["dirty"] else ""
    return {
        "device": f"{device.name}, {device.platform.version}, driver {device.driver_version}",
        "svgf_cl": f"{commit['version']}, git {commit['id'][:7]}{dirty}",
        "date": date.today().isoformat(),
    }
