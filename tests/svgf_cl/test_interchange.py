"""Arrays of other libraries: their memory is read where it is, or the field is named with what to do."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import FrameError
from svgf_cl.interchange import as_array

VALUE = np.arange(24, dtype=np.float32).reshape(2, 4, 3)


class Tensor:
    """As of PyTorch or JAX: DLPack from a device of this number."""

    def __init__(self, value: np.ndarray, device: int = 1) -> None:
        self.value, self.device = value, device

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.device, 0

    def __dlpack__(self, **wanted: Any) -> Any:
        assert self.device in (1, 3, 11), "nobody asks a GPU"
        return self.value.__dlpack__()


class Gradient(Tensor):
    """As of PyTorch, where it records gradients."""

    def __dlpack__(self, **wanted: Any) -> Any:
        raise BufferError("Can't export tensors that require gradient,\nuse tensor.detach()")


class Lazy:
    """As of many libraries: __array__ alone."""

    def __init__(self, value: np.ndarray) -> None:
        self.value = value

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return self.value


class Forbidden:
    """As of CuPy and sparse libraries: __array__ that raises."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        raise TypeError("Implicit conversion to a NumPy array is not allowed.")


def taken(value: Any, dtype: type = np.float32) -> Any:
    return as_array("color", value, dtype)


@pytest.mark.parametrize("change", [np.asarray, Tensor, Lazy, lambda v: Tensor(v, 3), lambda v: Tensor(v, 11)])
@pytest.mark.parametrize("form", [np.ascontiguousarray, lambda v: v[::-1], lambda v: v.transpose(1, 0, 2)])
def test_memory_of_the_host_is_not_copied(change: Callable, form: Callable) -> None:
    value = form(VALUE)
    found = taken(change(value))
    assert isinstance(found, np.ndarray)
    assert np.shares_memory(found, VALUE)
    assert_array_equal(found, value, strict=True)


@pytest.mark.parametrize("change", [np.ndarray.tolist, lambda value: tuple(map(list, value)), memoryview])
def test_lists_of_numbers_are_taken(change: Callable) -> None:
    assert_array_equal(taken(change(VALUE)), VALUE)


def test_an_array_of_opencl_stays_as_it_is(queue: cl.CommandQueue) -> None:
    array = cl_array.to_device(queue, VALUE)
    assert taken(array) is array


@pytest.mark.parametrize("dtype", [np.float32, np.uint32])
def test_a_buffer_comes_with_its_shape(dtype: type, queue: cl.CommandQueue) -> None:
    value = VALUE.astype(dtype)
    buffer = cl.Buffer(queue.context, cl.mem_flags.COPY_HOST_PTR, hostbuf=value)
    array = taken((buffer, value.shape), dtype)
    assert array.base_data is buffer
    assert array.context == queue.context
    assert_array_equal(array.get(queue), value, strict=True)


@pytest.mark.parametrize("shape", ["32", 5, (2.5, 2), (-1, 3), None, (2, None)])
def test_a_shape_that_is_none_is_refused(shape: Any, queue: cl.CommandQueue) -> None:
    buffer = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 96)
    with pytest.raises(FrameError, match=r"^Frame\.color: expected \(buffer, shape\) with a shape of whole"):
        taken((buffer, shape))


@pytest.mark.parametrize("rest", [(), ((2, 4, 3), 0)], ids=["nothing", "more"])
def test_a_buffer_without_its_shape_is_refused(rest: tuple[Any, ...], queue: cl.CommandQueue) -> None:
    buffer = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 96)
    with pytest.raises(FrameError, match=r"expected \(buffer, shape\)"):
        taken((buffer, *rest))
    with pytest.raises(FrameError, match=r"as a buffer does not know its shape, got Buffer"):
        taken(buffer)


@pytest.mark.parametrize(
    ("value", "found"),
    [
        (Tensor(VALUE, 2), r"Tensor on CUDA \(DLPack: 2\)"),
        (Tensor(VALUE, 4), r"Tensor on OpenCL \(DLPack: 4\)"),
        (Tensor(VALUE, 10), r"Tensor on ROCm \(DLPack: 10\)"),
        (Tensor(VALUE, 99), r"Tensor on a device \(DLPack: 99\)"),
        (SimpleNamespace(__cuda_array_interface__={}), r"SimpleNamespace with __cuda_array_interface__"),
    ],
)
def test_memory_of_a_gpu_is_refused_with_what_to_do(value: Any, found: str) -> None:
    with pytest.raises(FrameError, match=rf"^Frame\.color: expected memory of the host .* copy it .*, got {found}$"):
        taken(value)


@pytest.mark.parametrize(
    ("value", "found"),
    [
        ("color.exr", "str"),
        ({"shape": 3}, "dict"),
        (object(), "object"),
        (int, "type"),
        ([["a"]], "list"),
        ([[1.0], [1.0, 2.0]], "list: .*inhomogeneous.*"),
        (Forbidden(), "Forbidden: Implicit conversion to a NumPy array is not allowed."),
        (Gradient(VALUE), r"Gradient: Can't export tensors that require gradient, use tensor.detach\(\)"),
    ],
)
def test_what_is_no_array_is_refused(value: Any, found: str) -> None:
    with pytest.raises(FrameError, match=rf"^Frame\.color: expected an array in the host's memory .*, got {found}$"):
        taken(value)
