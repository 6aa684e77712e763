"""Nothing that a frame asks for is missing, and asked again it is answered again."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from embreex.rtcore_scene import EmbreeScene

from benchmarks.tracing.recording import BOUNCE, KINDS, PRIMARY, SHADOW, Recording, record, share_out
from benchmarks.tracing.rounds import sent_again
from svgf_cl_tracer import Shot, builtin_scene, integrator, trees
from svgf_cl_tracer.trees import MISS


class Counted(EmbreeScene):
    """Embree, counting rays."""

    rays = 0

    def run(self, origins: Any, *arguments: Any, **options: Any) -> Any:
        Counted.rays += len(origins)
        return super().run(origins, *arguments, **options)


@pytest.mark.parametrize("scene", ["cornell", "swing"])
def test_every_ray_is_recorded_and_sent_again(scene: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trees, "EmbreeScene", Counted)
    shot = Shot(builtin_scene(scene), (18, 32), 24)
    shot.scene.around(shot.origin(3))
    built = Counted.rays  # a tree takes a ray to be built
    recording = record(shot, 3)
    trees_built = 1 + (scene == "swing")  # to send all rays into, and of what moves in the frame
    assert Counted.rays - built - sum(recording.asked.values()) == trees_built
    Counted.rays = 0
    list(sent_again(recording, 2))
    assert Counted.rays == sum(recording.rays(kind) for kind in KINDS)


def test_kinds_of_rays(recording: Recording) -> None:
    assert recording.rays(PRIMARY) == 18 * 32
    assert 0 < recording.rays(SHADOW) <= 2 * 18 * 32, "one light a surface, two surfaces"
    assert 0 < recording.rays(BOUNCE) <= 2 * 18 * 32
    assert all(recording.asked[kind] == recording.rays(kind) for kind in (PRIMARY, SHADOW)), "one tree"
    assert recording.asked[BOUNCE] < recording.rays(BOUNCE), "the last of them only where the lamp may be ahead"


def test_each_tree_is_asked() -> None:
    recording = record(Shot(builtin_scene("swing"), (18, 32), 24), 3)
    assert recording.rays(PRIMARY) < recording.asked[PRIMARY] < 2 * recording.rays(PRIMARY), (
        "all rays ask what does not move, some what moves"
    )


def test_an_answer_is_what_the_shading_loop_got(recording: Recording) -> None:
    first = recording.sent[0]
    distance = first.distance.copy()
    hits = first.ask(first.origin, first.direction, distance)
    np.testing.assert_array_equal(hits.triangle, recording.shadings[0].hits.triangle)
    hit = hits.triangle != MISS
    np.testing.assert_array_equal(distance[hit], recording.shadings[0].hits.distance[hit])
    np.testing.assert_array_equal(first.direction, recording.shadings[0].paths.direction)


def test_paths_are_kept_though_their_memory_is_used_again(recording: Recording) -> None:
    assert [shading.depth for shading in recording.shadings] == [0, 1, 2]
    memory = [shading.paths.origin.__array_interface__["data"][0] for shading in recording.shadings]
    assert len(set(memory)) == 3


def test_nothing_is_watched_afterwards(recording: Recording) -> None:
    functions = integrator.shade, integrator.deposit, integrator.start_paths, trees.Tree.nearest, trees.Tree.blocked
    assert not any("watched" in getattr(function, "__qualname__", "") for function in functions)
    assert recording.asked


@pytest.mark.parametrize("threads", [1, 3])
def test_work_is_done_once_by_so_many_threads(threads: int) -> None:
    done, workers = [], set()
    together = threading.Barrier(threads)

    def work(item: int) -> None:
        if item < threads:
            together.wait(timeout=10)
        done.append(item)
        workers.add(threading.get_ident())

    share_out(work, range(20), threads)
    assert sorted(done) == list(range(20))
    assert len(workers) == threads


def test_an_error_in_a_thread_is_told() -> None:
    with pytest.raises(ZeroDivisionError):
        share_out(lambda item: 1 // item, [1, 0], 2)
