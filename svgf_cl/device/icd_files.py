"""Finds what is wrong with the drivers that ``.icd`` files name.

An OpenCL loader skips a driver that it cannot load, and gives no message. This module loads each driver as a loader
does, in a separate process, as the driver may crash.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from svgf_cl.device import apart, load_driver

SYSTEM_VENDORS = Path("/etc/OpenCL/vendors")
VARIABLE = "OCL_ICD_VENDORS"


def faults() -> list[tuple[str, str]]:
    """Return the drivers that the loader cannot use: for each the file or variable that names it, and the reason.

    Raises
    ------
    svgf_cl.device.apart.NoAnswerError
        If a driver crashes or hangs when it is loaded: this process would crash or hang, too.
    """
    chosen = os.environ.get(VARIABLE)
    place = Path(chosen or SYSTEM_VENDORS)
    icds = [place] if place.suffix == ".icd" else sorted(place.glob("*.icd"))
    found = [(str(icd), fault_of_file(icd)) for icd in icds]
    if chosen and place.is_dir() and not icds:
        found = [(f"{VARIABLE}={chosen}", f"has no .icd file; unset it for those in {SYSTEM_VENDORS}")]
    elif chosen and not icds:  # loaders treat such a value as a driver's library
        found = [(f"{VARIABLE}={chosen}", fault_of_library(chosen))]
    return [(name, fault) for name, fault in found if fault]


def fault_of_file(icd: Path) -> str:
    """Return why the driver named by an ``.icd`` file cannot be used; empty if it can."""
    try:
        library = icd.read_text(errors="replace").strip()
    except OSError as error:
        return f"cannot be read ({error.strerror})"
    return fault_of_library(library) if library else "names no library"


def fault_of_library(library: str) -> str:
    """Return why a driver cannot be used; empty if it can."""
    # Without the packages of this environment, Python starts ten times as fast.
    command = [sys.executable, "-I", "-S", load_driver.__file__, library, apart.ANSWER]
    try:
        reason = apart.ask(command, os.environ)
    except apart.NoAnswerError as error:
        raise apart.NoAnswerError(f"{library}: when it is loaded, {error}") from error
    return reason and f"names {library}, which {reason}"
