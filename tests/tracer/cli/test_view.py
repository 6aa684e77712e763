"""``svgf-cl view`` on scenes that the tracer renders."""

from __future__ import annotations

import pytest

from svgf_cl.view.server import Server
from tests.command_line import run


def test_a_scene_is_played_with_references_of_all_frames(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    found = []

    def serve(server: Server, poll: float) -> None:
        for index in range(3):
            found.append(server.frame({"index": index, "filter": "kalman"}))

    monkeypatch.setattr(Server, "serve_forever", serve)
    options = ("--size", "32x18", "--frames", "3", "--no-browser")
    assert run("view", "cornell", "--spp", "16", *options) == 0
    assert run("view", "cornell", *options) == 0
    assert [list(about["psnr"]) for about, _ in found] == [["noisy", "denoised"]] * 3 + [[]] * 3
    assert len({pictures[0].tobytes() for _, pictures in found}) == 3, "the same noise in both runs"
    assert "cornell: http://127.0.0.1:" in capsys.readouterr().out


def test_rays_move_within_the_pixel_only_where_that_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    found: list[tuple[str, bytes]] = []

    def serve(server: Server, poll: float) -> None:
        _, (noisy, *_) = server.frame({"index": 1, "filter": "kalman"})
        found.append((server.clip()["note"], noisy.tobytes()))

    monkeypatch.setattr(Server, "serve_forever", serve)
    for options in ((), ("--no-jitter",), ("--jitter",)):
        assert run("view", "cornell", "--size", "32x18", "--frames", "2", "--no-browser", *options) == 0
    usual, still, moving = found
    assert usual == still
    assert usual[0] == "1 sample per pixel, rays go through pixel centres; no reference"
    assert moving[0] == "1 sample per pixel, rays move within the pixel; no reference"
    assert usual[1] != moving[1]


def test_a_scene_that_is_not_there_is_refused(refused) -> None:
    refused(
        "no_such_scene: expected a scene's folder or file or a built-in scene", "view", "no_such_scene", "--no-browser"
    )
