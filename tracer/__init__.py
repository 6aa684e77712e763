"""A small path tracer on Embree that feeds the denoiser: noisy frames with their G-buffers, and references."""

from .builtin import BUILTIN, builtin_scene
from .camera import Camera, CameraPath
from .errors import SceneError
from .loading import load_scene
from .render import render_frame, render_reference, render_sequence
from .scene import Scene
from .shot import Shot

__all__ = [
    "BUILTIN",
    "Camera",
    "CameraPath",
    "Scene",
    "SceneError",
    "Shot",
    "builtin_scene",
    "load_scene",
    "render_frame",
    "render_reference",
    "render_sequence",
]
