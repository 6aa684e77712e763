"""Reads the cameras of a shot: from a file beside its frames, or from the header of a frame.

``cameras.json`` has ``width`` and ``height`` of the images in pixels, ``axes`` (see `Camera.from_fov`; the default is
``mitsuba`` if ``renderer`` is Mitsuba), and ``cameras``, a list with one entry for each frame::

    {"width": 1280, "height": 720, "axes": "opengl", "cameras": [
        {"frame": 1, "to_world": [[1, 0, 0, 0], [0, 1, 0, 2], [0, 0, 1, 5], [0, 0, 0, 1]], "fov": 40, "fov_axis": "x"}
    ]}

- ``frame``: the number in the frame's name. The first frame gets a motion if there is an entry for the frame before it.
- ``to_world`` or ``world_to_camera``: a matrix by rows, for columns (x, y, z, 1), without scale.
- ``fov`` in degrees and ``fov_axis`` (x, y, smaller or larger). Or ``focal`` and ``center``, two numbers each, as in
  `Camera`, with ``"orthographic": true`` if rays are parallel. Only ``fov`` needs ``width`` and ``height``.
- ``axes``, if the camera's axes differ from those of the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from svgf_cl.camera import Camera, view_axes
from svgf_cl.errors import ArgumentError, FileError, shown
from svgf_cl.io.atomic import read_json, unreadable
from svgf_cl.io.exr_header import Attribute
from svgf_cl.matrices import Array, inverse, rigid

NAME = "cameras.json"
ATTRIBUTES = {"m44f": "<f4", "m44d": "<f8"}  # the types of matrices in a header, and of their numbers
EXPECTED: dict[tuple[int, ...], str] = {(): "a number", (2,): "2 numbers", (4, 4): "4 rows of 4 numbers"}


def read_cameras(path: Path, shape: tuple[int, int] | None = None) -> dict[int, Camera]:
    """Read the cameras of a shot, by the numbers of its frames.

    Parameters
    ----------
    path : Path
    shape : (int, int), optional
        (height, width) of the frames' display window in pixels, which the cameras must match.

    Raises
    ------
    FileError
        If the file cannot be read, contains an invalid camera, or is for images of another size. The message names the
        frame and the field.
    """
    try:
        content = read_json(path)
    except OSError as error:
        raise unreadable(path, error) from error
    except ValueError as error:
        raise FileError(f"{path}: expected JSON, found something else ({error})") from error
    if not isinstance(content, dict) or not isinstance(content.get("cameras"), list):
        raise FileError(f"{path}: expected an object with a list of cameras, found {shown(content)}")
    common = {name: content[name] for name in ("width", "height", "axes") if name in content}
    if str(content.get("renderer")).startswith("Mitsuba"):
        common.setdefault("axes", "mitsuba")
    cameras: dict[int, Camera] = {}
    for entry in content["cameras"]:
        frame = entry.get("frame") if isinstance(entry, dict) else None
        if type(frame) is not int or frame in cameras:
            raise FileError(f"{path}: expected cameras of different frames, found {shown(entry)}")
        size = tuple({**common, **entry}.get(name) for name in ("height", "width"))
        if shape and size not in (shape, (None, None)):
            raise FileError(
                f"{path}: camera of frame {frame}: expected the width {shape[1]} and height {shape[0]} of the"
                f" frames, got {shown(size[1])} and {shown(size[0])}"
            )
        try:
            cameras[frame] = _camera({**common, **entry})
        except ArgumentError as error:
            raise FileError(f"{path}: camera of frame {frame}: {error}") from error
    return cameras


def camera_of_header(attributes: Mapping[str, Attribute], shape: tuple[int, int]) -> Camera | None:
    """Make a camera from the attributes of a part of an OpenEXR file, see `Camera.from_matrices`.

    Parameters
    ----------
    attributes : mapping
        Type and bytes by name, as `svgf_cl.io.exr_header.read_attributes` returns them.
    shape : (int, int)
        (height, width) of the display window in pixels.

    Returns
    -------
    Camera or None
        None if ``worldToCamera`` or ``worldToNDC`` is missing.

    Raises
    ------
    ArgumentError
        If an attribute is no matrix, or the two do not belong to one camera.
    """
    if not {"worldToCamera", "worldToNDC"} <= attributes.keys():
        return None
    return Camera.from_matrices(_attribute(attributes, "worldToCamera"), _attribute(attributes, "worldToNDC"), shape)


def _attribute(attributes: Mapping[str, Attribute], name: str) -> Array:
    """Return the matrix in an attribute of a header."""
    kind, content = attributes[name]
    number = np.dtype(ATTRIBUTES.get(kind, "<f4"))
    if kind not in ATTRIBUTES or len(content) != 16 * number.itemsize:
        raise ArgumentError(name, "16 numbers of type m44f or m44d", f"{len(content)} bytes of type {kind}")
    return np.frombuffer(content, number).reshape(4, 4).astype(np.float64)


def _camera(entry: Mapping[str, Any]) -> Camera:
    """Return the camera of an entry, which includes the fields that the file sets for all cameras."""
    axes: Any = entry.get("axes")
    matrices = [name for name in ("to_world", "world_to_camera") if name in entry]
    if len(matrices) != 1:
        raise ArgumentError("to_world", "either to_world or world_to_camera", " and ".join(matrices) or "neither")
    matrix = rigid(matrices[0], _numbers(entry, matrices[0], (4, 4)))
    to_world, to_camera = (matrix, inverse(matrix)) if matrices == ["to_world"] else (inverse(matrix), matrix)
    if "focal" not in entry:
        fov, fov_axis = float(_numbers(entry, "fov", ())), entry.get("fov_axis")
        shape = _size(entry, "height"), _size(entry, "width")
        return Camera.from_fov(to_world, fov, shape, fov_axis, axes)  # type: ignore[arg-type]  # from_fov checks them
    orthographic = entry.get("orthographic", False)
    if not isinstance(orthographic, bool):
        raise ArgumentError("orthographic", "true or false", shown(orthographic))
    focal, center = _numbers(entry, "focal", (2,)).tolist(), _numbers(entry, "center", (2,)).tolist()
    to_view = view_axes("axes", axes) @ to_camera
    return Camera(world_to_view=to_view, focal=focal, center=center, orthographic=orthographic)


def _size(entry: Mapping[str, Any], name: str) -> int:
    """Return the image's width or height in pixels."""
    value = entry.get(name)
    if type(value) is not int:
        raise ArgumentError(name, "a whole number of pixels", shown(value) if name in entry else "nothing")
    return value


def _numbers(entry: Mapping[str, Any], name: str, shape: tuple[int, ...]) -> Array:
    """Return the numbers in a field of an entry, as an array of `shape`."""
    value = entry.get(name)
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.empty(0)
    if array.dtype.kind not in "iuf" or array.shape != shape:
        raise ArgumentError(name, EXPECTED[shape], shown(value) if name in entry else "nothing")
    return array.astype(np.float64)


def cameras_beside(path: Path) -> Path | None:
    """Return the file of cameras in a frame's folder, or else in its parent folder, or None."""
    folder = path.resolve().parent
    return next((file for file in (folder / NAME, folder.parent / NAME) if file.is_file()), None)
