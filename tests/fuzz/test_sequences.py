"""Calls in any order: those that fail change nothing, a frame that breaks off is forgotten with all before it."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, DeviceError, Settings, SvgfError
from svgf_cl.device import devices
from tests.faults import broken_launch, no_room
from tests.frames import FULL, PLAIN, TINY
from tests.fuzz import calls
from tests.fuzz.effort import effort
from tests.fuzz.test_denoise import assert_is_a_picture, fetched

SETS = (PLAIN, FULL)


class Calls(RuleBasedStateMachine):
    """Every call goes to `den`; its twin gets only those that are right, and a reset where a frame broke off."""

    @initialize(taa=st.booleans(), names=st.sampled_from(SETS))
    def make(self, taa: bool, names: tuple[str, ...]) -> None:
        self.queue = devices.default_queue()
        self.den, self.twin = (Denoiser(TINY, settings=Settings(taa=taa), queue=self.queue) for _ in range(2))
        self.names = names
        self.begun = False

    @rule(data=st.data(), seed=calls.seeds, wild=st.booleans(), on_device=st.sampled_from((None, True, False)))
    def a_right_frame(self, data: st.DataObject, seed: int, wild: bool, on_device: bool | None) -> None:
        frame = calls.frame_of(seed, TINY, self.names, 3, wild=wild)
        held = data.draw(calls.held_somehow(frame, self.queue, on_device=on_device))
        out = fetched(self.den.denoise(held))
        assert_is_a_picture(out, TINY)
        assert_array_equal(out, self.twin.denoise(calls.plain(held)))
        self.begun = True

    @rule(data=st.data(), seed=calls.seeds)
    def a_wrong_call(self, data: st.DataObject, seed: int) -> None:
        wrong = data.draw(calls.wrong_calls(calls.frame_of(seed, TINY, self.names, 3, wild=False), self.queue))
        with pytest.raises(SvgfError, match="expected"):
            self.den.denoise(**wrong.arguments)

    @precondition(lambda self: self.begun)
    @rule(seed=calls.seeds)
    def a_frame_of_other_fields(self, seed: int) -> None:
        (other,) = set(SETS) - {self.names}
        with pytest.raises(SvgfError, match=r"\(frame\): expected the fields .* reset, got"):
            self.den.denoise(calls.frame_of(seed, TINY, other, 3, wild=False))

    @rule(names=st.sampled_from(SETS))
    def a_cut(self, names: tuple[str, ...]) -> None:
        self.den.reset()
        self.twin.reset()
        self.names, self.begun = names, False

    @rule(seed=calls.seeds, launch=st.integers(0, 8))
    def a_frame_that_breaks_off(self, seed: int, launch: int) -> None:
        frame = calls.frame_of(seed, TINY, self.names, 3, wild=False)
        with broken_launch(launch), pytest.raises(DeviceError, match="the history is discarded"):
            self.den.denoise(frame)
        self.twin.reset()
        self.begun = False

    @precondition(lambda self: not self.begun)
    @rule(seed=calls.seeds, buffer=st.integers(0, 5))  # the planes of the fewest fields take six
    def no_room_for_a_frame(self, seed: int, buffer: int) -> None:
        frame = calls.frame_of(seed, TINY, self.names, 3, wild=False)
        self.den.resize(TINY)  # gives back what an earlier frame has taken
        with no_room(buffer), pytest.raises(DeviceError, match="no room"):
            self.den.denoise(frame)

    @rule(data=st.data(), more=st.sampled_from(("blur", 1, None, (), [], np.array(["normal"] * 2))))
    def a_stage(self, data: st.DataObject, more: object) -> None:
        name = data.draw(st.sampled_from((*self.den.stages, more)))
        if name is more:
            with pytest.raises(SvgfError, match="expected one of"):
                self.den.stage(name)
            return
        with suppress(SvgfError):  # overwritten by a later pass
            assert np.isfinite(self.den.stage(name)).all()

    @rule()
    def a_profile(self) -> None:
        assert all(time >= 0 for time in self.den.profile().values())
        assert bool(self.den.profile()) == self.begun


TestCalls = Calls.TestCase
TestCalls.settings = effort()
