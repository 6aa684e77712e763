"""The public names of `svgf_cl_tracer`; importing this module imports Numba, Embree and all other packages it needs."""

from .builtin import BUILTIN, builtin_scene
from .camera import Camera, CameraPath
from .errors import SceneError
from .fingerprint import tracer_version
from .loading import load_scene
from .panorama import load_environment
from .references import Goal, References
from .render import frame_identity, render_frame, render_sequence
from .scene import Scene
from .shot import Shot
from .sky import Environment

__all__ = [
    "BUILTIN",
    "Camera",
    "CameraPath",
    "Environment",
    "Goal",
    "References",
    "Scene",
    "SceneError",
    "Shot",
    "builtin_scene",
    "frame_identity",
    "load_environment",
    "load_scene",
    "render_frame",
    "render_sequence",
    "tracer_version",
]
