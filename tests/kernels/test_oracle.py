"""Every kernel follows the float64 oracle on the same input, with every filter, set of fields and unusual settings."""

from __future__ import annotations

import pytest

from tests.oracle import ALL_CASES, assert_follows_oracle


@pytest.mark.parametrize("case", ALL_CASES)
def test_every_kernel_follows_the_oracle(case: str) -> None:
    assert_follows_oracle(ALL_CASES[case])
