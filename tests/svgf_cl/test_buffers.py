"""Device memory of a denoiser: what it holds at first, what is swapped, how much there is."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, SvgfError
from svgf_cl.buffers import Buffers
from svgf_cl.passes import Inputs, persistent_buffers, pipeline
from svgf_cl.planes import Layout
from svgf_cl.settings import Settings
from tests.frames import FULL, SHAPE, bumpy_sequence

FRAME = bumpy_sequence(FULL, count=1)[0]


class TestBuffers:
    INPUTS = Inputs.of(FRAME)
    PASSES = pipeline(INPUTS, Settings(taa=True))
    LAYOUT = Layout(*SHAPE)

    @pytest.fixture
    def buffers(self, queue: cl.CommandQueue) -> Buffers:
        return Buffers(queue, self.LAYOUT, self.PASSES, self.INPUTS, share=True)

    def test_history_begins_blank(self, buffers: Buffers) -> None:
        for name in persistent_buffers(self.PASSES):
            assert_array_equal(buffers.read(name), np.float32(np.nan if "antialiased" in name else 0))

    def test_nbytes_is_all_memory(self, buffers: Buffers) -> None:
        names = {name for step in self.PASSES for name in (*step.reads, *step.writes)} - {*self.INPUTS.fields, "out"}
        assert buffers.nbytes == sum(b.size for b in {buffers[name].int_ptr: buffers[name] for name in names}.values())

    def test_what_was_written_becomes_history(self, buffers: Buffers) -> None:
        guide, previous = buffers["guide"], buffers["previous guide"]
        buffers.begin_frame()
        assert (buffers["guide"], buffers["previous guide"]) == (previous, guide)

    def test_last_owner_of_shared_memory_survives(self, buffers: Buffers) -> None:
        assert buffers.survives("guide")
        assert buffers.survives("modulated") or buffers.survives("level 5")
        assert not buffers.survives("demodulated")

    def test_without_sharing_all_survive(self, queue: cl.CommandQueue) -> None:
        buffers = Buffers(queue, self.LAYOUT, self.PASSES, self.INPUTS, share=False)
        assert all(buffers.survives(name) for step in self.PASSES for name in step.writes if name != "out")


def test_too_large_an_image_is_refused_with_its_size() -> None:
    with pytest.raises(SvgfError, match=r"no room for a buffer of \d+ MiB"):
        Buffers(Denoiser((1, 1)).queue, Layout(1 << 18, 1 << 18), TestBuffers.PASSES, TestBuffers.INPUTS, share=True)
