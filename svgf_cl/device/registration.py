"""Tells the OpenCL loader of installed drivers that no ``.icd`` file of the system names.

``OCL_ICD_VENDORS`` names a directory of ``.icd`` files that the loader reads in place of the system's, when it first
lists the platforms. `register` writes such a directory, with ``.icd`` files of these drivers and links to the system's
files, and sets the variable.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import warnings
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from svgf_cl.device.drivers import DRIVERS, Driver
from svgf_cl.device.icd_files import SYSTEM_VENDORS, VARIABLE
from svgf_cl.errors import SvgfError
from svgf_cl.io.atomic import written_whole
from svgf_cl.io.cache import cache_folder, is_usable, temporary_folder

Libraries = Mapping[str, str]  # by the driver's name


def register() -> None:
    """Tell the OpenCL loader of installed drivers that no ``.icd`` file of the system names.

    If the user has set ``OCL_ICD_VENDORS``, this does nothing. A driver that an ``.icd`` file of the system names is
    left out: two Intel CPU runtimes in one process would share their thread pool's symbols. Call this before the first
    listing of platforms in this process, because loaders read the variable only once.
    """
    libraries = unregistered()
    if not libraries or not _is_free(libraries):
        return
    try:
        vendors = _vendors_folder(libraries)
    except (OSError, SvgfError) as error:
        warnings.warn(f"{' and '.join(libraries.values())}: not registered: {error}", stacklevel=2)
        return
    # Without the trailing slash some loaders take the value for a single library.
    os.environ[VARIABLE] = f"{vendors}/"


def unregistered() -> Libraries:
    """Return the libraries of installed drivers that no ``.icd`` file of the system names.

    Returns
    -------
    mapping of str to str
        Each library's path or name, by `Driver.name`.
    """
    registered = [_content(icd) for icd in SYSTEM_VENDORS.glob("*.icd")]
    found = {each.name: each.find() for each in DRIVERS if not any(each.library in text for text in registered)}
    return {name: library for name, library in found.items() if library}


def why_unlisted(platforms: Collection[str]) -> Iterator[tuple[Driver, str]]:
    """Yield each driver that is at least partly installed but not among these platforms, and the reason.

    Parameters
    ----------
    platforms : collection of str
        Names of all listed platforms.

    Yields
    ------
    driver : Driver
    reason : str
    """
    for driver in DRIVERS:
        if driver.platform not in platforms:
            library = driver.find()
            reason = _why_passed_over(library) if library else driver.why_missing()
            if reason:
                yield driver, reason


def _why_passed_over(library: str) -> str:
    vendors = os.environ.get(VARIABLE)
    if vendors is None:
        return f"{library} is registered in {SYSTEM_VENDORS}, but the OpenCL loader lists no platform of it"
    if Path(vendors).name == _folder_name(unregistered()):
        return (
            f"the OpenCL loader lists no platform of {library}: either the driver has none to offer, or the platforms "
            "were listed before svgf_cl was imported (then import svgf_cl first)"
        )
    return f"{library} is installed, but the OpenCL loader is not pointed at it ({VARIABLE}={vendors!r})"


def _is_free(libraries: Libraries) -> bool:
    """Whether the user has not set the variable: it is unset, or a parent process with svgf_cl set it.

    The folder of a parent process may be gone.
    """
    return VARIABLE not in os.environ or Path(os.environ[VARIABLE]).name == _folder_name(libraries)


def _content(icd: Path) -> str:
    try:
        return icd.read_text(errors="replace")
    except OSError:
        return ""  # a dangling link, or not readable for this user: it registers no driver here


def _folder_name(libraries: Libraries) -> str:
    # One directory per set of drivers, so that two environments do not rewrite each other's.
    return f"icd-{hashlib.sha256(os.fsencode(os.pathsep.join(libraries.values()))).hexdigest()[:12]}"


def _vendors_folder(libraries: Libraries) -> Path:
    place = cache_folder() if is_usable(cache_folder()) else temporary_folder()
    vendors = place / _folder_name(libraries)
    vendors.mkdir(parents=True, exist_ok=True)
    system = {icd.name for icd in SYSTEM_VENDORS.glob("*.icd")}
    for link in vendors.glob("*.icd"):
        if link.is_symlink() and link.name not in system:
            link.unlink(missing_ok=True)
    for name in system:
        _link(vendors / name, SYSTEM_VENDORS / name)
    for name, library in libraries.items():
        _write(vendors / f"svgf_cl-{name}.icd", f"{library}\n")
    return vendors


def _write(icd: Path, text: str) -> None:
    if _content(icd) != text:
        with written_whole(icd) as aside:
            aside.write_text(text)


def _link(link: Path, target: Path) -> None:
    with contextlib.suppress(FileExistsError):  # made by an earlier run, or just now by another process
        link.symlink_to(target)
