"""Pipelines: everything read was written before, everything written is read, and kernels find every plane."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_array_equal

from svgf_cl import Inputs, Settings
from svgf_cl.device.layout import HALO
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.formats import Format, Planes
from svgf_cl.filters.pipeline import OUT, Buffer, Life, Pass, Pipeline, Quantity, Resource, access, user
from svgf_cl.filters.taps import grid
from tests.svgf_cl.filters.strategies import every_filter, every_inputs, every_pipeline

RGB = Resource("rgb", "picture", (Quantity("color", 3),))
COARSE = Resource("coarse", "coarse", (Quantity("mean"),), spacing=2)
COARSER = Resource("coarser", "coarse", (Quantity("mean"),), spacing=4)


class TestResource:
    def test_planes_of_a_quantity_lie_together_signal_by_signal(self) -> None:
        light = Resource("light", "light", (Quantity("color", 3, signals=2), Quantity("variance", signals=2)))
        assert light.defines == {
            "LIGHT_COLOR": 0,
            "LIGHT_COLOR_CHANNELS": 3,
            "LIGHT_VARIANCE": 6,
            "LIGHT_VARIANCE_CHANNELS": 1,
        }

    def test_planes_are_counted_by_their_width(self) -> None:
        guide = Resource("guide", "guide", (Quantity("depth"), Quantity("normal", 3, format=Format.SNORM)))
        assert guide.planes == Planes(1, 3)

    @pytest.mark.parametrize(
        "formats",
        [(Format.SNORM, Format.FLOAT), (Format.FLOAT, Format.SNORM, Format.HALF)],
        ids=["32 bits behind 16", "two in 16 bits behind one in 32"],
    )
    def test_what_kernels_could_not_address_is_refused(self, formats: tuple[Format, ...]) -> None:
        with pytest.raises(ValueError, match="mixed: expected quantities all in 32 bits, all in 16, or one in 16"):
            Resource("mixed", "mixed", tuple(Quantity(f"q{i}", format=each) for i, each in enumerate(formats)))


class TestAccess:
    def test_takes_all_at_the_pixel_unless_told_otherwise(self) -> None:
        (use,) = access(RGB).uses
        assert (use.quantity, use.taps) == (RGB.quantities[0], grid(0))
        assert access(RGB, taps={}).uses == ()

    def test_names_the_argument(self) -> None:
        assert [access(RGB).argument, access(RGB, previous=True).argument] == ["rgb", "previous_rgb"]
        assert access(RGB, "target").argument == "target"

    @pytest.mark.parametrize(("name", "channels"), [("color", 3), ("depth", 1), ("id", 1), ("motion", 3), (OUT, 3)])
    def test_knows_the_users_arrays(self, name: str, channels: int) -> None:
        assert user(name).uses[0].quantity.nbytes == 4 * channels


class TestPipeline:
    def test_kinds_that_disagree_are_refused(self) -> None:
        other = Resource("other", "picture", (Quantity("depth"), Quantity("color", 3)))
        passes = (Pass("a", "a", writes=(access(RGB), access(other))),)
        with pytest.raises(ValueError, match="other: expected PICTURE_COLOR 0 as in others, got 1"):
            _ = Pipeline(passes).defines

    def test_a_read_of_what_nobody_wrote_is_refused(self) -> None:
        with pytest.raises(ValueError, match="b: expected a buffer that was written before, got rgb"):
            Pipeline((Pass("b", "b", reads=(access(RGB),)), Pass("a", "a", writes=(access(RGB),))))

    def test_names_that_would_hide_others_are_refused(self) -> None:
        with pytest.raises(ValueError, match="passes and stages of different names, got a, a"):
            Pipeline((Pass("a", "a"), Pass("a", "a")))
        with pytest.raises(ValueError, match="a: expected arguments of different names, got size, out, out"):
            Pass("a", "a", reads=(user("color", "out"),), writes=(user("out"),))

    def test_coarse_buffers_have_a_size_of_their_own(self) -> None:
        fine = Pass("a", "a", reads=(user("color"),), writes=(access(RGB),))
        down = Pass("b", "b", reads=(access(RGB),), writes=(access(COARSE),))
        up = Pass("c", "c", reads=(access(COARSE),), writes=(user(OUT),))
        assert [entry.sizes for entry in (fine, down, up)] == [("size",), *[("size", "coarse_size")] * 2]
        assert [entry.spacing for entry in (fine, down, up)] == [1, 2, 1]
        assert [entry.coarse_spacing for entry in (fine, down, up)] == [1, 2, 2]
        assert down.arguments == ("size", "coarse_size", "rgb", "coarse")

    @pytest.mark.parametrize(
        ("reads", "writes"), [((COARSE,), (COARSER,)), ((RGB,), (RGB, COARSE)), ((COARSE, COARSER), (RGB,))]
    )
    def test_two_sizes_beside_the_image_are_refused(
        self, reads: tuple[Resource, ...], writes: tuple[Resource, ...]
    ) -> None:
        with pytest.raises(ValueError, match="a: expected to write every pixel or every so many"):
            Pass(
                "a",
                "a",
                reads=tuple(access(each, "r" + each.name) for each in reads),
                writes=tuple(map(access, writes)),
            )

    def test_a_buffer_that_is_written_over_is_read_no_more(self) -> None:
        over = Resource("over", "picture", (Quantity("color", 3),), over="rgb")
        first, second = (
            Pass("a", "a", writes=(access(RGB),)),
            Pass("b", "b", reads=(access(RGB),), writes=(access(over),)),
        )
        Pipeline((first, second))
        late = Pass("c", "c", reads=(access(RGB), access(over)), writes=(user(OUT),))
        with pytest.raises(ValueError, match="c: expected rgb to be read before b writes over over it"):
            Pipeline((first, second, late))
        beside = replace(second, reads=(access(RGB, taps={"color": grid(1)}),))
        with pytest.raises(ValueError, match=r"b: expected rgb to be read .* at the pixel itself alone"):
            Pipeline((first, beside))

    def test_constant_arrays_are_apart_from_their_owners(self) -> None:
        weights = np.ones(3)
        entry = Pass("a", "a", arrays={"weights": weights})
        weights[:] = 2
        assert_array_equal(entry.arrays["weights"], 1)
        with pytest.raises(ValueError, match="read-only"):
            entry.arrays["weights"][0] = 2

    def test_numbers_alone_make_no_other_kernel(self) -> None:
        inputs = Inputs.every()
        plain = Settings().pipeline(inputs)
        assert Settings(sigma_depth=2, alpha_moments=0.5).pipeline(inputs).differs_in_scalars_alone(plain)
        assert not Settings(iterations=4).pipeline(inputs).differs_in_scalars_alone(plain)
        assert not Settings(precision="fast").pipeline(inputs).differs_in_scalars_alone(plain)

    @pytest.mark.parametrize(
        ("name", "chosen", "expected"),
        [
            ("guide", {}, Planes(6)),
            ("guide", {"half_guides": True}, Planes(3, 3)),
            ("guide", {"half_history": True}, Planes(6)),
            ("level_3", {}, Planes(8)),
            ("level_3", {"half_history": True}, Planes(0, 8)),
            ("moments", {"half_history": True}, Planes(0, 5)),
            ("modulated", {"half_guides": True, "half_history": True}, Planes(3)),
        ],
    )
    def test_settings_choose_how_planes_are_kept(self, name: str, chosen: dict, expected: Planes) -> None:
        resources = Settings(taa=True, **chosen).pipeline(Inputs.every()).resources
        assert [resource.planes for resource in resources if resource.name == name] == [expected]

    def test_the_largest_buffer_holds_colour_and_variance_of_two_signals(self) -> None:
        assert Settings().pipeline(Inputs.every()).widest == 8


class TestEveryFilter:
    @given(every_pipeline)
    def test_names_are_unique(self, pipeline: Pipeline) -> None:
        for names in (
            [entry.label for entry in pipeline.passes],
            [resource.name for resource in pipeline.resources],
            [name for name, _, _ in pipeline.shown()],
        ):
            assert len(set(names)) == len(names)

    @given(every_pipeline)
    def test_arguments_of_a_kernel_are_unique(self, pipeline: Pipeline) -> None:
        for entry in pipeline.passes:
            assert len(set(entry.arguments)) == len(entry.arguments)

    @given(every_filter, every_inputs)
    def test_everything_read_is_there(self, filter_: Filter, inputs: Inputs) -> None:
        pipeline = filter_.pipeline(inputs)
        there: set[Buffer | str] = {*inputs.fields}
        for resource in pipeline.lasting:  # from the last frame
            there.add(Buffer(resource, previous=resource.life is Life.PAIR))
        for entry in pipeline.passes:
            assert there.issuperset(each.of for each in entry.reads)
            there |= {each.of for each in entry.writes}
        assert OUT in {each.of for each in pipeline.passes[-1].writes}

    @given(every_filter, every_inputs)
    def test_every_field_and_every_result_is_read(self, filter_: Filter, inputs: Inputs) -> None:
        pipeline = filter_.pipeline(inputs)
        read = {each.of.resource for entry in pipeline.passes for each in entry.reads if isinstance(each.of, Buffer)}
        assert read == set(pipeline.resources)
        assert set(pipeline.fields) == set(inputs.fields)

    @given(every_pipeline)
    def test_every_quantity_is_written(self, pipeline: Pipeline) -> None:
        written = {
            (each.of.resource.name, use.quantity.name)
            for entry in pipeline.passes
            for each in entry.writes
            for use in each.uses
            if isinstance(each.of, Buffer)
        }
        assert written == {(each.name, name) for each in pipeline.resources for name in each.names}

    @given(every_pipeline)
    def test_who_reads_the_past_knows_whether_there_is_one(self, pipeline: Pipeline) -> None:
        """By the frame's number, or because what it reads says so."""
        for entry in pipeline.passes:
            past = [each.of.resource for each in entry.reads if isinstance(each.of, Buffer) and each.of.previous]
            assert "frame_number" in entry.per_frame or all(resource.tells_unknown for resource in past)

    @given(every_pipeline)
    def test_taps_stay_within_the_halo(self, pipeline: Pipeline) -> None:
        assert pipeline.reach <= HALO

    @given(every_pipeline)
    def test_every_pass_computes_something(self, pipeline: Pipeline) -> None:
        assert all(math.isfinite(entry.operations) and entry.operations > 0 for entry in pipeline.passes)
