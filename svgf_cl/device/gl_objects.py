"""Arrays in buffers of OpenGL: which device can share them, and when OpenCL has them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.frame import wrong

EXTENSION = "cl_khr_gl_sharing"
# Packages of pyopencl from PyPI are built without OpenGL, and have no such class.
GL_BUFFER: tuple[type[cl.MemoryObjectHolder], ...] = (cl.GLBuffer,) if cl.have_gl() else ()


def check_gl(name: str, device: cl.Device) -> None:
    """Raise the error of `wrong` unless a device can share the OpenGL buffer that an Array lies in."""
    if EXTENSION not in device.extensions.split():
        expected = f"an Array in a buffer of OpenCL, as {device.name} lacks {EXTENSION}"
        raise wrong(name, expected, "one in a buffer of OpenGL")


def gl_objects(arrays: Iterable[cl_array.Array]) -> list[cl.MemoryObjectHolder]:
    """The buffers of OpenGL that Arrays lie in, each once."""
    bases = (value.base_data for value in arrays)
    return list({base.int_ptr: base for base in bases if isinstance(base, GL_BUFFER)}.values())


@contextmanager
def acquired(
    queue: cl.CommandQueue, objects: list[cl.MemoryObjectHolder], done: list[tuple[str, cl.Event]]
) -> Iterator[None]:
    """Around commands that use buffers of OpenGL: it gets them back, after an error too.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    objects : list of pyopencl.GLBuffer
        Nothing is done where there are none.
    done : list of (str, pyopencl.Event)
        Label and event of both commands are added to it.
    """
    if not objects:
        yield
        return
    done.append(("acquire GL", cl.enqueue_acquire_gl_objects(queue, objects)))
    try:
        yield
    finally:
        done.append(("release GL", cl.enqueue_release_gl_objects(queue, objects)))
