from __future__ import annotations

import numpy as np
import pytest

from tracer import BUILTIN, SceneError, builtin_scene, render_sequence


@pytest.mark.parametrize("name", BUILTIN)
def test_the_whole_path_stays_inside(name: str) -> None:
    scene = builtin_scene(name)
    seen = set()
    for frame in render_sequence(scene, scene.camera_path, (36, 64), 12):
        assert np.isfinite(frame.depth).all()
        assert frame.depth.min() > 0.5
        seen |= set(frame.id.ravel().tolist())
    assert seen == set(scene.triangles.instance.tolist())


def test_unknown_names_are_refused_with_the_known_ones() -> None:
    with pytest.raises(SceneError, match="cornell"):
        builtin_scene("teapot")
