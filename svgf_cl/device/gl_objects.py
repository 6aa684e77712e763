"""Arrays in OpenGL buffers: checks that a device can share them, and acquires and releases them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.frame import wrong

EXTENSION = "cl_khr_gl_sharing"
# pyopencl's packages on PyPI are built without OpenGL and have no such class.
GL_BUFFER: tuple[type[cl.MemoryObjectHolder], ...] = (cl.GLBuffer,) if cl.have_gl() else ()


def check_gl(name: str, device: cl.Device) -> None:
    """Raise the error of `wrong` unless a device can share the OpenGL buffer that an Array lies in."""
    if EXTENSION not in device.extensions.split():
        expected = f"an Array in a buffer of OpenCL, as {device.name} lacks {EXTENSION}"
        raise wrong(name, expected, "one in a buffer of OpenGL")


def gl_objects(arrays: Iterable[cl_array.Array]) -> list[cl.MemoryObjectHolder]:
    """Return the OpenGL buffers that contain these Arrays, each once."""
    bases = (value.base_data for value in arrays)
    return list({base.int_ptr: base for base in bases if isinstance(base, GL_BUFFER)}.values())


@contextmanager
def acquired(
    queue: cl.CommandQueue, objects: list[cl.MemoryObjectHolder], done: list[tuple[str, cl.Event]]
) -> Iterator[None]:
    """Acquire OpenGL buffers for the commands in a ``with`` block, and release them after it, even after an error.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    objects : list of pyopencl.GLBuffer
        If it is empty, nothing happens.
    done : list of (str, pyopencl.Event)
        Gets the label and the event of both commands.
    """
    if not objects:
        yield
        return
    done.append(("acquire GL", cl.enqueue_acquire_gl_objects(queue, objects)))
    try:
        yield
    finally:
        done.append(("release GL", cl.enqueue_release_gl_objects(queue, objects)))
