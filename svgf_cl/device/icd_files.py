"""The drivers that the OpenCL loader is told of by ``.icd`` files, and what is wrong with them.

A loader passes over what it cannot load without a word. Here each driver is loaded as a loader does it, in a process of
its own, which it may crash.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from svgf_cl.device import apart, load_driver

SYSTEM_VENDORS = Path("/etc/OpenCL/vendors")
VARIABLE = "OCL_ICD_VENDORS"


def faults() -> list[tuple[str, str]]:
    """What the loader cannot use, each by the file or variable that names it, and why.

    Raises
    ------
    svgf_cl.device.apart.NoAnswerError
        Where a driver crashes or hangs as it is loaded: this process would, too.
    """
    chosen = os.environ.get(VARIABLE)
    place = Path(chosen or SYSTEM_VENDORS)
    icds = [place] if place.suffix == ".icd" else sorted(place.glob("*.icd"))
    found = [(str(icd), fault_of_file(icd)) for icd in icds]
    if chosen and place.is_dir() and not icds:
        found = [(f"{VARIABLE}={chosen}", f"holds no .icd file; unset it for those in {SYSTEM_VENDORS}")]
    elif chosen and not icds:  # loaders take it for a driver's library
        found = [(f"{VARIABLE}={chosen}", fault_of_library(chosen))]
    return [(name, fault) for name, fault in found if fault]


def fault_of_file(icd: Path) -> str:
    """Why the driver that an ``.icd`` file names cannot be used; empty if it can."""
    try:
        library = icd.read_text(errors="replace").strip()
    except OSError as error:
        return f"cannot be read ({error.strerror})"
    return fault_of_library(library) if library else "names no library"


def fault_of_library(library: str) -> str:
    """Why a driver cannot be used; empty if it can."""
    # Python without what belongs to this environment starts ten times as fast.
    command = [sys.executable, "-I", "-S", load_driver.__file__, library, apart.ANSWER]
    try:
        reason = apart.ask(command, os.environ)
    except apart.NoAnswerError as error:
        raise apart.NoAnswerError(f"{library}: when it is loaded, {error}") from error
    return reason and f"names {library}, which {reason}"
