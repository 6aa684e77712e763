"""What tests do without a C compiler or OpenCL's headers: fail in CI, where .ci/run installs them, else be skipped."""

from __future__ import annotations

import os
from typing import NoReturn

import pytest


def missing(what: str) -> NoReturn:
    """End a test for want of a tool."""
    if os.environ.get("CI"):
        pytest.fail(what)
    pytest.skip(what)
