"""Frames of renderers: one file a renderer, which says how its passes become the fields of a frame."""

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

# In the order in which they are asked whether a file is theirs.
READERS: dict[str, Reader] = {reader.name: reader for reader in (OWN, BLENDER, MITSUBA, PBRT, ARNOLD, VRAY)}


def reader_of(image: Image) -> Reader:
    """The reader for an image, told from its channels and header; that of our own channels where none knows it."""
    return next((reader for reader in READERS.values() if reader.recognises(image)), OWN)


def reader_called(name: str) -> Reader:
    """The reader of that name.

    Raises
    ------
    SvgfError
        There is none.
    """
    if name not in READERS:
        raise SvgfError(f"--format: expected {' or '.join(READERS)}, got {shown(name)}")
    return READERS[name]
