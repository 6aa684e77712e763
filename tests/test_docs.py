"""Pages that are made from the code are those that it makes now."""

from __future__ import annotations

from pathlib import Path

import pytest

from scripts import pass_table, scene_description

ROOT = Path(__file__).parents[1]


def test_the_description_of_scenes_is_up_to_date() -> None:
    written = (ROOT / scene_description.TARGET).read_text()
    assert written == scene_description.page(), "run scripts/scene_description.py"


def test_the_tables_of_passes_are_up_to_date() -> None:
    written = (ROOT / pass_table.TARGET).read_text()
    assert written == pass_table.page(written), "run scripts/pass_table.py"


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="expected"):
        pass_table.page("no marks")
