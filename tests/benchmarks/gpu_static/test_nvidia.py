"""What ptxas and nvdisasm print is read as it is meant."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from benchmarks.gpu_static import nvidia
from benchmarks.gpu_static.usage import Instructions, RejectedError, Usage

# Of ptxas 12.9.86 with -v.
REPORT = """\
ptxas info    : 0 bytes gmem
ptxas info    : Compiling entry function 'spilled' for 'sm_90'
ptxas info    : Function properties for spilled
    2928 bytes stack frame, 3468 bytes spill stores, 4704 bytes spill loads
ptxas info    : Used 255 registers, used 0 barriers, 2928 bytes cumulative stack size
ptxas info    : Compile time = 290.926 ms
ptxas info    : Compiling entry function 'twice' for 'sm_75'
ptxas info    : Function properties for twice
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 8 registers, used 0 barriers, 360 bytes cmem[0]
ptxas info    : Compile time = 1.102 ms
"""
# Of nvdisasm 13.5.37, shortened: two kernels, the first with padding.
LISTING = """\
	.headerflags	@"EF_CUDA_64BIT_ADDRESS EF_CUDA_SM90 EF_CUDA_VIRTUAL_SM(EF_CUDA_SM90)"
        /*0000*/                   LDC R1, c[0x0][0x28] ;
        /*0010*/                   IMAD.WIDE R22, R5, R22, UR4 ;
        /*0020*/                   LDG.E.CONSTANT R14, desc[UR16][R22.64] ;
        /*0030*/              @!P0 IADD3.X R9, R23, UR13, RZ, P0, !PT ;
        /*0040*/              @!P0 IMAD.MOV.U32 R0, RZ, RZ, R15 ;
        /*0050*/                   FADD.FTZ R2, R6.reuse, -R43 ;
        /*0060*/                   STG.E desc[UR4][R2.64], R0 ;
        /*0070*/                   NOP;
        /*0080*/             @UP0 UIADD3 UR4, UR4, 0x1, URZ ;
        /*0090*/                   ISETP.EQ.AND P3, PT, R9.reuse, 0x4, PT ;
"""
CODES = [bytes(8 * nvidia.BYTES), bytes(2 * nvidia.BYTES)]


def test_the_report_of_ptxas() -> None:
    assert nvidia.parse(REPORT) == {
        "spilled": Usage(registers=255, scalars=None, spills=3468 + 4704, scratch=2928),
        "twice": Usage(registers=8, scalars=None, spills=0, scratch=0),
    }


@pytest.mark.parametrize("report", ["", "ptxas info    : 0 bytes gmem\n", REPORT.replace("Used", "Took")])
def test_a_report_that_says_nothing_is_refused(report: str) -> None:
    with pytest.raises(RejectedError, match="ptxas: expected"):
        nvidia.parse(report)


def test_each_kernel_has_its_part_of_the_listing(monkeypatch: pytest.MonkeyPatch) -> None:
    ran = []
    monkeypatch.setattr(nvidia, "said_by", lambda command: ran.append(command[:3]) or LISTING)
    first, second = nvidia.instructions(SimpleNamespace(nvdisasm="nvdisasm"), "sm_90", CODES)  # type: ignore[arg-type]
    assert ran == [["nvdisasm", "--binary", "SM90"]]
    assert first == Instructions(total=7, loads=1, stores=1, integer=2)
    assert second == Instructions(total=2, loads=0, stores=0, integer=1)


def test_a_listing_of_another_length_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nvidia, "said_by", lambda command: LISTING)
    with pytest.raises(RejectedError, match="expected 8 instructions, found 10"):
        nvidia.instructions(SimpleNamespace(nvdisasm="nvdisasm"), "sm_90", CODES[:1])  # type: ignore[arg-type]
