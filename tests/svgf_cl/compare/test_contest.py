"""All rivals see the same frames, all of them, and are judged where there is a truth."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("flip_evaluator")
pytest.importorskip("skimage")

from svgf_cl import Frame
from svgf_cl.compare.contest import NOISY, REFERENCE, compete
from svgf_cl.compare.halves import Pair
from svgf_cl.compare.page import Entry, Scene
from svgf_cl.compare.rivals import Maker, Noisy
from svgf_cl.io.display import display
from svgf_cl.io.synthetic import room_frames

SHAPE = (24, 32)
LEVEL = 0.2  # of the truth, everywhere
OVER_TIME = ("temporal", "flicker", "warped", "moving_shadows", "ghost", "lag")


@dataclass(frozen=True)
class Room:
    """Five frames of the room, some of which have a truth: plain grey."""

    judged: Sequence[int] = (2, 3, 4)
    apart: float = 0.0  # of the halves, relative
    name: str = "room"
    note: str = "made up"
    shape: tuple[int, int] = SHAPE
    jitter: bool = False
    numbers: Sequence[int] = range(5)
    identity: str = ""

    @property
    def steps(self) -> int:
        return len(self.judged)

    def frames(self) -> Iterator[Frame]:
        return room_frames(SHAPE, 5)

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        for _ in self.judged:
            advance()
        return {number: (grey(LEVEL * (1 + self.apart)), grey(LEVEL * (1 - self.apart))) for number in self.judged}


def grey(level: float) -> np.ndarray:
    return np.full((*SHAPE, 3), level)


@dataclass
class Fixed:
    """Makes a grey picture of every frame, with a mark in one corner, and keeps the frames."""

    level: float
    milliseconds: float | None = None
    mark: float | None = None
    seen: list[Frame] = field(default_factory=list)

    def denoise(self, frame: Frame) -> np.ndarray:
        self.seen.append(frame)
        picture = grey(self.level)
        if self.mark is not None:
            picture[-3:, :4] = self.mark
        return picture


def let(room: Room, *, exposure: float = 0.0, **makers: Maker) -> Scene:
    return compete(room, makers, exposure, lambda: None)


def entries(scene: Scene) -> dict[str, Entry]:
    return {each.rival: each for each in scene.entries}


def image(file: bytes | None) -> Image.Image:
    assert file is not None
    return Image.open(io.BytesIO(file))


def test_every_frame_is_seen_by_all_and_the_last_are_judged() -> None:
    dark, bright = Fixed(0.0), Fixed(0.3)
    ticks: list[None] = []
    scene = compete(Room(), {"dark": dark, "bright": bright}, 0.0, lambda: ticks.append(None))
    assert len(ticks) == 3 + 5
    assert len(dark.seen) == 5
    assert all(one is other for one, other in zip(dark.seen, bright.seen, strict=True))
    assert (scene.name, scene.frames, scene.shown, scene.size) == ("room", [2, 3, 4], 3, SHAPE)
    assert list(entries(scene)) == ["dark", "bright", REFERENCE]
    assert (scene.reference, scene.noisy) == (REFERENCE, None)


def test_figures_are_those_of_the_pictures() -> None:
    found = entries(let(Room(), dark=Fixed(0.0), right=Fixed(LEVEL)))
    assert found["dark"].values["bias"] == -1
    assert found["dark"].values["psnr"] == pytest.approx(-20 * math.log10(display(grey(LEVEL))[0, 0, 0]))
    assert found["dark"].values["relmse"] == pytest.approx(LEVEL**2 / (LEVEL**2 + 0.01))
    assert found["right"].values["psnr"] == math.inf
    assert found["right"].values["ssim"] == 1
    assert found["right"].curves["psnr"] == [math.inf] * 3
    assert found[REFERENCE].values == found[REFERENCE].curves == {}


def test_the_noisy_frames_may_be_among_them() -> None:
    scene = let(Room(), right=Fixed(LEVEL), noisy=Noisy())
    assert list(entries(scene)) == ["right", NOISY, REFERENCE]
    assert scene.noisy == NOISY
    assert entries(scene)[NOISY].values["psnr"] < 20
    assert entries(scene)[NOISY].milliseconds is None


def test_times_are_those_of_judged_frames() -> None:
    class Slower(Fixed):
        """Takes as many milliseconds as it has seen frames."""

        def denoise(self, frame: Frame) -> np.ndarray:
            picture = super().denoise(frame)
            self.milliseconds = float(len(self.seen))
            return picture

    assert entries(let(Room(), slower=Slower(0.0)))["slower"].milliseconds == 4


def test_the_piece_is_where_the_first_is_worst() -> None:
    marked, right = Fixed(LEVEL, mark=1.0), Fixed(LEVEL)
    elsewhere = Noisy()
    room = Room((4,))
    first = let(room, marked=marked, right=right, noisy=elsewhere)
    assert first.crop == (0, 18, 8, 6)
    assert first.row == 21
    assert let(room, noisy=elsewhere, marked=marked).crop == first.crop, "noise is not what is tested"
    assert let(room, right=right, marked=marked).crop != first.crop


def test_pictures_are_of_the_frame_that_is_shown_and_clips_of_all() -> None:
    found = entries(let(Room(), dark=Fixed(0.0)))
    for entry in found.values():
        assert image(entry.picture).size == (32, 24)
        assert image(entry.clip).size == (8, 6)
        assert image(entry.profile).size == (32, 3 * 6)
    assert np.asarray(image(found["dark"].picture)).max() < 4
    assert np.asarray(image(found[REFERENCE].picture)) == pytest.approx(255 * display(grey(LEVEL))[0, 0, 0], abs=4)
    assert image(found["dark"].heat).size == (32, 24)
    assert found[REFERENCE].heat is None


def test_exposure_is_for_what_is_shown_and_comes_once() -> None:
    usual, exposed = (entries(let(Room(), dim=Fixed(0.1), exposure=stops))["dim"] for stops in (0.0, 1.0))
    difference = display(grey(2 * LEVEL)) - display(grey(0.2))
    assert exposed.values["psnr"] == pytest.approx(-20 * math.log10(difference[0, 0, 0]))
    assert [exposed.values[key] for key in ("relmse", "bias")] == [usual.values[key] for key in ("relmse", "bias")]
    assert np.asarray(image(exposed.picture)) == pytest.approx(255 * display(grey(0.2))[0, 0, 0], abs=4)


def test_it_is_said_how_far_the_halves_are_apart_if_they_are() -> None:
    assert let(Room(), right=Fixed(LEVEL)).note == "made up"
    apart = display(grey(LEVEL * 1.1)) - display(grey(LEVEL * 0.9))
    decibels = -20 * math.log10(apart[0, 0, 0])
    scene = let(Room(apart=0.1), right=Fixed(LEVEL))
    assert scene.note == f"made up; halves of the truth differ by {decibels:.1f} dB"
    assert entries(scene)["right"].values["psnr"] > decibels + 6, "its noise does not count"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("judged", [(0, 2, 4), (3,)])
def test_nothing_is_known_over_time_without_neighbours(judged: Sequence[int]) -> None:
    scene = let(Room(judged), dark=Fixed(0.0))
    dark = entries(scene)["dark"]
    assert all(math.isnan(dark.values[key]) for key in OVER_TIME)
    assert dark.values["bias"] == -1
    assert all(map(math.isnan, dark.curves["temporal"]))
    assert (scene.frames, scene.shown) == (list(judged), judged[len(judged) // 2])
    assert (dark.clip is None) == (dark.profile is None) == (len(judged) == 1)
    if len(judged) > 1:
        assert image(dark.profile).size == (32, 3 * 6)


def test_nan_in_a_picture_is_no_figure_and_black() -> None:
    dark = entries(let(Room(), dark=Fixed(0.0, mark=math.nan)))["dark"]
    assert all(math.isnan(dark.values[key]) for key in ("psnr", "ssim", "flip", "relmse", "bias"))
    assert np.asarray(image(dark.picture)).max() < 4


def test_without_any_truth_there_is_no_contest() -> None:
    with pytest.raises(ValueError, match="room"):
        let(Room(()), dark=Fixed(0.0))


@pytest.mark.filterwarnings("error")
def test_infinite_pixels_are_white_and_no_alarm() -> None:
    found = entries(let(Room((4,)), dark=Fixed(0.0, mark=math.inf), white=Fixed(0.0, mark=1.0)))
    assert found["dark"].values["psnr"] == found["white"].values["psnr"]
    assert found["dark"].values["relmse"] == math.inf
