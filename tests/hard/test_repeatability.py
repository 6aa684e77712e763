"""The same input gives the same bits: run after run, and however the work is cut into vectors and work-groups.

That is so on every implementation tested, though OpenCL does not promise it: with -cl-mad-enable a compiler may join a
product and a sum in the code of one vector width and not of another. None does.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Denoiser, Settings, Tuning
from tests.frames import SHAPE, SPLIT, bumpy_sequence

ROOT = Path(__file__).parents[2]
DIGEST = "from tests.hard.test_repeatability import *; print(digest(everything(denoiser())))"


def denoiser(tuning: Tuning | None = None) -> Denoiser:
    """One that runs every kernel."""
    return Denoiser(SHAPE, settings=Settings(taa=True), keep_stages=True, tuning=tuning)


def everything(den: Denoiser) -> dict[str, np.ndarray]:
    """Every picture of a sequence and every stage of its last frame."""
    pictures = {f"picture {number}": den.denoise(frame) for number, frame in enumerate(bumpy_sequence(SPLIT))}
    return pictures | {name: den.stage(name) for name in den.stages}


def digest(found: dict[str, np.ndarray]) -> str:
    """What no two different results have in common."""
    return hashlib.sha256(b"".join(values.tobytes() for values in found.values())).hexdigest()


def test_run_after_run() -> None:
    den = denoiser()
    first = digest(everything(den))
    den.reset()
    assert digest(everything(den)) == first
    assert digest(everything(denoiser())) == first


def test_in_another_process() -> None:
    child = subprocess.run([sys.executable, "-c", DIGEST], cwd=ROOT, capture_output=True, text=True, check=True)
    assert child.stdout.split()[-1] == digest(everything(denoiser()))


@pytest.mark.parametrize(
    "tuning",
    [
        Tuning(vector_width=1, work_group=(64, 1)),
        Tuning(vector_width=4, work_group=(3, 5)),
        Tuning(vector_width=8, work_group=(1, 16), row_alignment=16),
        Tuning(vector_width=16, work_group=(2, 1), row_alignment=512),
    ],
    ids=str,
)
def test_however_the_work_is_cut(tuning: Tuning) -> None:
    expected, found = everything(denoiser(Tuning(vector_width=4, work_group=(8, 1)))), everything(denoiser(tuning))
    for name in expected:
        np.testing.assert_array_equal(found[name], expected[name], err_msg=name)
