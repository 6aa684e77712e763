"""Variants can be told apart, and the first is what users get."""

from __future__ import annotations

from benchmarks.variants import VARIANTS
from svgf_cl.filters import DEFAULT


def test_no_two_variants_have_one_name_or_do_the_same() -> None:
    assert len({variant.name for variant in VARIANTS}) == len(VARIANTS)
    assert len({(variant.settings, variant.signals) for variant in VARIANTS}) == len(VARIANTS)


def test_the_first_variant_is_the_default() -> None:
    assert (VARIANTS[0].settings, VARIANTS[0].signals) == (DEFAULT(), 1)
