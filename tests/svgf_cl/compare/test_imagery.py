"""Pictures, clips and profiles are files of what was made."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest
from PIL import Image

from svgf_cl.compare.imagery import Piece, clip, encoded, error_map, profile

RAMP = np.broadcast_to(np.linspace(0, 255, 40).astype(np.uint8)[None, :, None], (30, 40, 3))


def opened(file: bytes | None) -> Image.Image:
    assert file is not None
    return Image.open(io.BytesIO(file))


def test_a_piece_is_a_part_of_a_picture() -> None:
    piece = Piece(np.s_[6:12], np.s_[10:20])
    assert piece.crop == (10, 6, 10, 6)
    assert piece.row == 9
    np.testing.assert_array_equal(piece.of(RAMP), RAMP[6:12, 10:20])


def test_a_picture_comes_out_as_it_went_in() -> None:
    file = opened(encoded(np.ascontiguousarray(RAMP)))
    assert file.format == "WEBP"
    np.testing.assert_allclose(np.asarray(file.convert("RGB")), RAMP, atol=8)


def test_a_picture_too_large_for_webp_is_a_png() -> None:
    file = opened(encoded(np.zeros((1, 16384, 3), np.uint8)))
    assert (file.format, file.size) == ("PNG", (16384, 1))


def test_a_clip_shows_every_piece() -> None:
    levels = (0, 128, 255)
    file = opened(clip([np.full((30, 20, 3), level, np.uint8) for level in levels]))
    assert (file.size, file.n_frames, file.info["loop"]) == ((20, 30), 3, 0)
    for number, level in enumerate(levels):
        file.seek(number)
        np.testing.assert_allclose(np.asarray(file.convert("RGB")), level, atol=4)


def test_a_profile_is_one_row_over_time() -> None:
    rows = [np.full((40, 3), level, np.uint8) for level in (0, 255)]
    file = opened(profile(rows))
    assert file.size == (40, 12)
    columns = np.asarray(file.convert("RGB"))[:, 20, 0].astype(int)
    assert columns[:4].max() < 40
    assert columns[-4:].min() > 215


def test_an_error_map_is_bright_where_pictures_differ() -> None:
    pytest.importorskip("flip_evaluator")
    wanted = np.zeros((30, 40, 3), np.uint8)
    picture = wanted.copy()
    picture[:, 20:] = 255
    light = np.asarray(opened(error_map(picture, wanted)).convert("L")).astype(int)
    assert light[:, 30:].min() > light[:, :10].max() + 50


def test_without_flip_there_is_no_error_map(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    assert error_map(RAMP, RAMP) is None
