"""What may stand for a scene or a sky on the command line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import svgf_cl_tracer
from svgf_cl.errors import SvgfError
from svgf_cl.io.pictures import write_picture
from svgf_cl_tracer.cli.scenes import open_scene, read_sky

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def test_a_sky_is_three_radiances_or_an_image(tmp_path: Path) -> None:
    assert read_sky("1,2.5,3") == (1, 2.5, 3)
    write_picture(tmp_path / "1,2,3.exr", np.full((2, 4, 3), 7))
    assert (read_sky(str(tmp_path / "1,2,3.exr")).image == 7).all()
    with pytest.raises(SvgfError, match=r"sky\.hdr: expected a file"):
        read_sky(str(tmp_path / "sky.hdr"))


def test_a_built_in_scenes_name_is_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("cornell").mkdir()  # such as the output of an earlier run
    assert len(open_scene("cornell", None).instances) > 1
    with pytest.raises(svgf_cl_tracer.SceneError, match=r"expected a scene\.json in this folder"):
        open_scene("./cornell", None)


def test_a_file_is_lit_as_asked(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(TRIANGLE)
    assert open_scene(str(tmp_path / "a.obj"), (1, 2, 3)).sky == (1, 2, 3)


def test_a_built_in_scene_has_its_own_lights() -> None:
    for sky, alternative in (((1, 1, 1), False), (None, True)):
        with pytest.raises(SvgfError, match="cornell: expected a file or folder to light otherwise"):
            open_scene("cornell", sky, alternative_lights=alternative)
