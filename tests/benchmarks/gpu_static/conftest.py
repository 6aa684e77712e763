from __future__ import annotations

import pytest

from benchmarks.gpu_static import tools
from svgf_cl import SvgfError


@pytest.fixture(scope="session")
def compilers() -> tools.Tools:
    """All tools; what needs them is skipped where some are missing, which CI installs."""
    try:
        return tools.find()
    except SvgfError as error:
        pytest.skip(" ".join(str(error).split()))
