"""Light passes are denoised one by one and still add up to the picture, whatever they hold."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Denoiser, Frame
from svgf_cl.filters import DEFAULT
from svgf_cl.io.shot import Light
from svgf_cl.io.synthetic import room_frame
from svgf_cl.lights import Denoised, single
from svgf_cl.shot_denoiser import Method, ShotDenoiser

SHAPE = (24, 40)
FRAMES = 3
PASSES = {"direct": ("d.R", "d.G", "d.B"), "indirect": ("i.R", "i.G", "i.B"), "emission": ("e.R", "e.G", "e.B")}

Shot = list[tuple[Frame, list[Light]]]


def noise(seed: int, scale: float = 1.0) -> np.ndarray:
    return np.random.default_rng(seed).exponential(scale, (*SHAPE, 3)).astype(np.float32)


def frame_of(number: int, lights: Sequence[Light], color: np.ndarray | None = None) -> Frame:
    """The room with the picture that is the sum of these lights, or with another one."""
    room = room_frame(SHAPE, number, number - 1)
    return replace(room, color=total(lights) if color is None else color)


def total(lights: Sequence[Light]) -> np.ndarray:
    terms = [light.radiance if light.factor is None else light.radiance * light.factor for light in lights]
    return np.sum(terms, axis=0, dtype=np.float32)


def diffuse(number: int, **changes: object) -> list[Light]:
    """Direct and indirect light before an albedo, and a lamp that is free of noise."""
    factor = np.asarray(room_frame(SHAPE, number, number - 1).albedo)
    lamp = np.zeros((*SHAPE, 3), np.float32)
    lamp[2:4, 5:9] = 30.0
    return [
        Light(PASSES["direct"], noise(number), factor, ("a.R", "a.G", "a.B")),
        Light(PASSES["indirect"], noise(100 + number, 0.3), factor, ("a.R", "a.G", "a.B")),
        Light(PASSES["emission"], lamp, None, filtered=False),
    ]


def denoiser_of(**settings: object) -> ShotDenoiser:
    """One that leaves guides as they are."""
    return ShotDenoiser(SHAPE, Method(DEFAULT(**settings), prefilter="off"), len(PASSES))


def denoised(shot: Shot) -> list[Denoised]:
    denoiser = denoiser_of()
    return [denoiser.denoise(frame, lights) for frame, lights in shot]


def shot_of(make: object = diffuse) -> Shot:
    lights = [make(number) for number in range(FRAMES)]  # type: ignore[operator]
    return [(frame_of(number, each), each) for number, each in enumerate(lights)]


def sum_of(found: Denoised, lights: Sequence[Light]) -> np.ndarray:
    """What somebody who adds the passes of the written file gets."""
    return total([replace(light, radiance=found.lights.get(light.channels, light.radiance)) for light in lights])


def assert_adds_up(found: Denoised, lights: Sequence[Light]) -> None:
    """To a few roundings of the greatest term, in single precision."""
    assert np.isfinite(found.picture).all()
    added = sum_of(found, lights)
    np.testing.assert_allclose(added, found.picture, rtol=2e-6, atol=1e-6 * np.abs(added).max())


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_denoised_passes_add_up_to_the_denoised_picture(scale: float) -> None:
    def make(number: int) -> list[Light]:
        return [replace(light, radiance=light.radiance * np.float32(scale)) for light in diffuse(number)]

    shot = shot_of(make)
    for found, (_, lights) in zip(denoised(shot), shot, strict=True):
        assert found.lights.keys() == {PASSES["direct"], PASSES["indirect"]}
        assert_adds_up(found, lights)


def test_each_pass_is_filtered_as_if_it_were_alone() -> None:
    shot = shot_of()
    found = denoised(shot)[-1].lights[PASSES["direct"]]
    alone = Denoiser(SHAPE, settings=DEFAULT())
    for frame, lights in shot:
        single = Frame(
            color=lights[0].radiance, normal=frame.normal, depth=frame.depth, motion=frame.motion, id=frame.id
        )
        expected = alone.denoise(single)
    np.testing.assert_array_equal(found, expected)


def test_a_picture_without_passes_is_filtered_as_a_whole() -> None:
    alone = Denoiser(SHAPE, settings=DEFAULT())
    for found, (frame, _) in zip(denoised([(frame, []) for frame, _ in shot_of()]), shot_of(), strict=True):
        assert found.lights == {}
        np.testing.assert_array_equal(found.picture, alone.denoise(frame))


def test_light_that_no_pass_has_is_denoised_too() -> None:
    """Such as subsurface scattering: what is left of the picture is one more light."""
    shot: Shot = []
    for number in range(FRAMES):
        lights = diffuse(number)
        shot.append((frame_of(number, lights, total(lights) + lights[0].factor * noise(200 + number)), lights))
    found, (_, lights) = denoised(shot)[-1], shot[-1]
    rest = (found.picture - sum_of(found, lights)) / lights[0].factor
    assert rest.min() >= -1e-5
    assert rest.mean() == pytest.approx(1.0, rel=0.1)
    assert rest.std() < 0.4, "it was 1"


def test_halves_that_do_not_quite_add_up_leave_no_rest() -> None:
    """Passes and picture rounded to 16 bits, each by itself."""
    shot: Shot = []
    for number in range(FRAMES):
        lights = diffuse(number)
        rounded = [
            replace(
                light,
                radiance=half(light.radiance),
                factor=None if light.factor is None else half(light.factor),
            )
            for light in lights
        ]
        shot.append((frame_of(number, rounded, half(total(lights))), rounded))
    for found, (_, lights) in zip(denoised(shot), shot, strict=True):
        assert_adds_up(found, lights)


def half(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float16).astype(np.float32)


def test_a_light_that_is_dark_at_first_shines_when_it_is_switched_on() -> None:
    def make(number: int) -> list[Light]:
        direct, indirect, lamp = diffuse(number)
        return [direct, replace(indirect, radiance=indirect.radiance * np.float32(number >= 2)), lamp]

    shot = shot_of(make)
    for number, (found, (_, lights)) in enumerate(zip(denoised(shot), shot, strict=True)):
        assert_adds_up(found, lights)
        assert found.lights[PASSES["indirect"]].any() == (number >= 2)


def test_a_light_that_is_switched_off_goes_out() -> None:
    def make(number: int) -> list[Light]:
        direct, indirect, lamp = diffuse(number)
        return [direct, replace(indirect, radiance=indirect.radiance * np.float32(number < 2)), lamp]

    shot = shot_of(make)
    found = denoised(shot)
    for each, (_, lights) in zip(found, shot, strict=True):
        assert_adds_up(each, lights)
    assert found[-1].lights[PASSES["indirect"]].mean() < 0.5 * found[1].lights[PASSES["indirect"]].mean()


@pytest.mark.parametrize(
    ("where", "value"),
    [("direct", np.inf), ("emission", np.nan), ("factor", np.inf), ("factor", np.nan), ("color", -np.inf)],
)
def test_values_that_are_not_finite_reach_no_result(where: str, value: float) -> None:
    """A pixel that has one in a pass is finite in all results, and so is all that comes after it."""
    shot: Shot = []
    for number in range(FRAMES):
        lights = diffuse(number)
        frame = frame_of(number, lights)
        if number == 1:
            index = {"direct": 0, "factor": 0, "emission": 2, "color": 0}[where]
            broken = lights[index].factor if where == "factor" else lights[index].radiance
            broken = np.array(frame.color if where == "color" else broken)
            broken[7, 11] = value
            if where == "color":
                frame = replace(frame, color=broken)
            else:
                lights[index] = replace(lights[index], **{"factor" if where == "factor" else "radiance": broken})
        shot.append((frame, lights))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = denoised(shot)
    for each in found:
        assert np.isfinite(each.picture).all()
        assert all(np.isfinite(light).all() for light in each.lights.values())


def test_a_firefly_that_the_renderer_clamped_in_the_picture_alone_leaves_no_hole() -> None:
    """The pass has it in full, so the picture is darker than its passes there: by a thousand, in one pixel."""
    shot: Shot = []
    for number in range(FRAMES):
        lights = diffuse(number)
        radiance = np.array(lights[0].radiance)
        radiance[7 + number, 11] = 1000.0
        lights[0] = replace(lights[0], radiance=radiance)
        shot.append((frame_of(number, lights, np.minimum(total(lights), 30.0)), lights))
    for found, (frame, _) in zip(denoised(shot), shot, strict=True):
        assert found.picture.min() >= 0.0
        assert found.picture.max() <= frame.color.max() * 1.1
        assert found.picture.mean() == pytest.approx(frame.color.mean(), rel=0.3)


def test_passes_that_are_no_parts_of_the_picture_are_left_alone() -> None:
    """As of a picture that was graded, or is of another view layer."""
    shot = [(replace(frame, color=np.float32(0.5) * frame.color), lights) for frame, lights in shot_of()]
    alone, together = Denoiser(SHAPE, settings=DEFAULT()), denoiser_of()
    with pytest.warns(
        UserWarning, match=r"add up to more than the picture in \d+ % of the pixels, .* as a whole"
    ) as told:
        found = [together.denoise(frame, lights) for frame, lights in shot]
    assert len(told) == 1
    for each, (frame, _) in zip(found, shot, strict=True):
        assert each.lights == {}
        np.testing.assert_array_equal(each.picture, alone.denoise(frame))


def test_direct_and_indirect_light_of_another_picture_do_not_replace_it() -> None:
    """A frame of our own has them as fields, too, and the denoiser reads them in place of the picture."""
    room = room_frame(SHAPE, 0, -1, signals=2)
    lights = [
        Light(PASSES[name], np.asarray(getattr(room, name)), None, filtered=True)
        for name in PASSES
        if name != "emission"
    ]
    frame = replace(room, color=np.float32(0.25) * room.color)
    with pytest.warns(UserWarning, match="add up to more than the picture"):
        found = denoiser_of().denoise(frame, lights)
    assert found.picture.mean() == pytest.approx(frame.color.mean(), rel=0.05)


def test_a_cut_forgets_every_light() -> None:
    denoiser, shot = denoiser_of(), shot_of()
    first = denoiser.denoise(*shot[0])
    for frame, lights in shot[1:]:
        denoiser.denoise(frame, lights)
    denoiser.reset()
    again = denoiser.denoise(*shot[0])
    np.testing.assert_array_equal(again.picture, first.picture)


def test_other_settings_are_those_of_every_light_and_keep_the_past() -> None:
    shot, other = shot_of(), DEFAULT(iterations=1)
    changed = denoiser_of()
    changed.denoise(*shot[0])
    changed.update(other)
    found = changed.denoise(*shot[1])
    for light in shot[1][1][:2]:
        with Denoiser(SHAPE, settings=DEFAULT()) as den:
            for (frame, lights), settings in zip(shot[:2], (DEFAULT(), other), strict=True):
                den.update(settings)
                (own,) = (each for each in lights if each.channels == light.channels)
                expected = den.denoise(single(frame, own.radiance, None))
        np.testing.assert_array_equal(found.lights[light.channels], expected)
    assert_adds_up(found, shot[1][1])


def test_the_error_of_a_sum_is_at_least_that_of_each_light() -> None:
    denoiser = denoiser_of(standard_error=True)
    lit = [replace(light, factor=None) for light in diffuse(0)[:2]]
    both = denoiser.denoise(frame_of(0, lit), lit).standard_error
    one = denoiser_of(standard_error=True).denoise(frame_of(0, lit[:1]), lit[:1]).standard_error
    assert both is not None
    assert one is not None
    assert both.shape == SHAPE
    assert np.isfinite(both).all()
    assert (both >= one * 0.999).all()
    assert denoiser_of().denoise(frame_of(0, lit), lit).standard_error is None


def test_times_are_those_of_all_lights() -> None:
    denoiser, (frame, lights) = denoiser_of(), shot_of()[0]
    denoiser.denoise(frame, lights)
    alone = Denoiser(SHAPE, settings=DEFAULT())
    alone.denoise(single(frame, lights[0].radiance, None))
    assert denoiser.profile().keys() == alone.profile().keys()
