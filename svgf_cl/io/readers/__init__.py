"""Reads the frames of renderers: one module for each, which says how its passes become the fields of a frame."""

from __future__ import annotations

from svgf_cl.errors import SvgfError, shown
from svgf_cl.io.image import Image
from svgf_cl.io.readers.arnold import ARNOLD
from svgf_cl.io.readers.blender import BLENDER
from svgf_cl.io.readers.mitsuba import MITSUBA
from svgf_cl.io.readers.own import OWN
from svgf_cl.io.readers.pbrt import PBRT
from svgf_cl.io.readers.reader import Reader
from svgf_cl.io.readers.vray import VRAY

# In the order in which they are tried on a file.
READERS: dict[str, Reader] = {reader.name: reader for reader in (OWN, BLENDER, MITSUBA, PBRT, ARNOLD, VRAY)}


def reader_of(image: Image) -> Reader:
    """Return the reader for an image by its channels and header; the reader of our own channels if none matches."""
    return next((reader for reader in READERS.values() if reader.recognises(image)), OWN)


def reader_called(name: str) -> Reader:
    """Return the reader of this name.

    Raises
    ------
    SvgfError
        If there is none.
    """
    if name not in READERS:
        raise SvgfError(f"--format: expected {' or '.join(READERS)}, got {shown(name)}")
    return READERS[name]
