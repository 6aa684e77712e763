"""`Tuning`: settings that change only the speed of a device, and the file that stores the best ones for each device."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import warnings
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import pyopencl as cl

from svgf_cl.device import programs
from svgf_cl.device.layout import PAGE, ROW_ALIGNMENT, WIDEST_VECTOR
from svgf_cl.errors import DeviceError, SvgfError, shown
from svgf_cl.io.atomic import read_json, write_text
from svgf_cl.io.cache import cache_folder, device_key

STORE = "tunings.json"
VECTOR_WIDTHS = (1, 4, 8, 16)  # what kernels/vectors.clh is written for
EXPONENTIALS = ("polynomial", "exp2")  # of kernels/surface.clh

# Long rows, because each work-group costs a CPU's driver a tenth of a microsecond or more.
CPU_WORK_GROUP = (64, 1)


@dataclass(frozen=True, kw_only=True)
class Tuning:
    """Settings that change only the speed of a device; results agree to within rounding.

    Parameters
    ----------
    vector_width : int, pixels, one of 1, 4, 8, 16
        Pixels of a row that a work-item treats as one vector.
    work_group : (int, int), work-items, each >= 1
        Size of a work-group, along a row and down. It is reduced for a kernel that the device can only run in smaller
        groups.
    row_alignment : int, pixels, 16 .. 512, a multiple of 16
        The distance between rows of the device's planes is a multiple of it; see `svgf_cl.device.layout.Layout`.
    exponential : str, "polynomial" or "exp2"
        How the exponential of precise weights is computed: by a polynomial (relative error below 4e-6), or by OpenCL's
        function (at most 4 ulp). Fast weights are the same with both.
    pinned_copies : bool
        Whether numpy arrays are copied to the device and back through pinned memory. A device that works in the host's
        memory seldom copies any.

    Raises
    ------
    SvgfError
        If a value is out of its range.
    """

    vector_width: int
    work_group: tuple[int, int]
    row_alignment: int = ROW_ALIGNMENT
    exponential: str = "polynomial"
    pinned_copies: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.vector_width, int) or self.vector_width not in VECTOR_WIDTHS:
            raise SvgfError(f"Tuning.vector_width: expected one of {VECTOR_WIDTHS}, got {shown(self.vector_width)}")
        group = self.work_group
        if not (isinstance(group, tuple) and len(group) == 2 and all(isinstance(n, int) and n >= 1 for n in group)):
            raise SvgfError(f"Tuning.work_group: expected two whole numbers >= 1, got {shown(group)}")
        alignments = range(WIDEST_VECTOR, PAGE // 2 + 1, WIDEST_VECTOR)
        if not isinstance(self.row_alignment, int) or self.row_alignment not in alignments:
            raise SvgfError(
                f"Tuning.row_alignment: expected a multiple of {WIDEST_VECTOR} in {WIDEST_VECTOR}..{PAGE // 2}, "
                f"got {shown(self.row_alignment)}"
            )
        if self.exponential not in EXPONENTIALS:
            raise SvgfError(f"Tuning.exponential: expected one of {EXPONENTIALS}, got {shown(self.exponential)}")
        if not isinstance(self.pinned_copies, bool):
            raise SvgfError(f"Tuning.pinned_copies: expected True or False, got {shown(self.pinned_copies)}")

    def __str__(self) -> str:
        along, down = self.work_group
        return (
            f"vectors of {self.vector_width}, {self.exponential}, rows aligned to {self.row_alignment}, "
            f"work-groups of {along}x{down}{', pinned copies' if self.pinned_copies else ''}"
        )

    @property
    def defines(self) -> dict[str, int]:
        """The macros of kernels that it decides."""
        return {"VW": self.vector_width, "EXP2": int(self.exponential == "exp2")}

    def check(self, device: cl.Device) -> None:
        """Raise `DeviceError` where `device` has no work-groups as large as these."""
        items = self.work_group[0] * self.work_group[1]
        most = device.max_work_group_size, *device.max_work_item_sizes[:2]
        if any(asked > limit for asked, limit in zip((items, *self.work_group), most, strict=True)):
            raise DeviceError(
                f"Tuning.work_group: expected at most {most[0]} work-items, {most[1]} along a row and {most[2]} down, "
                f"on {device.name}; got {self.work_group}"
            )


# What suits most GPUs: a vector is one pixel, a work-group a tile of whole warps, and exp2 a single instruction.
GPU_TUNING = Tuning(vector_width=1, work_group=(32, 4), exponential="exp2")
# What suits most CPUs of today, whose native vectors are of 8 floats or more.
CPU_TUNING = Tuning(vector_width=16, work_group=CPU_WORK_GROUP)


def best_tuning(device: cl.Device) -> Tuning:
    """Return the tuning that ``svgf-cl tune`` found for a device and its driver, else the default."""
    return stored_tuning(device) or default_tuning(device)


def default_tuning(device: cl.Device) -> Tuning:
    """Return a tuning that suits most devices of this kind.

    On a CPU, a vector has twice the native width, which hides the latency of the arithmetic, but at most 16, OpenCL's
    widest type. A driver that reports no native vectors makes vectors of work-items itself (rusticl on llvmpipe): it
    gets single pixels, and so do GPUs.
    """
    if not device.type & cl.device_type.CPU:
        return GPU_TUNING
    native = device.native_vector_width_float
    return Tuning(vector_width=min(16, 2 * native) if native > 1 else 1, work_group=CPU_WORK_GROUP)


def stored_tuning(device: cl.Device) -> Tuning | None:
    """Return the tuning stored for a device, its driver and these kernels, or None.

    If the file cannot be used, this warns and returns None, so that denoising continues.
    """
    try:
        entry = read_store().get(device_key(device))
        if entry is None or entry["kernels"] != kernels_digest():
            return None
        values = entry["tuning"]
        tuning = Tuning(**{**values, "work_group": tuple(values["work_group"])})
        tuning.check(device)
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        warnings.warn(
            f"{store_path()}: cannot be used ({error!r}), so devices run untuned; 'svgf-cl tune' writes it again",
            stacklevel=2,
        )
        return None
    return tuning


def store_tuning(device: cl.Device, tuning: Tuning) -> Path:
    """Store a tuning for a device, its driver and these kernels, and return the file's path.

    Raises
    ------
    SvgfError
        If that file cannot be written.
    """
    return write_store(known_tunings() | {device_key(device): {"kernels": kernels_digest(), "tuning": asdict(tuning)}})


def forget_tuning(device: cl.Device) -> Path:
    """Remove the stored tuning of a device, and return the file's path; errors are those of `store_tuning`."""
    return write_store({key: entry for key, entry in known_tunings().items() if key != device_key(device)})


@functools.cache
def kernels_digest() -> str:
    """Return a digest of the kernels, as other kernels may need another tuning."""
    sources = "".join(programs.source(name) for name in programs.names())
    return hashlib.sha256(sources.encode()).hexdigest()[:16]


def store_path() -> Path:
    """Return the path of the file of tunings."""
    return cache_folder() / STORE


def read_store() -> dict[str, Any]:
    """Return every stored tuning by `device_key`; raise `OSError` or `ValueError` if the file cannot be read."""
    if not os.path.exists(store_path()):  # returns False, not an error, if its folder is forbidden
        return {}
    entries = read_json(store_path())
    if not isinstance(entries, dict):
        raise ValueError(f"expected an object, got {type(entries).__name__}")
    return entries


def known_tunings() -> dict[str, Any]:
    """Return the result of `read_store`, or nothing if that fails: the content of such a file is lost already."""
    try:
        return read_store()
    except (OSError, ValueError):
        return {}


def write_store(entries: dict[str, Any]) -> Path:
    """Write the file of tunings completely or not at all, and return its path."""
    write_text(store_path(), json.dumps(entries, indent=1))
    return store_path()
