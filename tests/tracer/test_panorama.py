from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from svgf_cl_tracer import SceneError, load_environment, panorama
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
    with pytest.raises(SceneError, match=r"a\.exr: expected three channels and at most 7 pixels, got 3 and 4 x 2"):
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
    (tmp_path / "a.exr").write_bytes(b"nothing of the kind")
    with pytest.raises(SceneError, match=r"a\.exr: expected a Radiance HDR file"):
        load_environment(tmp_path / "a.exr")


def test_what_is_no_radiance_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"a\.exr: sky: expected finite radiance"):
        load_environment(write(tmp_path / "a.exr", -PIXELS))
