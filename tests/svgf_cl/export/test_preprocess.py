"""Sources without macros are what a C preprocessor makes of them, and keep what is the OpenCL compiler's."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence

import pytest

from svgf_cl import Inputs, Kalman, Lbf, Settings, SvgfError
from svgf_cl.device import programs
from svgf_cl.device.tuning import CPU_TUNING, GPU_TUNING, Tuning
from svgf_cl.export.preprocess import check_preprocessor, preprocessed
from svgf_cl.filters.filter import Filter
from tests.compilers import missing

# Each condition of a kernel that goes by the tuning is in those of Kalman, or in the headers of all.
KALMAN = Kalman(taa=True, half_history=True)
CASES = (
    (KALMAN, CPU_TUNING),
    (KALMAN, GPU_TUNING),
    (Settings(taps="5x5"), Tuning(vector_width=4, work_group=(8, 1), exponential="exp2")),
    (Lbf(), GPU_TUNING),
)


def tokens(source: str, options: Sequence[str] = ()) -> list[str]:
    """What the C compiler of this machine makes of a source."""
    command = ["cc", "-E", "-P", "-x", "c", "-w", *options, "-"]
    return subprocess.run(command, input=source, text=True, capture_output=True, check=True).stdout.split()


@pytest.mark.parametrize(("filter_", "tuning"), CASES, ids=str)
def test_kernels_are_those_of_a_c_preprocessor(filter_: Filter, tuning: Tuning) -> None:
    if shutil.which("cc") is None:
        missing("no C compiler: apt-get install gcc")
    pipeline = filter_.pipeline(Inputs.every())
    for source in {entry.source for entry in pipeline.passes}:
        macros = programs.macros(source, tuning.defines | pipeline.defines)
        text = preprocessed(programs.source(source), macros)
        assert not any(f" {macro} " in f" {text} " for macro in macros)
        assert tokens(text) == tokens(programs.source(source), [f"-D{name}={value}" for name, value in macros.items()])


def test_what_is_the_compilers_own_stays() -> None:
    source = """
#line 7 "elsewhere.cl"
#pragma OPENCL EXTENSION cl_khr_fp16 : enable
#if defined(cl_khr_fp16) && __OPENCL_VERSION__ >= 120
half h = CLK_LOCAL_MEM_FENCE + SCALE; // of this device
#endif
#define LOOP _Pragma("unroll 1") for (;;)
LOOP {}
"""
    assert preprocessed(source, {"SCALE": "2.0f"}).splitlines() == [
        "#pragma OPENCL EXTENSION cl_khr_fp16 : enable",
        "#if defined(cl_khr_fp16) && __OPENCL_VERSION__ >= 120",
        "half h = CLK_LOCAL_MEM_FENCE + 2.0f;",
        "#endif",
        "",
        '_Pragma("unroll 1") for (;;) {}',
    ]


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("#if SCALE == 2\n#endif\n", "expected a value for the macro SCALE, got none"),
        ("int a;\n#error not here\n", "#error not here"),
        ("#if 1\n", "line 1: Unterminated #if"),
        ('#include "other.h"\n', "line 1: Include file 'other.h' not found"),
    ],
)
def test_what_is_wrong_is_told(source: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        preprocessed(source, {})


def test_a_macro_that_may_be_missing_is_asked_for() -> None:
    assert preprocessed("#ifdef ABSENT\nno\n#else\nyes\n#endif\n", {}) == "yes\n"


def test_without_pcpp_it_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pcpp", None)
    with pytest.raises(SvgfError, match=r"export needs pcpp .*pip install 'svgf-cl\[export\]'"):
        check_preprocessor()
