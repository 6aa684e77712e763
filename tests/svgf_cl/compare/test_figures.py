"""Figures show all entries in a row, a piece of each below, and have names that any system takes."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from svgf_cl.compare.figures import WIDTH, figure, file_name
from svgf_cl.compare.page import Entry, Scene
from svgf_cl.io.panels import GAP, LABEL_HEIGHT


def png(picture: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "PNG")
    return file.getvalue()


def marked(height: int, width: int, level: int) -> bytes:
    """A picture that is brighter by 100 in its right lower quarter."""
    picture = np.full((height, width, 3), level, np.uint8)
    picture[height // 2 :, width // 2 :] += 100
    return png(picture)


def scene(height: int, width: int, crop: tuple[int, int, int, int] | None) -> Scene:
    pictures = {"a": marked(height, width, 10), "reference": marked(height, width, 120)}
    entries = [Entry(name, {}, {}, None, file, None, None, None) for name, file in pictures.items()]
    return Scene("room", "", (0,), 0, (height, width), crop, None, entries, "reference")


def test_all_are_in_a_row_with_a_piece_of_each_below() -> None:
    found = figure(scene(20, 40, (20, 10, 20, 5)))
    assert found.shape == (LABEL_HEIGHT + 20 + GAP + 10, 2 * 40 + GAP, 3)
    whole = found[LABEL_HEIGHT : LABEL_HEIGHT + 20]
    assert {*whole[:10, :40].ravel()} == {10}
    assert {*whole[10:, 20:40].ravel()} == {110}
    assert {*whole[:10, 40 + GAP :].ravel()} == {120}
    piece = found[LABEL_HEIGHT + 20 + GAP :]
    assert {*piece[:, :40].ravel()} == {110}
    assert {*piece[:, 40 + GAP :].ravel()} == {220}


def test_the_noisy_frame_comes_first() -> None:
    one = scene(20, 40, None)
    noisy = Entry("noisy", {}, {}, None, marked(20, 40, 60), None, None, None)
    found = figure(replace(one, entries=[one.entries[0], noisy, one.entries[1]], noisy="noisy"))
    assert [int(found[LABEL_HEIGHT, number * (40 + GAP), 0]) for number in range(3)] == [60, 10, 120]


def test_without_a_piece_there_are_pictures_alone() -> None:
    assert figure(scene(20, 40, None)).shape == (LABEL_HEIGHT + 20, 2 * 40 + GAP, 3)


@pytest.mark.parametrize(("height", "width", "expected"), [(200, 960, 100), (3, 4800, 1)])
def test_large_pictures_are_reduced_and_pieces_are_not(height: int, width: int, expected: int) -> None:
    found = figure(scene(height, width, (width // 2, height // 2, 48, 1)))
    assert found.shape == (LABEL_HEIGHT + expected + GAP + WIDTH // 48, 2 * WIDTH + GAP, 3)
    assert {*found[-5:, :WIDTH].ravel()} == {110}


def test_webp_is_read_too() -> None:
    file = io.BytesIO()
    Image.new("RGB", (16, 12), (50, 50, 50)).save(file, "WEBP")
    plain = scene(12, 16, None)
    found = figure(replace(plain, entries=[replace(plain.entries[0], picture=file.getvalue())]))
    np.testing.assert_allclose(found[LABEL_HEIGHT:], 50, atol=3)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("swing", "03.swing.png"),
        (".hidden", "03._hidden.png"),
        ("con", "03.con.png"),
        ('a/b\\c:d*e?f"g<h>i|j\n', "03.a_b_c_d_e_f_g_h_i_j_.png"),
        ("living room.glb", "03.living_room_glb.png"),
        ("br\udcfccke", "03.br_cke.png"),
        ("Brücke", "03.Brücke.png"),
        ("", "03..png"),
    ],
)
def test_names_are_such_as_any_system_takes(name: str, expected: str) -> None:
    assert file_name(3, name) == expected


def test_names_are_short_enough_for_any_file_system() -> None:
    assert len(file_name(100, 500 * "\U00020000").encode()) < 200
