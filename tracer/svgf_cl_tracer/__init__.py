"""A small path tracer on Embree that feeds the denoiser: noisy frames with their G-buffers, and references.

All names of `svgf_cl_tracer.api` are available here. They are imported at their first use, so that the command line
starts without them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from svgf_cl_tracer.api import *  # noqa: F403
else:

    def __getattr__(name: str) -> object:
        """Return what `svgf_cl_tracer.api` has under this name."""
        if not name.startswith("_"):
            from importlib import import_module

            api = import_module("svgf_cl_tracer.api")
            if name in api.__all__:
                return getattr(api, name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
