"""Makes Intel's OpenCL CPU runtime from PyPI visible to the OpenCL loader.

``pip install intel-opencl-rt intel-cmplr-lib-rt`` is a whole CPU device that needs no root, but pip registers it
nowhere a loader looks: the ``.icd`` file it brings holds a path of the machine that built the wheel. A loader takes one
directory of ``.icd`` files from ``OCL_ICD_VENDORS``, in place of the system's, when it first lists the platforms. So
`register` writes a directory with Intel's ``.icd`` file beside links to the system's and names it there.

No library needs to be loaded beforehand: since 2025.0 the runtime finds its neighbours by its own RUNPATH.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sysconfig
import warnings
from collections.abc import Container
from pathlib import Path

from svgf_cl.device.icd_files import SYSTEM_VENDORS, VARIABLE
from svgf_cl.errors import SvgfError
from svgf_cl.io.atomic import written_whole
from svgf_cl.io.cache import cache_folder, is_usable, temporary_folder

PLATFORM = "Intel(R) OpenCL"
LIBRARY = "libintelocl.so"


def find() -> Path | None:
    """Return the runtime's library in this Python environment or in the user's site, None if it is not installed.

    Returns
    -------
    pathlib.Path or None
    """
    schemes = (sysconfig.get_default_scheme(), sysconfig.get_preferred_scheme("user"))
    candidates = (Path(sysconfig.get_path("data", scheme), "lib", LIBRARY) for scheme in schemes)
    # Not `path.exists()`, which raises where the user's site is another user's, as under sudo.
    return next((path for path in candidates if os.path.exists(path)), None)


def register() -> None:
    """Point the OpenCL loader at the runtime, where it is installed and nobody has pointed the loader elsewhere.

    Does nothing if ``OCL_ICD_VENDORS`` is set (the user's choice stands) or if the system registers an Intel CPU
    runtime itself (two of them in one process would share their thread pool's symbols). Takes effect only before the
    first listing of platforms in this process, because loaders read the variable once.
    """
    library = find()
    if library is None or not _is_free(library) or _system_has_it():
        return
    try:
        vendors = _vendors_folder(library)
    except (OSError, SvgfError) as error:
        warnings.warn(f"Intel's OpenCL runtime stays unlisted: {error}", stacklevel=2)
        return
    # Without the trailing slash some loaders take the value for a single library.
    os.environ[VARIABLE] = f"{vendors}/"


def why_unlisted(platforms: Container[str]) -> str:
    """Return why the runtime, though installed, is not among these platforms; empty if there is nothing to explain.

    Parameters
    ----------
    platforms : container of str
        Names of all listed platforms.

    Returns
    -------
    str
    """
    library = find()
    if library is None or PLATFORM in platforms:
        return ""
    vendors = os.environ.get(VARIABLE)
    if vendors and Path(vendors).name == _folder_name(library):
        return "the platforms were listed before svgf_cl was imported; import svgf_cl first"
    return f"{library} is installed, but the OpenCL loader is not pointed at it ({VARIABLE}={vendors or ''!r})"


def _is_free(library: Path) -> bool:
    """Whether nobody has set the variable, but for a process that this one descends from, whose folder may be gone."""
    return VARIABLE not in os.environ or Path(os.environ[VARIABLE]).name == _folder_name(library)


def _system_has_it() -> bool:
    return any(LIBRARY in _content(icd) for icd in SYSTEM_VENDORS.glob("*.icd"))


def _content(icd: Path) -> str:
    try:
        return icd.read_text(errors="replace")
    except OSError:
        return ""  # a dangling link, or not for this user: it registers nothing here


def _folder_name(library: Path) -> str:
    # One directory per environment, so that two environments do not rewrite each other's.
    return f"icd-{hashlib.sha256(bytes(library)).hexdigest()[:12]}"


def _vendors_folder(library: Path) -> Path:
    place = cache_folder() if is_usable(cache_folder()) else temporary_folder()
    vendors = place / _folder_name(library)
    vendors.mkdir(parents=True, exist_ok=True)
    system = {icd.name for icd in SYSTEM_VENDORS.glob("*.icd")}
    for link in vendors.glob("*.icd"):
        if link.is_symlink() and link.name not in system:
            link.unlink(missing_ok=True)
    for name in system:
        _link(vendors / name, SYSTEM_VENDORS / name)
    intel = vendors / "svgf_cl-intel.icd"
    if _content(intel) != f"{library}\n":
        with written_whole(intel) as aside:
            aside.write_text(f"{library}\n")
    return vendors


def _link(link: Path, target: Path) -> None:
    with contextlib.suppress(FileExistsError):  # by an earlier run, or by another process just now
        link.symlink_to(target)
