"""What clang writes into assembly for AMD is read as it is meant."""

from __future__ import annotations

import pytest

from benchmarks.gpu_static import amd
from benchmarks.gpu_static.usage import Instructions, RejectedError, Usage

# Of clang 19.1.7 for gfx1100, shortened.
ASSEMBLY = """\
	.text
	.protected	twice                   ; -- Begin function twice
	.type	twice,@function
twice:                                  ; @twice
; %bb.0:
	s_load_b64 s[0:1], s[0:1], 0x0
	v_mov_b32_e32 v1, 0
	s_mul_i32 s15, s15, s2
	v_add3_u32 v2, s3, s15, v0
	v_ashrrev_i64 v[0:1], 30, v[1:2]
	v_add_co_u32 v0, vcc_lo, s0, v0
	v_add_co_ci_u32_e32 v1, vcc_lo, s1, v1, vcc_lo
	global_load_b32 v2, v[0:1], off
	v_add_f32_e32 v2, v2, v2
	v_dual_mov_b32 v14, s14 :: v_dual_mov_b32 v15, s15
	global_store_b32 v[0:1], v2, off
	s_endpgm
	s_code_end
	.section	.rodata,"a",@progbits
	.amdhsa_kernel twice
		.amdhsa_group_segment_fixed_size 0
	.end_amdhsa_kernel
	.text
.Lfunc_end0:
	.size	twice, .Lfunc_end0-twice
	.type	spilled,@function
spilled:                                ; @spilled
	scratch_store_b128 off, v[0:3], off
	s_endpgm
.Lfunc_end1:
	.amdgpu_metadata
---
amdhsa.kernels:
  - .args:
      - .address_space:  global
        .name:           values
        .offset:         0
        .size:           8
        .value_kind:     global_buffer
    .group_segment_fixed_size: 0
    .language_version:
      - 1
      - 2
    .name:           twice
    .private_segment_fixed_size: 0
    .sgpr_count:     18
    .sgpr_spill_count: 0
    .symbol:         twice.kd
    .vgpr_count:     3
    .vgpr_spill_count: 0
    .wavefront_size: 32
  - .agpr_count:     0
    .args:
      - .size:           8
        .value_kind:     global_buffer
    .name:           spilled
    .private_segment_fixed_size: 608
    .sgpr_count:     107
    .sgpr_spill_count: 814
    .vgpr_count:     256
    .vgpr_spill_count: 308
amdhsa.target:   amdgcn-amd-amdhsa--gfx1100
amdhsa.version:
  - 1
  - 2
...
	.end_amdgpu_metadata
"""


def test_the_metadata_of_every_kernel() -> None:
    found = amd.parse(ASSEMBLY)
    assert {name: kernel.usage for name, kernel in found.items()} == {
        "twice": Usage(registers=3, scalars=18, spills=0, scratch=0),
        "spilled": Usage(registers=256, scalars=107, spills=308 + 814, scratch=608),
    }


def test_instructions_are_those_of_the_kernel_itself() -> None:
    twice, spilled = amd.instructions([kernel.code for kernel in amd.parse(ASSEMBLY).values()])
    assert twice == Instructions(total=12, loads=1, stores=1, integer=5)
    assert spilled == Instructions(total=2, loads=0, stores=0, integer=0)


@pytest.mark.parametrize(
    "assembly", ["", ASSEMBLY.replace("amdhsa.kernels", "kernels"), ASSEMBLY.replace(".Lfunc", "")]
)
def test_assembly_that_says_nothing_is_refused(assembly: str) -> None:
    with pytest.raises(RejectedError, match="clang: expected"):
        amd.parse(assembly)
