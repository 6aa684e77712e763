"""svgf_cl: a denoiser for path-traced animation that runs on any OpenCL device."""

from svgf_cl.camera import Camera, motion_from_cameras
from svgf_cl.check import check_frame, check_sequence
from svgf_cl.denoiser import Denoiser
from svgf_cl.device.tuning import Tuning
from svgf_cl.errors import ArgumentError, DeviceError, FileError, FrameError, SchedulerError, SettingsError, SvgfError
from svgf_cl.filters import Accumulation, Eaw, Kalman, Lbf, Sbf, Settings
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import Frame
from svgf_cl.io.shot import open_sequence
from svgf_cl.look_ahead import look_ahead
from svgf_cl.next_motion import motion_to_next
from svgf_cl.tiled import TiledDenoiser, denoiser_for

__all__ = [
    "Accumulation",
    "ArgumentError",
    "Camera",
    "Denoiser",
    "DeviceError",
    "Eaw",
    "FileError",
    "Frame",
    "FrameError",
    "Inputs",
    "Kalman",
    "Lbf",
    "Sbf",
    "SchedulerError",
    "Settings",
    "SettingsError",
    "SvgfError",
    "TiledDenoiser",
    "Tuning",
    "check_frame",
    "check_sequence",
    "denoiser_for",
    "look_ahead",
    "motion_from_cameras",
    "motion_to_next",
    "open_sequence",
]
__version__ = "0.2.0"
