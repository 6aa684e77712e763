"""Makes arrays of other libraries usable for the denoiser, without a copy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.errors import FrameError, one_line, shown

UserArray = np.ndarray | cl_array.Array

EXPECTED = "an array in the host's memory (with __array__ or __dlpack__), a pyopencl Array, or (pyopencl Buffer, shape)"
FROM_GPU = "memory of the host or of OpenCL: copy it to a numpy.ndarray (.cpu(), .get()) or to a pyopencl Array"

# Devices by their numbers in dlpack.h. The host reads the CPU's memory, and memory that CUDA and ROCm have pinned.
READ_BY_HOST = (1, 3, 11)
DEVICES = {2: "CUDA", 4: "OpenCL", 7: "Vulkan", 8: "Metal", 10: "ROCm", 13: "CUDA (managed)", 14: "oneAPI"}


def as_array(field: str, value: Any, dtype: type[np.generic]) -> UserArray:
    """Return a field's value as a numpy.ndarray or a pyopencl Array.

    Parameters
    ----------
    field : str
        The field's name, for the error.
    value : object
        A numpy.ndarray or pyopencl Array, which is returned unchanged; an object with ``__dlpack__`` or ``__array__``;
        nested lists of numbers; or ``(buffer, shape)`` with a `pyopencl.Buffer` that begins with the array's elements
        in C order.
    dtype : type
        The type of a buffer's elements.

    Raises
    ------
    FrameError
        If it is none of these, or is in a GPU's memory but no OpenCL buffer.
    """
    if isinstance(value, UserArray):
        return value
    if isinstance(value, cl.MemoryObjectHolder):
        raise FrameError(field, "(buffer, shape), as a buffer does not know its shape", type(value).__name__)
    if isinstance(value, tuple) and value and isinstance(value[0], cl.MemoryObjectHolder):
        return of_buffer(field, value, dtype)
    if hasattr(value, "__cuda_array_interface__"):
        raise FrameError(field, FROM_GPU, f"{type(value).__name__} with __cuda_array_interface__")
    return of_host(field, value)


def of_buffer(field: str, value: tuple[Any, ...], dtype: type[np.generic]) -> cl_array.Array:
    """Return ``(buffer, shape)`` as an Array that belongs to no queue."""
    try:
        buffer, shape = value
        return cl_array.Array(buffer.get_info(cl.mem_info.CONTEXT), tuple(shape), dtype, data=buffer)
    except (TypeError, ValueError) as error:
        raise FrameError(field, "(buffer, shape) with a shape of whole numbers", shown(value)) from error


def of_host(field: str, value: Any) -> np.ndarray:
    """Return an ndarray in the same memory as another library's object; numbers in lists are copied."""
    kind = type(value).__name__
    try:
        if hasattr(value, "__dlpack_device__"):
            device = int(value.__dlpack_device__()[0])
            if device not in READ_BY_HOST:
                raise FrameError(field, FROM_GPU, f"{kind} on {DEVICES.get(device, 'a device')} (DLPack: {device})")
            return np.from_dlpack(value)
        array = np.asarray(value)
    except FrameError:
        raise
    except Exception as error:  # another library may raise any error
        raise FrameError(field, EXPECTED, f"{kind}: {one_line(error)}") from error
    if array.dtype.kind not in "biufc":
        raise FrameError(field, EXPECTED, kind)
    return array
