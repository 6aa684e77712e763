"""The OpenCL implementations on which svgf_cl is tested, and environments that give a process only one of them.

As a program it lists the implementations that do not work, with reasons; the exit code is then 1.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from svgf_cl.device import devices, icd_files
from svgf_cl.device.drivers import INTEL

# By the name in tables: the platform's name, the files that the OpenCL loader must load, and other variables for the
# driver. Oclgrind's package does not register it; `scripts/set_up implementations` installs them all.
CPU_IMPLEMENTATIONS = {
    "PoCL": (devices.POCL, "libpocl.so.2", {}),
    "Intel": (INTEL.platform, str(INTEL.find()), {}),
    "rusticl": ("rusticl", "libRusticlOpenCL.so.1", {"RUSTICL_ENABLE": "llvmpipe"}),
    "Oclgrind": (devices.SIMULATOR, "/usr/lib/oclgrind/liboclgrind-rt-icd.so", {}),
}

Environment = dict[str, str]


def environments(folder: Path) -> dict[str, Environment]:
    """Environments for processes in which one implementation is the default, by the name of the implementation.

    Parameters
    ----------
    folder : pathlib.Path
        A folder for files of the OpenCL loader; it must exist as long as those processes run.

    Returns
    -------
    dict of str to dict
        `CPU_IMPLEMENTATIONS`, installed or not, and every GPU that works.
    """
    gpus = {
        f"{report.device} ({report.platform})": {**os.environ, devices.VARIABLE: report.selector}
        for report in devices.list_devices()
        if report.works and report.kind == "GPU"
    }
    return {name: _alone(name, folder) for name in CPU_IMPLEMENTATIONS} | gpus


def _alone(name: str, folder: Path) -> Environment:
    platform, library, needs = CPU_IMPLEMENTATIONS[name]
    vendors = folder / name
    vendors.mkdir()
    (vendors / "only.icd").write_text(f"{library}\n")
    # With the slash, because some loaders would take the value for a library without it.
    return {**os.environ, **needs, icd_files.VARIABLE: f"{vendors}/", devices.VARIABLE: platform}


def main() -> None:
    """Check which implementations have a device that works."""
    works = True
    with tempfile.TemporaryDirectory() as folder:
        for name, environment in environments(Path(folder)).items():
            command = [sys.executable, "-m", "svgf_cl", "devices"]
            child = subprocess.run(command, env=environment, capture_output=True, text=True)
            if child.returncode:
                print(f"{name}: {child.stderr.strip() or child.stdout.strip()}")
                works = False
    sys.exit(not works)


if __name__ == "__main__":
    main()
