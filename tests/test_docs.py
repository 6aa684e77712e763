"""Pages that are made from the code are those that it makes now."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import typer
from PIL import Image

from scripts import pass_table, picture, scene_description, settings_page
from svgf_cl import chunks
from svgf_cl.cli import application
from svgf_cl.device import apart
from svgf_cl.filters.formats import HALF_MAX
from svgf_cl.io import cache, cameras, exr, frames
from svgf_cl.io.readers import READERS
from svgf_cl.oracle import temporal
from svgf_cl.view import clip, player
from svgf_cl_tracer import panorama
from svgf_cl_tracer.description import document
from svgf_cl_tracer.gltf import model, nodes
from tests.pages import PAGES, ROOT, blocks, name_of, without_code


def written(value: float) -> str:
    """As the pages write it: 1e-6."""
    return f"{value:g}".replace("e+", "e").replace("e-0", "e-")


def power(value: int) -> str:
    """A power of two, as the pages write it."""
    assert value.bit_count() == 1
    return f"2^{value.bit_length() - 1}"


# What a page says of a limit, made from where the code declares it.
LIMITS = (
    ("files.md", f"below {exr.TRUSTED >> 30} GiB, or below {exr.MAX_RATIO} times the size of the file"),
    ("files.md", f"nodes make a tree at most {nodes.MAX_DEPTH} deep"),
    ("files.md", f"{power(model.MAX_TRIANGLES)} over all nodes"),
    ("files.md", f"of a sky {power(panorama.MAX_PIXELS)}"),
    ("files.md", f"`scene.json` | {document.MAX_BYTES >> 20} MiB"),
    ("files.md", f"less than {cache.ROOM >> 20} MiB"),
    ("files.md", f"within {apart.TIMEOUT_SECONDS} seconds"),
    ("conventions.md", f"whole numbers up to {power(frames.MAX_ID)}"),
    ("conventions.md", "Depth is {} to {}".format(*map(written, temporal.DEPTH_RANGE))),
    ("view.md", f"stay in memory, up to {clip.MEMORY >> 30} GiB"),
    ("view.md", f"in memory ({player.MEMORY >> 20} MiB of pictures)"),
    ("view.md", f"begins anew {chunks.WARM_UP} frames before"),
    ("view.md", f"a past of less than {player.SETTLED} frames"),
    (
        "conventions.md",
        f"the length of a normal {written(temporal.NORMAL_FLOOR**0.5)} to {written(temporal.CHANNEL_MAX)}",
    ),
    ("conventions.md", "to {0}, radiance up to {0}".format(written(temporal.CHANNEL_MAX))),
    ("conventions.md", f"is limited to {HALF_MAX:.0f}"),
)


@pytest.mark.parametrize(("page", "words"), LIMITS)
def test_limits_in_the_pages_are_those_of_the_code(page: str, words: str) -> None:
    assert words in " ".join((ROOT / "docs" / page).read_text().split())


def test_the_description_of_scenes_is_up_to_date() -> None:
    written = (ROOT / scene_description.TARGET).read_text()
    assert written == scene_description.page(), "run scripts/scene_description.py"


def test_the_page_of_settings_is_up_to_date() -> None:
    assert (ROOT / settings_page.TARGET).read_text() == settings_page.page(), "run scripts/settings_page.py"


def test_the_tables_of_passes_are_up_to_date() -> None:
    written = (ROOT / pass_table.TARGET).read_text()
    assert written == pass_table.page(written), "run scripts/pass_table.py"


def test_the_caption_of_the_picture_says_what_it_shows() -> None:
    page = (ROOT / "README.md").read_text()
    shown = re.findall(r"\(`(\w+)`, (?:frame )?(\d+)", page.split(f"]({picture.TARGET})")[1].split("## ")[0])
    assert shown == [(part.scene, str(part.frame)) for part in picture.PARTS]
    assert f"The reference has {picture.SPP} samples per pixel." in page
    assert f"a reference of {picture.SPP} samples per pixel" in (ROOT / "docs/renderers/other.md").read_text()
    assert Image.open(ROOT / picture.TARGET).width == picture.SHAPE[1]


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="expected"):
        pass_table.page("no marks")


def examples(page: str, section: str, language: str) -> list[str]:
    """The blocks of code in a section of a page."""
    text = (ROOT / "docs" / page).read_text().split(f"\n## {section}\n")[1].split("\n## ")[0]
    return blocks(text, language)


def test_the_lines_on_motion_from_cameras_compute_it() -> None:
    depth = np.random.default_rng(0).uniform(1.0, 5.0, (36, 64))
    matrix, previous = np.eye(4), np.eye(4)
    matrix[:3, 3], previous[:3, 3] = (1.0, 2.0, 3.0), (1.2, 2.0, 3.3)
    previous[:3, :3] = ((0.96, 0.0, 0.28), (0.0, 1.0, 0.0), (-0.28, 0.0, 0.96))
    call, lines = examples("conventions.md", "Motion from cameras", "python")
    by_call = {"depth": depth, "matrix": matrix, "previous_matrix": previous}
    exec(call, by_call)
    camera, before = by_call["camera"], by_call["previous"]
    by_lines = {"depth": depth, "now": camera.world_to_view, "before": before.world_to_view, "f": camera.focal[0]}
    by_lines.update(zip(("cx", "cy"), camera.center, strict=True))
    exec(lines, by_lines)
    assert np.abs(by_call["motion"][..., :2]).max() > 1.0
    np.testing.assert_allclose(by_call["motion"], by_lines["motion"], atol=1e-5)


def test_the_file_of_cameras_in_the_page_is_one(tmp_path: Path) -> None:
    (text,) = examples("conventions.md", "Motion from cameras", "json")
    (tmp_path / cameras.NAME).write_text(text)
    assert list(cameras.read_cameras(tmp_path / cameras.NAME)) == [
        each["frame"] for each in json.loads(text)["cameras"]
    ]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(page.read_text())):
        if "://" in target:
            continue
        name, _, anchor = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        assert path.exists(), target
        assert not anchor or anchor in anchors(path), target


def anchors(page: Path) -> set[str]:
    """What links may name in a page: its headings, as GitHub makes anchors of them."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


# Renderers' pages

RENDERERS = ROOT / "docs" / "renderers"


def test_each_renderer_has_a_page_that_the_index_names() -> None:
    pages = {f"{'other' if name == 'svgf_cl' else name}.md" for name in READERS}
    assert pages == {page.name for page in RENDERERS.glob("*.md")} - {"README.md"}
    index = (RENDERERS / "README.md").read_text()
    assert all(f"[{page}]({page})" in index for page in pages)


@pytest.mark.parametrize("page", sorted(RENDERERS.glob("*.md")), ids=lambda page: page.name)
def test_options_that_pages_name_are_those_of_denoise(page: Path) -> None:
    command = typer.main.get_group(application()).commands["denoise"]
    known = {name for option in command.params for name in (*option.opts, *option.secondary_opts)}
    lines = page.read_text().replace("\\\n", " ").splitlines()
    named = [line for line in lines if "svgf-cl denoise" in line or line.startswith("| `--")]
    assert named
    assert {option for line in named for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", line)} <= known
