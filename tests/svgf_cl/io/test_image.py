"""A file passes through whole: channels in their own types, parts, windows, attributes, to the last bit."""

from __future__ import annotations

import re
import struct
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from svgf_cl import FileError
from svgf_cl.io.exr import read_attribute, read_image, read_windows, write_channels, write_image
from svgf_cl.io.image import COMPRESSIONS, Image, new_image
from svgf_cl.io.window import Window
from tests.exr_files import exr_bytes

RGB = {name: np.full((3, 4), index, np.float32) for index, name in enumerate("RGB")}

# A value of each type that an attribute has, and of one that nobody has heard of.
ATTRIBUTES = {
    "anInt": ("int", struct.pack("<i", -5)),
    "aDouble": ("double", struct.pack("<d", 0.1)),
    "aString": ("string", "grün".encode()),
    "anEmptyString": ("string", b""),
    "strings": ("stringvector", b"\1\0\0\0a\2\0\0\0bc"),
    "floats": ("floatvector", struct.pack("<3f", 1, 2, 3)),
    "aBox": ("box2f", struct.pack("<4f", 1, 2, 3, 4)),
    "unheardOf": ("ofMyOwn", b"\1\2\3\4\5"),
    "adoptedNeutral": ("v2f", struct.pack("<2f", 0.3, 0.3)),
    "capDate": ("string", b"2020:01:02 03:04:05"),
    "cameraTransform": ("m44f", struct.pack("<16f", *range(16))),
    "worldToCamera": ("m44f", struct.pack("<16f", *range(16, 32))),
    "worldToNDC": ("m44f", struct.pack("<16f", *range(32, 48))),
    "chromaticities": ("chromaticities", struct.pack("<8f", 0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)),
    "comments": ("string", b"a comment"),
    "owner": ("string", b"me"),
    "ImageDescription": ("string", b"not the comment"),
    "Software": ("string", b"a renderer"),
    "colorInteropID": ("string", b"lin_ap1_scene"),
    "oiio:ColorSpace": ("string", b"ACEScg"),
    "envmap": ("envmap", b"\0"),
    "textureformat": ("string", b"Plain Texture"),
    "compression level": ("float", struct.pack("<f", 45)),
    "dwaCompressionLevel": ("float", struct.pack("<f", 45)),
    "framesPerSecond": ("rational", struct.pack("<iI", 24000, 1001)),
    "keyCode": ("keycode", struct.pack("<7i", 1, 2, 3, 4, 5, 4, 64)),
    "timeCode": ("timecode", struct.pack("<II", 0x01020304, 5)),
    "smpte:TimeCode": ("string", b"not the time code"),
    "xDensity": ("float", struct.pack("<f", 72)),
    "view": ("string", b"left"),
    "multiView": ("stringvector", b"\4\0\0\0left"),
    "name": ("string", b"beauty"),
    "cryptomatte/0123/manifest": ("string", b'{"box": "12345678"}' * 1000),
    "a name that is longer than thirty-one bytes are": ("int", struct.pack("<i", 1)),
}


def passed_on(source: Path) -> Path:
    """What comes out where a file is read and written."""
    target = source.with_name("out.exr")
    write_image(target, read_image(source))
    return target


def assert_passes(content: bytes, folder: Path) -> Image:
    """What was read is what is read again, and OpenImageIO finds nothing wrong with it."""
    (folder / "in.exr").write_bytes(content)
    before, target = read_image(folder / "in.exr"), passed_on(folder / "in.exr")
    after = read_image(target)
    assert before.same_as(after)
    assert after.same_as(before)
    assert oiio.ImageBuf(str(target)).read(force=True)
    return after


def test_every_attribute_passes_and_none_is_added(tmp_path: Path) -> None:
    image = assert_passes(exr_bytes(RGB, ATTRIBUTES, (-2, 5), Window(1, 2, 30, 20), aspect=2.0), tmp_path)
    attributes = image.parts[0].attributes
    usual = {"displayWindow", "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth"}
    assert attributes.keys() == ATTRIBUTES.keys() | usual
    assert {name: attributes[name] for name in ATTRIBUTES} == ATTRIBUTES
    assert attributes["screenWindowCenter"] == ("v2f", struct.pack("<2f", 0.5, 0.25))
    windows = read_windows(tmp_path / "out.exr")
    assert windows.data == Window(-2, 5, 4, 3)
    assert windows.display == Window(1, 2, 30, 20)
    assert windows.pixel_aspect == 2.0


def test_openimageio_understands_what_passed(tmp_path: Path) -> None:
    assert_passes(exr_bytes(RGB, ATTRIBUTES), tmp_path)
    for name, value in {
        "Copyright": "me",
        "DateTime": "2020:01:02 03:04:05",
        "framesPerSecond": (24000, 1001),
        "worldToNDC": tuple(range(32, 48)),
        "Software": "a renderer",
    }.items():
        assert oiio.ImageInput.open(str(tmp_path / "out.exr")).spec().get(name) == value


NAMES = st.text(
    st.characters(codec="utf-8", exclude_characters="\0", exclude_categories=("Cs",)), min_size=1, max_size=40
)
LAYOUT = {"channels", "compression", "dataWindow", "lineOrder", "tiles", "type", "version", "chunkCount", "preview"}


@given(st.dictionaries(NAMES.filter(lambda name: name not in LAYOUT), st.binary(max_size=20), max_size=4))
@settings(deadline=None, max_examples=40)
def test_attributes_of_any_name_pass(values: dict[str, bytes]) -> None:
    attributes = {name: ("ofMyOwn", value) for name, value in values.items()}
    with tempfile.TemporaryDirectory() as folder:
        image = assert_passes(exr_bytes(RGB, attributes), Path(folder))
    assert attributes.items() <= image.parts[0].attributes.items()


@given(st.data())
@settings(deadline=None, max_examples=40)
def test_every_bit_of_every_type_passes(data: st.DataObject) -> None:
    """NaN of any kind, infinities, ids beyond what a float can count to."""
    shape = data.draw(st.tuples(st.integers(1, 20), st.integers(1, 5)))
    types = data.draw(st.lists(st.sampled_from(("u4", "f2", "f4")), min_size=1, max_size=5))
    planes = {f"c{i}": data.draw(hnp.arrays("u2" if t == "f2" else "u4", shape)).view(t) for i, t in enumerate(types)}
    with tempfile.TemporaryDirectory() as folder:
        image = assert_passes(exr_bytes(planes), Path(folder))
        formats = oiio.ImageInput.open(str(Path(folder) / "out.exr")).spec()
    for name, plane in planes.items():
        found = image.planes[name]
        assert found.dtype == plane.dtype
        assert found.tobytes() == plane.tobytes()
        wanted = {"u": oiio.UINT32, "f": oiio.HALF if plane.itemsize == 2 else oiio.FLOAT}[plane.dtype.kind]
        assert formats.channelformat(formats.channelindex(name)).basetype == wanted


def test_the_same_planes_make_the_same_file_without_a_date(tmp_path: Path) -> None:
    for name in ("a.exr", "b.exr"):
        write_channels(tmp_path / name, RGB)
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    assert read_attribute(tmp_path / "a.exr", "DateTime") is None


def test_what_the_pixels_are_no_longer_is_left_out(tmp_path: Path) -> None:
    preview = {"preview": ("preview", struct.pack("<II", 1, 1) + b"\1\2\3\4")}
    assert "preview" not in assert_passes(exr_bytes(RGB, preview), tmp_path).parts[0].attributes


def test_a_header_with_wrong_bits_is_refused_or_passes(tmp_path: Path) -> None:
    planes = {**RGB, "A": np.ones((3, 4), np.float16), "id": np.ones((3, 4), np.uint32)}
    content, rng, path, passed = exr_bytes(planes, ATTRIBUTES), np.random.default_rng(2), tmp_path / "in.exr", 0
    for _ in range(200):
        damaged = np.frombuffer(content, np.uint8).copy()
        places = rng.integers(0, 2500, rng.integers(1, 4))
        damaged[places] ^= (1 << rng.integers(0, 8, len(places))).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        try:
            assert read_image(passed_on(path)).same_as(read_image(path))
            passed += 1
        except FileError as error:
            assert "expected" in str(error) or "one of the attributes to keep is damaged" in str(error)  # noqa: PT017
    assert 20 < passed < 180


def test_planes_replaced_become_floats_and_all_else_stays(tmp_path: Path) -> None:
    planes = {name: np.full((3, 4), 0.1, np.float16) for name in "RA"} | {"id": np.full((3, 4), 2**32 - 1, np.uint32)}
    (tmp_path / "in.exr").write_bytes(exr_bytes(planes, ATTRIBUTES))
    before = read_image(tmp_path / "in.exr")
    red = np.full((3, 4), 0.123456789, np.float32)
    write_image(tmp_path / "out.exr", before.with_planes({"R": red, "G": 2 * red}))
    after = read_image(tmp_path / "out.exr")
    assert after.planes.keys() == {"R", "G", "A", "id"}
    np.testing.assert_array_equal(after.planes["R"], red, strict=True)
    np.testing.assert_array_equal(after.planes["id"], planes["id"], strict=True)
    np.testing.assert_array_equal(after.planes["A"], planes["A"], strict=True)
    assert after.parts[0].attributes == before.parts[0].attributes
    alone = before.without("owner").with_planes_alone({"R": red})
    assert alone.planes.keys() == {"R"}
    assert alone.parts[0].attributes.keys() == before.parts[0].attributes.keys() - {"owner"}


def test_a_text_in_another_encoding_passes(tmp_path: Path) -> None:
    latin = {"owner": ("string", "Gr\u00fcn".encode("latin-1")), "one": ("string", b"\xff"), **ATTRIBUTES}
    image = assert_passes(exr_bytes({**RGB, "id": np.full((3, 4), 0xFFFFFF, np.uint32)}, latin), tmp_path)
    assert {name: image.parts[0].attributes[name] for name in latin} == latin


# Compression


def random_planes(types: str) -> dict[str, np.ndarray]:
    """Planes of every bit pattern: NaN, infinities, what nobody would call a picture; and a smooth one of each type."""
    rng, smooth = np.random.default_rng(7), np.add.outer(np.arange(41), np.arange(35))
    planes = {f"noise{t}": rng.integers(0, 2 ** (8 * int(t[1])), (41, 35), f"u{t[1]}").view(t) for t in types.split()}
    return planes | {f"smooth{t}": smooth.astype(t) for t in types.split()}


def stored_compression(path: Path) -> object:
    return oiio.ImageInput.open(str(path)).spec().get("compression")


@pytest.mark.parametrize("types", ["f2", "f2 f4 u4", "f2 u4"])
@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_compression_is_kept_where_it_keeps_every_bit(compression: str, types: str, tmp_path: Path) -> None:
    planes, path = random_planes(types), tmp_path / "a.exr"
    part = replace(new_image(planes, {}).parts[0], compression=compression)
    write_image(path, replace(new_image(planes, {}), parts=(part,)))
    lossy = compression[:3] in ("b44", "dwa") or (compression == "pxr24" and "f4" in types)
    assert stored_compression(path) == ("zip" if lossy else compression)
    after = read_image(path)
    assert after.parts[0].compression == stored_compression(path)
    for name, plane in planes.items():
        assert after.planes[name].dtype == plane.dtype
        assert after.planes[name].tobytes() == plane.tobytes()


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_what_another_library_compressed_passes(compression: str, tmp_path: Path) -> None:
    picture = np.random.default_rng(3).random((41, 35, 3), np.float32)
    spec = oiio.ImageSpec(35, 41, 3, "half")
    spec.attribute("compression", compression)
    output = oiio.ImageOutput.create("openexr")
    assert output.open(str(tmp_path / "in.exr"), spec)
    assert output.write_image(picture)
    assert output.close()
    assert stored_compression(tmp_path / "in.exr") == compression
    before, target = read_image(tmp_path / "in.exr"), passed_on(tmp_path / "in.exr")
    assert read_image(target).same_as(before)
    np.testing.assert_array_equal(
        np.stack([before.planes[name] for name in "RGB"], axis=-1),
        oiio.ImageBuf(str(tmp_path / "in.exr")).get_pixels(oiio.HALF),
    )
    with_float = before.with_planes({"R": picture[..., 0]})
    write_image(target, with_float)
    kept = compression[:3] not in ("b44", "dwa") and compression != "pxr24"
    assert stored_compression(target) == (compression if kept else "zip")
    assert read_image(target).same_as(with_float)


# Parts


def write_parts(path: Path, parts: list[tuple[str, str]], first: Mapping[str, object] = {}, /, **more: object) -> None:
    """A file of parts, each a name and its channels; OpenImageIO is told `first` and `more` of the first and last."""
    specs = []
    for name, channels in parts:
        spec = oiio.ImageSpec(4, 3, len(channels.split()), "float")
        spec.channelnames = tuple(channels.split())
        spec.attribute("oiio:subimagename", name)
        specs.append(spec)
    for spec, told in ((specs[0], first), (specs[-1], more)):
        for name, value in told.items():
            spec.attribute(name, value) if name == "view" else setattr(spec, name, value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), specs), output.geterror()
    for index, spec in enumerate(specs):
        assert not index or output.open(str(path), spec, "AppendSubimage")
        assert output.write_image(np.full((3, 4, spec.nchannels), index, np.float32))
    assert output.close()


@pytest.mark.parametrize(
    ("parts", "names"),
    [
        ([("rgba", "R G B A"), ("aov", "Z id")], "R G B A aov.Z id"),
        ([("rgba", "R G B"), ("albedo", "R G B")], "R G B albedo.R albedo.G albedo.B"),
        ([("albedo", "R G B"), ("Beauty", "R G B A")], "albedo.R albedo.G albedo.B R G B A"),
        ([("C", "R G B"), ("normal", "X Y Z"), ("motion", "X Y")],
         "R G B normal.X normal.Y normal.Z motion.X motion.Y"),
        ([("only", "R G B A"), ("depth", "Z A"), ("fog", "Z")], "R G B A depth.Z depth.A fog.Z"),
        ([("rgba", "R G B"), ("depth", "Z"), ("normal", "X Y Z")], "R G B depth.Z normal.X normal.Y normal.Z"),
        ([("direct", "R G B"), ("indirect", "R G B")], "direct.R direct.G direct.B indirect.R indirect.G indirect.B"),
        ([("mine", "R G B"), ("albedo", "R G B")], "R G B albedo.R albedo.G albedo.B"),
        ([("a", "L.R L.G L.B"), ("b", "M.R M.G M.B")], "L.R L.G L.B M.R M.G M.B"),
    ],
)  # fmt: skip
def test_channels_of_all_parts_are_read_and_written(parts: list[tuple[str, str]], names: str, tmp_path: Path) -> None:
    write_parts(tmp_path / "in.exr", parts)
    found = read_image(tmp_path / "in.exr").planes
    assert sorted(found) == sorted(names.split())
    assert sorted(plane[0, 0] for plane in found.values()) == sorted(
        index for index, (_, channels) in enumerate(parts) for _ in channels.split()
    )
    target = passed_on(tmp_path / "in.exr")
    assert read_image(target).same_as(read_image(tmp_path / "in.exr"))
    for path in (tmp_path / "in.exr", target):
        source = oiio.ImageInput.open(str(path))
        for index, (name, channels) in enumerate(parts):
            assert source.seek_subimage(index, 0)
            assert source.spec().get("oiio:subimagename") == name
            assert sorted(source.spec().channelnames) == sorted(channels.split())


@pytest.mark.parametrize(
    ("parts", "more", "words"),
    [
        ([("one", "R G B"), ("two", "R G B")], {}, "expected R G B in one part, .*; found them in one, two"),
        ([("rgba", "R G B"), ("beauty", "R G B")], {}, ".*; found them in rgba, beauty"),
        ([("a", "Z a.Z"), ("b", "Z")], {}, "expected channels of different names, found two called a.Z"),
        ([("a", "R G B"), ("b", "Z")], {"deep": True}, "expected flat pixels, got deep ones; flatten"),
    ],
)  # fmt: skip
def test_parts_that_cannot_be_one_image_are_refused(parts, more: dict[str, object], words: str, tmp_path: Path) -> None:
    if "deep" in more:
        write_deep(tmp_path / "in.exr")
    else:
        write_parts(tmp_path / "in.exr", parts, **more)
    with pytest.raises(FileError, match=rf"in\.exr: {words}") as error:
        read_image(tmp_path / "in.exr")
    assert "\n" not in str(error.value)


def write_deep(path: Path) -> None:
    spec = oiio.ImageSpec(2, 2, 2, "float")
    spec.channelnames, spec.deep = ("R", "Z"), True
    deep = oiio.DeepData()
    deep.init(spec)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec)
    assert output.write_deep_image(deep)
    output.close()


@pytest.mark.parametrize("more", [{"x": 1}, {"view": "left"}, {"view": "left", "x": 1}])
def test_parts_elsewhere_pass_and_are_not_read(more: dict[str, object], tmp_path: Path) -> None:
    """Those of another view or another place, whatever their channels are called."""
    parts = [("right", "R G B"), ("b", "Z"), ("left", "R G B Z")]
    write_parts(tmp_path / "in.exr", parts, {"view": "right"}, **more)
    image = read_image(tmp_path / "in.exr")
    assert sorted(image.planes) == ["B", "G", "R", "b.Z"]
    assert [part.elsewhere for part in image.parts] == [None, None, Window(more.get("x", 0), 0, 4, 3)]
    changed = image.with_planes({"R": np.full((3, 4), 5, np.float32), "new": np.ones((3, 4), np.float32)}, "b.Z")
    write_image(tmp_path / "out.exr", changed)
    after = read_image(tmp_path / "out.exr")
    assert after.same_as(changed)
    assert after.parts[2].same_as(image.parts[2])
    assert [sorted(part.planes) for part in after.parts] == [["B", "G", "R"], ["b.Z", "new"], ["B", "G", "R", "Z"]]


def test_views_of_one_part_pass(tmp_path: Path) -> None:
    """The first one has no name before its channels."""
    both = {"multiView": ("stringvector", b"\4\0\0\0left\5\0\0\0right")}
    image = assert_passes(exr_bytes({**RGB, "right.R": RGB["R"]}, both), tmp_path)
    assert image.planes.keys() == {"R", "G", "B", "right.R"}
    assert image.parts[0].attributes["multiView"] == both["multiView"]


@pytest.mark.parametrize("names", ["Y RY BY", "R G B id"])
def test_channels_of_fewer_pixels_are_refused(names: str, tmp_path: Path) -> None:
    planes = {name: np.ones((4, 4), np.float16) for name in names.split()}
    sparse = {name: 2 for name in planes if name in ("RY", "BY", "id")}
    (tmp_path / "a.exr").write_bytes(exr_bytes(planes, sampling=sparse))
    with pytest.raises(FileError, match=r"a\.exr: expected a value for every pixel in each channel") as error:
        read_image(tmp_path / "a.exr")
    assert "\n" not in str(error.value)


def test_of_tiles_in_several_resolutions_the_finest_is_read(tmp_path: Path) -> None:
    picture = np.random.default_rng(0).random((64, 48, 3), np.float32)
    image = oiio.ImageBuf(oiio.ImageSpec(48, 64, 3, "float"))
    image.set_pixels(image.roi, picture)
    oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, image, str(tmp_path / "tiled.exr"), oiio.ImageSpec())
    assert oiio.ImageInput.open(str(tmp_path / "tiled.exr")).spec().tile_width
    for path in (tmp_path / "tiled.exr", passed_on(tmp_path / "tiled.exr")):
        planes = read_image(path).planes
        np.testing.assert_array_equal(np.stack([planes[name] for name in "RGB"], axis=-1), picture)


def test_a_display_window_of_any_size_costs_no_memory(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(exr_bytes(RGB, display=Window(0, 0, 10**6, 10**6)))
    with pytest.raises(FileError, match="expected a display window of at most 268435456 pixels, got 1000000x1000000"):
        read_windows(tmp_path / "a.exr")


# Files that nobody here wrote

SAMPLES = Path(__file__).parents[4] / "shared" / "samples"
# Of a sequence, the first file: in the others, the pixels alone differ.
FILES = sorted(path for path in (SAMPLES / "openexr").glob("*/*.exr") if not re.search(r"\.000[2-9]\.", path.name))


def facts(path: Path) -> list[dict[str, object]]:
    """What OpenImageIO says of each part: windows, channels, types, compression, every pixel of those not denoised."""
    source, parts = oiio.ImageInput.open(str(path)), []
    while source.seek_subimage(len(parts), 0):
        spec = source.spec()
        pixels = source.read_image(len(parts), 0, 0, spec.nchannels, "float").view(np.uint32)
        parts.append(
            {
                "name": spec.get("oiio:subimagename"),
                "data": (spec.x, spec.y, spec.width, spec.height),
                "display": (spec.full_x, spec.full_y, spec.full_width, spec.full_height),
                "compression": spec.get("compression"),
                **{
                    name: (str(spec.channelformat(index)), pixels[..., index].tobytes())
                    for index, name in enumerate(spec.channelnames)
                    if name not in ("R", "G", "B")
                },
            }
        )
    return parts


@pytest.mark.skipif(not SAMPLES.exists(), reason=f"{SAMPLES} is not here")
@pytest.mark.parametrize("path", FILES or [None], ids=lambda path: path and path.name)
def test_samples_pass_but_for_what_is_denoised(path: Path, tmp_path: Path) -> None:
    before = read_image(path)
    data = before.windows.data
    picture = np.random.default_rng(1).random((data.height, data.width, 3), np.float32)
    write_image(tmp_path / "out.exr", before.with_planes(dict(zip("RGB", np.moveaxis(picture, -1, 0), strict=True))))
    after = read_image(tmp_path / "out.exr")
    assert facts(tmp_path / "out.exr") == facts(path)
    assert [part.attributes for part in after.parts] == [part.attributes for part in before.parts]
    np.testing.assert_array_equal(np.stack([after.planes[name] for name in "RGB"], axis=-1), picture)


@pytest.mark.skipif(not SAMPLES.exists(), reason=f"{SAMPLES} is not here")
def test_files_that_broke_readers_are_refused_or_pass(tmp_path: Path) -> None:
    """Also where they could not be read: what comes is one line with the file's name."""
    refused: dict[Path, str] = {}
    for path in sorted((SAMPLES / "openexr" / "damaged").iterdir()):
        try:
            image = read_image(path)
        except FileError as error:
            refused[path] = str(error)
        else:
            write_image(tmp_path / "out.exr", image)
            assert read_image(tmp_path / "out.exr").same_as(image)
    assert len(refused) > 100
    for path, message in refused.items():
        assert re.fullmatch(rf"{re.escape(str(path))}: expected .*", message)
