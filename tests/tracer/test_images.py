from __future__ import annotations

import io
import struct
import warnings
import zlib
from typing import Any

import numpy as np
import PIL.Image
import pytest
from numpy.typing import ArrayLike

from svgf_cl_tracer import SceneError, images
from svgf_cl_tracer.images import Images
from svgf_cl_tracer.textures import Image

GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6  # PNG's colour types
COLOURS = np.array([[(255, 0, 0), (10, 20, 30)], [(1, 2, 3), (250, 128, 7)]], np.uint8)
OPACITY = np.array([[255, 0], [128, 1]], np.uint8)


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(size: tuple[int, int], depth: int, kind: int, rows: bytes, *more: bytes) -> bytes:
    """A PNG whose unfiltered `rows`, each behind a zero, are packed as the format has them."""
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", *size, depth, kind, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + b"".join(more) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def row(depth: int, kind: int, width: int, values: ArrayLike, *more: bytes) -> bytes:
    """A PNG of one row with these `values`, of 8 or 16 bits."""
    return png((width, 1), depth, kind, b"\0" + np.asarray(values, f">u{depth // 8}").tobytes(), *more)


def saved(pixels: ArrayLike, kind: str, mode: str | None = None, **options: Any) -> bytes:
    image = PIL.Image.fromarray(np.asarray(pixels))
    stream = io.BytesIO()
    (image.convert(mode) if mode else image).save(stream, kind, **options)
    return stream.getvalue()


def decoded(encoded: bytes) -> Image:
    pixels = Images().pixels("a", lambda: encoded)
    assert pixels.dtype == np.uint8
    return pixels


def key(*values: int) -> bytes:
    """The chunk that names a transparent colour."""
    return chunk(b"tRNS", struct.pack(f">{len(values)}H", *values))


COLOURS_OF_PALETTE = chunk(b"PLTE", bytes([255, 0, 0, 0, 255, 0]))


@pytest.mark.parametrize(
    ("encoded", "expected"),
    [
        pytest.param(row(8, GREY, 2, [7, 200]), [[7] * 3, [200] * 3], id="grey"),
        pytest.param(row(16, GREY, 2, [0x8000, 0x12FF]), [[0x80] * 3, [0x12] * 3], id="grey of 16 bits"),
        pytest.param(row(16, RGB, 1, [0x8000, 0x12FF, 0xFFFF]), [[0x80, 0x12, 0xFF]], id="RGB of 16 bits"),
        pytest.param(row(16, GREY_ALPHA, 1, [0x8000, 0x12FF]), [[0x80] * 3 + [0x12]], id="grey and alpha of 16 bits"),
        pytest.param(row(16, RGBA, 1, [0x8000, 0x1234, 0, 0x4000]), [[0x80, 0x12, 0, 0x40]], id="RGBA of 16 bits"),
        pytest.param(png((3, 1), 1, GREY, b"\0\xa0"), [[255] * 3, [0] * 3, [255] * 3], id="grey of 1 bit"),
        pytest.param(png((2, 1), 2, GREY, b"\0\x60"), [[85] * 3, [170] * 3], id="grey of 2 bits"),
        pytest.param(png((2, 1), 4, GREY, b"\0\x5f"), [[85] * 3, [255] * 3], id="grey of 4 bits"),
        pytest.param(
            png((2, 1), 1, PALETTE, b"\0\x40", COLOURS_OF_PALETTE), [[255, 0, 0], [0, 255, 0]], id="palette of 1 bit"
        ),
        pytest.param(
            row(8, PALETTE, 2, [1, 0], COLOURS_OF_PALETTE, chunk(b"tRNS", bytes([9]))),
            [[0, 255, 0, 255], [255, 0, 0, 9]],
            id="palette with opacity",
        ),
        pytest.param(row(8, GREY, 2, [1, 2], key(2)), [[1, 1, 1, 255], [2, 2, 2, 0]], id="key, grey"),
        pytest.param(png((2, 1), 1, GREY, b"\0\x40", key(1)), [[0, 0, 0, 255], [255] * 3 + [0]], id="key, 1 bit"),
        pytest.param(png((2, 1), 2, GREY, b"\0\x60", key(1)), [[85] * 3 + [0], [170] * 3 + [255]], id="key, 2 bits"),
        pytest.param(png((2, 1), 4, GREY, b"\0\x5f", key(5)), [[85] * 3 + [0], [255] * 4], id="key, 4 bits"),
        pytest.param(
            row(16, GREY, 2, [0x8000, 0x8001], key(0x8001)), [[0x80] * 3 + [255], [0x80] * 3 + [0]], id="key, 16 bits"
        ),
        pytest.param(row(8, RGB, 2, [1, 2, 3, 4, 5, 6], key(4, 5, 6)), [[1, 2, 3, 255], [4, 5, 6, 0]], id="key, RGB"),
        pytest.param(
            row(16, RGB, 2, [256, 512, 768, 9, 9, 9], key(256, 512, 768)),
            [[1, 2, 3, 0], [0, 0, 0, 255]],
            id="key, RGB of 16 bits",
        ),
        pytest.param(
            row(8, GREY, 1, [99], chunk(b"gAMA", struct.pack(">I", 100000))), [[99] * 3], id="gamma counts for nothing"
        ),
    ],
)
def test_every_kind_of_png(encoded: bytes, expected: ArrayLike) -> None:
    np.testing.assert_array_equal(decoded(encoded)[0], expected)


@pytest.mark.parametrize("kind", ["png", "webp", "tga", "tiff", "gif", "dds", "bmp"])
def test_other_formats_with_and_without_opacity(kind: str) -> None:
    lossless = {"lossless": True, "exact": True} if kind == "webp" else {}
    np.testing.assert_array_equal(decoded(saved(COLOURS, kind, **lossless))[..., :3], COLOURS)
    if kind not in ("gif", "bmp"):  # which hold none, or none but holes
        pixels = np.dstack([COLOURS, OPACITY])
        np.testing.assert_array_equal(decoded(saved(pixels, kind, **lossless)), pixels)


@pytest.mark.parametrize("mode", ["RGB", "L", "CMYK"])
def test_jpeg(mode: str) -> None:
    pixels = np.full((16, 16, 3), (200, 100, 50), np.uint8)
    expected = np.asarray(PIL.Image.fromarray(pixels).convert(mode).convert("RGB"))
    np.testing.assert_allclose(decoded(saved(pixels, "jpeg", mode)), expected, atol=3)


def test_the_orientation_of_a_photograph_counts_for_nothing() -> None:
    turned = PIL.Image.Exif()
    turned[0x0112] = 6
    assert decoded(saved(np.zeros((16, 32, 3), np.uint8), "jpeg", exif=turned)).shape == (16, 32, 3)


def test_grey_tiff_of_16_bits() -> None:
    np.testing.assert_array_equal(decoded(saved(np.full((2, 2), 0x8034, np.uint16), "tiff")), np.full((2, 2, 3), 0x80))


@pytest.mark.parametrize("values", [np.float32(0.5), np.int32(70000), np.int32(-1)])
def test_numbers_that_8_bits_cannot_stand_for_are_refused(values: np.generic) -> None:
    with pytest.raises(SceneError, match="image a: expected whole numbers of 8 or 16 bits, found others"):
        decoded(saved(np.full((2, 2), values), "tiff"))


@pytest.mark.parametrize("kind", ["png", "jpeg", "webp", "tga", "tiff", "gif", "dds", "bmp"])
def test_a_part_of_an_image_is_refused(kind: str) -> None:
    whole = saved(np.random.default_rng(1).integers(0, 256, (64, 64, 3), np.uint8), kind)
    for part in (whole[: len(whole) * 2 // 3], whole[:20], whole[:3], b""):
        with pytest.raises(SceneError, match="image a: expected") as caught:
            decoded(part)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("encoded", [b"hello, I am no image", b"#?RADIANCE\n", b"v/1\1" + bytes(100), b"<svg></svg>"])
def test_another_format_is_refused(encoded: bytes) -> None:
    with pytest.raises(SceneError, match=r"image a: expected PNG, JPEG, .* or TGA, found another format"):
        decoded(encoded)


def test_an_image_of_14000_by_14000_is_read() -> None:
    rows = bytes(1751) * 13999 + b"\0" + bytes(1749) + b"\1"
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # Pillow's bound is lower
        pixels = decoded(png((14000, 14000), 1, GREY, rows))
    assert pixels.shape == (14000, 14000, 3)
    assert pixels[-1, -1].tolist() == [255, 255, 255]


def test_images_that_are_too_large_together_are_not_decoded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(images, "MAX_PIXELS", 8)
    held, encoded = Images(), saved(COLOURS, "png")
    first = held.pixels("a", lambda: encoded)
    held.pixels("b", lambda: encoded)
    assert held.pixels("a", lambda: b"") is first
    # Only its header is looked at: there is nothing behind it.
    with pytest.raises(SceneError, match="image c: expected at most 8 pixels in all images together, found more"):
        held.pixels("c", lambda: png((60000, 60000), 8, RGB, b""))
