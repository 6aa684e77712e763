"""What goes wrong on a device, as errors that say what to do next."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pyopencl as cl

from svgf_cl.errors import DeviceError

# How drivers say that there is no room: a buffer larger than any may be is an invalid one.
LACK_OF_ROOM = (
    cl.status_code.MEM_OBJECT_ALLOCATION_FAILURE,
    cl.status_code.OUT_OF_RESOURCES,
    cl.status_code.OUT_OF_HOST_MEMORY,
    cl.status_code.INVALID_BUFFER_SIZE,
)


@contextmanager
def opencl_errors(device: cl.Device, what: str, then: str) -> Iterator[None]:
    """Have an OpenCL error come out as a `DeviceError`: what it means for the caller, and what to do then."""
    try:
        yield
    except cl.Error as error:
        raise DeviceError(f"{what}: expected {device.name} to work, got {error}; {then}") from error


@contextmanager
def lack_of_room(device: cl.Device, nbytes: int, needed: int) -> Iterator[None]:
    """Have an OpenCL error that says that a device has no room say how much was needed."""
    try:
        yield
    except cl.Error as error:
        if error.code in LACK_OF_ROOM:
            raise no_room(device, nbytes, needed) from error
        raise


def allocate(queue: cl.CommandQueue, nbytes: int, needed: int) -> cl.Buffer:
    """A buffer of uninitialised memory.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    nbytes : int
        Its size.
    needed : int
        Bytes of all buffers that are of no use without each other, for the error.

    Raises
    ------
    DeviceError
        If the device has no room.
    """
    with lack_of_room(queue.device, nbytes, needed):
        return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, nbytes)


def check_room(device: cl.Device, needed: int) -> None:
    """Raise `DeviceError` where a device has less memory than needed: drivers may find out only in use, or never."""
    if needed > device.global_mem_size:
        raise no_room(device, needed, needed)


def no_room(device: cl.Device, nbytes: int, needed: int) -> DeviceError:
    """The error that says how much was needed, and how much there is."""
    return DeviceError(
        f"{device.name} has no room for a buffer of {mebibytes(nbytes)}, of {mebibytes(needed)} needed in all; it has "
        f"{mebibytes(device.global_mem_size)}, {mebibytes(device.max_mem_alloc_size)} for one buffer, less what is in "
        "use. Free some, take smaller frames or 16-bit Settings (half_guides, half_history), or work in tiles, as "
        "svgf_cl.denoiser_for(shape, inputs) does"
    )


def mebibytes(nbytes: int) -> str:
    """Write a size: 12.5 MiB."""
    return f"{nbytes / 2**20:.1f} MiB"
