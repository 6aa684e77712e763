"""The Open Job Description template is valid, and its tasks write what one command writes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from svgf_cl.chunks import CHUNK, WARM_UP
from svgf_cl.filters import DEFAULT
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.synthetic import room_frames
from tests.command_line import contents, run

model = pytest.importorskip("openjd.model", reason="openjd-cli is not installed: the template is not tested")

TEMPLATE = Path(__file__).parents[1] / "examples" / "openjd" / "denoise.yaml"


@pytest.fixture(scope="module")
def parsed() -> Any:
    """The template, valid."""
    described = model.document_string_to_object(document=TEMPLATE.read_text(), document_type=model.DocumentType.YAML)
    return model.decode_job_template(template=described, supported_extensions=["TASK_CHUNKING"])


def test_defaults_are_those_of_the_command(parsed: Any) -> None:
    defaults = {each.name: each.default for each in parsed.parameterDefinitions}
    assert (defaults["ChunkSize"], defaults["WarmUp"], defaults["Filter"]) == (CHUNK, WARM_UP, DEFAULT.name)


def test_frames_come_in_contiguous_chunks(parsed: Any) -> None:
    (step,) = parsed.steps
    (parameter,) = step.parameterSpace.taskParameterDefinitions
    assert (parameter.type.value, parameter.chunks.rangeConstraint.value) == ("CHUNK[INT]", "CONTIGUOUS")


def test_the_job_run_here_writes_what_the_command_writes(tmp_path: Path) -> None:
    (tmp_path / "shot").mkdir()
    for number, frame in enumerate(room_frames((18, 32), 9)):
        write_frame(frame_path(tmp_path / "shot", number), frame)
    values = {"Shot": tmp_path / "shot", "Output": tmp_path / "job", "Frames": "1-8", "ChunkSize": 4, "WarmUp": 2}
    parameters = [part for name, value in values.items() for part in ("-p", f"{name}={value}")]
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    command = [sys.executable, "-m", "openjd", "run", str(TEMPLATE), *parameters]
    ran = subprocess.run(
        command, env=os.environ | {"PATH": path}, capture_output=True, text=True, timeout=300, check=False
    )
    assert ran.returncode == 0, ran.stdout
    assert "Chunks run: 2" in ran.stdout
    cut = ("--frames", "1-8", "--chunk", "4", "--warm-up", "2")
    assert run("denoise", tmp_path / "shot", "-o", tmp_path / "command", *cut) == 0
    assert contents(tmp_path / "job") == contents(tmp_path / "command")
    assert len(contents(tmp_path / "job")) == 8
