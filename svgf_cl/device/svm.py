"""Shared virtual memory (SVM) of OpenCL 2: checks that kernels can use it, and keeps it alive while they do."""

from __future__ import annotations

from typing import Any

import pyopencl as cl
from pyopencl.tools import PooledSVM

from svgf_cl.device.process import is_forked
from svgf_cl.frame import wrong

SYSTEM = cl.device_svm_capabilities.FINE_GRAIN_SYSTEM


def check_svm(name: str, memory: cl.SVMPointer, device: cl.Device) -> None:
    """Raise the error of `wrong` unless kernels on this device can use the SVM of an Array."""
    found = capabilities(device)
    if not found:
        expected = f"an Array in a buffer or memory pool, as {device.name} has no shared virtual memory (SVM)"
        raise wrong(name, expected, f"one in {type(memory).__name__}")
    if not (found & SYSTEM or is_allocated(memory)):
        expected = (
            f"SVM of csvm_empty, fsvm_empty, SVMAllocator or SVMPool, as {device.name} does not work in the host's "
            "other memory (FINE_GRAIN_SYSTEM)"
        )
        raise wrong(name, expected, "SVM of other memory")


def capabilities(device: cl.Device) -> int:
    """Return bits of `pyopencl.device_svm_capabilities`; 0 if a device has no SVM or no OpenCL 2."""
    try:
        return int(device.svm_capabilities)
    except cl.Error:
        return 0


def is_allocated(memory: Any) -> bool:
    """Whether OpenCL allocated this SVM, or the array of which it is a view."""
    while memory is not None and not isinstance(memory, cl.SVMAllocation | PooledSVM):
        memory = memory.mem if isinstance(memory, cl.SVM) else getattr(memory, "base", None)
    return memory is not None


class InFlight:
    """Keeps SVM alive while commands on the queue may use it: OpenCL does that for buffers, but not for SVM.

    If SVM were freed while a kernel runs, the kernel would read or write memory that belongs to something else.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._kept: list[tuple[cl.Event, list[cl.SVMPointer]]] = []

    def keep(self, memory: list[cl.SVMPointer]) -> None:
        """Keep memory until all commands that are now on the queue are done; the next call after that frees it."""
        done = cl.command_execution_status.COMPLETE
        self._kept = [(event, held) for event, held in self._kept if event.command_execution_status > done]
        if memory:
            self._kept.append((cl.enqueue_marker(self._queue), memory))

    def __del__(self) -> None:
        if self._kept and not is_forked():
            cl.wait_for_events([event for event, _ in self._kept])
