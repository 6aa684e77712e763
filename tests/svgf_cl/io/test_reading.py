"""How files become frames: any order of channels, whatever lies beside, and what the user says of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from svgf_cl import FileError, Frame, open_sequence
from svgf_cl.errors import SvgfError
from svgf_cl.io.image import new_image
from svgf_cl.io.reading import ReadAs, Reading
from tests.renderers import (
    ARNOLD_HEADER,
    BLENDER_HEADER,
    SHAPE,
    VRAY_HEADER,
    Header,
    Planes,
    arnold,
    blender,
    moment,
    own,
    same_frames,
    truth,
    vray,
    written,
)

AT = moment(2)
FILE = Path("shot_0002.exr")
MAKERS: dict[str, tuple[Callable[[], Planes], Header]] = {
    "blender": (lambda: blender(AT, "Main Layer"), BLENDER_HEADER),
    "arnold": (lambda: arnold(AT, motion=True), ARNOLD_HEADER),
    "vray": (lambda: vray(AT), VRAY_HEADER),
    "max": (lambda: vray(AT, "max"), VRAY_HEADER),
    "svgf_cl": (lambda: own(AT), {}),
}
# What other passes of the same renderer, of a user or of another program may be called.
JUNK = [
    "Main Layer.Denoising Normal.X", "Main Layer.Denoising Depth.Z", "Main Layer.Noisy Image.R", "Main Layer.AO.R",
    "Main Layer.normal.X", "Main Layer.Normal Map.X", "Main Layer.Mist.Z", "Main Layer.CryptoMaterial00.r",
    "normal_smooth.X", "N_world.X", "depth_mask", "n.X", "n.Y", "n.Z", "Albedo2.R", "zz.Z", "motionvector2.X",
    "Velocity.v2.red", "crypto_material00.R", "user.data.with.dots.X", "Ä.ö", "depth.Q", "a b.R", "uv.U", "samples",
    "AOV 1.Position.X", "normal..X",
]  # fmt: skip


def reading(planes: Planes, header: Header, **how: object) -> Reading:
    return Reading(FILE, new_image(planes, header), ReadAs(**how))  # type: ignore[arg-type]


def frame_of(planes: Planes, header: Header, **how: object) -> Frame:
    return reading(planes, header, **how).frame(FILE, planes)


@pytest.mark.parametrize("renderer", MAKERS)
@settings(deadline=None, max_examples=25)
@given(data=st.data())
def test_neither_order_nor_further_channels_change_a_frame(renderer: str, data: st.DataObject) -> None:
    make, header = MAKERS[renderer]
    planes = make()
    junk = data.draw(st.lists(st.sampled_from([name for name in JUNK if name not in planes]), unique=True))
    rubbish = np.full(SHAPE, np.float32(7.5))
    order = data.draw(st.permutations([*planes, *junk]))
    shuffled = {name: planes.get(name, rubbish) for name in order}
    found = reading(shuffled, header)
    assert found.reader.name == ("vray" if renderer == "max" else renderer)
    same_frames([found.frame(FILE, shuffled)], [frame_of(planes, header)])


@pytest.mark.parametrize("renderer", MAKERS)
def test_half_floats_make_the_frame_of_their_values(renderer: str) -> None:
    make, header = MAKERS[renderer]
    exact = {"id", "render_id.I", "VRayRenderID", *(f"crypto_object00.{c}" for c in "RGBA")}
    with np.errstate(over="ignore"):  # the depth of nothing is infinite
        halves = {name: plane if name in exact else plane.astype(np.float16) for name, plane in make().items()}
    rounded = {name: plane if name in exact else plane.astype(np.float32) for name, plane in halves.items()}
    same_frames([frame_of(halves, header)], [frame_of(rounded, header)])


# What the user says


def test_a_format_overrides_what_the_file_tells() -> None:
    """Such as a file of Arnold that went through a program that dropped its attributes."""
    planes = arnold(AT, motion=True)
    assert reading(planes, {}).reader.name == "svgf_cl"
    same_frames([frame_of(planes, {}, format="arnold")], [truth(AT)])
    with pytest.raises(SvgfError, match=r"--format: expected svgf_cl or blender or .*, got 'maya'"):
        frame_of(planes, {}, format="maya")


def test_fields_are_mapped_to_channels_and_passes() -> None:
    planes = {
        "R": AT.frame.color[..., 0], "G": AT.frame.color[..., 1], "B": AT.frame.color[..., 2],
        "Tiefe": AT.frame.depth,
        **{f"Normale (Welt).{c}": AT.frame.normal[..., i] for i, c in enumerate("XYZ")},
        **{f"flow.{c}": AT.frame.motion[..., i] for i, c in enumerate("uv")},
        "objects.I": AT.frame.id.astype(np.float32),
    }  # fmt: skip
    passes = {"depth": "Tiefe", "normal": "normale welt", "motion": "flow", "id": "objects"}
    same_frames([frame_of(planes, {}, passes=passes)], [truth(AT, "albedo", "emission")])


@pytest.mark.parametrize("renderer", MAKERS)
def test_an_id_is_mapped_to_any_pass_of_numbers(renderer: str) -> None:
    make, header = MAKERS[renderer]
    numbers = np.arange(SHAPE[0] * SHAPE[1], dtype=np.float32).reshape(SHAPE)
    for plane in (numbers, numbers.astype(np.uint32)):
        frame = frame_of({**make(), "material.I": plane}, header, passes={"id": "material"})
        np.testing.assert_array_equal(frame.id, numbers.astype(np.uint32), strict=True)


@pytest.mark.parametrize(
    ("passes", "words"),
    [
        ({"normal": "Tiefe"}, r"shot_0002\.exr: expected a pass or channel Tiefe for normal, found R G B normal.X Y Z"),
        ({"normal": "depth"}, r"expected 3 components of normal in depth, found 1"),
        ({"motion": "normal.X"}, r"expected 2 components of motion in normal.X, found 1"),
        ({"depht": "Z"}, r"--map: expected one of color, .*, got 'depht'"),
    ],
)
def test_a_wrong_map_is_refused(passes: dict[str, str], words: str) -> None:
    with pytest.raises(SvgfError, match=words):
        frame_of(own(AT), {}, passes=passes)


@pytest.mark.parametrize("renderer", MAKERS)
def test_motion_is_scaled_and_turned_round_after_the_renderer_s_own_axes(renderer: str) -> None:
    make, header = MAKERS[renderer]
    planes = make()
    plain, scaled = (frame_of(planes, header, motion_scale=scale).motion for scale in ((1.0, 1.0), (32.0, -20.0)))
    np.testing.assert_array_equal(scaled[..., :2], plain[..., :2] * np.float32((32, -20)))
    np.testing.assert_array_equal(scaled[..., 2:], plain[..., 2:])


def test_a_camera_stands_still_if_the_user_says_so_alone() -> None:
    planes = {name: plane for name, plane in blender(AT).items() if ".Vector." not in name}
    with pytest.raises(FileError, match=r"if neither the camera nor any object moves, give --still-camera"):
        frame_of(planes, {})
    assert not frame_of(planes, {}, still_camera=True).motion.any()
    assert frame_of(blender(AT), {}, still_camera=True).motion.any(), "the file tells it"


# What is computed


def test_a_shot_of_files_that_no_renderer_is_known_of_tells_what_looks_like_a_field(tmp_path: Path) -> None:
    planes = {name: plane for name, plane in own(AT).items() if not name.startswith(("normal", "depth"))}
    planes |= {"Z": AT.frame.depth, **{f"World Normal.{c}": AT.frame.normal[..., i] for i, c in enumerate("XYZ")}}
    frames = open_sequence(written(tmp_path, {2: {n: np.ascontiguousarray(p) for n, p in planes.items()}}))
    with pytest.raises(FileError, match=r"--map normal='World Normal'; Z looks like depth: .* --map depth=Z"):
        frames[0]
    assert open_sequence(tmp_path, passes={"normal": "World Normal", "depth": "Z"})[0].depth.any()
