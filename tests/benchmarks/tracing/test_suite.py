"""All is measured, named and kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.tracing import suite
from benchmarks.tracing.recording import KINDS, THREADS
from benchmarks.tracing.split import PARTS
from benchmarks.tracing.tables import tables
from svgf_cl import SvgfError
from svgf_cl.bench.results import Run
from svgf_cl.cli.console import progress_bar
from tests.benchmarks.tracing.made_up import COLD, WARM


@pytest.fixture(autouse=True)
def _started(monkeypatch: pytest.MonkeyPatch) -> None:
    """No process is started, and a rough reference will do."""
    monkeypatch.setattr(suite, "starts", lambda *_: [COLD, WARM])
    monkeypatch.setattr(suite, "REFERENCE_SPP", 16)


def test_results_of_a_scene(tmp_path: Path) -> None:
    results = suite.measure("cornell", (9, 16), 2, progress_bar)
    names = {result.name for result in results}
    assert {"tracer.frame.16x9", "tracer.embree.16x9", "tracer.start.cold.1920x1080"} <= names
    assert {f"tracer.embree.{kind}.16x9" for kind in KINDS} <= names
    assert {f"tracer.split.{'.'.join(part.lower().split())}.16x9" for part in PARTS} <= names
    assert ("tracer.embree.threads1.16x9" in names) == (THREADS > 1)
    assert {result.device for result in results} == {"tracer: cornell"}
    assert all(len(result.seconds) == 2 for result in results if "start" not in result.name)
    (rays,) = (result.facts["rays"] for result in results if result.name == "tracer.embree.primary.16x9")
    assert rays == 9 * 16
    Run.now((), results, ()).write(tmp_path / "results.json")
    assert Run.read(tmp_path / "results.json").results == results
    assert all(len(row) == len(table.columns) for table in tables(results) for row in table.rows)


def test_a_scene_that_is_not_there() -> None:
    with pytest.raises(SvgfError, match="nowhere: expected a scene's folder or file"):
        suite.measure("nowhere", (9, 16), 1, progress_bar)
