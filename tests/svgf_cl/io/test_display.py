"""Exposure, tone mapping and picture files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813  # its documentation calls it so
import pytest

from svgf_cl import FileError
from svgf_cl.frame import LUMINANCE
from svgf_cl.io import display

RNG = np.random.default_rng(5)


@pytest.mark.parametrize(("linear", "shown"), [(-1, 0), (0, 0), (0.002, 0.02584), (0.214041, 0.5), (1, 1), (9, 1)])
def test_the_srgb_curve(linear: float, shown: float) -> None:
    assert display.display(np.full((1, 1, 3), linear)) == pytest.approx(np.full((1, 1, 3), shown), abs=1e-6)


def test_exposure_is_in_stops() -> None:
    linear = RNG.random((4, 4, 3))
    np.testing.assert_array_equal(display.display(linear, 2), display.display(4 * linear))


def test_nan_is_shown_black_and_infinity_white() -> None:
    linear = np.array([[[np.nan, np.inf, -np.inf]]])
    assert display.to_bytes(linear).tolist() == [[[0, 255, 0]]]


def test_automatic_exposure_brings_the_log_average_to_middle_grey() -> None:
    blocks = RNG.lognormal(size=(3, 4, 1)) * np.array([1.0, 0.5, 0.2])
    linear = blocks.repeat(display.BLOCK, 0).repeat(display.BLOCK, 1)[:-3, :-5]  # the last blocks are cut
    luminance = (blocks * 2.0 ** display.automatic_exposure(linear)) @ np.array(LUMINANCE)
    assert np.exp(np.log(luminance).mean()) == pytest.approx(0.18)


def test_noise_and_black_borders_leave_the_automatic_exposure_as_it_is() -> None:
    linear = np.full((256, 256, 3), 0.3)
    noisy = linear * RNG.exponential(size=(256, 256, 1))
    bordered = np.pad(linear, ((0, 0), (16, 16), (0, 0)))
    expected = np.log2(0.18 / 0.3)
    assert display.automatic_exposure(noisy) == pytest.approx(expected, abs=0.05)
    assert display.automatic_exposure(bordered) == pytest.approx(expected)
    assert display.automatic_exposure(np.zeros((4, 4, 3))) == 0.0


def test_png_comes_back(tmp_path: Path) -> None:
    picture = RNG.integers(0, 256, (5, 7, 3), np.uint8)
    display.write_image(tmp_path / "a.png", picture)
    np.testing.assert_array_equal(oiio.ImageBuf(str(tmp_path / "a.png")).get_pixels(oiio.UINT8), picture)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def test_webp_comes_back_nearly(tmp_path: Path) -> None:
    picture = np.linspace(0, 255, 3 * 32 * 32).reshape(32, 32, 3).astype(np.uint8)
    display.write_image(tmp_path / "a.webp", picture)
    assert (tmp_path / "a.webp").read_bytes()[8:12] == b"WEBP"
    back = oiio.ImageBuf(str(tmp_path / "a.webp")).get_pixels(oiio.UINT8).astype(float)
    assert np.abs(back - picture).mean() < 4.0


def test_an_unwritable_picture_is_an_error_that_names_it(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match=r"file/a\.png: cannot be written"):
        display.write_image(tmp_path / "file" / "a.png", np.zeros((2, 2, 3), np.uint8))
