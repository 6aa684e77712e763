"""The way in and out: every kind of array that is taken gives the same picture, all else is refused by name."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pyopencl.tools as cl_tools
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import ArgumentError, Denoiser, DeviceError, Eaw, Frame, FrameError, Inputs, Settings
from svgf_cl.device import user_arrays
from svgf_cl.device.tiling import Tiling
from svgf_cl.device.tuning import default_tuning
from svgf_cl.frame import CARRIED, CHANNELS
from svgf_cl.io.synthetic import room_frames
from svgf_cl.tiled import TiledDenoiser
from tests.arrays import STRIDED, big_endian, fetched, like, mapped_file, of_one_row, read_only, strided, unaligned
from tests.faults import broken_launch, failing
from tests.frames import FULL, PLAIN, SHAPE, SPLIT, bumpy_sequence, wall

FRAME = bumpy_sequence(FULL, count=1)[0]
OUT = (*SHAPE, 3)


@pytest.fixture(params=["usual", "copied"])
def den(queue: cl.CommandQueue, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Denoiser:
    """Treats numpy arrays as suits the device; and by copies, as on a GPU."""
    if request.param == "copied":
        monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture
def in_place(queue: cl.CommandQueue) -> Denoiser:
    """Works on numpy arrays where they lie."""
    if not user_arrays.shares_memory(queue.device):
        pytest.skip(f"{queue.device.name} has memory of its own")
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return Denoiser(SHAPE).denoise(FRAME)


def mapped(frame: Frame, change: Callable[[np.ndarray], Any]) -> Frame:
    """The frame with every field changed."""
    return replace(frame, **{name: change(value) for name, value in frame.present().items()})


def on_device(frame: Frame, queue: cl.CommandQueue) -> Frame:
    return mapped(frame, lambda value: cl_array.to_device(queue, value))


class TestInput:
    @pytest.mark.parametrize("change", [np.asfortranarray, strided, read_only, unaligned, big_endian])
    def test_layout_in_memory_does_not_matter(self, change: Callable, den: Denoiser, expected: np.ndarray) -> None:
        assert_array_equal(den.denoise(mapped(FRAME, change)), expected)

    @pytest.mark.parametrize(("real", "whole"), [(np.float64, np.int64), (np.float64, np.uint8)])
    def test_wider_types_are_rounded(self, real: type, whole: type, den: Denoiser, expected: np.ndarray) -> None:
        wide = mapped(FRAME, lambda value: value.astype(real if value.dtype.kind == "f" else whole))
        assert_array_equal(den.denoise(wide), expected)

    def test_half_floats_are_widened(self, den: Denoiser) -> None:
        half = mapped(FRAME, lambda value: value.astype(np.float16) if value.dtype.kind == "f" else value)
        single = mapped(half, lambda value: value.astype(np.float32) if value.dtype.kind == "f" else value)
        assert_array_equal(den.denoise(half), Denoiser(SHAPE).denoise(single))

    def test_arrays_on_the_device_give_one_on_the_same_queue(self, den: Denoiser, expected: np.ndarray) -> None:
        out = den.denoise(on_device(FRAME, den.queue))
        assert isinstance(out, cl_array.Array)
        assert out.queue == den.queue
        assert_array_equal(out.get(), expected)

    def test_one_numpy_field_gives_numpy(self, den: Denoiser, expected: np.ndarray) -> None:
        out = den.denoise(replace(on_device(FRAME, den.queue), depth=FRAME.depth))
        assert isinstance(out, np.ndarray)
        assert_array_equal(out, expected)

    def test_arrays_are_left_as_they_were(self, den: Denoiser) -> None:
        frame = on_device(FRAME, den.queue)
        den.denoise(frame)
        for name, value in frame.present().items():
            assert_array_equal(value.get(), getattr(FRAME, name))

    def test_numpy_fields_may_be_overwritten_afterwards(self, den: Denoiser, expected: np.ndarray) -> None:
        frame = mapped(FRAME, np.copy)
        out = cl_array.empty(den.queue, OUT, np.float32)
        den.denoise(frame, out=out)
        for value in frame.present().values():
            value.fill(0)
        assert_array_equal(out.get(), expected)

    @pytest.mark.parametrize("name", ["color", "depth", "id"])
    def test_array_of_another_type_is_refused(self, name: str, den: Denoiser) -> None:
        other = np.int64 if name == "id" else np.float64
        frame = replace(
            on_device(FRAME, den.queue), **{name: cl_array.zeros(den.queue, getattr(FRAME, name).shape, other)}
        )
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected dtype \w+32, got dtype \w+64"):
            den.denoise(frame)

    def test_array_on_another_context_is_refused(self, den: Denoiser) -> None:
        other = cl.Context([den.queue.device])  # held here: on Intel's runtime a queue does not keep its context
        stranger = cl.CommandQueue(other)
        with pytest.raises(FrameError, match=r"Frame\.color: .* context"):
            den.denoise(on_device(FRAME, stranger))

    @pytest.mark.parametrize("name", [name for name in CHANNELS if name not in CARRIED])
    def test_field_of_a_wrong_shape_is_refused(self, name: str, den: Denoiser) -> None:
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected shape"):
            den.denoise(replace(wall(direct=0, indirect=0), **{name: np.zeros((3, 3), np.float32)}))

    def test_other_fields_need_a_reset(self, den: Denoiser) -> None:
        frame = wall()
        den.denoise(frame)
        with pytest.raises(ArgumentError, match=r"\(frame\): expected .*, motion \(.* reset, got .*, albedo"):
            den.denoise(FRAME)
        den.reset()
        assert_array_equal(den.denoise(FRAME), Denoiser(SHAPE).denoise(FRAME))

    def test_refused_frame_leaves_the_history_alone(self, den: Denoiser) -> None:
        frames = bumpy_sequence(PLAIN, count=2)
        den.denoise(frames[0])
        for bad in (FRAME, replace(frames[1], depth=None), replace(frames[1], color=np.zeros((2, 2, 3)))):
            with pytest.raises((ArgumentError, FrameError)):
                den.denoise(bad)
        other = Denoiser(SHAPE)
        other.denoise(frames[0])
        assert_array_equal(den.denoise(frames[1]), other.denoise(frames[1]))


class TestStrides:
    """Arrays that do not fill a buffer in C order are copied on the device."""

    @pytest.mark.parametrize("form", STRIDED)
    def test_how_elements_lie_does_not_matter(self, form: Callable, den: Denoiser, expected: np.ndarray) -> None:
        frame = mapped(FRAME, lambda value: form(den.queue, value))
        for _ in range(2):
            out = den.denoise(frame)
            assert isinstance(out, cl_array.Array)
            assert_array_equal(out.get(), expected)
            den.reset()

    def test_one_row_may_stand_for_all(self, den: Denoiser) -> None:
        frame = wall(albedo=0.5, id=7, emission=0.1)
        out = den.denoise(mapped(frame, lambda value: of_one_row(den.queue, value)))
        assert_array_equal(out.get(), Denoiser(SHAPE).denoise(frame))

    @pytest.mark.parametrize("form", STRIDED)
    def test_result_may_have_strides(self, form: Callable, den: Denoiser, expected: np.ndarray) -> None:
        out = form(den.queue, np.full(OUT, np.nan, np.float32))
        assert den.denoise(on_device(FRAME, den.queue), out=out) is out
        assert_array_equal(fetched(out), expected)
        den.reset()
        den.denoise(FRAME, out=out)
        assert_array_equal(fetched(out), expected)

    def test_what_lies_around_a_result_stays(self, den: Denoiser, expected: np.ndarray) -> None:
        stack = np.random.default_rng(1).random((*SHAPE, 16), np.float32)
        out = like(den.queue, stack, stack[..., 5:8])
        den.denoise(FRAME, out=out)
        stack[..., 5:8] = expected
        found = np.empty_like(stack)
        cl.enqueue_copy(den.queue, found, out.base_data)
        assert_array_equal(found, stack)

    def test_result_may_take_the_place_of_a_field_in_a_stack(self, den: Denoiser, expected: np.ndarray) -> None:
        stack = cl_array.to_device(den.queue, np.concatenate([FRAME.normal, FRAME.color, FRAME.albedo], axis=-1))
        normal, color, albedo = (stack[..., first : first + 3] for first in (0, 3, 6))
        frame = replace(on_device(FRAME, den.queue), normal=normal, color=color, albedo=albedo)
        den.denoise(frame, out=color)
        assert_array_equal(stack.get(), np.concatenate([FRAME.normal, expected, FRAME.albedo], axis=-1))

    def test_arrays_without_strides_are_not_copied(self, den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        frame = on_device(FRAME, den.queue)
        monkeypatch.delattr(cl, "enqueue_copy")
        monkeypatch.setattr(user_arrays, "StridedCopies", None)
        den.denoise(frame)
        assert not [label for label, _ in den.events if label.startswith(("gather", "scatter"))]

    def test_buffers_are_kept_from_frame_to_frame(self, den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        frame = mapped(FRAME, lambda value: STRIDED[0](den.queue, value))
        out = STRIDED[0](den.queue, np.empty(OUT, np.float32))
        den.denoise(frame, out=out)
        monkeypatch.setattr(user_arrays, "allocate", None)
        den.denoise(frame, out=out)

    def test_copies_are_in_the_profile(self, queue: cl.CommandQueue) -> None:
        timed = cl.CommandQueue(queue.context, properties=cl.command_queue_properties.PROFILING_ENABLE)
        den = Denoiser(SHAPE, queue=timed)
        depth = STRIDED[0](timed, FRAME.depth)
        den.denoise(replace(on_device(FRAME, timed), depth=depth), out=STRIDED[0](timed, np.empty(OUT, np.float32)))
        labels = list(den.profile())
        assert (labels[0], labels[-1]) == ("gather depth", "scatter light")

    def test_a_view_still_being_computed_on_another_queue_is_waited_for(
        self, expected: np.ndarray, den: Denoiser
    ) -> None:
        renderer = cl.CommandQueue(den.queue.context)
        stack = cl_array.zeros(den.queue, (*SHAPE, 8), np.float32)
        den.queue.finish()
        values = np.zeros(stack.shape, np.float32)
        values[..., 2:5] = FRAME.color
        go = cl.UserEvent(den.queue.context)
        rendered = cl.enqueue_copy(renderer, stack.base_data, values, wait_for=[go], is_blocking=False)
        stack.add_event(rendered)
        out = den.denoise(replace(on_device(FRAME, den.queue), color=stack[..., 2:5]))
        go.set_status(cl.command_execution_status.COMPLETE)
        assert_array_equal(out.get(), expected)

    def test_a_result_with_strides_knows_when_it_is_ready(self, den: Denoiser, expected: np.ndarray) -> None:
        out = STRIDED[2](den.queue, np.empty(OUT, np.float32))
        den.denoise(on_device(FRAME, den.queue), out=out)
        (ready,) = out.events
        assert ready == den.events[-1][1]
        assert den.events[-1][0] == "scatter light"

    @pytest.mark.parametrize(
        ("offset", "strides", "message"),
        [
            (2, None, r"an offset and strides of whole elements, 4 bytes each, got offset 2, strides"),
            (0, (6 * SHAPE[1], 6), r"an offset and strides of whole elements, 4 bytes each, got offset 0, strides"),
            (4, None, r"elements inside their buffer, got bytes 4 to 7848 of one of 7844"),
            (0, (-4 * SHAPE[1], 4), r"elements inside their buffer, got bytes -7696 to 148 of one of 7844"),
        ],
    )
    def test_elements_that_are_not_there_are_refused(
        self, offset: int, strides: tuple[int, ...] | None, message: str, den: Denoiser
    ) -> None:
        data = cl.Buffer(den.queue.context, cl.mem_flags.READ_WRITE, FRAME.depth.nbytes)
        depth = cl_array.Array(den.queue, SHAPE, np.float32, data=data, offset=offset, strides=strides)
        if den.shape != (53, 37):
            message = message.partition(", got bytes")[0]
        with pytest.raises(FrameError, match=rf"Frame\.depth: expected {message}"):
            den.denoise(replace(FRAME, depth=depth))

    def test_an_array_of_nothing_is_refused(self, den: Denoiser) -> None:
        depth = cl_array.empty(den.queue, (0, SHAPE[1]), np.float32)
        with pytest.raises(FrameError, match=r"Frame\.depth: expected shape .*, got shape \(0, 37\)"):
            den.denoise(replace(FRAME, depth=depth))

    @pytest.mark.parametrize("strides", [(0, 12, 4), (4, 4, 4), (12 * SHAPE[1], 12, 0), (12, 12 * SHAPE[0] - 4, 4)])
    def test_a_result_whose_elements_overlap_is_refused(self, strides: tuple[int, ...], den: Denoiser) -> None:
        data = cl.Buffer(den.queue.context, cl.mem_flags.READ_WRITE, 2 * FRAME.color.nbytes)
        out = cl_array.Array(den.queue, OUT, np.float32, data=data, strides=strides)
        with pytest.raises(ArgumentError, match=r"out\): expected memory of its own for every element, got strides"):
            den.denoise(FRAME, out=out)


def any_alpha(seed: int) -> np.ndarray:
    """All that 32 bits can be, as float32."""
    return np.random.default_rng(seed).integers(0, 2**32, SHAPE, np.uint32).view(np.float32)


def assert_same_bits(found: np.ndarray, wanted: np.ndarray) -> None:
    assert_array_equal(np.ascontiguousarray(found).view(np.uint32), np.ascontiguousarray(wanted).view(np.uint32))


class TestAlpha:
    """Color of four channels gives a result of four, with the same light as without, and alpha bit for bit."""

    RGBA = np.concatenate([FRAME.color, any_alpha(0)[..., None]], axis=-1)

    def assert_is_right(self, out: np.ndarray | cl_array.Array, expected: np.ndarray) -> None:
        assert out.shape == (*SHAPE, 4)
        assert_array_equal(fetched(out)[..., :3], expected)
        assert_same_bits(fetched(out)[..., 3], self.RGBA[..., 3])

    @pytest.mark.parametrize("color", ["numpy", "Array", "strided"])
    @pytest.mark.parametrize("others", ["numpy", "Array"])
    @pytest.mark.parametrize("out", ["none", "numpy", "Array", "strided"])
    def test_alpha_goes_through(self, color: str, others: str, out: str, den: Denoiser, expected: np.ndarray) -> None:
        forms: dict[str, Callable[[np.ndarray], Any]] = {
            "none": lambda value: None,
            "numpy": np.copy,
            "Array": lambda value: cl_array.to_device(den.queue, value),
            "strided": lambda value: STRIDED[3](den.queue, value),
        }
        frame = replace(mapped(FRAME, forms[others]), color=forms[color](self.RGBA))
        target = forms[out](np.zeros_like(self.RGBA))
        found = den.denoise(frame, out=target)
        assert target is None or found is target
        assert isinstance(found, np.ndarray) == (out == "numpy" or (out == "none" and "numpy" in (color, others)))
        self.assert_is_right(found, expected)

    @pytest.mark.parametrize("on", ["host", "device"])
    def test_result_may_take_the_place_of_color(self, on: str, den: Denoiser, expected: np.ndarray) -> None:
        frame = replace(FRAME, color=self.RGBA.copy())
        frame = on_device(frame, den.queue) if on == "device" else frame
        assert den.denoise(frame, out=frame.color) is frame.color
        self.assert_is_right(frame.color, expected)

    def test_alpha_may_come_beside_a_split(self, den: Denoiser) -> None:
        split = bumpy_sequence(SPLIT, count=1)[0]
        out = den.denoise(replace(split, color=self.RGBA))
        self.assert_is_right(out, Denoiser(SHAPE).denoise(split))

    def test_alpha_follows_its_frame(self, den: Denoiser) -> None:
        for seed, frame in enumerate(bumpy_sequence(PLAIN, count=3)):
            alpha = any_alpha(seed)
            out = den.denoise(replace(frame, color=np.concatenate([frame.color, alpha[..., None]], axis=-1)))
            assert_same_bits(out[..., 3], alpha)

    def test_a_single_pixel_has_alpha(self, queue: cl.CommandQueue) -> None:
        frame = wall((1, 1))
        color = np.float32([[[0.5, 0.5, 0.5, 0.25]]])
        out = Denoiser((1, 1), queue=queue).denoise(replace(frame, color=color), out=color)
        assert_array_equal(out[..., :3], Denoiser((1, 1)).denoise(frame))
        assert out[0, 0, 3] == 0.25

    def test_a_result_without_room_for_alpha_is_refused(self, den: Denoiser) -> None:
        with pytest.raises(ArgumentError, match=r"out\): expected shape \(.*4\), float32, got shape \(.*3\), float32"):
            den.denoise(replace(FRAME, color=self.RGBA), out=np.empty(OUT, np.float32))

    def test_alpha_in_another_context_is_refused(self, den: Denoiser) -> None:
        other = cl.Context([den.queue.device])
        color = cl_array.to_device(cl.CommandQueue(other), self.RGBA)
        with pytest.raises(FrameError, match=r"Frame\.color.*: .* context"):
            den.denoise(replace(bumpy_sequence(SPLIT, count=1)[0], color=color))


class TestInPlace:
    def test_nothing_is_copied(self, in_place: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delattr(cl, "enqueue_copy")
        assert_array_equal(in_place.denoise(FRAME), expected)

    def test_converted_arrays_are_not_copied_again(
        self, in_place: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.delattr(cl, "enqueue_copy")
        assert_array_equal(in_place.denoise(mapped(FRAME, np.asfortranarray)), expected)

    def test_pages_that_cannot_be_written_are_read(self, den: Denoiser, expected: np.ndarray, tmp_path: Path) -> None:
        fields = {name: mapped_file(value, tmp_path / name) for name, value in FRAME.present().items()}
        assert_array_equal(den.denoise(replace(FRAME, **fields)), expected)

    def test_arrays_are_let_go(self, den: Denoiser) -> None:
        frame, out = mapped(FRAME, np.copy), np.empty(OUT, np.float32)
        den.denoise(frame, out=out)
        before = {name: sys.getrefcount(value) for name, value in {"out": out, **frame.present()}.items()}
        den.denoise(FRAME, out=np.empty(OUT, np.float32))
        assert before == {name: sys.getrefcount(value) for name, value in {"out": out, **frame.present()}.items()}

    def test_one_array_may_be_several_fields(self, den: Denoiser) -> None:
        same, apart = bumpy_sequence(FULL, count=2)
        same = replace(same, emission=same.color, albedo=same.color)
        apart = mapped(same, np.copy)
        assert_array_equal(den.denoise(same), Denoiser(SHAPE).denoise(apart))

    @pytest.mark.parametrize("name", ["color", "normal", "motion", "albedo", "emission"])
    def test_result_may_take_the_place_of_a_field(self, name: str, queue: cl.CommandQueue) -> None:
        settings = Settings(taa=True)
        den, other = Denoiser(SHAPE, queue=queue, settings=settings), Denoiser(SHAPE, queue=queue, settings=settings)
        for frame in bumpy_sequence(FULL, count=3):
            frame = mapped(frame, np.copy)
            expected = other.denoise(frame)
            assert_array_equal(den.denoise(frame, out=getattr(frame, name)), expected)

    def test_result_may_overlap_a_field(self, den: Denoiser, expected: np.ndarray) -> None:
        memory = np.empty((SHAPE[0] + 3, SHAPE[1], 3), np.float32)
        albedo, out = memory[3:], memory[:-3]
        albedo[:] = FRAME.albedo
        assert_array_equal(den.denoise(replace(FRAME, albedo=albedo), out=out), expected)

    def test_unaligned_result_is_filled(self, den: Denoiser, expected: np.ndarray) -> None:
        out = unaligned(np.zeros(OUT, np.float32))
        den.denoise(FRAME, out=out)
        assert_array_equal(out, expected)

    def test_after_an_error_nothing_reads_the_arrays(self, in_place: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        events: list[cl.Event] = []

        def fail_after_third(_: str, event: cl.Event) -> None:
            events.append(event)
            if len(events) == 3:
                raise KeyboardInterrupt

        in_place = Denoiser(SHAPE, queue=in_place.queue, after_pass=fail_after_third)
        go = cl.UserEvent(in_place.queue.context)
        release = threading.Timer(0.1, go.set_status, [cl.command_execution_status.COMPLETE])
        release.start()
        with pytest.raises(KeyboardInterrupt):
            in_place.denoise(FRAME, wait_for=[go])
        assert [event.command_execution_status for event in events] == [cl.command_execution_status.COMPLETE] * 3


class TestUploads:
    """Numpy arrays that are copied to the device: one wait a frame, at its end."""

    @pytest.fixture(params=[False, True], ids=["direct", "pinned"])
    def den(self, queue: cl.CommandQueue, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Denoiser:
        monkeypatch.setattr(user_arrays, "shares_memory", lambda device: False)
        tuning = replace(default_tuning(queue.device), pinned_copies=request.param)
        return Denoiser(SHAPE, queue=queue, tuning=tuning)

    @pytest.fixture
    def held_up(self, queue: cl.CommandQueue) -> Iterator[None]:
        """All that is put on the queue begins a little later."""
        go = cl.UserEvent(queue.context)
        cl.enqueue_barrier(queue, wait_for=[go])
        threading.Timer(0.1, go.set_status, [cl.command_execution_status.COMPLETE]).start()
        yield
        queue.finish()

    def test_pictures_are_the_same(self, den: Denoiser, queue: cl.CommandQueue) -> None:
        other = Denoiser(SHAPE, queue=queue)
        for frame in bumpy_sequence(FULL, count=3):
            assert_array_equal(den.denoise(frame), other.denoise(frame))
            den.denoise(frame, out=(out := cl_array.empty(queue, OUT, np.float32)))
            assert_array_equal(out.get(), other.denoise(frame))

    def test_tiles_are_uploaded_one_after_the_other(self, den: Denoiser, queue: cl.CommandQueue) -> None:
        settings, frames = Eaw(iterations=1), list(room_frames((60, 150), 2))
        inputs = Inputs.of(frames[0])
        least = Tiling(settings.pipeline(inputs), (60, 150), den.tuning.row_alignment).least()
        tiled = TiledDenoiser(
            (60, 150), inputs, settings=settings, queue=queue, tuning=den.tuning, max_bytes=int(1.2 * least)
        )
        assert tiled.tiles > 1
        other = Denoiser((60, 150), settings=settings, queue=queue)
        for frame in frames:
            assert_array_equal(tiled.denoise(frame), other.denoise(frame))

    def test_sizes_may_change(self, den: Denoiser) -> None:
        den.denoise(FRAME)
        den.resize((20, 30))
        frame = wall((20, 30))
        assert_array_equal(den.denoise(frame), Denoiser((20, 30)).denoise(frame))

    def test_the_host_does_not_wait_for_each(self, den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
        uploads: list[bool] = []

        def copy(queue: cl.CommandQueue, target: Any, source: Any, *, is_blocking: bool = True) -> cl.Event:
            if isinstance(target, cl.Buffer):
                uploads.append(is_blocking)
            return usual(queue, target, source, is_blocking=is_blocking)

        den.denoise(FRAME)
        usual = cl.enqueue_copy
        monkeypatch.setattr(cl, "enqueue_copy", copy)
        den.denoise(FRAME)
        assert uploads == [False] * len(FRAME.present())

    def test_fields_may_be_overwritten_afterwards(self, den: Denoiser, expected: np.ndarray, held_up: None) -> None:
        frame = mapped(FRAME, np.copy)
        out = cl_array.empty(den.queue, OUT, np.float32)
        den.denoise(frame, out=out)
        for value in frame.present().values():
            value.fill(0)
        assert_array_equal(out.get(), expected)

    def test_after_an_error_nothing_reads_the_fields(
        self, den: Denoiser, held_up: None, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        events = noted(monkeypatch)
        with broken_launch(3), pytest.raises(DeviceError):
            den.denoise(FRAME, out=cl_array.empty(den.queue, OUT, np.float32))
        if not den.tuning.pinned_copies:  # else these are not the arrays that are read
            assert_complete(events, len(FRAME.present()))

    def test_where_one_upload_fails_nothing_reads_the_others(
        self, den: Denoiser, held_up: None, monkeypatch: pytest.MonkeyPatch, expected: np.ndarray
    ) -> None:
        def fail(*_: object, **__: object) -> None:
            raise cl.LogicError("clEnqueueWriteBuffer failed: OUT_OF_RESOURCES")

        events = noted(monkeypatch)
        with failing("enqueue_copy", 2, fail), pytest.raises(DeviceError, match="the frame was not started"):
            den.denoise(FRAME)
        if not den.tuning.pinned_copies:
            assert_complete(events, 2)
        assert_array_equal(den.denoise(FRAME), expected)


def noted(monkeypatch: pytest.MonkeyPatch) -> list[cl.Event]:
    """The events of copies from now on."""
    usual, events = cl.enqueue_copy, []

    def copy(*arguments: Any, **options: Any) -> cl.Event:
        events.append(usual(*arguments, **options))
        return events[-1]

    monkeypatch.setattr(cl, "enqueue_copy", copy)
    return events


def assert_complete(events: list[cl.Event], count: int) -> None:
    done = cl.command_execution_status.COMPLETE
    assert [event.command_execution_status for event in events] == [done] * count


class TestOutput:
    def test_numpy_out_is_filled_and_returned(self, den: Denoiser, expected: np.ndarray) -> None:
        out = np.full(OUT, np.nan, np.float32)
        assert den.denoise(FRAME, out=out) is out
        assert_array_equal(out, expected)

    def test_array_out_is_filled_and_returned(self, den: Denoiser, expected: np.ndarray) -> None:
        out = cl_array.empty(den.queue, OUT, np.float32)
        assert den.denoise(FRAME, out=out) is out
        assert_array_equal(out.get(), expected)

    def test_numpy_out_of_arrays(self, den: Denoiser, expected: np.ndarray) -> None:
        out = np.empty(OUT, np.float32)
        den.denoise(on_device(FRAME, den.queue), out=out)
        assert_array_equal(out, expected)

    def test_results_do_not_share_memory(self, den: Denoiser) -> None:
        first = den.denoise(FRAME)
        kept = first.copy()
        den.denoise(wall(emission=0, albedo=1, id=1))
        assert_array_equal(first, kept)

    @pytest.mark.parametrize(
        ("out", "message"),
        [
            ([1.0], r"expected a numpy.ndarray or pyopencl.array.Array, got list"),
            (np.empty(SHAPE, np.float32), r"expected shape \(53, 37, 3\), float32, got shape \(53, 37\), float32"),
            (np.empty(OUT, np.float64), r"expected shape .*, float32, got shape \(53, 37, 3\), float64"),
            (np.empty(OUT[::-1], np.float32).T, r"expected a writable C-contiguous array"),
            (read_only(np.empty(OUT, np.float32)), r"expected a writable C-contiguous array"),
        ],
        ids=["list", "shape", "type", "order", "read-only"],
    )
    def test_what_cannot_be_written_is_refused(self, out: Any, message: str, den: Denoiser) -> None:
        with pytest.raises(ArgumentError, match=rf"^denoise\(out\): {message}"):
            den.denoise(FRAME, out=out)


def test_waits_for_events_before_arrays_are_read(den: Denoiser, expected: np.ndarray) -> None:
    frame = on_device(replace(FRAME, color=np.zeros_like(FRAME.color)), den.queue)
    den.queue.finish()
    go = cl.UserEvent(den.queue.context)
    renderer = cl.CommandQueue(den.queue.context)
    rendered = cl.enqueue_copy(renderer, frame.color.base_data, FRAME.color, wait_for=[go], is_blocking=False)
    renderer.flush()
    out = den.denoise(frame, wait_for=[rendered])
    go.set_status(cl.command_execution_status.COMPLETE)
    assert_array_equal(out.get(), expected)


def test_values_beyond_float32_are_no_light(den: Denoiser) -> None:
    color = np.full(OUT, 1e300)
    assert_allclose(den.denoise(replace(wall(), color=color)), 0)


def test_arrays_from_a_memory_pool_are_taken(expected: np.ndarray, den: Denoiser) -> None:
    pool = cl_tools.MemoryPool(cl_tools.ImmediateAllocator(den.queue))
    frame = mapped(FRAME, lambda value: cl_array.to_device(den.queue, value, allocator=pool))
    assert_array_equal(den.denoise(frame).get(), expected)


@pytest.mark.parametrize("name", ["color", "normal", "emission"])
def test_result_must_not_overwrite_a_field(name: str, den: Denoiser) -> None:
    frame = on_device(FRAME, den.queue)
    with pytest.raises(ArgumentError, match=rf"out\): expected memory of its own, got that of {name}"):
        den.denoise(frame, out=getattr(frame, name))


@pytest.mark.parametrize(("offset", "apart"), [(0, False), (1, False), (2, True)])
def test_result_must_not_overlap_a_field_in_one_buffer(offset: int, apart: bool, den: Denoiser) -> None:
    half = 1 << 14  # bytes; two hold an image, and on any device a part of a buffer may begin there
    buffer = cl.Buffer(den.queue.context, cl.mem_flags.READ_WRITE, 4 * half)
    color, out = (
        cl_array.Array(den.queue, OUT, np.float32, data=buffer.get_sub_region(begin * half, 2 * half))
        for begin in (0, offset)
    )
    color.set(FRAME.color)
    frame = replace(on_device(FRAME, den.queue), color=color)
    if apart:
        assert np.isfinite(den.denoise(frame, out=out).get()).all()
        return
    with pytest.raises(ArgumentError, match=r"out\): expected memory of its own, got that of color"):
        den.denoise(frame, out=out)


def test_a_field_still_being_computed_on_another_queue_is_waited_for(expected: np.ndarray, den: Denoiser) -> None:
    renderer = cl.CommandQueue(den.queue.context)
    frame = on_device(replace(FRAME, color=np.zeros_like(FRAME.color)), den.queue)
    den.queue.finish()
    go = cl.UserEvent(den.queue.context)
    rendered = cl.enqueue_copy(renderer, frame.color.base_data, FRAME.color, wait_for=[go], is_blocking=False)
    frame.color.add_event(rendered)
    out = den.denoise(frame)
    go.set_status(cl.command_execution_status.COMPLETE)
    assert_array_equal(out.get(), expected)


def test_an_array_finished_on_the_same_queue_is_not_waited_for(den: Denoiser, monkeypatch: pytest.MonkeyPatch) -> None:
    frame = on_device(FRAME, den.queue)
    assert frame.color.events
    monkeypatch.delattr(cl, "enqueue_barrier")
    den.denoise(frame)


def test_a_result_knows_when_it_is_ready(den: Denoiser) -> None:
    out = den.denoise(on_device(FRAME, den.queue))
    assert out.events
    cl.wait_for_events(out.events)


def test_a_refused_first_frame_leaves_no_trace(expected: np.ndarray, den: Denoiser) -> None:
    with pytest.raises(ArgumentError):
        den.denoise(wall(), out=np.empty((1, 1), np.float32))
    assert_array_equal(den.denoise(FRAME), expected)
