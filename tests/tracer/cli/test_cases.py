"""The EXR files of ../shared/cases, which once failed, give what they should."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl.io.exr import read_image
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.sequence import find_frames
from svgf_cl_tracer import load_environment
from tests.command_line import run

CASES = Path(__file__).parents[4] / "shared" / "cases" / "exr"
pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="takes ../shared/cases/exr beside the checkout")


@pytest.mark.parametrize(
    ("name", "mended"),
    [("sky_in_a_layer", ""), ("tiny_negative", "1 pixel negative"), ("inf_sun", "1 pixel infinite")],
)
def test_a_sky(name: str, mended: str, recwarn: pytest.WarningsRecorder) -> None:
    image = load_environment(CASES / f"{name}.exr").image
    assert [mended in str(warning.message) for warning in recwarn] == ([True] if mended else [])
    np.testing.assert_array_equal(np.median(image, axis=(0, 1)), (1.0, 0.5, 0.25))
    assert np.isfinite(image).all()
    assert image.min() >= 0.0


def test_a_still_bar_behind_a_moving_window(tmp_path: Path) -> None:
    assert run("denoise", CASES / "moving_window", "-o", tmp_path) == 0
    for source in find_frames([CASES / "moving_window"]):
        assert read_image(tmp_path / source.name).windows == read_image(source).windows
    picture = read_picture(tmp_path / "frame.0007.exr")[:, 56:216, 0]
    bar = np.where(picture.mean(axis=0) > 0.5, 1.0, 0.1)
    assert np.sqrt(np.square(picture - bar).mean()) < 0.06


def test_a_frame_in_two_parts(tmp_path: Path) -> None:
    assert run("denoise", CASES / "two_parts", "-o", tmp_path) == 0
    for source in find_frames([CASES / "two_parts"]):
        before, after = read_image(source), read_image(tmp_path / source.name)
        assert [part.planes.keys() for part in after.parts] == [part.planes.keys() for part in before.parts]
        assert [part.attributes for part in after.parts] == [part.attributes for part in before.parts]
        for name, plane in before.planes.items():
            assert (after.planes[name].tobytes() == plane.tobytes()) == (name not in "RGB")
