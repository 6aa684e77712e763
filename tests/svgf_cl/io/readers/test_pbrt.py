"""Frames of pbrt's film "gbuffer": in the camera's space or in the world's, old names and new, matrices either way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, Frame, open_sequence
from tests.renderers import NUMBERS, Header, Planes, cameras_file, matrices, moments, pbrt, same_frames, truth, written

# Headers and positions are single precision.
TOLERANCE = {"depth": 2e-5, "motion": 1e-3, "normal": 1e-6}


def headers(**how: bool) -> dict[int, Header]:
    return {at.number: matrices(at, "pbrt", **how) for at in moments()}


def expected() -> list[Frame]:
    """Frames without ids, lamps and sky; nothing tells the camera before the first."""
    frames = [truth(at, "id", "emission", motion=3) for at in moments()]
    frames[0].motion[:] = 0
    return frames


@pytest.mark.parametrize("space", ["camera", "world"])
@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize("transposed", [False, True])
def test_frames_are_read_in_either_space(space: str, old: bool, transposed: bool, tmp_path: Path) -> None:
    planes = {at.number: pbrt(at, space, old=old) for at in moments()}
    frames = open_sequence(written(tmp_path, planes, headers(transposed=transposed)))
    assert frames.reading.reader.name == "pbrt"
    same_frames(frames, expected(), TOLERANCE)


def test_a_mirrored_camera_is_told_from_where_its_positions_are_seen(tmp_path: Path) -> None:
    """Scale -1 1 1 in a scene turns the x of the camera's space round."""
    planes: dict[int, Planes] = {}
    for at in moments():
        own = pbrt(at)
        planes[at.number] = {name: -plane if name in ("P.X", "Ns.X", "N.X") else plane for name, plane in own.items()}
    same_frames(open_sequence(written(tmp_path, planes, headers())), expected(), TOLERANCE)


def test_the_space_may_be_told_with_jitter_and_misses(tmp_path: Path) -> None:
    """Positions are averages over a pixel's hits, which do not lie at its middle."""
    rng, planes = np.random.default_rng(5), {}
    for at in moments():
        own = pbrt(at, "world")
        jitter = at.camera.unproject(np.where(at.hit, at.frame.depth, 1.0)) - at.camera.unproject(
            np.where(at.hit, at.frame.depth, 1.0) * rng.uniform(0.98, 1.02, at.frame.shape)
        )
        for i, c in enumerate("XYZ"):
            own[f"P.{c}"] = np.where(at.hit, own[f"P.{c}"] + jitter[..., i], 0).astype(np.float32)
        planes[at.number] = own
    for frame, wanted in zip(open_sequence(written(tmp_path, planes, headers())), expected(), strict=True):
        np.testing.assert_allclose(frame.normal, wanted.normal, atol=1e-6)


def test_cameras_may_lie_beside_the_frames(tmp_path: Path) -> None:
    cameras_file(tmp_path, (0, *NUMBERS))
    frames = open_sequence(written(tmp_path, {at.number: pbrt(at) for at in moments()}))
    same_frames(frames, [truth(at, "id", "emission", motion=3) for at in moments()], TOLERANCE)


def test_a_file_without_the_camera_is_refused(tmp_path: Path) -> None:
    frames = open_sequence(written(tmp_path, {at.number: pbrt(at) for at in moments()}))
    with pytest.raises(FileError, match=r"expected depth, motion in a file of pbrt-v4, .*; give the camera of each"):
        frames[0]


def test_a_camera_that_is_none_is_refused_by_the_name_of_its_file(tmp_path: Path) -> None:
    broken = headers()
    broken[2]["worldToNDC"] = "m44f", bytes(64)
    frames = open_sequence(written(tmp_path, {at.number: pbrt(at) for at in moments()}, broken))
    assert frames[0].depth.any()
    with pytest.raises(FileError, match=r"shot_0002\.exr: .*world_to_ndc\): expected the projection .*--cameras FILE"):
        frames[1]


def test_missing_passes_are_named_with_the_film_that_has_them(tmp_path: Path) -> None:
    for lost, field in (("Ns N", "normal"), ("P", "depth, motion"), ("R G B A", "color")):
        planes = {
            at.number: {c: p for c, p in pbrt(at).items() if c.split(".")[0] not in lost.split()} for at in moments()
        }
        frames = open_sequence(written(tmp_path / field, planes, headers()))
        with pytest.raises(FileError, match=rf'shot_0001\.exr: expected {field} in a file of pbrt-v4, Film "gbuffer"'):
            frames[0]


def test_components_of_an_old_name_that_are_missing_are_named(tmp_path: Path) -> None:
    planes = {at.number: pbrt(at, old=True) for at in moments()}
    for own in planes.values():
        del own["Py"]
    with pytest.raises(FileError, match=r"shot_0001\.exr: expected channels Px Py Pz, found only Px Pz"):
        open_sequence(written(tmp_path, planes, headers()))
