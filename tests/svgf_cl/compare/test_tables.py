"""Tables say what was found, and leave blank what is not there."""

from __future__ import annotations

import math

from svgf_cl.compare.measures import MEASURES
from svgf_cl.compare.page import Entry, Page, Scene
from svgf_cl.compare.tables import frame_table, scene_table

VALUES = {"psnr": 40.0, "ssim": 0.99, "relmse": 0.01, "ghost": math.nan, "lag": math.inf, "edges": 1.0}
CURVES = {"psnr": [30.0, math.inf], "ssim": [0.98, 1.0], "relmse": [0.02, 0.0]}
ENTRIES = [
    Entry("svgf", VALUES, CURVES, 1.25, b"", None, None, None),
    Entry("noisy", {"psnr": 20.0}, {}, None, b"", None, None, None),
    Entry("reference", {}, {}, None, b"", None, None, None),
]


def shown(*entries: Entry) -> tuple[Page, Scene]:
    measures = [each for each in MEASURES if each.key in VALUES]
    scene = Scene("swing", "", (8, 9), 8, (18, 32), None, None, entries, "reference")
    return Page("", {}, measures, [scene]), scene


def test_a_scene_has_a_row_for_each_filter_but_none_for_the_reference() -> None:
    columns, rows = scene_table(*shown(*ENTRIES))
    assert columns == ["filter", "PSNR, dB", "SSIM", "ghost", "lag, frames", "ms"]
    assert rows == [["svgf", "40.00", "0.990", "", "∞", "1.2"], ["noisy", "20.00", "", "", "", ""]]


def test_pictures_have_a_row_for_each_frame_and_one_for_all() -> None:
    columns, rows = frame_table(*shown(ENTRIES[0], ENTRIES[2]))
    assert columns == ["frame", "PSNR, dB", "SSIM", "relMSE"]
    assert rows == [
        ["8", "30.00", "0.980", "0.0200"],
        ["9", "∞", "1.000", "0.0000"],
        ["all", "40.00", "0.990", "0.0100"],
    ]
