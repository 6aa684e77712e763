from __future__ import annotations

import shutil
from pathlib import Path

import numba
import pytest

import svgf_cl_tracer.compiled
from svgf_cl.io.cache import cache_folder
from svgf_cl_tracer.compiled import FOLDER, compiled


def double(x: float) -> float:
    return 2.0 * x


def test_what_is_compiled_is_kept_on_disk_for_the_next_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(svgf_cl_tracer.compiled, "FOLDER", tmp_path)
    first, second = compiled(double), compiled(double)
    assert first(3.0) == second(3.0) == 6.0
    assert list(tmp_path.rglob("*.nbc"))
    assert not first.stats.cache_hits
    assert second.stats.cache_hits


def test_the_folder_is_named_by_the_state_of_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert FOLDER.is_relative_to(cache_folder())
    sources = shutil.copytree(Path(svgf_cl_tracer.compiled.__file__).parent, tmp_path / "tracer")
    monkeypatch.setattr(svgf_cl_tracer.compiled, "__file__", str(sources / "compiled.py"))
    assert svgf_cl_tracer.compiled._digest() == FOLDER.name
    with (sources / "vec3.py").open("a") as file:
        file.write("# another state\n")
    assert svgf_cl_tracer.compiled._digest() != FOLDER.name


def test_numbas_own_folder_stays_what_it_was() -> None:
    before = numba.config.CACHE_DIR
    compiled(double)
    assert before == numba.config.CACHE_DIR
