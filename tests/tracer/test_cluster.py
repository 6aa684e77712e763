"""A cluster of processes renders, bit by bit, what this one renders, whoever dies on the way."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from distributed import LocalCluster

from svgf_cl import Frame
from svgf_cl.cli import main
from svgf_cl.io import cache
from svgf_cl.io.exr import read_image
from svgf_cl.scheduling import here, scheduled
from svgf_cl_tracer import Goal, References, Shot, builtin_scene, render_frame, tracer_version
from svgf_cl_tracer.references import CHUNK
from tests.cluster import WORKERS, kill

ROOM = Shot(builtin_scene(), (36, 64), frames=9)


def assert_same(found: Frame, expected: Frame) -> None:
    assert found.present().keys() == expected.present().keys()
    for name, values in expected.present().items():
        np.testing.assert_array_equal(getattr(found, name), values)


def test_a_reference_loses_nothing_when_all_workers_are_killed(
    cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path / "local")
    expected = References(ROOM).render(4, 12 * CHUNK)
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path / "cluster")
    before = {worker.pid for worker in cluster.workers.values()}
    with scheduled(cluster.scheduler_address, tracer_version) as run:
        growing = References(ROOM).refine(4, Goal(12 * CHUNK), run)
        for _ in range(3):
            next(growing)
        kill(cluster, WORKERS)
        *_, found = growing
    assert len(before - {worker.pid for worker in cluster.workers.values()}) == WORKERS
    assert found.history == expected.history
    np.testing.assert_array_equal(found.light, expected.light)
    np.testing.assert_array_equal(found.squares, expected.squares)


def test_frames_come_in_order_when_a_worker_is_killed(cluster: LocalCluster) -> None:
    task, moving = partial(render_frame, spp=4, seed=3), replace(ROOM, scene=builtin_scene("swing"))
    with scheduled(cluster.scheduler_address, tracer_version) as run:
        frames = run(task, moving, range(ROOM.frames))
        found = [next(frames)]
        kill(cluster, 1)
        found += frames
    for one, other in zip(found, here(task, moving, range(ROOM.frames)), strict=True):
        assert_same(one, other)


def test_render_on_a_cluster_writes_the_same_files(
    cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    render = ["render", "cornell", "--frames", "2", "--size", "32x18", "--reference-spp", "16", "--until-error", "0.1"]
    for folder, where in (("here", []), ("there", ["--scheduler", cluster.scheduler_address])):
        monkeypatch.setattr(cache, "cache_folder", lambda folder=folder: tmp_path / f"cache {folder}")
        with pytest.raises(SystemExit) as left:
            main([*render, *where, "-o", str(tmp_path / folder)])
        assert not left.value.code
    files = sorted(path.name for path in (tmp_path / "here").iterdir())
    assert files == ["frame.0000.exr", "frame.0001.exr", "reference.0000.exr", "reference.0001.exr"]
    for name in files:
        one, other = (read_image(tmp_path / folder / name).planes for folder in ("here", "there"))
        assert one.keys() == other.keys()
        for channel, values in one.items():
            np.testing.assert_array_equal(other[channel], values)
