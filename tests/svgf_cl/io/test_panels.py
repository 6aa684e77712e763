"""The pictures that show what was gained."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from svgf_cl.io import panels as pictures

RNG = np.random.default_rng(5)


def noise(height: int, width: int) -> np.ndarray:
    return RNG.integers(0, 256, (height, width, 3), np.uint8)


def test_the_preview_is_animated_and_loops(tmp_path: Path) -> None:
    pictures.write_preview(tmp_path / "a.webp", (noise(16, 32) for _ in range(3)))
    with Image.open(tmp_path / "a.webp") as preview:
        assert (preview.size, preview.n_frames, preview.info["loop"]) == ((32, 16), 3, 0)


def test_panels_stand_side_by_side_under_their_labels() -> None:
    left, right = noise(20, 30), noise(20, 30)
    sheet = pictures.side_by_side({"left": left, "right": right})
    np.testing.assert_array_equal(sheet[-20:, :30], left)
    np.testing.assert_array_equal(sheet[-20:, -30:], right)
    assert sheet[:-20, :30].any()
    assert sheet[:-20, -30:].any()


def test_a_long_label_keeps_to_its_own_panel() -> None:
    sheet = pictures.side_by_side({"far too long for this": noise(20, 60), "": noise(20, 60)})
    label = sheet[: pictures.LABEL_HEIGHT]
    assert label[:, :60].any()
    assert not label[:, 60:].any()


def test_a_sheet_has_every_panel_in_rows() -> None:
    panels = {f"panel {index}": noise(20, 60) for index in range(5)}
    sheet = pictures.contact_sheet(panels)
    down, across = pictures.LABEL_HEIGHT + 20 + pictures.GAP, 60 + pictures.GAP
    assert sheet.shape == (2 * down, 3 * across - pictures.GAP, 3)
    for index, panel in enumerate(panels.values()):
        top, left = index // 3 * down + pictures.LABEL_HEIGHT, index % 3 * across
        np.testing.assert_array_equal(sheet[top : top + 20, left : left + 60], panel)
    assert not sheet[down:, 2 * across :].any()


def test_the_still_magnifies_where_the_last_two_panels_differ_most() -> None:
    reference = noise(40, 80)
    tested = reference.copy()
    tested[12, 65] ^= 255
    assert pictures.worst_piece(tested, reference) == np.s_[10:20, 60:80]
    sheet = pictures.still({"noisy": noise(40, 80), "denoised": tested, "reference": reference})
    np.testing.assert_array_equal(sheet[-40::4, -80::4], reference[10:20, 60:80])


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (17, 33)])
def test_stills_of_any_size(size: tuple[int, int]) -> None:
    sheet = pictures.still({name: noise(*size) for name in ("noisy", "denoised", "reference")})
    assert sheet.shape[0] == 2 * size[0] + pictures.LABEL_HEIGHT + pictures.GAP
