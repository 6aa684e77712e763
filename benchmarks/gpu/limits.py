"""Limits of GPUs that their makers publish: peaks that no program exceeds, and few reach."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.bench.ceilings import Ceilings

# For a compute unit and a clock: 32-bit operations, where a multiply-add counts as two; and bytes from the nearest
# cache (NVIDIA Volta, Ampere, Hopper and Ada whitepapers; AMD RDNA whitepaper: a line of 128 bytes).
OPERATIONS, LOADED = 256, 128


@dataclass(frozen=True)
class Gpu:
    """A GPU's published limits.

    Parameters
    ----------
    name : str
    architecture : str
        The most similar architecture for which ``benchmarks.gpu_static`` compiles.
    units : int
        Streaming multiprocessors (NVIDIA) or compute units (AMD).
    clock : float, Hz
        The boost clock.
    memory : float, bytes / s
    cache : int, bytes
        The last cache before memory.
    cache_bandwidth : float, bytes / s
    sources : str
        The documents that publish the limits.
    """

    name: str
    architecture: str
    units: int
    clock: float
    memory: float
    cache: int
    cache_bandwidth: float
    sources: str

    @property
    def flops(self) -> float:
        """Single precision operations per second; a multiply-add counts as two."""
        return OPERATIONS * self.units * self.clock

    @property
    def instructions(self) -> float:
        """Single precision instructions per second, for one work-item each."""
        return self.flops / 2

    @property
    def loads(self) -> float:
        """Bytes per second from the nearest caches."""
        return LOADED * self.units * self.clock

    @property
    def ceilings(self) -> Ceilings:
        """The limits as ceilings of the benchmark; data of up to twice the size of the cache is partly in it."""
        bandwidth = ((self.cache, self.cache_bandwidth), (2 * self.cache, self.memory))
        return Ceilings(bandwidth, aligned_loads=self.loads, offset_loads=self.loads, flops=self.flops)


A100_L2 = 5120  # bytes per clock: NVIDIA A100 whitepaper. NVIDIA publishes no figure for later GPUs

GPUS = (
    Gpu(
        "H100 SXM5",
        "sm_90",
        units=132,
        clock=1.98e9,
        memory=3.35e12,
        cache=50_000_000,
        cache_bandwidth=A100_L2 * 1.98e9,
        sources="NVIDIA H100 datasheet; NVIDIA H100 Tensor Core GPU Architecture; its L2's speed is taken to be A100's",
    ),
    Gpu(
        "GeForce RTX 4090",
        "sm_90",
        units=128,
        clock=2.52e9,
        memory=1.008e12,
        cache=72_000_000,
        cache_bandwidth=A100_L2 * 2.52e9,
        sources="NVIDIA Ada GPU Architecture; its L2's speed is taken to be A100's",
    ),
    Gpu(
        "Radeon RX 7900 XTX",
        "gfx1100",
        units=96,
        clock=2.5e9,
        memory=0.96e12,
        cache=96_000_000,
        cache_bandwidth=5.3e12,
        sources="AMD's page of the product; AMD's announcement of 2022-11-03 (5.3 TB/s between chiplets)",
    ),
)

# Bytes per second in each direction over 16 lanes: 16 and 32 GT/s with 128 of 130 bits (PCI-SIG, PCI Express Base 4.0
# and 5.0).
PCI_EXPRESS = {"PCIe 4.0 x16": 16e9 * 16 / 8 * 128 / 130, "PCIe 5.0 x16": 32e9 * 16 / 8 * 128 / 130}
