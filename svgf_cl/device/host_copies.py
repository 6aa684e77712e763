"""Copies of numpy arrays to the device and back, in which the host does not wait for each upload on its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
import pyopencl as cl

from svgf_cl.device.opencl_errors import lack_of_room


class HostCopies:
    """Copies between numpy arrays and buffers, for one queue and one thread at a time.

    An upload is put on the queue without waiting for the one before. The event that pyopencl returns for it keeps the
    array alive, and waits for the end of the copy before it lets go.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._under_way: list[cl.Event] = []

    def upload(self, name: str, value: np.ndarray, target: cl.Buffer) -> None:
        """Put the copy of an array to the device on the queue.

        Parameters
        ----------
        name : str
            Of the field; arrays of one name have one size until `forget`.
        value : C-contiguous array
            It must stay as it is until `wait` returns.
        target : pyopencl.Buffer
            Of the same number of bytes.
        """
        self._under_way.append(cl.enqueue_copy(self._queue, target, value, is_blocking=False))

    def download(self, name: str, source: cl.Buffer, target: np.ndarray) -> None:
        """Copy a buffer to an array, after all that is on the queue; the values are there when this returns."""
        cl.enqueue_copy(self._queue, target, source)

    def wait(self) -> None:
        """Wait until all arrays that were uploaded are their owners' again."""
        under_way, self._under_way = self._under_way, []
        if under_way:
            cl.wait_for_events(under_way)

    def forget(self) -> None:
        """Give back what is kept for arrays of these sizes."""


@dataclass
class Staging:
    """Pinned memory that an array goes through.

    Parameters
    ----------
    view : array
        The memory as the host sees it, with the shape and type of the array. It keeps the buffer mapped.
    upload : pyopencl.Event, optional
        The last copy from here to the device.
    """

    view: np.ndarray
    upload: cl.Event | None = None

    @classmethod
    def of(cls, value: np.ndarray, queue: cl.CommandQueue) -> Staging:
        """Memory for arrays like this one, mapped by this queue; `DeviceError` if there is none left."""
        flags = cl.mem_flags.READ_WRITE | cl.mem_flags.ALLOC_HOST_PTR
        access = cast("cl.map_flags", cl.map_flags.READ | cl.map_flags.WRITE)  # an int, which its types do not know
        with lack_of_room(queue.device, value.nbytes, value.nbytes):
            buffer = cl.Buffer(queue.context, flags, value.nbytes)
            view, _ = cl.enqueue_map_buffer(queue, buffer, access, 0, value.shape, value.dtype)
        return cls(view)

    def wait(self) -> None:
        """Until the memory may be written to again."""
        if self.upload:
            self.upload.wait()


class PinnedCopies(HostCopies):
    """The same by way of pinned memory, from which a GPU copies by itself and at full speed.

    While the GPU copies one field, the host fills the memory for the next. Pinned memory is kept from frame to frame:
    as much as the arrays take.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        super().__init__(queue)
        self._mapping = cl.CommandQueue(queue.context, queue.device)  # does not wait for what the other has to do
        self._staging: dict[str, Staging] = {}

    def upload(self, name: str, value: np.ndarray, target: cl.Buffer) -> None:
        """As `HostCopies.upload`, but the array is its owner's again when this returns."""
        staging = self._staging_for(name, value)
        staging.wait()
        np.copyto(staging.view, value)
        staging.upload = cl.enqueue_copy(self._queue, target, staging.view, is_blocking=False)
        self._queue.flush()  # the GPU is to begin while the host goes on with the next field

    def download(self, name: str, source: cl.Buffer, target: np.ndarray) -> None:
        """As `HostCopies.download`."""
        staging = self._staging_for(name, target)
        cl.enqueue_copy(self._queue, staging.view, source)
        np.copyto(target, staging.view)

    def forget(self) -> None:
        """Give back the pinned memory, once nothing is copied from it any more."""
        for staging in self._staging.values():
            staging.wait()
        self._staging.clear()

    def _staging_for(self, name: str, value: np.ndarray) -> Staging:
        """The memory of this name, made anew where the array is another one than before."""
        staging = self._staging.get(name)
        if staging is None or (staging.view.shape, staging.view.dtype) != (value.shape, value.dtype):
            staging = self._staging[name] = Staging.of(value, self._mapping)
        return staging
