"""``svgf-cl view`` as it is called: what it plays, what it refuses, and how it ends."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import pytest

from svgf_cl.cli import view as module
from svgf_cl.view.server import Server
from tests.command_line import run

Played = Callable[..., dict[str, Any]]


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Played:
    """What the page would be told, of a command line; nothing is served."""
    told: list[dict[str, Any]] = []
    monkeypatch.setattr(Server, "serve_forever", lambda server, poll: told.append(server.clip()))
    monkeypatch.setattr(module.webbrowser, "open", lambda url: told.append({"url": url}))

    def play(*argv: str | Path) -> dict[str, Any]:
        assert run("view", "--no-browser", *argv) == 0
        return told.pop()

    return play


def test_frames_are_played_as_they_are_read(played: Played, rendered: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = "/".join(rendered.parts[-2:])
    for given in (rendered, rendered / "frame.####.exr", rendered / "frame.%04d.exr"):
        clip = played(given)
        assert (clip["name"], clip["numbers"], clip["has_references"]) == (name, [0, 1, 2], False)
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("read as ")
    assert said[1].startswith(f"{name}: http://127.0.0.1:")


def test_references_are_a_folder_or_a_picture(played: Played, rendered: Path) -> None:
    assert played(rendered, "--reference", rendered)["has_references"]
    assert played(rendered, "--reference", rendered / "reference.0001.exr")["has_references"]


def test_without_anything_it_plays_the_room(played: Played) -> None:
    clip = played("--size", "32x18", "--frames", "3", "--filter", "svgf", "--set", "iterations=2", "--exposure", "1.5")
    assert (clip["name"], clip["width"], clip["height"], len(clip["numbers"])) == ("room", 32, 18, 3)
    assert (clip["filter"], clip["settings"]["iterations"], clip["exposure"]) == ("svgf", 2, 1.5)


def test_the_browser_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(Server, "serve_forever", lambda server, poll: opened.append(server.url))
    monkeypatch.setattr(module.webbrowser, "open", opened.append)
    assert run("view", "--size", "32x18") == 0
    assert opened[0] == opened[1]


@pytest.mark.parametrize(
    ("words", "argv"),
    [
        ("nowhere: expected a file or a folder", ["nowhere/####.exr"]),
        ("nowhere.exr", ["nowhere.exr"]),
        ("--filter: expected kalman or ", ["--filter", "nlm"]),
        ("--set iterations: expected a whole number", ["--set", "iterations=many"]),
        ("--size: expected WIDTHxHEIGHT", ["--size", "big"]),
        ("--spp: expected a scene, got none", ["--spp", "8"]),
        ("--jitter: expected a scene, got none", ["--jitter"]),
        ("--reference: expected frames in files, got a scene", ["--reference", "pictures"]),
        ("other options of reading: expected frames in files, got a scene", ["cornell", "--map", "depth=Z"]),
        ("expected one scene, or only frames, got 2 arguments", ["cornell", "swing"]),
        ("'--port'", ["--port", "70000"]),
    ],
)
def test_wrong_input_is_refused_before_anything_is_rendered(words: str, argv: list[str], refused) -> None:
    refused(words, "view", "--no-browser", *argv)


def test_options_of_scenes_are_refused_with_files(rendered: Path, refused) -> None:
    for option, *value in (("--size", "32x18"), ("--frames", "2"), ("--spp", "8"), ("--jitter",)):
        refused(f"{option}: expected ", "view", rendered, option, *value)


def test_a_reference_without_its_frame_is_refused(rendered: Path, tmp_path: Path, refused) -> None:
    (tmp_path / "reference.0009.exr").write_bytes((rendered / "reference.0001.exr").read_bytes())
    refused("expected a frame number 9 among the frames", "view", rendered, "--reference", tmp_path)


def test_a_used_port_is_refused(refused) -> None:
    from tests.svgf_cl.view.clips import serving

    with serving() as server:
        port = str(server.server_port)
        refused(f"--port: expected a free port, got {port}", "view", "--no-browser", "--size", "32x18", "--port", port)


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_until_it_is_interrupted(ending: signal.Signals) -> None:
    command = [sys.executable, "-m", "svgf_cl", "view", "--no-browser", "--size", "32x18", "--frames", "3"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ
    ) as process:
        assert process.stdout is not None
        url = process.stdout.readline().split()[1]
        with urlopen(f"{url}clip", timeout=60) as answer:
            assert json.load(answer)["name"] == "room"
        process.send_signal(ending)
        _, said = process.communicate(timeout=60)
    assert (process.returncode, said) == (130, "svgf-cl: interrupted\n")
