"""Planes on the host: a part goes to the device and comes back, in 32 bits and in 16, and nothing else changes."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl.device.devices import default_queue
from svgf_cl.device.host_planes import HostPlanes, Place
from svgf_cl.device.layout import Layout
from svgf_cl.filters.formats import Format
from svgf_cl.filters.pipeline import Quantity, Resource

DEPTH, NORMAL = Quantity("depth", 2, unknown=-2.0), Quantity("normal", 3, format=Format.SNORM, unknown=0.5)
GUIDE = Resource("guide", "guide", (DEPTH, NORMAL))
SHAPE, LAYOUT = (23, 37), Layout(11, 19)


@pytest.fixture(scope="module")
def queue() -> cl.CommandQueue:
    return default_queue()


def test_a_part_goes_there_and_comes_back(queue: cl.CommandQueue) -> None:
    nbytes = LAYOUT.nbytes(GUIDE.planes.depth)
    memory = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, nbytes)
    cl.enqueue_copy(queue, memory, np.zeros(nbytes, np.uint8))
    there, back = (HostPlanes({GUIDE: GUIDE.quantities}, SHAPE) for _ in range(2))
    there.forget()
    there.upload(queue, GUIDE, Place(memory, LAYOUT, (2, 3)), (5, 7), (6, 10))
    cl.wait_for_events(back.download(queue, GUIDE, Place(memory, LAYOUT, (2, 3)), (8, 20), (6, 10)))
    raw = np.empty(nbytes, np.uint8)
    cl.enqueue_copy(queue, raw, memory)
    full = LAYOUT.crop(raw[: LAYOUT.nbytes(64)].view(np.float32))
    half = LAYOUT.crop(raw[LAYOUT.nbytes(64) :].view(np.int16))
    for planes, value in ((full, -2.0), (half, 16384)):
        assert (planes[:, 2:8, 3:13] == value).all()
        assert np.count_nonzero(planes) == len(planes) * 60  # and nothing beside, the halo too
    assert np.count_nonzero(raw[: LAYOUT.nbytes(64)].view(np.float32)) == 2 * 60
    for quantity, value in ((DEPTH, -2.0), (NORMAL, 16384)):
        planes = back._planes[GUIDE][quantity]
        assert (planes[:, 8:14, 20:30] == value).all()
        assert np.count_nonzero(planes) == quantity.planes * 60


def test_it_holds_what_it_was_made_for() -> None:
    planes = HostPlanes({GUIDE: (DEPTH,)}, SHAPE)
    other = Resource("other", "guide", (DEPTH,))
    assert [planes.holds(*each) for each in ((GUIDE, DEPTH), (GUIDE, NORMAL), (other, DEPTH))] == [True, False, False]


def test_it_forgets() -> None:
    planes = HostPlanes({GUIDE: (DEPTH,)}, SHAPE)
    planes._planes[GUIDE][DEPTH][...] = 7
    known = planes.of(GUIDE, DEPTH)
    planes.forget()
    assert (planes.of(GUIDE, DEPTH) == -2).all()
    assert (known == 7).all()
    assert planes.nbytes == 2 * 4 * 23 * 37
