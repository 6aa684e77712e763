"""EXR files come back as they were written; nothing that lies in one can crash, exhaust the memory or go unnoticed."""

from __future__ import annotations

import json
import os
import re
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from svgf_cl import FileError
from svgf_cl.io import exr
from svgf_cl.io.exr import read_attribute, read_image, write_channels
from tests.disk import files_up_to, unprivileged

RNG = np.random.default_rng(5)
PLANES = {name: RNG.random((11, 7), np.float32) for name in ("R", "G", "B", "depth.Z")}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A whole file of `PLANES`."""
    write_channels(tmp_path / "a.exr", PLANES, {"svgf_cl:spp": 16})
    return tmp_path / "a.exr"


def assert_whole(path: Path) -> None:
    found = read_image(path).planes
    assert found.keys() == PLANES.keys()
    for name, plane in PLANES.items():
        np.testing.assert_array_equal(found[name], plane, strict=True)


def test_channels_and_attributes_come_back(path: Path) -> None:
    assert_whole(path)
    assert read_attribute(path, "svgf_cl:spp") == 16
    assert read_attribute(path, "svgf_cl:none") is None


def test_halves_and_integers_are_read_as_the_numbers_they_are(tmp_path: Path) -> None:
    path, spec = tmp_path / "a.exr", oiio.ImageSpec(4, 3, 2, "float")
    spec.channelnames, spec.channelformats = ("R", "id"), (oiio.HALF, oiio.UINT32)
    values = np.stack([np.full((3, 4), 0.1), np.arange(12).reshape(3, 4) * 1000 / (2**32 - 1)], axis=-1)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec)
    assert output.write_image(values)
    output.close()
    found = read_image(path).planes
    np.testing.assert_array_equal(found["R"], np.full((3, 4), 0.1, np.float16), strict=True)
    np.testing.assert_array_equal(found["id"], np.arange(12, dtype=np.uint32).reshape(3, 4) * 1000, strict=True)


@pytest.mark.parametrize("name", ["a b", "ü 日本", "new\nline", "-dash", "q?x=1", "f.####", "%04d", "semi;colon", " "])
def test_any_name_will_do(name: str, tmp_path: Path) -> None:
    (tmp_path / name).mkdir()
    for path in (tmp_path / f"{name}.exr", tmp_path / name / "a.exr"):
        write_channels(path, PLANES)
        assert_whole(path)


def test_a_name_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"\xff.exr")
    with pytest.raises(FileError, match=r"udcff.*: expected a name in UTF-8"):
        write_channels(path, PLANES)
    path.touch()
    with pytest.raises(FileError, match=r"udcff.*: expected a name in UTF-8"):
        read_image(path)
    assert list(tmp_path.iterdir()) == [path]


# What is no file


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: None, "found nothing there"),
        (lambda path: path.mkdir(), "found something that is not a file"),
        (os.mkfifo, "found something that is not a file"),
        (lambda path: path.symlink_to(path), "cannot be read \\(Too many levels of symbolic links\\)"),
        (lambda path: path.touch(), "expected an OpenEXR file, got an empty file"),
        (lambda path: path.write_text("hello"), "expected an OpenEXR file, got"),
        (
            lambda path: oiio.ImageBuf(oiio.ImageSpec(2, 2, 3, "uint8")).write(str(path), fileformat="png"),
            "begins with b'.x89PNG'",
        ),
    ],
)
def test_what_is_no_exr_file_is_refused(make: Callable[[Path], object], words: str, tmp_path: Path) -> None:
    make(tmp_path / "a.exr")
    with pytest.raises(FileError, match=rf"a\.exr: .*{words}"):
        read_image(tmp_path / "a.exr")


def test_a_file_behind_a_closed_door_is_refused(path: Path) -> None:
    with unprivileged(path.parent), pytest.raises(FileError, match=r"a\.exr: cannot be read \(Permission denied\)"):
        read_image(path)


# Damage


def test_a_file_cut_off_anywhere_is_refused(path: Path) -> None:
    content = path.read_bytes()
    for length in range(len(content)):
        path.write_bytes(content[:length])
        with pytest.raises(FileError, match=r"a\.exr: expected"):
            read_image(path)


@pytest.mark.parametrize("seed", range(4))
def test_a_file_with_wrong_bits_is_refused_or_has_planes(seed: int, path: Path) -> None:
    """A bit of a name, an attribute or of what was too noisy to compress can be any other: OpenEXR has no checksum."""
    content, rng = path.read_bytes(), np.random.default_rng(seed)
    refused = 0
    for _ in range(250):
        damaged = np.frombuffer(content, np.uint8).copy()
        # Half of them in the header, where all sizes are.
        places = rng.integers(0, 500 if rng.random() < 0.5 else len(damaged), rng.integers(1, 5))
        damaged[places] ^= (1 << rng.integers(0, 8, len(places))).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        try:
            shapes = {plane.shape for plane in read_image(path).planes.values()}
            assert len(shapes) == 1
        except FileError as error:
            assert str(path) in str(error)  # noqa: PT017  # either will do
            refused += 1
    assert refused > 100


def test_a_header_that_is_no_text_is_refused(path: Path) -> None:
    path.write_bytes(path.read_bytes().replace(b"chlist", b"chl\xffst"))
    with pytest.raises(FileError, match=r"a\.exr: expected text in UTF-8 in its header"):
        read_image(path)


# Headers


def header(width: int, height: int, channels: int = 3, tile: int | None = None) -> bytes:
    """The header of an EXR file, zip compression, float channels; whatever should follow does not."""

    def attribute(name: str, kind: str, value: bytes) -> bytes:
        return b"%s\0%s\0" % (name.encode(), kind.encode()) + struct.pack("<i", len(value)) + value

    listed = b"".join(b"c%06d\0" % index + struct.pack("<iB3xii", 2, 0, 1, 1) for index in range(channels))
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    parts = [
        attribute("channels", "chlist", listed + b"\0"),
        attribute("compression", "compression", b"\3"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        attribute("screenWindowCenter", "v2f", bytes(8)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)),
        attribute("tiles", "tiledesc", struct.pack("<IIB", tile, tile, 0)) if tile else b"",
    ]
    return struct.pack("<II", 20000630, 0x202 if tile else 2) + b"".join(parts) + b"\0"


HUGE = {
    "a million squared": header(10**6, 10**6),
    "a million squared in tiles": header(10**6, 10**6, tile=64),
    "in a million million tiles": header(10**6, 10**6, tile=1),
    "a tile of its own size": header(30_000, 30_000, tile=30_000),
    "as large as the format allows": header(2**31 - 2, 2**31 - 2),
    "a row": header(2**28, 1),
    "many channels": header(64, 64, channels=5000),
    "many channels of many pixels": header(16_384, 16_384, channels=1000),
    "8K": header(7680, 4320, channels=24),
    "8K, and a megabyte of nothing": header(7680, 4320, channels=24) + bytes(2**20),
    "8K, and more of nothing": header(7680, 4320, channels=24) + bytes(2**24),
    "nothing": header(0, 0),
    "less than nothing": header(-5, -5),
}

# What reading one may add to the memory in use: a bound far below what is claimed, 3 GB or more.
MAX_GROWTH = 256 * 2**20

READ_ALL = """
import json, resource, sys
from pathlib import Path
from svgf_cl import FileError
from svgf_cl.io.exr import read_image
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
said, before = {}, peak()
for path in sorted(Path(sys.argv[1]).iterdir()):
    try:
        read_image(path)
    except FileError as error:
        said[path.name] = str(error)
Path(sys.argv[2]).write_text(json.dumps([said, peak() - before]))  # OpenEXR prints what is wrong, too
"""


def test_no_memory_is_taken_for_what_a_header_claims(tmp_path: Path) -> None:
    folder, answer = tmp_path / "huge", tmp_path / "answer.json"
    folder.mkdir()
    for name, content in HUGE.items():
        (folder / name).with_suffix(".exr").write_bytes(content)
    subprocess.run([sys.executable, "-c", READ_ALL, folder, answer], capture_output=True, check=True)
    said, growth = json.loads(answer.read_text())
    assert said.keys() == {f"{name}.exr" for name in HUGE}
    for name, message in said.items():
        assert message.startswith(f"{folder / name}: expected"), message
        assert "\n" not in message
    assert growth < MAX_GROWTH


def test_more_pixels_than_a_file_can_hold_are_refused(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exr, "MAX_RATIO", 0.5)
    assert_whole(path)
    monkeypatch.setattr(exr, "TRUSTED", 11 * 7 * 16 - 1)
    with pytest.raises(FileError, match=r"a\.exr: expected a complete image, got 1232 bytes of pixels in a file of"):
        read_image(path)


def test_what_compresses_best_is_read(tmp_path: Path) -> None:
    """A black picture, of which zlib makes as little as of anything, is not taken for a lie."""
    write_channels(tmp_path / "a.exr", {"Y": np.zeros((2048, 2048), np.float32)})
    assert exr.MAX_RATIO * (tmp_path / "a.exr").stat().st_size > 2048 * 2048 * 4


def test_too_little_memory_names_the_file(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError("std::bad_alloc")

    monkeypatch.setattr(exr.OpenEXR, "File", full)
    with pytest.raises(FileError, match=r"a\.exr: expected an image that fits into memory"):
        read_image(path)


# Writing


def test_a_disk_that_is_full_at_any_place_is_reported(path: Path) -> None:
    old = path.read_bytes()
    size = len(old)
    for limit in (*range(0, size - 40, 61), *range(size - 40, size)):
        with files_up_to(limit), pytest.raises(FileError, match=r"a\.exr: cannot be written"):
            write_channels(path, PLANES, {"svgf_cl:spp": 16})
        assert path.read_bytes() == old
        assert list(path.parent.iterdir()) == [path]
    with files_up_to(size):
        write_channels(path, PLANES, {"svgf_cl:spp": 16})
    assert_whole(path)


def test_a_folder_in_the_way_and_a_file_in_place_of_a_folder(tmp_path: Path) -> None:
    (tmp_path / "taken.exr").mkdir()
    with pytest.raises(FileError, match=re.escape("taken.exr: cannot be written (Is a directory)")):
        write_channels(tmp_path / "taken.exr", PLANES)
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match=re.escape("a.exr: cannot be written (File exists)")):
        write_channels(tmp_path / "file" / "a.exr", PLANES)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "taken.exr"]


def test_a_folder_behind_a_closed_door(path: Path) -> None:
    with unprivileged(path.parent), pytest.raises(FileError, match=r"cannot be written \(Permission denied\)"):
        write_channels(path, PLANES)
    assert_whole(path)
