"""Every block of Python in the pages runs, given what its page speaks of; that of README is given nothing."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import svgf_cl_tracer.api  # noqa: F401  # before the fixtures move the cache, which has its loops compiled
from svgf_cl.filters import signals
from svgf_cl.io.synthetic import room_frames
from tests.denoising import narrow_vectors  # noqa: F401
from tests.pages import PAGES, ROOT, blocks, name_of
from tests.renderers import moments, own, written

HEIGHT, WIDTH = 36, 64
# What makes a block cheap: a smaller picture.
SMALLER = {"(180, 320)": "(18, 32)", "360, 640": "36, 64", "ahead=8, cuts=[120, 310]": "ahead=1, cuts=[2]"}


def given() -> dict[str, Any]:
    """What pages take for granted: a renderer's frames, its cameras, and the focal lengths of a frame."""
    frames = list(room_frames((HEIGHT, WIDTH), 3))
    previous_matrix = np.eye(4)
    previous_matrix[0, 3] = 0.1
    cameras = {"matrix": np.eye(4), "previous_matrix": previous_matrix, "now": np.eye(4), "before": previous_matrix}
    lens = {"f": 50.0, "cx": (WIDTH - 1) / 2, "cy": (HEIGHT - 1) / 2}
    one = {"previous": frames[0], "frame": frames[1], "first_frame": frames[0], "depth": frames[0].depth}
    declarations = {name: getattr(signals, name) for name in ("Signal", "COLOR", "DIRECT", "INDIRECT")}
    return {"height": HEIGHT, "width": WIDTH, "frames": frames} | cameras | lens | one | declarations


def smaller(block: str) -> str:
    for large, small in SMALLER.items():
        block = block.replace(large, small)
    return block


EXAMPLES = [
    pytest.param(block, id=f"{name_of(page)}-{number}")
    for page in PAGES
    if page != ROOT / "README.md"
    for number, block in enumerate(blocks(page.read_text(), "python"))
]


@pytest.mark.parametrize("block", EXAMPLES)
def test_blocks_of_python_run(block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "shot", {at.number: own(at) for at in moments()}, stem="")
    exec(smaller(block), given())


def test_the_example_of_readme_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = blocks((ROOT / "README.md").read_text(), "python")
    exec(smaller(example), {})
    before, after = map(float, re.match(r"([\d.]+) -> ([\d.]+) \{", capsys.readouterr().out).groups())
    assert after < before
