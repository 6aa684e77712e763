"""Channels are grouped into passes, whatever they are called and in whatever order they come."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.io.readers.passes import by_view_layer, called, plain

BLENDER = ["Main Layer.Combined.R", "Main Layer.Combined.G", "Main Layer.Combined.B", "Main Layer.Combined.A",
           "Main Layer.Vector.X", "Main Layer.Vector.Y", "Main Layer.Vector.Z", "Main Layer.Vector.W",
           "Main Layer.CryptoObject00.r", "Main Layer.CryptoObject00.g", "Main Layer.CryptoObject00.b",
           "Main Layer.CryptoObject00.a", "Main Layer.Depth.Z"]  # fmt: skip


@given(st.permutations(BLENDER))
def test_components_are_in_their_order_whatever_that_of_the_channels(channels: list[str]) -> None:
    (view_layer, passes), *rest = by_view_layer(channels).items()
    assert not rest
    assert view_layer == "Main Layer"
    assert passes["combined"] == tuple(BLENDER[:4])
    assert passes["vector"] == tuple(BLENDER[4:8])
    assert passes["cryptoobject00"] == tuple(BLENDER[8:12])
    assert passes["depth"] == ("Main Layer.Depth.Z",)


@pytest.mark.parametrize(
    ("channels", "name"),
    [
        (("R", "G", "B", "A"), ""),
        (("diffuse.red", "diffuse.green", "diffuse.blue"), "diffuse"),
        (("pp.X", "pp.Y", "pp.Z"), "pp"),
        (("dd.T",), "dd"),
        (("idx.I",), "idx"),
        (("uv.U", "uv.V"), "uv"),
        (("Z",), "z"),
        (("zDepth",), "zdepth"),
        (("Denoising_Albedo.R", "Denoising_Albedo.G"), "denoisingalbedo"),
    ],
)
def test_names_of_renderers(channels: tuple[str, ...], name: str) -> None:
    assert by_view_layer(channels) == {"": {name: channels}}


def test_the_last_dot_but_one_ends_the_view_layer() -> None:
    assert by_view_layer(["Ebene.001 ü.Depth.Z"]) == {"Ebene.001 ü": {"depth": ("Ebene.001 ü.Depth.Z",)}}


def test_passes_that_differ_in_capitals_are_not_mixed() -> None:
    channels = [f"{name}.{c}" for name in ("n", "N") for c in "XYZ"]
    assert by_view_layer(channels) == {"": {"n": ("N.X", "N.Y", "N.Z")}}


def test_a_component_that_is_there_twice_is_taken_once() -> None:
    assert by_view_layer(["N.X", "N.Y", "N.Z", "N.R"]) == {"": {"n": ("N.R", "N.Y", "N.Z")}}


@given(st.text())
def test_a_plain_name_stays_as_it_is(name: str) -> None:
    assert plain(plain(name)) == plain(name)


def test_a_user_may_mean_a_channel_a_pass_or_one_of_the_view_layer() -> None:
    channels = [*BLENDER, "Z", "Fog.Depth.Z"]
    assert called("Z", channels, "Main Layer") == ("Z",)
    assert called("Depth", channels, "Main Layer") == ("Main Layer.Depth.Z",)
    assert called("Depth", channels, "Fog") == ("Fog.Depth.Z",)
    assert called("Fog.Depth", channels, "Main Layer") == ("Fog.Depth.Z",)
    assert called("vector", channels, "Main Layer") == tuple(BLENDER[4:8])
    assert called("Main Layer.Vector.X", channels, "Main Layer") == ("Main Layer.Vector.X",)
    assert called("Mist", channels, "Main Layer") == ()
