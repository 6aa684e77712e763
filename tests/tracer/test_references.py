"""A reference depends on what was asked for, not on kills, caches or threads; and it knows its error."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from svgf_cl.compare.metrics import relmse
from svgf_cl.io import cache
from svgf_cl.io.exr import read_image
from svgf_cl.io.frames import read_frame
from svgf_cl_tracer import Camera, CameraPath, Goal, References, Scene, SceneError, Shot, builtin_scene, render_frame
from svgf_cl_tracer.estimate import Estimate
from svgf_cl_tracer.references import CHUNK, chunks
from svgf_cl_tracer.render import TILE
from svgf_cl_tracer.sky import Environment

ROOM = Shot(builtin_scene(), (18, 32), frames=3)

KILLED = """
import sys
from pathlib import Path
from svgf_cl.io import cache
from svgf_cl_tracer import Goal, References, Shot, builtin_scene
cache.cache_folder = lambda: Path(sys.argv[1])
for estimate in References(Shot(builtin_scene(), (18, 32), frames=3)).refine(1, Goal(10**6)):
    print(estimate.spp, flush=True)
"""


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder, empty at first, that holds what is kept."""
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path)
    return tmp_path / "references"


def steps(references: References, goal: Goal, number: int = 1) -> list[Estimate]:
    return list(references.refine(number, goal))


def assert_same(found: Estimate, expected: Estimate) -> None:
    assert (found.spp, found.history) == (expected.spp, expected.history)
    np.testing.assert_array_equal(found.light, expected.light)
    np.testing.assert_array_equal(found.squares, expected.squares)


def test_a_reference_grows_by_chunks_to_its_goal() -> None:
    assert [step.spp for step in steps(References(ROOM), Goal(2 * CHUNK + 1))] == [CHUNK, 2 * CHUNK, 3 * CHUNK]


def test_it_is_what_frames_converge_to() -> None:
    references = References(ROOM)
    color = references.picture(references.render(1, 256))
    frame = render_frame(ROOM, 1, spp=256).color
    assert color.shape == frame.shape
    assert color.dtype == np.float32
    np.testing.assert_allclose(color.mean((0, 1)), frame.mean((0, 1)), rtol=0.01)


def test_without_jitter_it_is_what_frames_without_jitter_converge_to() -> None:
    area, centre = (References(ROOM, jitter=jitter).render(1, 256).color for jitter in (True, False))
    frame = render_frame(ROOM, 1, spp=256, jitter=False).color.reshape(-1, 3)
    assert np.square(centre - frame).mean() < 0.5 * np.square(area - frame).mean()


def test_the_same_request_has_the_same_result_whatever_is_kept() -> None:
    references = References(ROOM)
    fresh = {spp: steps(references, Goal(spp))[-1] for spp in (4 * CHUNK, 2 * CHUNK, 3 * CHUNK)}
    for spp, expected in fresh.items():
        assert_same(steps(references, Goal(spp))[-1], expected)


def test_an_error_is_reached_at_the_same_place_whatever_is_kept() -> None:
    references = References(ROOM)
    goal = Goal(1, steps(references, Goal(8 * CHUNK))[2].error)
    again = steps(references, goal)
    assert [step.spp for step in again] == [CHUNK, 2 * CHUNK, 3 * CHUNK]
    assert again[-1].error <= goal.until_error < again[-2].error
    (kept_one,) = steps(references, goal)
    assert_same(kept_one, again[-1])


def test_the_error_is_honest() -> None:
    truth = References(ROOM, seed=100).render(1, 4096).color
    for seed in range(3):
        estimate = steps(References(ROOM, seed=seed), Goal(64, 0.05))[-1]
        assert estimate.error <= 0.05
        assert relmse(estimate.color, truth) ** 0.5 == pytest.approx(estimate.error, rel=0.15)


def test_the_error_is_not_too_small_where_light_comes_by_rare_ways() -> None:
    glossy = Shot(builtin_scene("glossy"), (18, 32), frames=8)
    truth = References(glossy, seed=100).render(3, 2048).color
    for seed in range(3):
        estimate = steps(References(glossy, seed=seed), Goal(), 3)[-1]
        assert relmse(estimate.color, truth) ** 0.5 < estimate.error / 0.8


def test_a_killed_process_loses_nothing(kept: Path, tmp_path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", KILLED, tmp_path], stdout=subprocess.PIPE, text=True) as process:
        said = [int(process.stdout.readline()) for _ in range(4)]
        process.send_signal(signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL
    goal = Goal(said[-1] + 40 * CHUNK)
    resumed = steps(References(ROOM), goal)
    assert resumed[0].spp >= said[-1]
    for path in kept.glob("*/*"):
        path.unlink()
    assert_same(resumed[-1], steps(References(ROOM), goal)[-1])


def test_a_damaged_file_is_rendered_again(kept: Path) -> None:
    references = References(ROOM)
    expected = steps(references, Goal(3 * CHUNK))[-1]
    (path,) = kept.glob("*/*")
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.warns(UserWarning, match="damaged"):
        assert_same(steps(references, Goal(3 * CHUNK))[-1], expected)


def test_it_does_not_hang_on_the_number_of_threads(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shot = replace(ROOM, shape=(260, 270))
    assert shot.shape[0] * shot.shape[1] > 2 * TILE
    found = []
    for threads in (1, 5):
        monkeypatch.setattr(os, "cpu_count", lambda threads=threads: threads)
        found.append(References(shot).render(0, CHUNK))
        for path in kept.glob("*/*"):
            path.unlink()
    assert_same(*found)


def test_it_shares_no_noise_with_frames_of_its_seed_nor_with_other_references() -> None:
    shot = replace(ROOM, shape=(54, 96), camera_path=CameraPath.static(ROOM.camera(1)))

    def noise(color: np.ndarray, of_truth: int) -> np.ndarray:
        truth = References(shot, seed=of_truth).render(0, 256).color
        return ((color.reshape(-1, 3) - truth) / (truth + 0.1))[:, 1]

    reference = noise(References(shot).render(1, CHUNK).color, of_truth=8)
    others = {
        "frame": render_frame(shot, 1).color,
        "frame of as many samples": render_frame(shot, 1, spp=CHUNK).color,
        "reference of another seed": References(shot, seed=1).render(1, CHUNK).color,
        "reference of another frame": References(shot).render(2, CHUNK).color,
    }
    for name, color in others.items():
        # One sample in common of the 16 makes 0.25; chance 0.014.
        assert abs(np.corrcoef(reference, noise(color, of_truth=9))[0, 1]) < 0.07, name


def test_rows_are_those_of_the_whole() -> None:
    whole = References(ROOM)
    band = References(ROOM, rows=(5, 9))
    expected = whole.picture(whole.render(2, CHUNK))[5:9]
    np.testing.assert_array_equal(band.picture(band.render(2, CHUNK)), expected)


@pytest.mark.parametrize("rows", [(-1, 5), (5, 5), (12, 19)])
def test_rows_that_are_not_there(rows: tuple[int, int]) -> None:
    with pytest.raises(SceneError, match="rows: expected 0 <= first < end <= 18"):
        References(ROOM, rows=rows)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Goal(0), "at least 1 sample per pixel, got 0"),
        (lambda: Goal(until_error=0.0), "an error above 0"),
        (lambda: Goal(until_error=float("nan")), "an error above 0"),
        (lambda: References(ROOM, seed=-1), "seed and bounces of at least 0"),
        (lambda: References(ROOM, bounces=-1), "seed and bounces of at least 0"),
    ],
)
def test_numbers_out_of_range_are_named(make: Callable[[], object], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        make()


def brighter(shot: Shot) -> Shot:
    scene = shot.scene
    lamp = next(i for i, each in enumerate(scene.instances) if max(each.material.emission) > 0)
    instances = list(scene.instances)
    material = replace(instances[lamp].material, emission=(17.0, 13.0, 9.0))
    instances[lamp] = replace(instances[lamp], material=material)
    return replace(shot, scene=Scene(instances, camera_path=scene.camera_path))


def lit_by(sky: tuple[float, float, float] | Environment) -> Callable[[References], References]:
    def change(r: References) -> References:
        return replace(r, shot=replace(r.shot, scene=Scene(r.shot.scene.instances, sky=sky)))

    return change


@pytest.mark.parametrize(
    "change",
    [
        lambda r: replace(r, seed=1),
        lambda r: replace(r, jitter=False),
        lambda r: replace(r, bounces=2),
        lambda r: replace(r, rows=(0, 17)),
        lambda r: replace(r, shot=replace(r.shot, shape=(18, 33))),
        lambda r: replace(r, shot=replace(r.shot, frames=4)),
        lambda r: replace(r, shot=replace(r.shot, fps=25.0)),
        lambda r: replace(r, shot=replace(r.shot, camera_path=CameraPath.static(Camera((0, 1, 3), (0, 1, 0))))),
        lambda r: replace(r, shot=brighter(r.shot)),
        lit_by((1.0, 1.0, 1.0)),
        lit_by((1.0, 1.0, 1.5)),
        lit_by(Environment(np.ones((2, 4, 3), np.float32))),
    ],
)
def test_what_differs_is_kept_apart(change: Callable[[References], References]) -> None:
    assert change(References(ROOM)).folder != References(ROOM).folder


def test_what_is_the_same_is_kept_together() -> None:
    again = Shot(pickle.loads(pickle.dumps(ROOM.scene)), ROOM.shape, 3, ROOM.scene.camera_path)
    assert References(again, rows=(0, 18)).folder == References(ROOM).folder


def test_every_chunk_is_reported_once_kept_or_not() -> None:
    ticks: list[None] = []
    for spp in (20, 20, 60):
        References(ROOM).render(0, spp, lambda: ticks.append(None))
    assert len(ticks) == chunks(20) + chunks(20) + chunks(60) == 2 + 2 + 4


def test_work_is_shared_out_by_what_is_still_missing() -> None:
    goal = Goal(64, 0.1)
    estimate = steps(References(ROOM), Goal(CHUNK))[-1]
    assert goal.share(Estimate.nothing(9)) == 0.0
    assert goal.share(estimate) == pytest.approx(min(CHUNK / 64, (0.1 / estimate.error) ** 2))
    assert Goal(CHUNK).share(estimate) == 1.0


def test_a_file_holds_all_there_is_to_know(tmp_path: Path) -> None:
    references = References(ROOM, seed=4)
    estimate = references.render(2, 64)
    path = tmp_path / "reference.exr"
    references.write(path, 2, estimate)
    frame = read_frame(path)
    np.testing.assert_array_equal(frame.color, references.picture(estimate))
    np.testing.assert_allclose(frame.color, frame.direct + frame.indirect + frame.emission, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(frame.color, frame.diffuse + frame.specular + frame.emission, rtol=1e-5, atol=1e-6)
    centres = render_frame(ROOM, 2, jitter=False)
    for name in ("albedo", "normal", "depth", "motion", "id", "roughness"):
        np.testing.assert_array_equal(getattr(frame, name), getattr(centres, name))
    channels = read_image(path).planes
    error = np.stack([channels[f"error.{c}"] for c in "RGB"], axis=-1)
    np.testing.assert_array_equal(error.reshape(-1, 3), estimate.standard_error)
    attributes = {each.name: each.value for each in oiio.ImageInput.open(str(path)).spec().extra_attribs}
    assert (attributes["svgf_cl:spp"], attributes["svgf_cl:seed"]) == (64, 4)
    assert attributes["svgf_cl:error"] == pytest.approx(estimate.error)


def test_a_file_of_some_rows_holds_those(tmp_path: Path) -> None:
    references = References(ROOM, rows=(5, 9))
    references.write(tmp_path / "band.exr", 0, references.render(0, CHUNK))
    assert read_frame(tmp_path / "band.exr").shape == (4, 32)
