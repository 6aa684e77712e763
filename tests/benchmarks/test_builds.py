"""What is compiled of a filter, each once, and by what name."""

from __future__ import annotations

from benchmarks.builds import Case, builds
from scripts import lint_kernels
from svgf_cl import Kalman
from svgf_cl.device import programs
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.filters.signals import Inputs

PLAIN = Case(Kalman(), Inputs(albedo=True), GPU_TUNING)


def test_a_case_says_what_is_not_default() -> None:
    assert str(PLAIN) == "kalman by default; color, normal, depth, motion, albedo (motion of 2 components)"
    fast = Case(Kalman(precision="fast", half_guides=True), Inputs(), GPU_TUNING)
    assert str(fast).startswith("kalman half_guides=True precision=fast; ")


def test_each_is_built_once_under_its_first_name() -> None:
    other = Case(Kalman(alpha_color=0.5), Inputs(albedo=True), GPU_TUNING)  # a number: the same kernels
    assert builds([PLAIN, other]) == builds([PLAIN])
    found = builds([PLAIN])
    assert len({(build.source, build.options) for build in found}) == len(found)
    assert {build.variant for build in found if build.source not in programs.WITHOUT_HEADERS} == {str(PLAIN)}


def test_macros_are_part_of_the_options() -> None:
    (atrous,) = (build for build in builds([PLAIN]) if build.source == "atrous")
    assert set(programs.OPTIONS) == set(atrous.options) - set(atrous.macros)
    assert "-DVW=1" in atrous.macros
    assert "-DHAS_ALBEDO=1" in atrous.macros


def test_lint_checks_every_source() -> None:
    assert {build.source for build in lint_kernels.variants()} == set(programs.names())
