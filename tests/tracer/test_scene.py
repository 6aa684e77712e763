from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tracer.errors import SceneError
from tracer.geometry import Instance
from tracer.materials import Material
from tracer.scene import Scene


def test_a_scene_that_emits_nothing_offers_a_sky(floor: Callable[[Material], Instance]) -> None:
    for sky in (None, (0.0, 0.0, 0.0)):
        with pytest.raises(SceneError, match="--sky"):
            Scene([floor(Material())], sky=sky)


def test_an_empty_scene_is_refused() -> None:
    with pytest.raises(SceneError, match="at least one triangle"):
        Scene([Instance(np.zeros((0, 3, 3)), Material())], sky=(1, 1, 1))


def test_vertices_that_are_not_finite_are_refused() -> None:
    with pytest.raises(SceneError, match="finite vertex"):
        Scene([Instance(np.full((1, 3, 3), np.nan), Material())], sky=(1, 1, 1))


@pytest.mark.parametrize("sky", [(-1.0, 0.0, 0.0), (np.nan, 1.0, 1.0), (np.inf, 1.0, 1.0)])
def test_skies_out_of_range_are_refused(floor: Callable[[Material], Instance], sky: tuple[float, ...]) -> None:
    with pytest.raises(SceneError, match="radiances >= 0"):
        Scene([floor(Material())], sky=sky)


def test_the_default_camera_sees_every_corner(quad: Callable[..., Instance]) -> None:
    scene = Scene([quad((3, -2, 5), (0, 4, 0), (6, 0, -9))], sky=(1, 1, 1))
    camera = scene.camera_path.at(0.5)
    corners = np.array([(3, -2, 5), (3, 2, 5), (9, -2, -4), (9, 2, -4)], float)
    x, y, depth = camera.project((corners - camera.position).T, (100, 100))
    assert depth.min() > 0
    assert min(x.min(), y.min()) > -0.5
    assert max(x.max(), y.max()) < 99.5
