"""Checks the user's arrays: that kernels can use their memory, and that the result overwrites no field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device import gl_objects
from svgf_cl.device.strided import buffer_of, is_aligned, is_apart, span
from svgf_cl.device.svm import check_svm
from svgf_cl.filters.pipeline import OUT
from svgf_cl.frame import check_array, element_type, wrong


def check_given(name: str, value: cl_array.Array, queue: cl.CommandQueue) -> None:
    """Raise the error of `wrong` unless kernels on this queue can read and write all elements of a user's Array."""
    wanted = np.dtype(element_type(name))
    if value.dtype != wanted:
        raise wrong(name, f"dtype {wanted}", f"dtype {value.dtype}")
    if value.context != queue.context:
        raise wrong(name, "an Array in the context of Denoiser(queue=...)", "one of another context")
    check_memory(name, value.base_data, queue)
    if not is_aligned(value):
        steps = f"offset {value.offset}, strides {value.strides}"
        raise wrong(name, f"an offset and strides of whole elements, {wanted.itemsize} bytes each", steps)
    first, end = span(value)
    size = buffer_of(value).size
    if first < 0 or end > size:
        place = f"bytes {first} to {end} of one of {size}"
        raise wrong(name, "elements inside their buffer", place)


def check_memory(name: str, memory: Any, queue: cl.CommandQueue) -> None:
    """Raise the error of `wrong` unless kernels on this queue can use the memory of an Array."""
    if isinstance(memory, cl.SVMPointer):
        check_svm(name, memory, queue.device)
    elif not isinstance(memory, cl.MemoryObjectHolder):
        raise wrong(name, "an Array in a buffer or memory pool", type(memory).__name__)
    elif memory.get_info(cl.mem_info.CONTEXT) != queue.context:  # the Array's queue may have another context
        raise wrong(name, "an Array in a buffer of the context of Denoiser(queue=...)", "one of another context")
    elif isinstance(memory, gl_objects.GL_BUFFER):
        gl_objects.check_gl(name, queue.device)


def check_apart(fields: Mapping[str, cl_array.Array], result: np.ndarray | cl_array.Array) -> None:
    """Raise `ArgumentError` if the result would overwrite a field that neighbouring pixels still read.

    Parameters
    ----------
    fields : mapping of str to Array
        The fields that the passes read in place.
    result : array
        The array that the passes write in place.
    """
    for name, value in fields.items():
        if are_joined(value, result):
            raise wrong(OUT, "memory of its own", f"that of {name}")


def are_joined(field: cl_array.Array, result: np.ndarray | cl_array.Array) -> bool:
    """Whether the two may share the memory of an element."""
    if isinstance(result, np.ndarray):  # SVM may be a view of it
        return isinstance(field.base_data, cl.SVMPointer) and np.may_share_memory(field.base_data.buf, result)
    memory, first, last = place(field)
    other, begin, end = place(result)
    return memory == other and first < end and begin < last


def place(array: cl_array.Array) -> tuple[int, int, int]:
    """Return the number of the memory that an Array lies in, its first byte there, and the byte after its last.

    A sub-buffer has the number of the whole buffer.
    """
    first, end = span(array)
    memory = array.base_data
    if isinstance(memory, cl.SVMPointer):  # all SVM is in one address space
        return 0, memory.svm_ptr + first, memory.svm_ptr + end
    buffer = buffer_of(array)
    whole = cast("cl.Buffer | None", buffer.get_info(cl.mem_info.ASSOCIATED_MEMOBJECT)) or buffer
    return whole.int_ptr, buffer.offset + first, buffer.offset + end


def check_out(out: Any, shape: tuple[int, int, int]) -> None:
    """Raise `ArgumentError` unless a result of this shape can be written to `out`."""
    check_array(OUT, out)
    if tuple(out.shape) != shape or out.dtype != np.float32:
        raise wrong(OUT, f"shape {shape}, float32", f"shape {tuple(out.shape)}, {out.dtype}")
    if isinstance(out, np.ndarray) and not (out.flags.c_contiguous and out.flags.writeable):
        raise wrong(OUT, "a writable C-contiguous array", "a view or read-only array")
    if isinstance(out, cl_array.Array) and not is_apart(out):
        raise wrong(OUT, "memory of its own for every element", f"strides {out.strides}")
