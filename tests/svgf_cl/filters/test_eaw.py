"""EAW as a pipeline."""

from __future__ import annotations

from svgf_cl import Eaw, Inputs
from svgf_cl.filters.pipeline import Buffer, Life


def test_accumulated_light_is_the_colour_history() -> None:
    passes = {entry.label: entry for entry in Eaw().pipeline(Inputs()).passes}
    (written,) = [each for each in passes["temporal"].writes if each.argument == "accumulated"]
    (read,) = [each for each in passes["temporal"].reads if each.argument == "history"]
    (filtered,) = [each for each in passes["atrous 1"].reads if each.argument == "source"]
    assert isinstance(written.of, Buffer)
    assert written.of.resource.life is Life.PAIR
    assert read.of == Buffer(written.of.resource, previous=True)
    assert filtered.of == written.of


def test_there_is_no_variance_of_light() -> None:
    pipeline = Eaw().pipeline(Inputs.every())
    assert "variance" not in {entry.kernel for entry in pipeline.passes}
    assert "ILLUMINATION_VARIANCE" not in pipeline.defines
    assert pipeline.defines["GUIDED_BY_VARIANCE"] == 0
