from __future__ import annotations

from collections.abc import Callable

import pytest

from svgf_cl_tracer.camera import Camera, CameraPath, CarriedCamera
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.shot import Shot

PATH = CameraPath.through([Camera((0, 1, 5), (0, 0, 0)), Camera((4, 1, 5), (4, 0, 0))])


@pytest.fixture(scope="module")
def scene(floor: Callable[[Material], Instance]) -> Scene:
    return Scene([floor(Material())], sky=(1, 1, 1), camera_path=CameraPath.static(Camera((9, 9, 9), (0, 0, 0))))


def test_the_camera_covers_its_path_however_many_frames_there_are(scene: Scene) -> None:
    for frames in (2, 5, 9):
        shot = Shot(scene, (4, 4), frames, PATH)
        assert [shot.camera(number).position[0] for number in (0, (frames - 1) / 2, frames - 1)] == [0, 2, 4]


def test_a_single_frame_starts_the_path(scene: Scene) -> None:
    assert Shot(scene, (4, 4), 1, PATH).camera(0).position[0] == 0


def test_the_scenes_own_path_is_the_default(scene: Scene) -> None:
    assert Shot(scene, (4, 4)).camera(0).position == (9, 9, 9)


def test_a_frames_time_is_its_number_over_the_rate(scene: Scene) -> None:
    assert Shot(scene, (4, 4), 100, fps=50.0).time(25) == 0.5
    assert Shot(scene, (4, 4), 100).time(12.0) == 0.5


def test_a_carried_camera_keeps_the_time_of_a_clock(scene: Scene) -> None:
    way = CarriedCamera(Camera((0, 1, 5), (0, 0, 0)), Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)]))
    for frames in (1, 100):
        assert Shot(scene, (4, 4), frames, way, fps=10.0).camera(5).position == (2, 1, 5)


def test_the_origin_follows_the_camera_in_large_steps(quad: Callable[..., Instance]) -> None:
    wide = Scene(
        [quad((0, -1, 0), (1e6, 0, 0), (0, 2, 0)), *[quad((0, 0, 0), (1, 0, 0), (0, 1, 0))] * 2], sky=(1, 1, 1)
    )
    road = CameraPath.through([Camera((x, 0, 9), (x, 0, 0)) for x in (100.0, 1e6)])
    shot = Shot(wide, (4, 4), 10001, road)
    origins = {number: shot.origin(number) for number in range(0, 1001)}
    assert origins[0] == (100, 0, 0)
    assert 90 < len(set(origins.values())) < 110
    for number, origin in origins.items():
        assert abs(shot.camera(number).position[0] - origin[0]) <= 500 + 1e-6
    still = Shot(wide, (4, 4), 10, CameraPath.static(Camera((5e5, 7, 9), (5e5, 0, 0))))
    assert still.origin(0) == still.origin(9) == (5e5, 1, 0)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"shape": (0, 5)}, r"shape: .*\(0, 5\)"),
        ({"shape": (5, -1)}, r"shape: .*\(5, -1\)"),
        ({"frames": 0}, "frames: .* 0"),
        ({"fps": 0.0}, "fps: .* 0.0"),
        ({"fps": float("inf")}, "fps: .* inf"),
        ({"fps": float("nan")}, "fps: .* nan"),
    ],
)
def test_numbers_out_of_range_are_named(scene: Scene, wrong: dict, named: str) -> None:
    with pytest.raises(SceneError, match=named):
        Shot(**({"scene": scene, "shape": (4, 4)} | wrong))
