"""The whole pipeline: it follows the oracle over a sequence, and keeps its promises whatever image comes."""

from __future__ import annotations

import copy
import os
import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import ArgumentError, Denoiser, DeviceError, Eaw, Frame, Inputs, Kalman, Settings, SvgfError
from svgf_cl.device import devices
from svgf_cl.device.layout import HALO, Layout
from svgf_cl.frame import Shape
from svgf_cl.oracle.accuracy import DECISION
from svgf_cl.oracle.rounding import largest_channel, relative_error
from svgf_cl.oracle.svgf import Oracle
from tests.denoising import feed, vector_width
from tests.faults import failing
from tests.frames import FULL, PLAIN, SHAPE, SPLIT, TINY, bumpy_sequence, only, wall
from tests.oracle import DECIDED_OTHERWISE, PIPELINE_TOLERANCE
from tests.svgf_cl.device.test_user_arrays import on_device

TAA = Settings(taa=True)


def assert_alike(got: np.ndarray, expected: np.ndarray, otherwise: float = DECIDED_OTHERWISE) -> None:
    """Two pictures are the same but for rounding, and for a few pixels decided otherwise."""
    error = relative_error(got, expected, largest_channel(expected))
    decided_otherwise = ~(error <= DECISION)
    assert decided_otherwise.mean() <= otherwise
    assert error[~decided_otherwise].max(initial=0.0) <= PIPELINE_TOLERANCE


def plain_lengths(den: Denoiser, frame: Frame) -> np.ndarray:
    """The length of the history after one more frame."""
    den.denoise(frame)
    return den.stage("history_length")


class TestOracle:
    @pytest.mark.parametrize(
        ("frames", "chosen"),
        [
            (bumpy_sequence(PLAIN, count=10), Settings()),
            (bumpy_sequence(FULL, count=10), Settings(alpha_color=0, alpha_moments=0)),
            (bumpy_sequence(SPLIT, count=10), TAA),
        ],
        ids=["plain", "full", "split"],
    )
    def test_errors_do_not_build_up_over_a_sequence(self, frames: Sequence[Frame], chosen: Settings) -> None:
        den, oracle = Denoiser(frames[0].shape, settings=chosen), Oracle(frames[0].shape, chosen)
        for frame in frames:
            assert_alike(den.denoise(frame), oracle.denoise(frame))

    # Shrinking takes minutes and finds little: the examples are small as they are.
    @settings(max_examples=40, deadline=None, derandomize=True, phases=[Phase.generate])
    @given(
        shape=st.tuples(st.integers(1, 24), st.integers(1, 40)),
        variant=st.sampled_from(((PLAIN, False), (FULL, False), (SPLIT, False), (SPLIT, True))),
        chosen=st.fixed_dictionaries(
            {
                "iterations": st.integers(1, 5),
                "sigma_luminance": st.floats(0.5, 10),
                "sigma_depth": st.floats(0.1, 10),
                "depth_slope_floor": st.floats(1e-3, 0.1),
                **{name: st.floats(0, 1) for name in ("alpha_color", "alpha_moments", "alpha_taa", "depth_threshold")},
                "normal_threshold": st.floats(-1, 0.99),
            }
        ),
        seed=st.integers(0, 999),
    )
    def test_any_size_fields_and_settings(self, shape: Shape, variant: Any, chosen: dict, seed: int) -> None:
        fields, taa = variant
        wanted = Settings(taa=taa, **chosen)
        den, oracle = Denoiser(shape, settings=wanted), Oracle(shape, wanted)
        for frame in bumpy_sequence(fields, count=3, shape=shape, seed=seed):
            out = den.denoise(frame)
            assert out.shape == (*shape, 3)
            assert np.isfinite(out).all()
            assert_alike(out, oracle.denoise(frame), otherwise=0.02)


def sequence_at(width: int) -> list[np.ndarray]:
    with vector_width(width):
        den = Denoiser(SHAPE, settings=TAA)
    return [den.denoise(frame) for frame in bumpy_sequence(SPLIT)]


@pytest.mark.parametrize("width", [1, 4])  # with 8, tests/kernels and the tuner's test look at the same kernels
def test_vector_width_does_not_matter(width: int) -> None:
    for got, expected in zip(sequence_at(width), sequence_at(16), strict=True):
        assert_alike(got, expected)


def test_same_input_gives_the_same_bits() -> None:
    assert_array_equal(sequence_at(16), sequence_at(16))


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 1), (1, 100), (100, 1), (3, 17), (13, 31), (64, 64)])
@pytest.mark.parametrize("chosen", [Settings(), TAA], ids=["plain", "taa"])
def test_any_size_keeps_a_constant_image(shape: Shape, chosen: Settings) -> None:
    den = Denoiser(shape, settings=chosen)
    for _ in range(3):
        out = den.denoise(only(wall(shape, direct=0.3, indirect=0.1, emission=0.1, albedo=0.5, id=1), SPLIT))
    assert_allclose(out, 0.5, rtol=1e-5)


def test_static_noise_converges() -> None:
    rng = np.random.default_rng(0)
    frames = [wall(color=rng.exponential(0.5, (*SHAPE, 3))) for _ in range(64)]
    errors = [np.abs(feed(*frames[:count], alpha_color=0, alpha_moments=0)[0] - 0.5).mean() for count in (1, 8, 64)]
    assert errors[0] > 2 * errors[1] > 4 * errors[2]


def test_without_taa_the_result_is_what_taa_is_given() -> None:
    frames = bumpy_sequence(SPLIT, shape=TINY)
    assert_array_equal(feed(*frames)[0], feed(*frames, taa=True)[1].stage("modulated"))


class TestReset:
    @pytest.mark.parametrize("chosen", [Settings(), TAA], ids=["plain", "taa"])
    def test_camera_cut_leaves_no_trace(self, chosen: Settings) -> None:
        before, *after = bumpy_sequence(SPLIT)
        den, fresh = Denoiser(SHAPE, settings=chosen), Denoiser(SHAPE, settings=chosen)
        den.denoise(replace(before, direct=1e6 * before.direct))
        den.reset()
        for frame in after:
            assert_array_equal(den.denoise(frame), fresh.denoise(frame))

    def test_before_any_frame_is_harmless(self) -> None:
        den = Denoiser(TINY)
        den.reset()
        assert_allclose(den.denoise(wall(TINY)), 0.5, rtol=1e-6)

    def test_denoisers_of_one_queue_do_not_mix(self, queue: cl.CommandQueue) -> None:
        one, other, alone = (Denoiser(SHAPE, queue=queue) for _ in range(3))
        for frame, disturbance in zip(bumpy_sequence(SPLIT), bumpy_sequence(SPLIT, seed=1), strict=True):
            other.denoise(disturbance)
            assert_array_equal(one.denoise(frame), alone.denoise(frame))

    def test_keeps_kernels_and_memory(self, queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
        """A cut costs what a frame costs."""
        first, second = (on_device(frame, queue) for frame in bumpy_sequence(SPLIT, count=2))
        den = Denoiser(SHAPE, queue=queue, settings=TAA)
        out = den.denoise(first)
        held = den.nbytes
        for name in ("Kernel", "Program", "Buffer"):
            monkeypatch.delattr(cl, name)
        den.reset()
        den.denoise(second, out=out)
        assert den.nbytes == held

    def test_frames_with_other_fields_may_follow(self) -> None:
        den = Denoiser(SHAPE)
        den.denoise(bumpy_sequence(SPLIT, count=1)[0])
        (plain,) = bumpy_sequence(PLAIN, count=1)
        with pytest.raises(ArgumentError, match=r"fields direct, .* as before, or a call of reset, got color"):
            den.denoise(plain)
        den.reset()
        assert_array_equal(den.denoise(plain), Denoiser(SHAPE).denoise(plain))


@pytest.mark.parametrize("name", ["shape", "settings", "queue", "tuning"])
def test_what_it_is_made_of_cannot_be_assigned(name: str) -> None:
    den = Denoiser(TINY)
    first = den.denoise(wall(TINY))
    for value in (getattr(den, name), (2000, 3000)):
        with pytest.raises(AttributeError):
            setattr(den, name, value)
    assert_array_equal(den.denoise(wall(TINY)), first)


@pytest.mark.parametrize("send", [copy.copy, copy.deepcopy, pickle.dumps])
def test_it_cannot_be_copied_or_sent(send: Callable[[Denoiser], object]) -> None:
    with pytest.raises(SvgfError, match="a Denoiser cannot be copied or sent to another process"):
        send(Denoiser(TINY))


def test_it_says_what_it_is() -> None:
    assert "Denoiser of 9x7 pixels, eaw, on " in repr(Denoiser(TINY, settings=Eaw()))


class TestUpdate:
    def test_numbers_change_at_once_and_nothing_is_built_or_lost(
        self, queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        frames = [on_device(frame, queue) for frame in bumpy_sequence(FULL, count=3)]
        den, plain = (Denoiser(SHAPE, settings=Settings(), queue=queue) for _ in range(2))
        for frame in frames[:2]:
            out, _ = den.denoise(frame), plain.denoise(frame)
        with monkeypatch.context() as patch:
            for name in ("Kernel", "Program", "Buffer"):
                patch.delattr(cl, name)
            assert den.update(Settings(sigma_luminance=1.0, alpha_color=0.5)) is False
            den.denoise(frames[2], out=out)
        assert den.settings == Settings(sigma_luminance=1.0, alpha_color=0.5)
        assert_array_equal(den.stage("history_length"), plain_lengths(plain, frames[2]))
        assert (out.get() != plain.denoise(frames[2]).get()).any()

    @pytest.mark.parametrize(
        "chosen",
        [Settings(iterations=3), Settings(taa=True), Settings(precision="fast"), Settings(taps="5x5")],
        ids=str,
    )
    def test_other_passes_or_kernels_keep_the_past(self, chosen: Settings) -> None:
        *before, after = bumpy_sequence(FULL, count=3)
        den, plain = Denoiser(SHAPE, settings=Settings()), Denoiser(SHAPE, settings=Settings())
        for frame in before:
            den.denoise(frame)
            plain.denoise(frame)
        assert den.update(chosen) is True
        den.denoise(after)
        assert_array_equal(den.stage("history_length"), plain_lengths(plain, after))
        assert_array_equal(den.stage("mean"), plain.stage("mean"))

    @pytest.mark.parametrize("chosen", [Kalman(iterations=3), Kalman(taa=True, standard_error=True)], ids=str)
    def test_nor_is_the_past_of_kalman_lost(self, chosen: Kalman) -> None:
        *before, after = bumpy_sequence(FULL, count=3)
        den, plain = Denoiser(SHAPE), Denoiser(SHAPE)
        for frame in before:
            den.denoise(frame)
            plain.denoise(frame)
        assert den.update(chosen) is True
        den.denoise(after)
        plain.denoise(after)
        for name in ("inverse_count", "accumulated", "tone", "residual"):
            assert_array_equal(den.stage(name), plain.stage(name))

    @pytest.mark.parametrize("chosen", [Settings(half_history=True), Eaw()], ids=str)
    def test_a_past_that_is_kept_in_another_way_is_forgotten(self, chosen: Settings | Eaw) -> None:
        before, after = bumpy_sequence(FULL, count=2)
        den = Denoiser(SHAPE, settings=Settings())
        den.denoise(before)
        assert den.update(chosen) is True
        assert_array_equal(den.denoise(after), Denoiser(SHAPE, settings=chosen).denoise(after))

    def test_what_it_shows_is_never_of_a_plan_that_has_not_run(self) -> None:
        den = Denoiser(SHAPE, settings=Settings(), keep_stages=True)
        den.denoise(bumpy_sequence(FULL, count=1)[0])
        assert den.update(Settings(iterations=3)) is True
        assert (den.stages, den.profile()) == ([], {})
        with pytest.raises(SvgfError, match="none before a frame"):
            den.stage("level_1")

    def test_a_cut_before_it_stays_a_cut(self) -> None:
        before, after = bumpy_sequence(FULL, count=2)
        den = Denoiser(SHAPE, settings=Settings())
        den.denoise(before)
        den.reset()
        den.update(Settings(iterations=2))
        assert_array_equal(den.denoise(after), Denoiser(SHAPE, settings=Settings(iterations=2)).denoise(after))

    def test_before_a_frame_it_only_chooses(self) -> None:
        den = Denoiser(TINY)
        assert den.update(Settings(iterations=1)) is False
        den.denoise(wall(TINY))
        assert "level_2" not in den.stages

    def test_takes_settings_alone(self) -> None:
        with pytest.raises(
            SvgfError, match=r"expected settings=Kalman\(\.\.\.\) or Settings\(\.\.\.\) or .*, got None"
        ):
            Denoiser(TINY).update(None)  # type: ignore[arg-type]


class TestResize:
    def test_begins_anew_with_the_kernels_that_are_there(self, monkeypatch: pytest.MonkeyPatch) -> None:
        den = Denoiser(SHAPE, settings=TAA)
        den.denoise(wall(SHAPE))
        monkeypatch.delattr(cl, "Program")
        den.resize(TINY)
        assert (den.shape, den.nbytes, den.stages) == (TINY, 0, [])
        assert den.denoise(wall(TINY)).shape == (*TINY, 3)

    def test_a_wrong_shape_changes_nothing(self) -> None:
        den = Denoiser(TINY)
        with pytest.raises(SvgfError, match="at least 1 x 1 pixel"):
            den.resize((0, 3))
        assert den.shape == TINY


class TestWarmUp:
    def test_builds_ahead(self, queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
        frame = on_device(bumpy_sequence(FULL, count=1)[0], queue)
        out = cl_array.empty(queue, (*SHAPE, 3), np.float32)
        den = Denoiser(SHAPE, queue=queue)
        den.warm_up(Inputs.of(frame))
        for name in ("Kernel", "Program", "Buffer"):
            monkeypatch.delattr(cl, name)
        den.denoise(frame, out=out)

    def test_leaves_no_trace(self) -> None:
        frame = bumpy_sequence(FULL, count=1)[0]
        den = Denoiser(SHAPE)
        den.warm_up(Inputs.of(frame))
        assert den.stages == []
        assert_array_equal(den.denoise(frame), Denoiser(SHAPE).denoise(frame))

    def test_other_fields_in_mid_sequence_are_told_by_its_name(self) -> None:
        den = Denoiser(SHAPE)
        den.denoise(bumpy_sequence(FULL, count=1)[0])
        with pytest.raises(ArgumentError, match=r"warm_up\(inputs\): expected the fields color, .* reset, got direct"):
            den.warm_up(Inputs.every())

    def test_takes_inputs_alone(self) -> None:
        with pytest.raises(SvgfError, match=r"expected Inputs\(\.\.\.\) or Inputs.of\(frame\), got 'color'"):
            Denoiser(TINY).warm_up("color")  # type: ignore[arg-type]


class TestClose:
    def test_gives_memory_back_and_refuses_what_comes_after(self) -> None:
        with Denoiser(TINY) as den:
            out = den.denoise(wall(TINY))
        assert (den.nbytes, den.stages) == (0, [])
        assert np.isfinite(out).all()
        for call in (lambda: den.denoise(wall(TINY)), den.reset, den.profile, lambda: den.update(Settings())):
            with pytest.raises(SvgfError, match=r"expected one that is open, got one after close\(\)"):
                call()
        den.close()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_a_fork_is_told_at_once() -> None:
    """Drivers' threads do not survive it: without a word the child would wait for ever."""
    den = Denoiser(TINY)
    den.denoise(wall(TINY))
    calls = (lambda: den.denoise(wall(TINY)), lambda: Denoiser(TINY), lambda: den.stages, devices.list_devices)
    child = os.fork()
    if not child:
        told = 0
        for call in calls:
            try:
                call()
            except DeviceError as error:
                told += "forked" in str(error)
        den.close()  # as at the end of a `with`, without a word
        os._exit(told)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == len(calls)
    den.denoise(wall(TINY))


class TestAfterPass:
    def test_is_told_every_pass_in_order(self) -> None:
        told: list[tuple[str, cl.Event]] = []
        den = Denoiser(TINY, settings=TAA, after_pass=lambda label, event: told.append((label, event)))
        den.denoise(wall(TINY))
        assert tuple(told) == den.events
        assert [label for label, _ in told] == list(den.profile())

    @pytest.mark.parametrize(
        "call", [lambda den: den.reset(), lambda den: den.denoise(wall(TINY)), lambda den: den.stage("depth")]
    )
    def test_may_not_call_the_denoiser(self, call: Callable[[Denoiser], object]) -> None:
        dens: list[Denoiser] = []
        dens.append(Denoiser(TINY, after_pass=lambda *_: call(dens[0]) and None))
        with pytest.raises(SvgfError, match="expected no call from after_pass"):
            dens[0].denoise(wall(TINY))
        dens[0].reset()  # and goes on

    def test_must_be_callable(self) -> None:
        with pytest.raises(SvgfError, match=r"expected after_pass=function\(label, event\), got 3"):
            Denoiser(TINY, after_pass=3)  # type: ignore[arg-type]

    def test_waiting_in_it_changes_no_pixel(self) -> None:
        plain, waits = Denoiser(SHAPE), Denoiser(SHAPE, after_pass=lambda _, event: event.wait())
        for frame in bumpy_sequence(SPLIT, count=2):
            assert_array_equal(waits.denoise(frame), plain.denoise(frame))


@pytest.mark.parametrize("before", [1, 2])
def test_a_cut_that_fails_leaves_all_in_step(before: int) -> None:
    """Halves of pairs and launches: what follows is what it is with one that never failed."""
    frames = bumpy_sequence(FULL, count=5)
    den, plain = Denoiser(SHAPE, settings=TAA), Denoiser(SHAPE, settings=TAA)
    for frame in frames[:before]:  # with either half in turn
        den.denoise(frame)
    den.reset()
    with failing("enqueue_fill_buffer", 0, no_such_call), pytest.raises(DeviceError, match="history is discarded"):
        den.denoise(frames[2])
    for frame in frames[2:]:
        assert_array_equal(den.denoise(frame), plain.denoise(frame))
        assert_array_equal(den.stage("history_length"), plain.stage("history_length"))


def no_such_call(*_: object, **__: object) -> None:
    raise cl.RuntimeError("clEnqueueFillBuffer failed: OUT_OF_RESOURCES")


class TestStages:
    @pytest.mark.parametrize(("fields", "signals"), [(FULL, 1), (SPLIT, 2)])
    def test_shapes(self, fields: tuple[str, ...], signals: int) -> None:
        _, den = feed(*bumpy_sequence(fields, count=1), taa=signals == 2)
        pictures = {"normal", "modulated", "antialiased"}
        shared = {"depth", "history_length"}
        for name in den.stages:
            shape = den.stage(name).shape
            if name in shared:
                assert shape == SHAPE
            elif name in pictures:
                assert shape == (*SHAPE, 3)
            elif "variance" in name or name == "mean":
                assert shape == (signals, *SHAPE)
            else:
                assert shape == (signals, *SHAPE, 3)

    def test_overwritten_one_tells_of_keep_stages(self) -> None:
        den = Denoiser(TINY, settings=Settings())
        den.denoise(wall(TINY))
        with pytest.raises(SvgfError, match=r"'demodulated' was overwritten .*keep_stages=True"):
            den.stage("demodulated")

    def test_those_that_survive_are_the_same_as_kept_ones(self) -> None:
        frames = bumpy_sequence(SPLIT, count=2)
        _, kept = feed(*frames)
        den = Denoiser(SHAPE, settings=Settings())
        for frame in frames:
            den.denoise(frame)
        for name in ("normal", "depth", "history_length", "mean", "moment_variance", "level_1", "level_5"):
            assert_array_equal(den.stage(name), kept.stage(name))

    def test_unknown_one_is_named(self) -> None:
        den = Denoiser(TINY)
        with pytest.raises(SvgfError, match="expected one of none before a frame; got 'level_1'"):
            den.stage("level_1")
        den.denoise(wall(TINY))
        with pytest.raises(SvgfError, match=r"expected one of depth, normal, .*; got 'blur'"):
            den.stage("blur")

    def test_none_before_a_frame_and_after_reset(self) -> None:
        den = Denoiser(TINY)
        assert den.stages == []
        den.denoise(wall(TINY))
        den.reset()
        assert den.stages == []


class TestMemory:
    def test_none_before_a_frame(self) -> None:
        den = Denoiser(TINY)
        assert den.nbytes == 0
        den.denoise(wall(TINY))
        assert den.nbytes > 0

    def test_copies_of_stages_count(self) -> None:
        den = Denoiser(TINY, settings=Settings())
        den.denoise(wall(TINY))
        assert den.nbytes < feed(wall(TINY))[1].nbytes

    def test_is_that_of_22_planes(self) -> None:
        """Two guides of 4, moments of 3, and 4 each of history and of what is filtered."""
        den = Denoiser((90, 160), settings=Settings())
        den.denoise(wall((90, 160)))
        assert den.nbytes == 22 * 4 * Layout(90, 160, den.tuning.row_alignment).plane

    def test_16_bits_save_memory(self) -> None:
        den = Denoiser((90, 160), settings=Settings(half_guides=True, half_history=True))
        den.warm_up(Inputs.of(wall((90, 160))))
        assert den.nbytes == 13 * 4 * Layout(90, 160, den.tuning.row_alignment).plane

    @pytest.mark.parametrize("halves", [False, True])
    def test_halos_stay_clean(self, halves: bool) -> None:
        """Whoever has had its memory: nothing is seen outside the image."""
        den = Denoiser(SHAPE, settings=Settings(half_guides=halves, half_history=halves))
        layout = Layout(*SHAPE, den.tuning.row_alignment)
        for frame in bumpy_sequence(SPLIT, count=5):
            den.denoise(frame)
            for name in ("depth", "history_length"):
                planes = den.raw_stage(name)
                planes = planes[: len(planes) // layout.plane * layout.plane].reshape(-1, layout.rows, layout.pitch)
                width = -(-SHAPE[1] // den.tuning.vector_width) * den.tuning.vector_width
                planes[:, HALO : HALO + SHAPE[0], HALO : HALO + width] = 0
                assert not planes[: 2 if halves else None].any()


class TestProfile:
    def test_times_every_pass_of_the_table(self) -> None:
        frame = bumpy_sequence(SPLIT, count=1)[0]
        den = Denoiser(SHAPE, settings=TAA)
        den.denoise(frame)
        times = den.profile()
        assert list(times) == [entry.label for entry in TAA.pipeline(Inputs.of(frame)).passes]
        assert all(time > 0 for time in times.values())

    def test_is_empty_before_a_frame(self) -> None:
        assert Denoiser(TINY).profile() == {}

    def test_needs_a_queue_that_profiles(self, context: cl.Context) -> None:
        den = Denoiser(TINY, queue=cl.CommandQueue(context))
        den.denoise(wall(TINY))
        with pytest.raises(SvgfError, match="PROFILING_ENABLE"):
            den.profile()
