"""Cameras from files: what cameras.json and headers say, what is refused, and what cameras of Mitsuba see."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl import ArgumentError, Camera, motion_from_cameras
from svgf_cl.errors import FileError
from svgf_cl.io.cameras import NAME, camera_of_header, read_cameras
from svgf_cl.io.exr import read_attributes, read_image

SAMPLES = Path(__file__).parents[4] / "shared" / "samples"
MITSUBA = SAMPLES / "mitsuba"
ARNOLD = SAMPLES / "openexr" / "cryptomatte" / "multichannel.exr"

TO_WORLD = [[0.0, 0.0, -1.0, 3.0], [0.0, 1.0, 0.0, 4.0], [1.0, 0.0, 0.0, 5.0], [0.0, 0.0, 0.0, 1.0]]
FOV = {"fov": 40.0, "fov_axis": "y"}


def written(folder: Path, cameras: Any, **file: Any) -> Path:
    path = folder / NAME
    path.write_text(json.dumps({"width": 64, "height": 36, "axes": "opengl", "cameras": cameras} | file))
    return path


def same(one: Camera, other: Camera) -> None:
    np.testing.assert_allclose(one.world_to_view, other.world_to_view, atol=1e-12)
    assert (one.focal, one.center, one.orthographic) == (other.focal, other.center, other.orthographic)


def test_cameras_are_read_by_the_numbers_of_their_frames(tmp_path: Path) -> None:
    entries = [{"frame": frame, "to_world": TO_WORLD, **FOV} for frame in (-1, 7)]
    cameras = read_cameras(written(tmp_path, entries))
    assert list(cameras) == [-1, 7]
    for camera in cameras.values():
        same(camera, Camera.from_fov(TO_WORLD, 40.0, (36, 64), "y", "opengl"))


def test_a_matrix_may_lead_to_the_camera_instead(tmp_path: Path) -> None:
    entry = {"frame": 0, "world_to_camera": np.linalg.inv(TO_WORLD).tolist(), **FOV}
    same(read_cameras(written(tmp_path, [entry]))[0], Camera.from_fov(TO_WORLD, 40.0, (36, 64), "y", "opengl"))


def test_an_entry_may_have_axes_of_its_own(tmp_path: Path) -> None:
    entry = {"frame": 0, "to_world": TO_WORLD, **FOV, "axes": "mitsuba"}
    same(read_cameras(written(tmp_path, [entry]))[0], Camera.from_fov(TO_WORLD, 40.0, (36, 64), "y", "mitsuba"))


@pytest.mark.parametrize("more", [{}, {"orthographic": True}])
def test_a_projection_may_be_given_in_pixels(tmp_path: Path, more: dict[str, bool]) -> None:
    entry = {"frame": 0, "to_world": TO_WORLD, "focal": [50, 60], "center": [30.5, 17], **more}
    camera = read_cameras(written(tmp_path, [entry], width=None))[0]
    assert (camera.focal, camera.center, camera.orthographic) == ((50, 60), (30.5, 17), bool(more))
    same(camera, Camera(world_to_view=camera.world_to_view, focal=(50, 60), center=(30.5, 17), **more))
    np.testing.assert_allclose(
        camera.world_to_view, Camera.from_fov(TO_WORLD, 40.0, (36, 64)).world_to_view, atol=1e-12
    )


def test_a_file_of_mitsuba_says_nothing_of_axes(tmp_path: Path) -> None:
    path = written(tmp_path, [{"frame": 0, "to_world": TO_WORLD, **FOV}], renderer="Mitsuba 3.9.1")
    content = json.loads(path.read_text())
    same(read_cameras(path)[0], Camera.from_fov(TO_WORLD, 40.0, (36, 64), "y", "opengl"))
    del content["axes"]
    path.write_text(json.dumps(content))
    same(read_cameras(path)[0], Camera.from_fov(TO_WORLD, 40.0, (36, 64), "y", "mitsuba"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"to_world": None}, "camera of frame 3: to_world: expected 4 rows of 4 numbers, got None"),
        (
            {"to_world": [[1, 2], [3]]},
            r"camera of frame 3: to_world: expected 4 rows of 4 numbers, got \[\[1, 2\], \[3\]\]",
        ),
        ({"to_world": np.eye(4).astype(str).tolist()}, "camera of frame 3: to_world: expected 4 rows of 4 numbers"),
        ({"to_world": (2 * np.eye(4)).tolist()}, "camera of frame 3: to_world: expected a rotation and a translation"),
        ({"to_world": np.transpose(TO_WORLD).tolist()}, r"to_world: .* for columns \(x, y, z, 1\), got"),
        (
            {"world_to_camera": TO_WORLD},
            "to_world: expected either to_world or world_to_camera, got to_world and world",
        ),
        ({"fov": "40"}, "camera of frame 3: fov: expected a number, got '40'"),
        ({"fov": True}, "camera of frame 3: fov: expected a number, got True"),
        ({"fov": 180}, r"fov_degrees\): expected an angle in \(0, 180\) degrees, got 180"),
        ({"fov": float("nan")}, r"fov_degrees\): expected an angle in \(0, 180\) degrees, got nan"),
        ({"fov_axis": "diagonal"}, "expected one of x, y, smaller, larger, got 'diagonal'"),
        ({"fov_axis": ["x"]}, "expected one of x, y, smaller, larger"),
        (
            {"axes": "maya"},
            "camera of frame 3: .*axes.*: expected one of opencv, opengl, mitsuba, renderman, got 'maya'",
        ),
        ({"axes": {}}, "expected one of opencv, opengl, mitsuba, renderman"),
        ({"width": 64.5}, "camera of frame 3: width: expected a whole number of pixels, got 64.5"),
        ({"height": 0}, r"expected \(height, width\) in pixels, got \(0, 64\)"),
        ({"focal": [1, 2]}, "camera of frame 3: center: expected 2 numbers, got nothing"),
        ({"focal": 1, "center": [1, 2]}, "camera of frame 3: focal: expected 2 numbers, got 1"),
        ({"focal": [0, 1], "center": [1, 2]}, r"camera of frame 3: Camera\(focal\): expected two numbers > 0"),
        ({"focal": [1, 1], "center": [1, 2], "orthographic": 1}, "orthographic: expected true or false, got 1"),
    ],
)
def test_what_is_no_camera_is_refused_by_frame_and_field(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    entry = {"frame": 3, "to_world": TO_WORLD, **FOV, **change}
    with pytest.raises(FileError, match=message) as error:
        read_cameras(written(tmp_path, [{"frame": 2, "to_world": TO_WORLD, **FOV}, entry]))
    assert str(tmp_path / NAME) in str(error.value)


@pytest.mark.parametrize("field", ["to_world", "fov", "fov_axis"])
def test_a_field_that_is_missing_is_named(tmp_path: Path, field: str) -> None:
    entry = {"frame": 3, "to_world": TO_WORLD, **FOV}
    del entry[field]
    with pytest.raises(FileError, match=rf"camera of frame 3: .*{field}"):
        read_cameras(written(tmp_path, [entry]))


@pytest.mark.parametrize("field", ["width", "height", "axes"])
def test_what_the_file_does_not_say_of_all_cameras_is_named(tmp_path: Path, field: str) -> None:
    path = written(tmp_path, [{"frame": 3, "to_world": TO_WORLD, **FOV}])
    content = json.loads(path.read_text())
    del content[field]
    path.write_text(json.dumps(content))
    with pytest.raises(FileError, match=rf"camera of frame 3: .*{field}"):
        read_cameras(path)


@pytest.mark.parametrize(
    "cameras", [[{}], [3], [{"frame": "1"}], [{"frame": True}], [{"frame": 1, "to_world": TO_WORLD, **FOV}] * 2]
)
def test_each_camera_has_a_frame_of_its_own(tmp_path: Path, cameras: list[Any]) -> None:
    with pytest.raises(FileError, match="expected cameras of different frames, found"):
        read_cameras(written(tmp_path, cameras))


@pytest.mark.parametrize("content", ["", "{", "[]", "{}", '{"cameras": {}}', "[" * 100_000])
def test_what_is_no_list_of_cameras_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / NAME
    path.write_text(content)
    with pytest.raises(FileError, match=r"cameras\.json: expected"):
        read_cameras(path)


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"cameras\.json: cannot be read"):
        read_cameras(tmp_path / NAME)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=4),
    max_leaves=8,
)


@given(st.sampled_from(["to_world", "fov", "fov_axis", "axes", "frame", "focal", "center", "width", "height"]), JSON)
def test_whatever_a_field_holds_the_file_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, field: str, value: Any
) -> None:
    entry = {"frame": 3, "to_world": TO_WORLD, **FOV, "center": [1, 2], field: value}
    path = written(tmp_path_factory.mktemp("cameras"), [entry])  # in the folder above others, it would be theirs
    try:
        (camera,) = read_cameras(path).values()
    except FileError:
        return
    assert np.isfinite(camera.world_to_view).all()


# Headers


def attributes_of(kind: str, number: str) -> dict[str, tuple[str, bytes]]:
    to_camera = np.diag((1.0, 1.0, 1.0, 1.0))
    to_camera[3, :3] = 1.0, 2.0, 3.0
    projection = np.zeros((4, 4))
    projection[[0, 1, 2, 3, 2], [0, 1, 2, 2, 3]] = 2.0, 2.0 * 64 / 36, 1.0, -0.1, 1.0
    matrices = {"worldToCamera": to_camera, "worldToNDC": to_camera @ projection}
    return {name: (kind, struct.pack(f"<16{number}", *matrix.ravel())) for name, matrix in matrices.items()}


@pytest.mark.parametrize(("kind", "number"), [("m44f", "f"), ("m44d", "d")])
def test_a_header_has_a_camera(kind: str, number: str) -> None:
    camera = camera_of_header(attributes_of(kind, number), (36, 64))
    assert camera is not None
    assert camera.focal == pytest.approx((64, 64))
    np.testing.assert_allclose(camera.to_view([0.0, 0.0, 0.0]), (1, -2, 3), atol=1e-6)


@pytest.mark.parametrize("name", ["worldToCamera", "worldToNDC"])
def test_a_header_without_one_of_the_matrices_has_no_camera(name: str) -> None:
    attributes = attributes_of("m44f", "f")
    del attributes[name]
    assert camera_of_header(attributes, (36, 64)) is None


def test_what_is_no_matrix_is_refused() -> None:
    attributes = attributes_of("m44f", "f")
    with pytest.raises(
        ArgumentError, match="worldToNDC: expected 16 numbers of type m44f or m44d, got 4 bytes of type"
    ):
        camera_of_header({**attributes, "worldToNDC": ("float", bytes(4))}, (36, 64))
    with pytest.raises(ArgumentError, match=r"worldToNDC: .*, got 64 bytes of type m44d"):
        camera_of_header({**attributes, "worldToNDC": ("m44d", bytes(64))}, (36, 64))


@pytest.mark.skipif(not ARNOLD.exists(), reason=f"{ARNOLD} is not here")
def test_a_file_of_arnold_has_a_camera() -> None:
    camera = camera_of_header(read_attributes(ARNOLD), (128, 128))
    assert camera is not None
    assert camera.center == pytest.approx((63.5, 63.5), abs=1e-3)


# Frames of Mitsuba: rays are jittered within their pixels, and positions are those that they hit.

CENTRES = np.indices((144, 256))[::-1].transpose(1, 2, 0)
NEAR_CLIP = 0.01  # Mitsuba's default; its distances begin there, not at the camera
needs_mitsuba = pytest.mark.skipif(not MITSUBA.exists(), reason=f"{MITSUBA} is not here")


def mitsuba(frame: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (NaN where nothing was hit), normals and distances of a frame."""
    planes = read_image(MITSUBA / "noisy" / f"cbox.{frame:04d}.exr").planes
    position, normal = (np.stack([planes[f"{name}.{axis}"] for axis in "XYZ"], -1) for name in ("pp", "nn"))
    return np.where((normal != 0).any(-1, keepdims=True), position, np.nan), normal, planes["dd.T"]


@needs_mitsuba
@pytest.mark.parametrize("frame", range(8))
def test_cameras_of_mitsuba_see_positions_in_their_own_pixels(frame: int) -> None:
    camera = read_cameras(MITSUBA / NAME)[frame]
    pixels, _ = camera.project(mitsuba(frame)[0])
    assert 0.49 < np.nanmax(np.abs(pixels - CENTRES)) < 0.5001


@needs_mitsuba
@pytest.mark.parametrize("frame", [0, 7])
def test_motion_from_positions_is_that_from_depth(frame: int) -> None:
    cameras = read_cameras(MITSUBA / NAME)
    position, _, distance = mitsuba(frame)
    depth = np.where(np.isnan(position[..., 0]), np.inf, cameras[frame].depth_of(distance) + NEAR_CLIP)
    by_position = motion_from_cameras(cameras[frame], cameras[frame - 1], position=position)
    by_depth = motion_from_cameras(cameras[frame], cameras[frame - 1], depth=depth)
    assert np.abs(by_position[..., :2]).max() > 2.0
    # Half a pixel of jitter in a motion that changes by some hundredths from pixel to pixel.
    np.testing.assert_allclose(by_position[..., :2], by_depth[..., :2], atol=6e-3)
    np.testing.assert_array_equal(by_position[np.isinf(depth)], by_depth[np.isinf(depth)])


@needs_mitsuba
@pytest.mark.parametrize("frame", [1, 7])
def test_motion_leads_to_the_same_surface_in_the_previous_frame(frame: int) -> None:
    """Where both frames see one plane, the previous position lies in it to within thousandths of a pixel's size."""
    cameras = read_cameras(MITSUBA / NAME)
    (position, normal, _), (before, normal_before, _) = mitsuba(frame), mitsuba(frame - 1)
    motion = motion_from_cameras(cameras[frame], cameras[frame - 1], position=position)
    x, y = np.rint(CENTRES + motion[..., :2]).astype(int).transpose(2, 0, 1)
    inside = (x >= 0) & (x < 256) & (y >= 0) & (y < 144) & ~np.isnan(position[..., 0])
    there, normal_there = before[y[inside], x[inside]], normal_before[y[inside], x[inside]]
    same_plane = (normal_there * normal[inside]).sum(-1) > 0.99
    assert same_plane.mean() > 0.97
    size = cameras[frame].depth_at(position[inside]) / cameras[frame].focal[0]
    off = np.abs(((there - position[inside]) * normal[inside]).sum(-1)) / size
    assert np.quantile(off[same_plane], 0.998) < 1e-3
    still = np.abs(((before[inside] - position[inside]) * normal[inside]).sum(-1)) / size
    assert np.nanmean(still > 1.0) > np.mean(off > 1.0)


def test_cameras_of_another_size_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, [{"frame": 1, "to_world": TO_WORLD, **FOV}])
    assert read_cameras(path, (36, 64)).keys() == {1}
    with pytest.raises(FileError, match="frame 1: expected the width 32 and height 18 of the frames, got 64 and 36"):
        read_cameras(path, (18, 32))
