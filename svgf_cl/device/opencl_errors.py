"""Turns OpenCL's errors into errors that say what to do next."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pyopencl as cl

from svgf_cl.errors import DeviceError

# The errors with which drivers report too little memory. For a buffer above the size limit it is INVALID_BUFFER_SIZE.
LACK_OF_ROOM = (
    cl.status_code.MEM_OBJECT_ALLOCATION_FAILURE,
    cl.status_code.OUT_OF_RESOURCES,
    cl.status_code.OUT_OF_HOST_MEMORY,
    cl.status_code.INVALID_BUFFER_SIZE,
)


@contextmanager
def opencl_errors(device: cl.Device, what: str, then: str) -> Iterator[None]:
    """Turn an OpenCL error into a `DeviceError` that begins with `what` and ends with `then`, the advice."""
    try:
        yield
    except cl.Error as error:
        raise DeviceError(f"{what}: expected {device.name} to work, got {error}; {then}") from error


@contextmanager
def lack_of_room(device: cl.Device, nbytes: int, needed: int) -> Iterator[None]:
    """Turn an OpenCL error that reports too little memory into a `DeviceError` that says how much was needed."""
    try:
        yield
    except cl.Error as error:
        if error.code in LACK_OF_ROOM:
            raise no_room(device, nbytes, needed) from error
        raise


def allocate(queue: cl.CommandQueue, nbytes: int, needed: int) -> cl.Buffer:
    """Allocate a buffer of uninitialised memory.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    nbytes : int
        Size of the buffer.
    needed : int
        Bytes of all buffers that are needed together, for the error message.

    Raises
    ------
    DeviceError
        If the device does not have enough memory.
    """
    with lack_of_room(queue.device, nbytes, needed):
        return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, nbytes)


def check_room(device: cl.Device, needed: int) -> None:
    """Raise `DeviceError` if a device has less memory than needed: drivers may notice late, or never."""
    if needed > device.global_mem_size:
        raise no_room(device, needed, needed)


def no_room(device: cl.Device, nbytes: int, needed: int) -> DeviceError:
    """Return the error that says how much memory was needed, and how much there is."""
    return DeviceError(
        f"{device.name} has no room for a buffer of {mebibytes(nbytes)}, of {mebibytes(needed)} needed in all; it has "
        f"{mebibytes(device.global_mem_size)}, {mebibytes(device.max_mem_alloc_size)} for one buffer, less what is in "
        "use. Free some, take smaller frames or 16-bit Settings (half_guides, half_history), or work in tiles, as "
        "svgf_cl.denoiser_for(shape, inputs) does"
    )


def mebibytes(nbytes: int) -> str:
    """Write a size: 12.5 MiB."""
    return f"{nbytes / 2**20:.1f} MiB"
