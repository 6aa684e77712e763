"""`check_frame`, `check_sequence` and what they report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest

from svgf_cl import Frame, FrameError, check_frame, check_sequence
from svgf_cl.check import CHECKS, Inspection, camera, depth, motion, shading, surfaces, values
from svgf_cl.check.check import Check
from svgf_cl.check.finding import EXPECTED, Finding, Unknown
from svgf_cl.frame import CARRIED, CHANNELS
from svgf_cl.io.synthetic import room_frames
from tests.arrays import STRIDED
from tests.frames import TINY, bumpy, noise, only, wall

SHAPE = (180, 320)


@pytest.fixture(scope="module")
def room() -> list[Frame]:
    return list(room_frames(SHAPE, 4))


def test_each_check_is_a_finding_or_unknown_or_passed(room: list[Frame]) -> None:
    report = check_sequence(room)
    topics = [*{unknown.topic for unknown in report.unknown}, *report.passed]
    assert sorted(topics) == sorted(check.topic for check in CHECKS)


def test_a_single_frame_tells_nothing_of_motion(room: list[Frame]) -> None:
    report = check_frame(room[0])
    assert not report.findings
    untold = {unknown.topic for unknown in report.unknown}
    assert untold >= {check.topic for check in CHECKS if check.frames == 2}
    assert depth.ENCODING.topic in report.passed


def test_a_pair_tells_of_motion(room: list[Frame]) -> None:
    wrong = replace(room[1], motion=room[1].motion * np.float32([-1, -1, 1]))
    assert check_frame(wrong, room[0]).findings[0].what == "points the other way"
    assert motion.DIRECTION.topic in check_frame(room[1], room[0]).passed


def test_a_finding_says_all_there_is_to_say(room: list[Frame]) -> None:
    wrong = [replace(frame, motion=frame.motion * np.float32([-1, -1, 1])) for frame in room]
    (finding,) = check_sequence(wrong).findings
    assert (finding.field, finding.severity, finding.cure) == ("motion", "error", "negate it")
    assert "previous minus current" in finding.expected
    assert any(character.isdigit() for character in finding.measured)
    for part in (finding.field, finding.what, finding.measured, finding.expected, finding.cure):
        assert part in str(finding)


def test_what_relies_on_a_wrong_field_is_put_off(room: list[Frame]) -> None:
    wrong = [replace(frame, motion=frame.motion * np.float32([-1, -1, 1])) for frame in room]
    untold = {unknown.topic: unknown.why for unknown in check_sequence(wrong).unknown}
    assert untold[surfaces.NAMES.topic] == "correct motion first"


def test_frames_on_both_sides_of_a_cut_are_not_compared(room: list[Frame]) -> None:
    inspection = Inspection()
    for frame in (*room[:2], *[replace(frame, motion=-frame.motion) for frame in room[3:1:-1]]):
        inspection.cut()
        inspection.add(frame)
    report = inspection.report()
    assert not report.findings
    assert {unknown.why for unknown in report.unknown} >= {"it needs 2 consecutive frames"}


def test_a_warning_puts_nothing_off() -> None:
    def judge(total: np.ndarray) -> list[Finding]:
        return [Finding("albedo", "odd", "1", "nothing", "warning")]

    check = Check("topic", lambda view: np.ones(1), judge, trusts=("albedo",))
    assert check.verdict(np.ones(1), set(), 1) == judge(np.ones(1))
    assert check.verdict(np.ones(1), {"albedo"}, 1) == [Unknown("topic", "correct albedo first")]


@pytest.mark.parametrize("field", ["normal", "depth", "motion"])
def test_a_missing_field_is_named(room: list[Frame], field: str) -> None:
    with pytest.raises(FrameError, match=field):
        check_frame(replace(room[0], **{field: None}))


def test_a_frame_of_another_size_is_refused(room: list[Frame]) -> None:
    with pytest.raises(FrameError, match=r"\(9, 7, 3\)"):
        check_sequence([room[0], wall((9, 7))])


def test_frames_on_a_device_are_as_good(room: list[Frame], queue: cl.CommandQueue) -> None:
    there = [
        Frame(**{name: cl_array.to_device(queue, value) for name, value in frame.present().items()}) for frame in room
    ]
    assert check_sequence(there) == check_sequence(room)


def test_frames_without_optional_fields_are_checked(room: list[Frame]) -> None:
    bare = [Frame(color=f.color, normal=f.normal, depth=f.depth, motion=f.motion[..., :2].copy()) for f in room]
    report = check_sequence(bare)
    assert not report.findings
    assert {surfaces.NAMES.topic, values.ALBEDO.topic} <= {unknown.topic for unknown in report.unknown}
    assert camera.JITTER.topic in report.passed


@pytest.mark.parametrize("given", [(), ("albedo",), ("id", "roughness"), ("diffuse", "specular"), CARRIED])
def test_what_was_not_there_has_not_passed(given: tuple[str, ...]) -> None:
    frame = bumpy(np.random.default_rng(1))
    report = check_frame(only(frame, ("color", *given)))
    there = {"color", "normal", "depth", "motion", *given}
    assert set(report.looked_at[values.FINITE.topic]) == there - {"id"}
    assert all(set(fields) <= there for topic, fields in report.looked_at.items() if topic != shading.PARTS.topic)
    for check, needed in ((values.ALBEDO, "albedo"), (values.ROUGHNESS, "roughness"), (shading.PARTS, "diffuse")):
        assert (check.topic in {unknown.topic for unknown in report.unknown}) == (needed not in given)


@pytest.mark.parametrize("field", [name for name in CHANNELS if name != "id"])
def test_no_field_passes_unseen(field: str) -> None:
    """Nothing but NaN in it is noticed, whichever field it is."""
    frame = bumpy(np.random.default_rng(1))
    broken = replace(frame, **{field: np.full_like(getattr(frame, field), np.nan)})
    assert field in {finding.field for finding in check_frame(broken).findings}


def test_every_field_is_explained() -> None:
    assert EXPECTED.keys() == CHANNELS.keys()


@pytest.mark.parametrize(("kind", "great"), [(np.int64, 2**32), (np.uint64, 2**64 - 1), (np.int64, -(2**31) - 1)])
def test_an_id_that_32_bits_cannot_hold_is_refused(kind: type, great: int) -> None:
    ids = np.ones(TINY, kind)
    ids[3, 3] = great
    with pytest.raises(FrameError, match=rf"Frame\.id: expected ids in 0\.\.4294967295, .* got {great}"):
        check_frame(replace(wall(TINY), id=ids))


def test_parts_stand_in_for_color() -> None:
    frames = [replace(frame, color=None) for frame in room_frames(SHAPE, 3, signals=2)]
    assert not check_sequence(frames).findings


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (2, 2), (7, 9)])
def test_tiny_frames_raise_no_alarm(shape: tuple[int, int]) -> None:
    assert not check_sequence([wall(shape, color=noise(shape=shape))] * 2).findings


def test_frames_without_any_surface_raise_no_alarm() -> None:
    sky = wall(color=noise(), normal=0.0, depth=np.inf, albedo=1.0, id=0)
    assert not check_sequence([sky] * 2).findings


@pytest.mark.parametrize("form", STRIDED)
def test_how_arrays_lie_on_a_device_does_not_matter(form: Callable, room: list[Frame], queue: cl.CommandQueue) -> None:
    wrong = replace(room[1], motion=room[1].motion * np.float32([-1, -1, 1]))
    fields = {name: form(queue, value) for name, value in wrong.present().items()}
    assert str(check_frame(Frame(**fields), room[0])) == str(check_frame(wrong, room[0]))


def test_alpha_is_not_looked_at(room: list[Frame]) -> None:
    rgba = np.concatenate([room[0].color, np.full((*SHAPE, 1), np.nan, np.float32)], axis=-1)
    assert str(check_frame(replace(room[0], color=rgba))) == str(check_frame(room[0]))
