from __future__ import annotations

from pathlib import Path

import pytest

from tests.command_line import run


@pytest.fixture(scope="session")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three frames of the built-in scene and their references; not to be changed."""
    folder = tmp_path_factory.mktemp("rendered")
    assert run("render", "cornell", "--frames", "3", "--size", "32x18", "--reference-spp", "16", "-o", folder) == 0
    return folder
