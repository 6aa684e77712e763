"""Strategies for what users hand to `Denoiser.denoise`: all forms that are right, all sorts of wrong."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pyopencl.tools as cl_tools
from hypothesis import strategies as st

from svgf_cl import Frame
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import REQUIRED, Shape
from tests import arrays
from tests.frames import bumpy, only

# Right

FORMS = (
    np.asarray,
    np.asfortranarray,
    arrays.strided,
    arrays.backwards,
    arrays.inside,
    arrays.read_only,
    arrays.unaligned,
    arrays.one_row,
)
REAL = (np.float16, np.float32, np.float64, np.longdouble, ">f4", ">f8")
WHOLE = (np.uint8, np.int16, np.uint32, np.int64, np.uint64, ">u4", ">i8")

shapes = st.tuples(st.integers(1, 24), st.integers(1, 40))
seeds = st.integers(0, 2**32 - 1)


@st.composite
def fields(draw: st.DrawFn) -> tuple[str, ...]:
    """A set of fields beside the surface's, all that a frame may have."""
    radiance = draw(st.sampled_from([("color",), ("direct", "indirect"), ("color", "direct", "indirect")]))
    return (*radiance, *(name for name in ("albedo", "id", "emission", "roughness") if draw(st.booleans())))


def any_bits(rng: np.random.Generator, value: np.ndarray) -> np.ndarray:
    """All that 32 bits can be in place of the values: NaN, infinities, denormals, any size and sign."""
    return rng.integers(0, 2**32, value.shape, np.uint32).view(value.dtype)


def frame_of(seed: int, shape: Shape, names: tuple[str, ...], motion: int, *, wild: bool) -> Frame:
    """A frame of plain arrays: bumpy, or of any bits."""
    rng = np.random.default_rng(seed)
    frame = only(bumpy(rng, shape), names, motion)
    return mapped(frame, lambda _, value: any_bits(rng, value)) if wild else frame


def mapped(frame: Frame, change: Callable[[str, np.ndarray], Any]) -> Frame:
    """The frame with every field changed."""
    return replace(frame, **{name: change(name, value) for name, value in frame.present().items()})


@st.composite
def held_somehow(draw: st.DrawFn, frame: Frame, queue: cl.CommandQueue, *, on_device: bool | None = None) -> Frame:
    """The frame as a user may hold it, each field in another form; `on_device` says whether in Arrays, None: some."""

    def change(name: str, value: np.ndarray) -> Any:
        if draw(st.booleans()) if on_device is None else on_device:
            return to_device(draw, queue, value)
        with np.errstate(over="ignore", invalid="ignore"):
            typed = value.astype(draw(st.sampled_from(WHOLE if name == "id" else REAL)))
        return draw(st.sampled_from(FORMS))(typed)

    return mapped(frame, change)


def to_device(draw: st.DrawFn, queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """An Array of this queue, of another one of its context, out of a memory pool, or with strides or an offset."""
    kind = draw(st.sampled_from(("own", "other queue", "pool", *arrays.STRIDED)))
    if callable(kind):
        return kind(queue, value)
    if kind == "pool":
        pool = cl_tools.MemoryPool(cl_tools.ImmediateAllocator(queue))
        return cl_array.to_device(queue, value, allocator=pool)
    return cl_array.to_device(queue if kind == "own" else cl.CommandQueue(queue.context), value)


def plain(frame: Frame) -> Frame:
    """What the denoiser is to read: the same values as plain numpy arrays of the kernels' type."""

    def change(name: str, value: Any) -> np.ndarray:
        with np.errstate(over="ignore", invalid="ignore"):
            return np.array(arrays.fetched(value), np.uint32 if name == "id" else np.float32, order="C")

    return mapped(frame, change)


# Wrong

NO_ARRAYS: tuple[Callable[[np.ndarray], Any], ...] = (
    np.ndarray.tolist,
    memoryview,
    lambda value: "depth.exr",
    lambda value: 0.5,
    lambda value: np.float32(0.5),
    lambda value: {"shape": value.shape},
    lambda value: np.ndarray,
)
WRONG_SHAPES: tuple[Callable[[np.ndarray], np.ndarray], ...] = (
    np.ravel,
    np.transpose,
    lambda value: value[:-1],
    lambda value: value[:, 1:],
    lambda value: value[:0],
    lambda value: value[None],
    lambda value: value[..., None],
    lambda value: value[0, 0],
)
WRONG_TYPES = (bool, np.complex64, object, "S4", "U4", "M8[s]", "m8[s]", [("x", np.float32)])


def wrong_arrays(queue: cl.CommandQueue, name: str, value: np.ndarray) -> st.SearchStrategy[Any]:
    """What cannot be this field, made of what could."""
    other_kind = np.float32 if name == "id" else np.int32
    host = st.one_of(
        st.sampled_from((*NO_ARRAYS, *WRONG_SHAPES)).map(lambda change: change(value)),
        st.sampled_from((*WRONG_TYPES, other_kind)).map(lambda dtype: np.zeros(value.shape, dtype)),
    )
    return st.one_of(host, st.sampled_from(WRONG_DEVICE_ARRAYS).map(lambda make: make(queue, value)))


def of_another_type(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    return cl_array.zeros(queue, value.shape, np.float64)


def without_the_last_row(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    return cl_array.to_device(queue, value[:-1].copy())


def in_another_context(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    array = cl_array.to_device(cl.CommandQueue(another_context(queue.device)), value)
    array.finish()
    return array


def in_too_small_a_buffer(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    data = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, value.nbytes - 4)
    return cl_array.Array(queue, value.shape, value.dtype, data=data)


def off_the_grid(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    data = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, value.nbytes + 2)
    return cl_array.Array(queue, value.shape, value.dtype, data=data, offset=2)


def beyond_its_buffer(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    strides = (-value.strides[0], *value.strides[1:])
    return cl_array.Array(queue, value.shape, value.dtype, data=cl_array.to_device(queue, value).data, strides=strides)


def that_failed(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    array = cl_array.to_device(queue, value)
    array.add_event(failed(queue))
    return array


WRONG_DEVICE_ARRAYS = (
    of_another_type,
    off_the_grid,
    beyond_its_buffer,
    without_the_last_row,
    in_another_context,
    in_too_small_a_buffer,
    that_failed,
)


@functools.cache
def another_context(device: cl.Device) -> cl.Context:
    """Held, as a queue does not keep its context on Intel's runtime."""
    return cl.Context([device])


def failed(queue: cl.CommandQueue) -> cl.UserEvent:
    """An event of a command that failed."""
    event = cl.UserEvent(queue.context)
    event.set_status(cl.status_code.OUT_OF_RESOURCES)
    return event


def wrong_events(queue: cl.CommandQueue) -> st.SearchStrategy[Any]:
    """What cannot be waited for."""
    return st.one_of(
        st.sampled_from((None, 1, [None], ["done"], "done", [[]])),
        st.builds(lambda: failed(queue)),
        st.builds(lambda: [failed(queue)]),
        st.builds(lambda: [cl.UserEvent(another_context(queue.device))]),
    )


class WrongCall:
    """Arguments of `denoise`, of which one is wrong; `what` says which. Not shown: drivers hang on what failed."""

    def __init__(self, what: str, **arguments: Any) -> None:
        self.what = what
        self.arguments = arguments

    def __repr__(self) -> str:
        return f"WrongCall({self.what!r})"


@st.composite
def wrong_calls(draw: st.DrawFn, frame: Frame, queue: cl.CommandQueue) -> WrongCall:
    """A call with one thing wrong."""
    what = draw(st.sampled_from(("field", "missing", "out", "wait_for", "frame")))
    if what == "field":
        name = draw(st.sampled_from(Inputs.of(frame).fields))
        wrong = draw(wrong_arrays(queue, name, getattr(frame, name)))
        return WrongCall(name, frame=replace(frame, **{name: wrong}))
    if what == "missing":
        name = draw(st.sampled_from(REQUIRED))
        return WrongCall(name, frame=replace(frame, **{name: None}))
    if what == "out":
        right = np.empty((*frame.shape, 3), np.float32)
        unfit = (arrays.read_only(right), np.asfortranarray(right), arrays.big_endian(right), arrays.one_row(right))
        return WrongCall(what, frame=frame, out=draw(st.sampled_from(unfit) | wrong_arrays(queue, what, right)))
    if what == "wait_for":
        return WrongCall(what, frame=frame, wait_for=draw(wrong_events(queue)))
    return WrongCall(what, frame=draw(st.sampled_from((None, {}, frame.present(), frame.depth, Frame, "frame.exr"))))
