"""svgf_cl: a denoiser for path-traced animation that runs on any OpenCL device."""

from svgf_cl.check import check_frame, check_sequence
from svgf_cl.denoiser import Denoiser
from svgf_cl.device.tuning import Tuning
from svgf_cl.errors import DeviceError, FileError, FrameError, SettingsError, SvgfError
from svgf_cl.frame import Frame
from svgf_cl.settings import Settings

__all__ = [
    "Denoiser",
    "DeviceError",
    "FileError",
    "Frame",
    "FrameError",
    "Settings",
    "SettingsError",
    "SvgfError",
    "Tuning",
    "check_frame",
    "check_sequence",
]
__version__ = "0.1.0"
