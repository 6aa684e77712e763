"""Reads what a URI in the file refers to: data in the URI itself, or a file beside the model."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.folder import found_inside


def resource(folder: Path, uri: str) -> bytes:
    """The bytes that `uri` refers to, for a model in `folder`.

    Raises
    ------
    SceneError
        If it leads out of the folder, or to nothing, or its data is damaged.
    """
    scheme, _, rest = uri.partition(":")
    if scheme.lower() == "data":
        return _embedded(rest)
    # The name is also tried undecoded: many exporters write spaces, umlauts or % without encoding.
    path = found_inside(folder, unquote(uri), folder) or found_inside(folder, uri, folder)
    if path is None:
        raise SceneError(f"expected a file in the model's folder or below, found none called {shown(unquote(uri))}")
    return path.read_bytes()


def _embedded(data: str) -> bytes:
    """Decode the part after ``data:`` (RFC 2397), of any media type; padding may be missing."""
    head, comma, body = data.partition(",")
    raw = unquote_to_bytes(body)
    if not comma:
        raise SceneError(f"expected data behind a comma, found {shown('data:' + data)}")
    if not head.lower().strip().endswith(";base64"):
        return raw
    digits = b"".join(raw.split()).rstrip(b"=")
    try:
        return base64.b64decode(digits + b"=" * (-len(digits) % 4), validate=True)
    except binascii.Error as error:
        raise SceneError(f"expected data in base64, found something else ({error}); export the model anew") from error
