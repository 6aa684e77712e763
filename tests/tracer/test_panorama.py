from __future__ import annotations

import os
import struct
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from svgf_cl.io.window import Window
from svgf_cl_tracer import SceneError, load_environment, panorama
from tests.exr_files import exr_bytes
from tests.tracer.gltf_files import png

PIXELS = np.arange(24, dtype=np.float32).reshape(2, 4, 3)


def write(path: Path, pixels: np.ndarray) -> Path:
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "float")
    image = oiio.ImageBuf(spec)
    image.set_pixels(spec.roi, pixels)
    image.write(str(path))
    return path


@pytest.mark.parametrize("name", ["a.hdr", "a.exr"])
def test_what_was_written_is_read(tmp_path: Path, name: str) -> None:
    turn = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    environment = load_environment(write(tmp_path / name, PIXELS), turn)
    np.testing.assert_allclose(environment.image, PIXELS, atol=0.1)  # .hdr has 8 bits
    np.testing.assert_array_equal(environment.to_world, turn)


def test_a_fourth_channel_is_left_out(tmp_path: Path) -> None:
    path = write(tmp_path / "a.exr", np.concatenate([PIXELS, PIXELS[..., :1]], axis=2))
    np.testing.assert_array_equal(load_environment(path).image, PIXELS)


def test_too_large_a_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panorama, "MAX_PIXELS", 7)
    with pytest.raises(SceneError, match=r"a\.exr: expected at most 7 pixels, got 4x2 at 0,0"):
        load_environment(write(tmp_path / "a.exr", PIXELS))


@pytest.mark.parametrize("name", ["a.hdr", "a.exr"])
def test_a_damaged_file_is_named(tmp_path: Path, name: str) -> None:
    path = write(tmp_path / name, np.ones((64, 64, 3), np.float32) * np.arange(64, dtype=np.float32)[:, None])
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(SceneError, match=f"{name}: expected"):
        load_environment(path)


def test_no_memory_is_taken_for_what_a_header_claims(tmp_path: Path) -> None:
    path = tmp_path / "a.hdr"
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 60000\n" + bytes(1000))
    with pytest.raises(SceneError, match=r"a\.hdr: expected .* from a 1053 byte file|in a file of 1053"):
        load_environment(path)


def test_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"a\.hdr: expected a file"):
        load_environment(tmp_path / "a.hdr")
    (tmp_path / "a.png").write_bytes(png(np.zeros((2, 2, 3))))
    with pytest.raises(SceneError, match=r"expected a Radiance HDR file or an OpenEXR file, got the format png"):
        load_environment(tmp_path / "a.png")
    os.mkfifo(tmp_path / "pipe.hdr")
    for name in (".", "pipe.hdr"):
        with pytest.raises(SceneError, match=r"found something that is not a file"):
            load_environment(tmp_path / name)
    (tmp_path / "a.exr").write_bytes(b"nothing of the kind")
    with pytest.raises(SceneError, match=r"a\.exr: expected a Radiance HDR file"):
        load_environment(tmp_path / "a.exr")


@pytest.mark.parametrize(
    ("value", "mended", "words"),
    [
        (-1e-9, 0.0, "1 pixel negative, now 0"),
        (-np.inf, 0.0, "1 pixel negative, now 0"),
        (np.nan, 0.0, "1 pixel NaN, now 0"),
        (np.inf, 23.0, "1 pixel infinite, now 23 as the brightest finite one"),
    ],
)
@pytest.mark.parametrize("name", ["R", "G", "B"])
def test_what_is_no_radiance_is_mended_and_said(
    name: str, value: float, mended: float, words: str, tmp_path: Path
) -> None:
    pixels, expected = PIXELS.copy(), PIXELS.copy()
    pixels[0, 1, "RGB".index(name)], expected[0, 1, "RGB".index(name)] = value, mended
    with pytest.warns(UserWarning, match=rf"a\.exr: mended in this sky: {words}$"):
        environment = load_environment(write(tmp_path / "a.exr", pixels))
    np.testing.assert_array_equal(environment.image, expected)


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf, -np.inf])
def test_an_image_with_no_radiance_at_all_is_refused(value: float, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"a\.exr: .*expected .*radiance, got none"):
        load_environment(write(tmp_path / "a.exr", np.full_like(PIXELS, value)))


@pytest.mark.filterwarnings("error")
def test_a_black_sky_is_one(tmp_path: Path) -> None:
    assert not load_environment(write(tmp_path / "a.exr", np.zeros_like(PIXELS))).image.any()


def test_the_picture_is_found_by_name_and_lies_on_its_display_window(tmp_path: Path) -> None:
    planes = {f"Beauty.{name}": PIXELS[..., index] for index, name in enumerate("RGB")}
    planes["A_depth.Z"] = np.full((2, 4), 7, np.float32)
    (tmp_path / "a.exr").write_bytes(exr_bytes(planes, at=(2, -1), display=Window(0, 0, 8, 4)))
    expected = np.zeros((4, 8, 3), np.float32)
    expected[0, 2:6] = PIXELS[1]
    np.testing.assert_array_equal(load_environment(tmp_path / "a.exr").image, expected)


def test_an_image_that_is_grey_or_has_no_picture(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(exr_bytes({"Y": PIXELS[..., 0]}))
    np.testing.assert_array_equal(load_environment(tmp_path / "a.exr").image, PIXELS[..., :1].repeat(3, axis=-1))
    (tmp_path / "a.exr").write_bytes(exr_bytes(dict.fromkeys(("X", "Y", "Z"), PIXELS[..., 0])))
    with pytest.raises(SceneError, match=r"a\.exr: expected channels R G B, .*; found X Y Z"):
        load_environment(tmp_path / "a.exr")


def test_other_primaries_are_converted(tmp_path: Path) -> None:
    """The corners of a cube of colours, in ACEScg."""
    corners = np.indices((2, 2, 2)).reshape(3, 2, 4).transpose(1, 2, 0).astype(np.float32)
    attribute = "chromaticities", struct.pack("<8f", 0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    planes = {name: np.ascontiguousarray(corners[..., index]) for index, name in enumerate("RGB")}
    (tmp_path / "a.exr").write_bytes(exr_bytes(planes, {"chromaticities": attribute}))
    with pytest.warns(UserWarning, match=r"a\.exr: mended in this sky: 6 pixels negative, now 0"):
        image = load_environment(tmp_path / "a.exr").image
    # The matrix from AP1 to Rec. 709 that the Academy publishes, to four digits.
    matrix = [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]]
    np.testing.assert_allclose(image, np.maximum(corners @ np.transpose(matrix), 0.0), atol=2e-4)


@pytest.mark.parametrize("chromaticities", [(0.0,) * 8, (0.3, 0.3) * 4, (np.nan,) * 8])
def test_primaries_that_no_colours_have_are_refused(chromaticities: tuple[float, ...], tmp_path: Path) -> None:
    attribute = "chromaticities", struct.pack("<8f", *chromaticities)
    planes = {name: np.ascontiguousarray(PIXELS[..., index]) for index, name in enumerate("RGB")}
    (tmp_path / "a.exr").write_bytes(exr_bytes(planes, {"chromaticities": attribute}))
    with pytest.raises(SceneError, match=r"a\.exr: sky: expected chromaticities of three primaries and a white"):
        load_environment(tmp_path / "a.exr")
