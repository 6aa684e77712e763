"""The host in C makes of an exported plan what `Denoiser` makes, bit by bit, and allocates nothing while it runs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import Accumulation, Denoiser, Frame, Inputs, Kalman, Lbf, Settings
from svgf_cl.device.arguments import layout_of
from svgf_cl.device.tuning import GPU_TUNING, Tuning, best_tuning
from svgf_cl.export.folder import write_plan
from svgf_cl.filters.filter import Filter
from svgf_cl.schedule import Schedule
from tests.compilers import missing
from tests.examples.running import EXAMPLES
from tests.frames import FULL, PLAIN, SPLIT, bumpy_sequence

HOST = EXAMPLES / "c_host"
README = (HOST / "README.md").read_text(encoding="utf-8")
SHAPE = (37, 53)
COUNT, CUT = 6, 4  # frames; the one, from 1 on, that follows on a cut
COUNTED = ("malloc", "calloc", "realloc", "clCreateBuffer", "clCreateKernel", "clEnqueueReadBuffer")


def compiled(folder: Path, *arguments: str) -> Path:
    """The host, built in a folder of its own."""
    copied(folder)
    subprocess.run(["make", "-s", "-C", folder, *arguments], check=True)
    return folder / "svgf_host"


def copied(folder: Path) -> None:
    """A copy of the example, where it can be built."""
    if shutil.which("make") is None or shutil.which("cc") is None or not Path("/usr/include/CL/cl.h").exists():
        missing("no C compiler or OpenCL headers: apt-get install gcc make opencl-c-headers ocl-icd-opencl-dev")
    shutil.copytree(HOST, folder, ignore=shutil.ignore_patterns("svgf_host"))


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The host, which counts what it allocates."""
    sources = f"main.c plan.c json.c files.c {EXAMPLES.parent}/tests/examples/allocations.c"
    wrapped = f"LDFLAGS={' '.join(f'-Wl,--wrap={name}' for name in COUNTED)}"
    return compiled(tmp_path_factory.mktemp("counting") / "c_host", f"SOURCES={sources}", wrapped)


def write_frames(folder: Path, frames: list[Frame]) -> None:
    folder.mkdir()
    for number, frame in enumerate(frames, start=1):
        for name, value in frame.present().items():
            (folder / f"{number:04d}.{name}.raw").write_bytes(value.tobytes())


def run(host: Path, queue: cl.CommandQueue, *arguments: Path | str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"OPENCL_PLATFORM": queue.device.platform.name}
    return subprocess.run([host, *arguments], env=environment, capture_output=True, text=True, check=False, timeout=600)


CASES = {
    "two signals": (Kalman(taa=True), SPLIT, replace(GPU_TUNING, work_group=(8, 2))),
    "svgf": (Settings(taa=True), FULL, Tuning(vector_width=4, work_group=(1024, 64))),  # which no device can run
    "network": (Lbf(), PLAIN, None),
}


@pytest.mark.parametrize("case", CASES)
def test_pictures_are_those_of_a_denoiser(case: str, host: Path, queue: cl.CommandQueue, tmp_path: Path) -> None:
    settings, fields, wanted = CASES[case]
    tuning = wanted or best_tuning(queue.device)
    frames = bumpy_sequence(fields, count=COUNT, shape=SHAPE)
    plan_for(tmp_path / "plan", settings, frames[0], tuning)
    write_frames(tmp_path / "frames", frames)
    (tmp_path / "out").mkdir()
    ran = run(host, queue, tmp_path / "plan", tmp_path / "frames", tmp_path / "out", str(CUT))
    assert ran.returncode == 0, ran.stderr
    other_groups = replace(tuning, work_group=(16, 2))  # the result does not depend on them
    with Denoiser(SHAPE, settings=settings, queue=queue, tuning=other_groups) as den:
        for number, frame in enumerate(frames, start=1):
            if number == CUT:
                den.reset()
            picture = den.denoise(frame)
            assert (tmp_path / "out" / f"{number:04d}.raw").read_bytes() == picture.tobytes()
            assert np.ptp(picture) > 0
    allocations = re.findall(r"allocations: (\d+)", ran.stderr)
    assert len(allocations) == COUNT
    assert int(allocations[0]) > 10
    assert len({*allocations}) == 1, "made after the first frame"


def plan_for(folder: Path, settings: Filter, frame: Frame, tuning: Tuning) -> None:
    pipeline = settings.pipeline(Inputs.of(frame))
    write_plan(folder, Schedule(pipeline, layout_of(SHAPE, tuning, settings), tuning), settings)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_compilers_have_nothing_to_say(compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        missing(f"no {compiler}: apt-get install {compiler}")
    built = compiled(tmp_path / "c_host", f"CC={compiler}", "CFLAGS=-O2 -Wconversion -Wshadow -Wcast-qual")
    assert built.exists()


def test_wrong_input_is_named(host: Path, queue: cl.CommandQueue, tmp_path: Path) -> None:
    frames = bumpy_sequence(PLAIN, count=1, shape=SHAPE)
    plan, given, out = (tmp_path / name for name in ("plan", "frames", "out"))
    plan_for(plan, Accumulation(), frames[0], GPU_TUNING)
    write_frames(given, frames)
    out.mkdir()

    def complaint(*arguments: Path | str) -> str:
        ran = run(host, queue, *arguments)
        assert ran.returncode == 1
        return ran.stderr

    assert "usage: svgf_host PLAN FRAMES OUT [CUT ...]" in complaint(plan)
    assert "nowhere/plan.json: cannot be read" in complaint(tmp_path / "nowhere", given, out)
    assert "plan: expected a file 0001.color.raw, found none" in complaint(plan, plan, out)
    assert "CUT: expected the number of a frame, got two" in complaint(plan, given, out, "two")
    assert "nowhere/0001.raw: cannot be written" in complaint(plan, given, tmp_path / "nowhere")
    (given / "0001.depth.raw").write_bytes(b"\0" * 12)
    assert f"0001.depth.raw: expected {4 * SHAPE[0] * SHAPE[1]} bytes" in complaint(plan, given, out)
    text = (plan / "plan.json").read_text()
    (plan / "plan.json").write_text(text[:-2] + ",")
    assert f"plan.json: expected JSON, got something else at byte {len(text) - 1}" in complaint(plan, given, out)
    (plan / "plan.json").write_text(text.replace('"format": 1', '"format": 2', 1))
    assert "plan.json: expected format 1" in complaint(plan, given, out)


def test_the_commands_of_its_readme_work_as_they_stand(tmp_path: Path) -> None:
    """In a folder with the example alone, and the environment's commands."""
    copied(tmp_path / "examples" / "c_host")
    bin_ = tmp_path / ".venv" / "bin"
    bin_.mkdir(parents=True)
    (bin_ / "activate").write_text(f'PATH="{Path(sys.executable).parent}:$PATH"\n')
    (tmp_path / "out").mkdir()
    (commands,) = re.findall(r"```sh\n(.*?)```", README, re.DOTALL)
    subprocess.run(["bash", "-euc", commands], cwd=tmp_path, check=True, timeout=600)
    (program,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True, timeout=600)
    assert len(list((tmp_path / "out" / "clean").iterdir())) == 8
    assert (tmp_path / "out" / "clean.png").stat().st_size > 1000
