"""The demo, small: every file it promises is there and fits, and denoised is better than noisy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from svgf_cl import Denoiser, FileError
from svgf_cl.io.panels import GAP, LABEL_HEIGHT
from svgf_cl_tracer.demo import SETTINGS, Demo

WIDTH, HEIGHT = 64, 36


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Demo:
    demo = Demo(tmp_path_factory.mktemp("demo"), frames=4, shape=(HEIGHT, WIDTH), reference_spp=32)
    assert len(list(demo.denoise(Denoiser(demo.shape, settings=SETTINGS)))) == 4
    demo.render_references(lambda: None)
    demo.write_stills()
    demo.write_preview()
    return demo


@pytest.mark.parametrize(
    ("frames", "compared"), [(1, [0]), (2, [0, 1]), (9, [0, 8]), (10, [0, 8, 9]), (24, [0, 8, 15, 23])]
)
def test_the_first_frame_and_some_after_the_warm_up_are_compared(frames: int, compared: list[int]) -> None:
    assert Demo(Path(), frames, (1, 1), 1).compared == compared


@pytest.mark.parametrize("kind", ["filtered", "denoised"])
def test_denoised_is_better_than_noisy_from_the_first_frame_on(run: Demo, kind: str) -> None:
    noisy, clean = run.measure("noisy"), run.measure(kind)
    assert list(noisy) == [0, 3]
    for number in noisy:
        assert clean[number].psnr > noisy[number].psnr + 3
        assert clean[number].ssim > noisy[number].ssim


def test_the_demo_gains_what_it_promises_once_warm(tmp_path: Path) -> None:
    """Measured: +9.5 dB, of which SVGF alone +6.7; more in larger pictures, whose features span more pixels."""
    demo = Demo(tmp_path, frames=9, shape=(90, 160), reference_spp=128)
    for _ in demo.denoise(Denoiser(demo.shape, settings=SETTINGS)):
        pass
    demo.render_references(lambda: None)
    noisy, svgf, antialiased = (demo.measure(kind)[8] for kind in ("noisy", "filtered", "denoised"))
    assert svgf.psnr > noisy.psnr + 6
    assert antialiased.psnr > noisy.psnr + 8.8


@pytest.mark.parametrize("frames", [3, 5])
def test_another_length_does_not_go_into_the_same_folder(run: Demo, frames: int) -> None:
    run.check_leftovers()
    with pytest.raises(FileError, match="left by an earlier run"):
        replace(run, frames=frames).check_leftovers()


def test_only_compared_frames_have_a_reference(run: Demo) -> None:
    names = [f"frame.{number:04d}.exr" for number in range(4)]
    assert sorted(path.name for path in (run.folder / "noisy").iterdir()) == names
    assert sorted(path.name for path in (run.folder / "filtered").iterdir()) == names
    assert sorted(path.name for path in (run.folder / "denoised").iterdir()) == names
    references = sorted(path.name for path in (run.folder / "reference").iterdir())
    assert references == ["reference.0000.exr", "reference.0003.exr"]


def test_pictures_show_all_panels(run: Demo) -> None:
    with Image.open(run.folder / "still.0003.png") as still:
        assert still.size == (3 * WIDTH + 2 * GAP, 2 * HEIGHT + LABEL_HEIGHT + GAP)
    with Image.open(run.folder / "preview.webp") as preview:
        assert preview.size == (2 * WIDTH, HEIGHT)
        assert preview.n_frames == 4
