"""The tracer's error for users."""

from __future__ import annotations

from svgf_cl.errors import SvgfError


class SceneError(SvgfError):
    """A scene file or a camera cannot be used; the message is one line that says what to do."""
