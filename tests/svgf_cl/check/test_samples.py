"""Frames of other renderers: no alarm where they are right, and what is wrong with them is found."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Frame, check_sequence
from svgf_cl.check import Report
from svgf_cl.io.exr import read_image

SAMPLES = Path(__file__).parents[4] / "shared" / "samples"
PATHS = sorted((SAMPLES / "blender" / "noisy").glob("*.exr"))

pytestmark = pytest.mark.skipif(not SAMPLES.exists(), reason=f"{SAMPLES} is not here")


def stacked(planes: dict[str, np.ndarray], name: str, components: str) -> np.ndarray:
    return np.stack([planes[f"{name}.{component}"] for component in components], axis=-1)


def blender(path: Path) -> Frame:
    """A frame of Cycles, by the conventions that README.md of the samples found."""
    planes = read_image(path).planes
    depth = planes["Main Layer.Depth.Z"]
    missed = depth > 1e9
    albedo = stacked(planes, "Main Layer.DiffCol", "RGB") + stacked(planes, "Main Layer.GlossCol", "RGB")
    return Frame(
        color=stacked(planes, "Main Layer.Combined", "RGB"),
        normal=stacked(planes, "Main Layer.Normal", "XYZ"),
        depth=np.where(missed, np.inf, depth).astype(np.float32),
        motion=stacked(planes, "Main Layer.Vector", "XY") * np.float32([1, -1]),
        albedo=np.where(missed[..., None], 1, albedo).astype(np.float32),
        id=planes["Main Layer.IndexOB.X"].astype(np.uint32),
        emission=stacked(planes, "Main Layer.Emit", "RGB") + stacked(planes, "Main Layer.Env", "RGB"),
    )


def seen(points: np.ndarray, camera: dict) -> np.ndarray:
    """Column, row and depth of world points (H, W, 3); Mitsuba's cameras look along z, x to the left, y up."""
    height, width, _ = points.shape
    inverse = np.linalg.inv(np.array(camera["to_world"]))
    there = points @ inverse[:3, :3].T + inverse[:3, 3]
    focal = 0.5 * min(height, width) / np.tan(np.radians(camera["fov"] / 2))
    middle = np.array([width - 1, height - 1]) / 2
    return np.concatenate([middle - focal * there[..., :2] / there[..., 2:], there[..., 2:]], axis=-1)


def mitsuba(path: Path, number: int, cameras: dict[int, dict]) -> Frame:
    """A frame of Mitsuba, whose motion is made of positions and cameras."""
    planes = read_image(path).planes
    points = stacked(planes, "pp", "XYZ").astype(np.float64)
    now, before = (seen(points, cameras[frame]) for frame in (number, number - 1))
    missed = planes["dd.T"] <= 0
    return Frame(
        color=np.stack([planes[channel] for channel in "RGB"], axis=-1),
        normal=stacked(planes, "nn", "XYZ"),
        depth=np.where(missed, np.inf, now[..., 2]).astype(np.float32),
        motion=np.where(missed[..., None], 0, before - now).astype(np.float32),
        albedo=stacked(planes, "albedo", "RGB"),
        id=planes["idx.I"].astype(np.uint32),
    )


@pytest.fixture(scope="module")
def cycles() -> list[Frame]:
    return [blender(path) for path in PATHS]


@pytest.fixture(scope="module")
def report(cycles: list[Frame]) -> Report:
    return check_sequence(cycles)


def test_blender_raises_no_alarm(report: Report) -> None:
    assert not [str(finding) for finding in report.findings]


def test_blender_s_own_sign_of_motion_is_found(cycles: list[Frame]) -> None:
    raw = [replace(frame, motion=frame.motion * np.float32([1, -1])) for frame in cycles]
    assert [(found.field, found.what) for found in check_sequence(raw).findings] == [("motion", "y points up")]


@pytest.mark.parametrize("number", [1e10, 0.0, 3e38])
def test_a_number_for_depth_where_there_is_no_normal_is_a_miss(
    cycles: list[Frame], report: Report, number: float
) -> None:
    """Blender writes 1e10, and the denoiser takes it as one."""
    raw = [
        replace(frame, depth=np.where(np.isinf(frame.depth), number, frame.depth).astype(np.float32))
        for frame in cycles
    ]
    assert check_sequence(raw) == report


def test_the_next_frame_s_motion_in_the_third_component_is_found(cycles: list[Frame]) -> None:
    vectors = [stacked(read_image(path).planes, "Main Layer.Vector", "XYZ") for path in PATHS]
    raw = [
        replace(frame, motion=vector * np.float32([1, -1, 1])) for frame, vector in zip(cycles, vectors, strict=True)
    ]
    found = [(finding.field, finding.what) for finding in check_sequence(raw).findings]
    assert found == [("motion", "third component is not the change of depth")]


def test_blender_out_of_focus_raises_no_alarm() -> None:
    frames = [blender(path) for path in sorted((SAMPLES / "blender" / "noisy_dof_4spp").glob("*.exr"))]
    assert not [str(finding) for finding in check_sequence(frames).findings]


def test_mitsuba_numbers_shapes_anew_in_every_frame() -> None:
    """Its scene is loaded once a frame, and shapes come in another order; all else is right."""
    cameras = {
        camera["frame"]: camera for camera in json.loads((SAMPLES / "mitsuba/cameras.json").read_text())["cameras"]
    }
    paths = sorted((SAMPLES / "mitsuba" / "noisy").glob("*.exr"))
    found = check_sequence(mitsuba(path, number, cameras) for number, path in enumerate(paths)).findings
    assert [(finding.field, finding.what) for finding in found] == [
        ("id", "the same object changes its id between frames")
    ]
