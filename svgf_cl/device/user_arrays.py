"""Lets kernels use the user's arrays: in place where possible, else through copies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple, TypeGuard

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device.array_checks import check_apart, check_given
from svgf_cl.device.gl_objects import gl_objects
from svgf_cl.device.host_copies import HostCopies, PinnedCopies
from svgf_cl.device.opencl_errors import allocate, lack_of_room
from svgf_cl.device.strided import StridedCopies, buffer_of, is_plain
from svgf_cl.device.svm import InFlight
from svgf_cl.filters.pipeline import OUT
from svgf_cl.frame import ALPHA, element_type
from svgf_cl.interchange import UserArray


class Copy(NamedTuple):
    """A copy on the device from one Array to another, and its label in a profile."""

    label: str
    source: cl_array.Array
    target: cl_array.Array


@dataclass(frozen=True)
class Exchange:
    """The buffers that the passes of one frame use, and the copies before and after the passes.

    Parameters
    ----------
    buffers : dict of str to pyopencl.Buffer
        The buffers that the passes read, by the names of fields, and the one that they write, by the name `OUT`. All
        are in C order from the first byte.
    landing : pyopencl.Buffer
        The buffer that contains the result in the end.
    before, after : sequence of Copy
        The copies to make before the passes and after them.
    given : sequence of Array
        The user's Arrays.
    """

    buffers: dict[str, cl.Buffer]
    landing: cl.Buffer
    before: Sequence[Copy]
    after: Sequence[Copy]
    given: Sequence[cl_array.Array]

    @property
    def gl_objects(self) -> list[cl.MemoryObjectHolder]:
        """The OpenGL buffers to acquire for this frame."""
        return gl_objects(self.given)

    @property
    def svm(self) -> list[cl.SVMPointer]:
        """The shared virtual memory that must live until the frame is done."""
        return [value.base_data for value in self.given if isinstance(value.base_data, cl.SVMPointer)]


class UserArrays:
    """Lets kernels read a frame's arrays and write its result.

    Kernels use numpy arrays in place if the result is a numpy array, so that the call waits for it anyway, and the
    device works in the host's memory. Else numpy arrays are copied to and from buffers that are kept from frame to
    frame. Kernels use a `pyopencl.array.Array` in place, unless it has strides, an offset or alpha: then it is copied
    on the device, to or from buffers that are kept.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    pinned : bool
        Whether numpy arrays are copied through pinned memory.
    """

    def __init__(self, queue: cl.CommandQueue, *, pinned: bool) -> None:
        self._queue = queue
        self._host = (PinnedCopies if pinned else HostCopies)(queue)
        self._in_flight = InFlight(queue)
        self._kept: dict[str, cl.Buffer] = {}
        self._strided: StridedCopies | None = None  # built where it is needed

    def exchange(self, fields: Mapping[str, UserArray], result: UserArray) -> Exchange:
        """Return the buffers that the passes use for these fields and this result, and queue uploads of numpy arrays.

        `in_use` waits for the uploads.

        Parameters
        ----------
        fields : mapping of str to array
            The fields that the passes read, as `Frame.layer` returns them, and `ALPHA` if the result has four channels.
        result : (H, W, 3) or (H, W, 4) array

        Raises
        ------
        FrameError, ArgumentError
            If kernels on this queue cannot use an Array's memory, or the passes would overwrite what they read.
        DeviceError
            If the device does not have enough memory.
        """
        arrays = {OUT: result} | {name: as_read(name, value) for name, value in fields.items()}
        given = {name: value for name, value in arrays.items() if isinstance(value, cl_array.Array)}
        for name, value in given.items():
            check_given(name, value, self._queue)
        direct = {name: value for name, value in given.items() if is_plain(value)}
        if ALPHA in fields:
            direct.pop(OUT, None)
        elif OUT in direct or isinstance(result, np.ndarray):
            check_apart({name: value for name, value in direct.items() if name != OUT}, result)
        before = {name: self._gather(name, value) for name, value in given.items() if name not in (OUT, *direct)}
        host = {name: value for name, value in arrays.items() if isinstance(value, np.ndarray)}
        buffers = {name: buffer_of(value) for name, value in direct.items()}
        buffers |= {name: buffer_of(copy.target) for name, copy in before.items()}
        buffers |= self._from_host(host, result)
        landing = buffers[OUT] if OUT in buffers else buffer_of(given[OUT])
        after = []
        if ALPHA in fields or OUT not in buffers:
            target = given[OUT] if OUT in given else self._array(landing, result.shape)
            after = self._scatter(target, buffers.get(ALPHA))
            buffers[OUT] = buffer_of(after[0].source)
        if before or after:
            self._strided = self._strided or StridedCopies(self._queue)
        self._upload(host, buffers)
        return Exchange(buffers, landing, tuple(before.values()), tuple(after), tuple(given.values()))

    def copy(self, copies: Sequence[Copy]) -> list[tuple[str, cl.Event]]:
        """Put copies on the queue, and return the label and the event of each."""
        if self._strided is None:
            return []
        return [(copy.label, self._strided.enqueue(copy.source, copy.target)) for copy in copies]

    def drop_copies(self) -> None:
        """Free the buffers that were kept for frames of another size or with other fields."""
        self._kept.clear()
        self._host.forget()

    @contextmanager
    def in_use(self, exchange: Exchange, result: UserArray) -> Iterator[None]:
        """Use the arrays in a ``with`` block.

        After the block a numpy result is complete, and the owners may change their numpy arrays again.
        """
        try:
            yield
            if self._works_in_place(result):
                self._show(exchange.landing, result)
            elif isinstance(result, np.ndarray):
                self._host.download(OUT, exchange.landing, result)
        finally:  # after an error too: commands that were queued before it may still run
            waits = isinstance(result, np.ndarray)
            if waits:
                self._queue.finish()
            self._in_flight.keep([] if waits else exchange.svm)
            self._host.wait()

    def _works_in_place(self, result: UserArray) -> TypeGuard[np.ndarray]:
        return isinstance(result, np.ndarray) and result.flags.aligned and shares_memory(self._queue.device)

    def _gather(self, name: str, value: cl_array.Array) -> Copy:
        """Return the copy of a field that has strides or an offset to a buffer without them."""
        return Copy(f"gather {name}", value, self._scratch(name, value.shape, value.dtype))

    def _scatter(self, target: cl_array.Array, alpha: cl.Buffer | None) -> list[Copy]:
        """Return the copies to a result that the passes cannot write directly: its light, and alpha if it has any."""
        light = self._scratch("light", (*target.shape[:2], 3))
        copies = [Copy("scatter light", light, target[..., :3])]
        if alpha:
            copies.append(Copy("scatter alpha", self._array(alpha, target.shape[:2]), target[..., 3]))
        return copies

    def _scratch(self, name: str, shape: tuple[int, ...], dtype: np.dtype | type = np.float32) -> cl_array.Array:
        """Return an Array in a buffer that is kept."""
        nbytes = math.prod(shape) * np.dtype(dtype).itemsize
        return self._array(self._keep(f"scratch {name}", nbytes), shape, dtype)

    def _array(self, buffer: cl.Buffer, shape: tuple[int, ...], dtype: np.dtype | type = np.float32) -> cl_array.Array:
        """Return a whole buffer as an Array in C order."""
        return cl_array.Array(self._queue, shape, dtype, data=buffer)

    def _from_host(self, arrays: Mapping[str, np.ndarray], result: UserArray) -> dict[str, cl.Buffer]:
        """Return buffers for numpy arrays: their own memory if the device works in it, else kept ones for copies."""
        wrapped = self._wrapped(arrays) if self._works_in_place(result) else {}
        return wrapped | {name: self._keep(name, value.nbytes) for name, value in arrays.items() if name not in wrapped}

    def _wrapped(self, arrays: Mapping[str, np.ndarray]) -> dict[str, cl.Buffer]:
        """Return buffers in the arrays' own memory. No two may overlap (OpenCL 1.2, 5.2.1), so others are left out."""
        chosen: dict[str, np.ndarray] = {}
        for name, value in arrays.items():
            if not any(np.may_share_memory(value, other) for other in chosen.values()):
                chosen[name] = value
        return {name: wrap(self._queue, value) for name, value in chosen.items()}

    def _upload(self, arrays: Mapping[str, np.ndarray], buffers: Mapping[str, cl.Buffer]) -> None:
        """Queue copies of fields to kept buffers; if one fails, wait for those before it."""
        try:
            for name, value in arrays.items():
                if name != OUT and buffers[name] is self._kept.get(name):
                    self._host.upload(name, value, buffers[name])
        except BaseException:
            self._host.wait()
            raise

    def _keep(self, name: str, nbytes: int) -> cl.Buffer:
        """Return the buffer of this name and size; reuse that of the last frame if there is one."""
        if name not in self._kept or self._kept[name].size != nbytes:
            self._kept[name] = allocate(self._queue, nbytes, nbytes)
        return self._kept[name]

    def _show(self, buffer: cl.Buffer, result: np.ndarray) -> None:
        """Make the values that kernels wrote to a wrapped array visible to the host."""
        mapped, _ = cl.enqueue_map_buffer(self._queue, buffer, cl.map_flags.READ, 0, result.shape, result.dtype)
        mapped.base.release(self._queue)


def shares_memory(device: cl.Device) -> bool:
    """Whether a device works in the host's memory as well as in its own; integrated GPUs would, but get copies."""
    return bool(device.type & cl.device_type.CPU)


def as_read(name: str, value: UserArray) -> UserArray:
    """Return a field as kernels read it: a numpy array of another type, order or alignment is converted."""
    if isinstance(value, cl_array.Array):
        return value
    with np.errstate(over="ignore"):  # a value beyond float32 becomes infinite, and is treated so
        return np.require(value, element_type(name), ("C", "ALIGNED"))


def wrap(queue: cl.CommandQueue, value: np.ndarray) -> cl.Buffer:
    """Return a buffer that uses a numpy array's own memory, and keeps it alive.

    The buffer is not marked as read-only: Intel's runtime would then copy every array that does not begin at a multiple
    of 128 bytes, which takes 10 ms for an image of 720p.
    """
    with lack_of_room(queue.device, value.nbytes, value.nbytes):
        return cl.Buffer(queue.context, cl.mem_flags.USE_HOST_PTR, hostbuf=value)
