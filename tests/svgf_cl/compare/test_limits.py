"""Limits are read from texts, and what is beyond one is said."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import pytest

from svgf_cl.compare.limits import Limits
from svgf_cl.compare.page import Entry, Scene
from svgf_cl.errors import SvgfError
from svgf_cl.gate import Check


def entry(rival: str, values: Mapping[str, float | None], **curves: Sequence[float]) -> Entry:
    return Entry(rival, values, curves, None, b"", None, None, None)


def scene(*entries: Entry) -> Scene:
    return Scene("room", "", (8, 9), 8, (18, 32), None, None, entries, "reference")


GOOD = entry("good", {"psnr": 40.0, "ssim": 0.99, "relmse": 0.001, "ghost": 0.1, "lag": 3.0})
BAD = entry(
    "bad",
    {"psnr": 20.0, "relmse": 0.1, "ghost": math.nan, "temporal": 0.02},
    psnr=[30.0, 10.0],
    temporal=[math.nan, 0.02],
)
SCENE = scene(GOOD, BAD)


def complaints(below: str, above: str, rival: str, *, each_frame: bool = False) -> list[str]:
    checks = Limits.parse(below, above).checks(SCENE, rival, each_frame=each_frame)
    return [f"{check.group} {check.name}: {check.complaint}" for check in checks if check.complaint]


def test_both_sides_are_read() -> None:
    limits = Limits.parse("psnr=30,ssim=.9", "relmse=1e-2,lag=inf")
    assert limits == Limits({"psnr": 30.0, "ssim": 0.9}, {"relmse": 0.01, "lag": math.inf})
    assert limits
    assert not Limits.parse("", "")
    assert Limits.parse("", "lag=0")


def test_what_is_within_its_limits_passes() -> None:
    found = list(Limits.parse("psnr=40,ssim=0.99", "relmse=0.001,ghost=0.1").checks(SCENE, "good"))
    assert found == [Check(key, "room.good") for key in ("psnr", "ssim", "relmse", "ghost")]


def test_what_is_beyond_a_limit_is_said_in_the_words_of_its_measure() -> None:
    assert complaints("psnr=41,ssim=0.995", "relmse=0,ghost=0.05,lag=2", "good") == [
        "room.good psnr: PSNR 40.00 dB is below 41 dB",
        "room.good ssim: SSIM 0.990 is below 0.995",
        "room.good relmse: relMSE 0.0010 is above 0",
        "room.good ghost: ghost 10% is above 5%",
        "room.good lag: lag 3 frames is above 2 frames",
    ]


@pytest.mark.parametrize("key", ["ghost", "flip"])
def test_what_was_not_measured_is_beyond_all(key: str) -> None:
    for below, above in ((f"{key}=-inf", ""), ("", f"{key}=inf")):
        (complaint,) = complaints(below, above, "bad")
        assert "was not measured" in complaint


def test_limits_may_hold_for_every_frame() -> None:
    assert complaints("psnr=15", "", "bad") == []
    assert complaints("psnr=15", "", "bad", each_frame=True) == ["room 9 psnr: PSNR 10.00 dB is below 15 dB"]


def test_what_is_no_figure_of_one_frame_is_held_to_its_limit_once() -> None:
    """The first frame has no temporal error, which is no fault."""
    assert complaints("", "temporal=0.03", "bad", each_frame=True) == []
    (complaint,) = complaints("", "temporal=0.01", "bad", each_frame=True)
    assert complaint.startswith("room.bad temporal: temporal 0.02000 is above 0.01")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("sharpness=1", "a measure among psnr, ssim, .*, got 'sharpness=1'"),
        ("psnr=30, ssim=1", "got ' ssim=1'"),
        ("psnr", "psnr: expected a number, got ''"),
        ("psnr=high", "psnr: expected a number, got 'high'"),
        ("psnr=nan", "psnr: expected a number, got nan"),
        ("psnr=1,ssim=1,psnr=2", "each measure once, got psnr twice"),
    ],
)
def test_what_is_no_limit_is_refused(text: str, complaint: str) -> None:
    with pytest.raises(SvgfError, match=f"--fail-below.*{complaint}"):
        Limits.parse(text, "")
    with pytest.raises(SvgfError, match=f"--fail-above.*{complaint}"):
        Limits.parse("psnr=1", text)
