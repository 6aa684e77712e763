"""Pages that are made from the code are those that it makes now."""

from __future__ import annotations

from pathlib import Path

from scripts.scene_description import TARGET, page


def test_the_description_of_scenes_is_up_to_date() -> None:
    assert (Path(__file__).parents[1] / TARGET).read_text() == page(), "run scripts/scene_description.py"
