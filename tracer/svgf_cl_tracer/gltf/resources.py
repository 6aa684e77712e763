"""What a URI in the file stands for: data in the URI itself, or a file beside the model."""

from __future__ import annotations

import base64
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError


def resource(folder: Path, uri: str) -> bytes:
    """The bytes that `uri` stands for in a model that lies in `folder`.

    Raises
    ------
    SceneError
        It leads out of the folder, or to nothing.
    """
    scheme, _, rest = uri.partition(":")
    if scheme.lower() == "data":
        return _embedded(rest)
    # The name as it stands comes second: many exporters write spaces, umlauts or % as they are.
    for name in dict.fromkeys((unquote(uri), uri)):
        try:
            path = (folder / name).resolve()
            found = path.is_file()
        except (OSError, RuntimeError, ValueError) as error:  # a name too long or with a zero in it, a loop of links
            raise SceneError(f"expected the name of a file, found {shown(uri)} ({error})") from error
        if not path.is_relative_to(folder.resolve()):
            raise SceneError(f"expected a file in the model's folder or below, found {shown(uri)}")
        if found:
            return path.read_bytes()
    raise SceneError(f"expected a file beside the model, found none called {shown(unquote(uri))}")


def _embedded(data: str) -> bytes:
    """What follows ``data:`` (RFC 2397), with any media type; padding may be missing."""
    head, _, body = data.partition(",")
    raw = unquote_to_bytes(body)
    return base64.b64decode(raw + b"==") if head.lower().strip().endswith(";base64") else raw
