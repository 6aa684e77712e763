"""Channels that look like a field under another renderer's name are told from those that do not."""

from __future__ import annotations

import pytest

from svgf_cl.io.look_alikes import advice, grouped, look_alikes
from svgf_cl.io.readers.own import CHANNEL_NAMES, needed

ALIKE = [
    ("depth", "Z"), ("depth", "depth"), ("depth", "Depth.Z"), ("depth", "ViewLayer.Depth.Z"), ("depth", "ViewLayer.Z"),
    ("depth", "rgba.Z"), ("depth", "depth.R"), ("depth", "dd.T"), ("depth", "VRayZDepth"), ("depth", "zDepth.V"),
    ("normal", "N.X"), ("normal", "Normal.X"), ("normal", "normal.x"), ("normal", "Ns.X"), ("normal", "nn.X"),
    ("normal", "View Layer.Denoising Normal.X"), ("normal", "normals.R"), ("normal", "World Normal.X"),
    ("albedo", "Albedo.R"), ("albedo", "albedo.r"), ("albedo", "albedo.red"), ("albedo", "a.Denoising Albedo.R"),
    ("albedo", "diffuse_albedo.R"), ("albedo", "DiffCol.R"), ("albedo", "ALBEDO.R"), ("albedo", "base-color.R"),
    ("motion", "Vector.X"), ("motion", "motionvector.X"), ("motion", "motion_vector.R"), ("motion", "velocity.X"),
    ("id", "IndexOB.X"), ("id", "ID"), ("id", "id.R"), ("id", "objectId"), ("id", "idx.I"), ("id", "id.X"),
    ("emission", "Emit.R"), ("emission", "Emission.R"), ("emission", "selfIllumination.red"),
    ("color", "Combined.R"), ("color", "r"), ("color", "beauty.R"), ("color", "rgba.R"),
    ("direct", "Direct.R"), ("indirect", "GI.R"), ("roughness", "Roughness"), ("diffuse", "Diffuse.R"),
]  # fmt: skip
OTHER = [
    "A", "alpha", "R", "uv.U", "Mist.Z", "AO.R", "Shadow.R", "Env.R", "CryptoObject00.r",
    "samples", "Debug Sample Count.X", "Normal.A", "idle", "Combined.A", "ZZ", "holdout", "Y", "depth_of_field_mask",
]  # fmt: skip


@pytest.mark.parametrize(("field", "channel"), ALIKE)
def test_other_names_of_a_field(field: str, channel: str) -> None:
    assert look_alikes([channel], CHANNEL_NAMES) == {field: [channel]}


def test_what_is_something_else_raises_no_alarm() -> None:
    positions = [f"{layer}.{component}" for layer in ("P", "pp", "Position") for component in "XYZ"]
    fields = [field for field in CHANNEL_NAMES if field != "color"]
    assert look_alikes([*OTHER, *positions], fields) == {}


def test_the_likeliest_come_first_and_only_these_are_shown() -> None:
    names = [f"V.{layer}.{c}" for layer in ("Ng", "Denoising Normal", "Normal") for c in "XYZ"]
    assert look_alikes(names, ["normal"]) == {"normal": ["V.Normal.X Y Z", "V.Denoising Normal.X Y Z"]}


def test_layers_are_named_once() -> None:
    assert grouped(["R", "G", "B", "a.b.X", "a.b.Y", "c.X", "id", "hit_distance.diffuse"]) == (
        "R G B a.b.X Y c.X id hit_distance.diffuse"
    )


def test_advice_says_what_to_map() -> None:
    wanted = {field: needed(field) for field in ("depth", "motion", "albedo")}
    assert advice(["R", "Z", "Vector.X", "Vector.Y", "A"], wanted) == (
        "Z looks like depth: if it is, give --map depth=Z; "
        "Vector.X Y looks like motion: if it is, give --map motion=Vector"
    )
    assert advice(["albedo.R", "albedo.G", "albedo.b"], wanted) == (
        "albedo.b looks like albedo: if it is, give --map albedo=albedo"
    ), "what has its right name already needs no other"
    assert advice(["A", "samples"], wanted) == ""
    assert "albedo='V.Denoising Albedo'" in advice([f"V.Denoising Albedo.{c}" for c in "RGB"], wanted)
