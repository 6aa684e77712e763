"""Copies numpy arrays to the device and back, without waiting for each single upload."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
import pyopencl as cl

from svgf_cl.device.opencl_errors import lack_of_room


class HostCopies:
    """Copies between numpy arrays and buffers, for one queue and one thread at a time.

    An upload is put on the queue without waiting for the previous one. The event that pyopencl returns for an upload
    keeps the array alive until the copy has ended.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._under_way: list[cl.Event] = []

    def upload(self, name: str, value: np.ndarray, target: cl.Buffer) -> None:
        """Queue the copy of an array to the device.

        Parameters
        ----------
        name : str
            The field's name; arrays of one name have one size until `forget`.
        value : C-contiguous array
            It must not change until `wait` returns.
        target : pyopencl.Buffer
            It has the same number of bytes.
        """
        self._under_way.append(cl.enqueue_copy(self._queue, target, value, is_blocking=False))

    def download(self, name: str, source: cl.Buffer, target: np.ndarray) -> None:
        """Copy a buffer to an array after all commands on the queue; returns when the values are there."""
        cl.enqueue_copy(self._queue, target, source)

    def wait(self) -> None:
        """Wait until all uploads have ended, so that the owners may change their arrays again."""
        under_way, self._under_way = self._under_way, []
        if under_way:
            cl.wait_for_events(under_way)

    def forget(self) -> None:
        """Free the memory that is kept for arrays of the sizes so far."""


@dataclass
class Staging:
    """Pinned memory through which an array is copied.

    Parameters
    ----------
    view : array
        The memory as the host sees it, with the shape and type of the array. It keeps the buffer mapped.
    upload : pyopencl.Event, optional
        The last copy from this memory to the device.
    """

    view: np.ndarray
    upload: cl.Event | None = None

    @classmethod
    def of(cls, value: np.ndarray, queue: cl.CommandQueue) -> Staging:
        """Allocate memory for arrays like this one, mapped by this queue; raise `DeviceError` if there is none left."""
        flags = cl.mem_flags.READ_WRITE | cl.mem_flags.ALLOC_HOST_PTR
        # The flags are an int, which pyopencl's types do not say.
        access = cast("cl.map_flags", cl.map_flags.READ | cl.map_flags.WRITE)
        with lack_of_room(queue.device, value.nbytes, value.nbytes):
            buffer = cl.Buffer(queue.context, flags, value.nbytes)
            view, _ = cl.enqueue_map_buffer(queue, buffer, access, 0, value.shape, value.dtype)
        return cls(view)

    def wait(self) -> None:
        """Wait until the memory may be written to again."""
        if self.upload:
            self.upload.wait()


class PinnedCopies(HostCopies):
    """Copies through pinned memory, from which a GPU copies by itself and at full speed.

    While the GPU copies one field, the host fills the memory for the next. Pinned memory is kept from frame to frame,
    and is as large as the arrays.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        super().__init__(queue)
        # A second queue, so that it does not wait for the commands of the first.
        self._mapping = cl.CommandQueue(queue.context, queue.device)
        self._staging: dict[str, Staging] = {}

    def upload(self, name: str, value: np.ndarray, target: cl.Buffer) -> None:
        """Queue a copy as `HostCopies.upload` does, but the array may be changed as soon as this returns."""
        staging = self._staging_for(name, value)
        staging.wait()
        np.copyto(staging.view, value)
        staging.upload = cl.enqueue_copy(self._queue, target, staging.view, is_blocking=False)
        self._queue.flush()  # so that the GPU begins while the host continues with the next field

    def download(self, name: str, source: cl.Buffer, target: np.ndarray) -> None:
        """Copy a buffer to an array as `HostCopies.download` does."""
        staging = self._staging_for(name, target)
        cl.enqueue_copy(self._queue, staging.view, source)
        np.copyto(target, staging.view)

    def forget(self) -> None:
        """Free the pinned memory, once no copy uses it any more."""
        for staging in self._staging.values():
            staging.wait()
        self._staging.clear()

    def _staging_for(self, name: str, value: np.ndarray) -> Staging:
        """Return the memory of this name; allocate it again if the array's shape or type has changed."""
        staging = self._staging.get(name)
        if staging is None or (staging.view.shape, staging.view.dtype) != (value.shape, value.dtype):
            staging = self._staging[name] = Staging.of(value, self._mapping)
        return staging
