"""``scene.json``: adds to a model what its own file does not contain, as pydantic models; docs/scene_description.md."""

from .document import FILE_NAME, SceneDescription, read_description
from .scene import described_scene

__all__ = ["FILE_NAME", "SceneDescription", "described_scene", "read_description"]
