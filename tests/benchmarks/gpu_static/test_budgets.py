"""A kernel that outgrows its budget is told, and so are budgets that fit no kernel."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.gpu_static import budgets
from benchmarks.gpu_static.gate import ARCHITECTURES
from benchmarks.gpu_static.variants import variants
from svgf_cl import SvgfError
from tests.benchmarks.gpu_static.made_up import row

ROWS = [row("atrous", "sm_90", 40), row("atrous", "sm_90", 64, variant="fast"), row("atrous", "gfx1100", 48)]
FITTING = {"atrous/atrous": {"sm_90": 64, "gfx1100": 48}}


def test_a_budget_is_the_most_of_all_variants() -> None:
    assert budgets.of(ROWS) == FITTING


def test_what_keeps_its_budget_passes() -> None:
    assert list(budgets.exceeded(ROWS, FITTING)) == []
    assert list(budgets.exceeded(ROWS, {"atrous/atrous": {"sm_90": 255, "gfx1100": 255}})) == []


def test_what_exceeds_it_is_named_with_both_numbers() -> None:
    (fault,) = budgets.exceeded(ROWS, {"atrous/atrous": {"sm_90": 63, "gfx1100": 48}})
    assert fault.startswith("kernel atrous of atrous.cl on sm_90 (fast): expected at most 63 registers, found 64; ")
    assert "--record" in fault


@pytest.mark.parametrize("recorded", [{}, {"atrous/atrous": {"sm_90": 64}}])
def test_a_missing_budget_is_named(recorded: budgets.Budgets) -> None:
    assert "atrous/atrous on gfx1100: expected a budget" in "\n".join(budgets.exceeded(ROWS, recorded))


def test_a_budget_without_a_kernel_is_named() -> None:
    stale = {**FITTING, "atrous/gone": {"sm_90": 8}}
    (fault,) = budgets.exceeded(ROWS, stale)
    assert fault.startswith("atrous/gone on sm_90: expected a kernel, found a budget")


def test_what_is_recorded_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "budgets.json"
    budgets.record(path, ROWS, {"clang": "19.1.7"})
    assert budgets.read(path) == (FITTING, {"clang": "19.1.7"})
    assert list(budgets.exceeded(ROWS, budgets.read(path)[0])) == []


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"compilers": {}, "a/b": 3}', '{"compilers": {}, "a/b": {"c": "d"}}']
)
def test_a_file_of_something_else_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "budgets.json"
    path.write_text(text)
    with pytest.raises(SvgfError, match=r"budgets.json: expected budgets.*--record"):
        budgets.read(path)
    with pytest.raises(SvgfError, match="cannot be read"):
        budgets.read(tmp_path / "none.json")


def test_the_recorded_budgets_are_of_every_source_and_architecture() -> None:
    recorded, _ = budgets.read(budgets.FILE)
    assert {name.partition("/")[0] for name in recorded} == {build.source for build in variants()}
    assert all(set(each) == set(ARCHITECTURES) for each in recorded.values())
