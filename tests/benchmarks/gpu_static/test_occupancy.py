"""Occupancy as NVIDIA's calculator and AMD's compiler tell it."""

from __future__ import annotations

import pytest

from benchmarks.gpu_static.gate import ARCHITECTURES
from benchmarks.gpu_static.occupancy import LIMITS, rounded_up
from benchmarks.gpu_static.usage import Usage


def taking(registers: int, scalars: int | None = None) -> Usage:
    return Usage(registers, scalars, 0, 0)


# NVIDIA's occupancy calculator: registers of a thread, threads of a block, warps of a multiprocessor in percent.
@pytest.mark.parametrize(
    ("architecture", "registers", "group", "percent"),
    [
        ("sm_90", 32, 128, 100),
        ("sm_90", 33, 128, 75),  # 40 are allocated: 12 warps a scheduler
        ("sm_90", 40, 128, 75),
        ("sm_90", 64, 128, 50),
        ("sm_90", 65, 128, 43.75),
        ("sm_90", 72, 128, 43.75),
        ("sm_90", 128, 128, 25),
        ("sm_90", 255, 128, 12.5),
        ("sm_90", 64, 1024, 50),
        ("sm_90", 72, 1024, 0),  # 28 warps have room, a block has 32
        ("sm_90", 16, 32, 50),  # 32 blocks of one warp
        ("sm_75", 64, 128, 100),
        ("sm_75", 72, 128, 87.5),
        ("sm_75", 255, 128, 25),
        ("sm_75", 32, 32, 50),  # 16 blocks of one warp
    ],
)
def test_nvidia(architecture: str, registers: int, group: int, percent: float) -> None:
    assert 100 * LIMITS[architecture].occupancy(taking(registers), group) == percent


# The most VGPRs for each number of waves: llvm/test/CodeGen/AMDGPU/occupancy-levels.ll and AMD's tables.
@pytest.mark.parametrize(
    ("architecture", "most"),
    [
        ("gfx1030", {16: 64, 12: 80, 10: 96, 9: 112, 8: 128, 7: 144, 6: 160, 5: 192, 4: 256}),
        ("gfx1100", {16: 96, 12: 120, 10: 144, 9: 168, 8: 192, 7: 216, 6: 240}),
        ("gfx90a", {8: 64, 7: 72, 6: 80, 5: 96, 4: 128, 3: 168, 2: 256, 1: 512}),
    ],
)
def test_vgprs_of_amd(architecture: str, most: dict[int, int]) -> None:
    limits = LIMITS[architecture]
    for (waves, registers), fewer in zip(most.items(), [*list(most)[1:], None], strict=True):
        assert limits.waves(taking(registers)) == waves
        if fewer is not None:
            assert limits.waves(taking(registers + 1)) == fewer


def test_scalars_limit_waves_where_waves_share_them() -> None:
    limits = LIMITS["gfx90a"]
    assert [limits.waves(taking(32, scalars)) for scalars in (16, 96, 97, 112)] == [8, 8, 7, 7]
    assert LIMITS["gfx1100"].waves(taking(32, 106)) == 16


def test_a_work_group_of_a_gpu_is_whole_waves_of_every_architecture() -> None:
    for name in ARCHITECTURES:
        limits = LIMITS[name]
        assert limits.occupancy(taking(1), 128) == 1
        assert limits.occupancy(taking(1), limits.wave + 1) == limits.occupancy(taking(1), 2 * limits.wave)


def test_registers_are_allocated_in_granules() -> None:
    assert [rounded_up(count, 24) for count in (0, 1, 24, 25)] == [24, 24, 24, 48]
