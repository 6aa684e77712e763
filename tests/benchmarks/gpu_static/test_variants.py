"""All kernels are compiled, and every choice that changes their code is made."""

from __future__ import annotations

from benchmarks.gpu_static.variants import EXTREMES, USUAL, cases, choices, variants
from svgf_cl import Kalman
from svgf_cl.device import programs
from svgf_cl.filters import FILTERS
from svgf_cl.filters.signals import Inputs


def test_every_source_is_compiled_for_single_pixels() -> None:
    found = variants()
    assert {build.source for build in found} == set(programs.names())
    assert all("-DVW=1" in build.macros for build in found if build.source not in programs.WITHOUT_HEADERS)


def test_the_first_of_a_source_is_the_default_filter_with_usual_frames() -> None:
    first = {build.source: build.variant for build in reversed(variants())}
    assert first["atrous"].startswith("kalman by default; ")
    assert first["temporal"].startswith("svgf by default; ")
    assert first["atrous"].endswith(str(USUAL))


def test_every_choice_of_every_filter_is_made_alone_and_with_the_others() -> None:
    made = [(case.chosen, case.inputs) for case in cases()]
    for kind in FILTERS.values():
        alone = choices(kind)
        together = kind(**{name: value for each in alone for name, value in each.items()})
        assert all((kind(**each), USUAL) in made for each in alone)
        assert all((chosen, supplied) in made for chosen in (kind(), together) for supplied in EXTREMES)


def test_numbers_are_no_choices() -> None:
    names = {name for each in choices(Kalman) for name in each}
    assert names == {"taa", "half_guides", "half_history", "precision", "taps", "standard_error"}


def test_extremes_are_nothing_and_everything_of_both_splits() -> None:
    assert Inputs() in EXTREMES
    assert Inputs.every() in EXTREMES
    assert {len(each.signals) for each in EXTREMES} == {1, 2}
