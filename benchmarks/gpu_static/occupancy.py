"""How many waves of a kernel run at the same time, computed from limits that vendors publish.

NVIDIA's warps are called waves here, too. A multiprocessor (NVIDIA), compute unit (AMD's CDNA) or work-group processor
(RDNA) runs whole work-groups. It has four schedulers, each with its own registers:

    waves of a scheduler = min(most waves, floor(registers / registers of a wave, rounded up to the granule))
    groups               = min(most groups, floor(4 waves of a scheduler / waves of a group))
    occupancy            = groups * waves of a group / (4 * most waves)

Sources: CUDA C++ Programming Guide, "Technical Specifications per Compute Capability", and NVIDIA's occupancy
calculator (registers are allocated by 256 a warp); AMD's instruction set documents of RDNA 2, RDNA 3 and CDNA 2, and
LLVM's "User Guide for AMDGPU Backend" (granules of registers).
"""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.gpu_static.usage import Usage

SCHEDULERS = 4


@dataclass(frozen=True)
class Limits:
    """Limits of one architecture.

    Parameters
    ----------
    wave : int
        Work-items of a wave.
    most_waves, most_groups : int
        The most waves of a scheduler, and the most work-groups of four schedulers.
    registers, granule : int
        32-bit registers of a scheduler for each work-item of a wave, and the number that is allocated at a time.
    scalars, scalar_granule : int
        The same for registers of a whole wave, if waves share them; otherwise 0.
    """

    wave: int
    most_waves: int
    most_groups: int
    registers: int
    granule: int
    scalars: int = 0
    scalar_granule: int = 1

    def waves(self, usage: Usage) -> int:
        """The number of waves whose registers fit in a scheduler."""
        room = [self.most_waves, self.registers // rounded_up(usage.registers, self.granule)]
        if self.scalars and usage.scalars:
            room.append(self.scalars // rounded_up(usage.scalars, self.scalar_granule))
        return min(room)

    def occupancy(self, usage: Usage, group: int) -> float:
        """The waves that run, as a share of the most that can, 0..1, for work-groups of `group` work-items."""
        waves_of_group = -(-group // self.wave)
        groups = min(self.most_groups, SCHEDULERS * self.waves(usage) // waves_of_group)
        return groups * waves_of_group / (SCHEDULERS * self.most_waves)


LIMITS = {
    "sm_75": Limits(wave=32, most_waves=8, most_groups=16, registers=512, granule=8),
    "sm_90": Limits(wave=32, most_waves=16, most_groups=32, registers=512, granule=8),
    "gfx1030": Limits(wave=32, most_waves=16, most_groups=32, registers=1024, granule=16),
    "gfx1100": Limits(wave=32, most_waves=16, most_groups=32, registers=1536, granule=24),
    "gfx90a": Limits(wave=64, most_waves=8, most_groups=16, registers=512, granule=8, scalars=800, scalar_granule=16),
}


def rounded_up(count: int, granule: int) -> int:
    """The least multiple of `granule` that is at least `count` and greater than 0."""
    return max(1, -(-count // granule)) * granule
