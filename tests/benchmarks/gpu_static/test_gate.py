"""A kernel goes through every compiler, and what it must not do is told."""

from __future__ import annotations

import pytest

from benchmarks.builds import Build
from benchmarks.gpu_static import gate, spirv, usage
from benchmarks.gpu_static.tools import Tools
from benchmarks.gpu_static.variants import variants
from svgf_cl.device import programs
from tests.benchmarks.gpu_static.made_up import row

# More values alive at a time than any GPU has registers for a work-item.
SPILLING = """
__kernel void spilling(__global float *values, const int n) {
    float kept[560];
    values += n * (int)get_global_id(0);
#pragma unroll
    for (int i = 0; i < 560; ++i) kept[i] = values[i];
    barrier(CLK_GLOBAL_MEM_FENCE);
#pragma unroll
    for (int i = 0; i < 560; ++i) values[559 - i] = kept[i] * n;
}
"""
# An array in memory, as its index is known at run time alone.
INDEXED = """
__kernel void indexed(__global float *values, const int n) {
    float kept[64];
    for (int i = 0; i < 64; ++i) kept[i] = values[i * n];
    for (int i = 0; i < n; ++i) kept[(i * n) & 63] += kept[(i + n) & 63];
    values[0] = kept[n & 63];
}
"""
ADDING = "__kernel void adding(__global float *v) { const int i = get_global_id(0); v[i] = v[i] + 1.0f; }"
EXPONENTIAL = ADDING.replace("v[i] + 1.0f", "exp2(v[i])")
WRONG = "__kernel void wrong(__global float *values) { values[0] = missing(values[1]); }"
BUILD = Build("made_up", programs.OPTIONS, "a test")


def outcomes(tools: Tools, text: str, monkeypatch: pytest.MonkeyPatch) -> list[gate.Outcome]:
    """A source of its own, compiled for all targets."""
    monkeypatch.setattr(usage.programs, "source", lambda name: text)
    return gate.compile_all(tools, [BUILD], lambda: None)


def test_spills_and_scratch_are_faults_that_say_what_to_do() -> None:
    assert list(row("atrous", "sm_90", 64).faults()) == []
    spilled, scratch = row("atrous", "gfx90a", 64, spills=3, scratch=16).faults()
    place = "kernel atrous of atrous.cl on gfx90a (any): "
    assert spilled.startswith(f"{place}expected no registers spilled, found 3 registers spilled; ")
    assert scratch.startswith(f"{place}expected no scratch memory, found 16 bytes a work-item; ")


def test_a_kernel_goes_through_all_compilers(compilers: Tools) -> None:
    (copy,) = (build for build in variants() if build.source == "strided_copy")
    steps: list[int] = []
    found = gate.compile_all(compilers, [copy], lambda: steps.append(1))
    assert [outcome.fault for outcome in found] == [""] * len(gate.TARGETS)
    assert len(steps) == len(gate.TARGETS)
    rows = gate.rows(compilers, found)
    assert [each.architecture for each in rows] == list(gate.ARCHITECTURES)
    for each in rows:
        assert each.name == "strided_copy/strided_copy"
        assert list(each.faults()) == []
        assert 8 <= each.usage.registers <= 128
        assert 0 < each.occupancy <= 1
        counted = each.instructions
        assert counted.loads == counted.stores >= 1
        assert counted.total > counted.loads + counted.stores + counted.integer


def test_a_kernel_that_spills_is_refused_on_every_architecture(
    compilers: Tools, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = gate.rows(compilers, outcomes(compilers, SPILLING, monkeypatch))
    assert [each.architecture for each in rows] == list(gate.ARCHITECTURES)
    assert all("expected no registers spilled" in next(each.faults()) for each in rows)


def test_scratch_memory_is_refused_on_every_architecture(compilers: Tools, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = gate.rows(compilers, outcomes(compilers, INDEXED, monkeypatch))
    assert [each.architecture for each in rows] == list(gate.ARCHITECTURES)
    assert all(any("expected no scratch memory" in fault for fault in each.faults()) for each in rows)


def test_an_exponential_is_an_instruction_on_every_architecture(
    compilers: Tools, monkeypatch: pytest.MonkeyPatch
) -> None:
    adding, exponential = (
        gate.rows(compilers, outcomes(compilers, text, monkeypatch)) for text in (ADDING, EXPONENTIAL)
    )
    for one, other in zip(adding, exponential, strict=True):
        assert other.instructions.total <= one.instructions.total  # 20 more where a library writes it out


def test_what_does_not_compile_is_told_for_every_target(compilers: Tools, monkeypatch: pytest.MonkeyPatch) -> None:
    found = outcomes(compilers, WRONG, monkeypatch)
    assert [outcome.target for outcome in found if "missing" in outcome.fault] == list(gate.TARGETS)
    assert gate.rows(compilers, found) == []


def test_a_module_that_is_not_valid_is_told(compilers: Tools, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spirv, "TARGET", tuple(option for option in spirv.TARGET if option != "-Dinline=static"))
    atrous = next(build for build in variants() if build.source == "atrous")
    (outcome,) = gate.compile_together(compilers, atrous, (spirv.NAME,))
    fault = outcome.fault
    assert fault.startswith("atrous.cl on SPIR-V (kalman by default; ")
    assert "expected a valid module; spirv-val: " in fault
