"""Published figures that follow from others agree with them."""

from __future__ import annotations

import pytest

from benchmarks.gpu.limits import GPUS, PCI_EXPRESS, Gpu

# As the makers' documents give it, in TFLOP/s.
PUBLISHED = {"H100 SXM5": 67.0, "GeForce RTX 4090": 82.6, "Radeon RX 7900 XTX": 61.4}


@pytest.mark.parametrize("gpu", GPUS, ids=lambda gpu: gpu.name)
def test_units_and_clock_make_the_published_rate(gpu: Gpu) -> None:
    assert 1e-12 * gpu.flops == pytest.approx(PUBLISHED[gpu.name], rel=2e-3)
    assert gpu.cache_bandwidth > gpu.memory
    assert gpu.loads > gpu.cache_bandwidth


def test_a_working_set_within_the_cache_has_its_speed_and_a_large_one_that_of_memory() -> None:
    gpu = GPUS[0]
    ceilings = gpu.ceilings
    for size in (1_000, gpu.cache):
        assert ceilings.bandwidth_at(size) == gpu.cache_bandwidth
    for size in (2 * gpu.cache, 10**12):
        assert ceilings.bandwidth_at(size) == gpu.memory
    assert gpu.memory < ceilings.bandwidth_at(1.4 * gpu.cache) < gpu.cache_bandwidth


def test_the_bus_is_as_fast_as_specified() -> None:
    assert PCI_EXPRESS["PCIe 4.0 x16"] == pytest.approx(31.5e9, rel=1e-3)
