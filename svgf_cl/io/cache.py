"""Where svgf_cl keeps what it has learnt about this machine."""

from __future__ import annotations

from pathlib import Path

import platformdirs
import pyopencl as cl


def cache_folder() -> Path:
    """Return the platform's per-user cache folder of svgf_cl; it need not exist."""
    return platformdirs.user_cache_path("svgf_cl", appauthor=False)


def device_key(device: cl.Device) -> str:
    """Return what identifies a device together with its driver; equal devices share it."""
    return " | ".join((device.platform.name, device.platform.version, device.name, device.driver_version))
