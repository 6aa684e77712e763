"""What a header says of its pixels is understood, or refused with what is wrong with it."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from svgf_cl.io.exr_header import Attributes
from svgf_cl.io.exr_layout import Channel, layout_of
from svgf_cl.io.image import COMPRESSIONS, Windows
from svgf_cl.io.window import Window
from tests.exr_files import box

PART: Attributes = {
    "channels": (
        "chlist",
        b"A\0" + struct.pack("<iB3xii", 1, 0, 1, 1) + b"id\0" + struct.pack("<iB3xii", 0, 0, 2, 1) + b"\0",
    ),
    "compression": ("compression", b"\4"),
    "dataWindow": box(Window(-3, 5, 40, 30)),
    "displayWindow": box(Window(0, 0, 64, 48)),
    "pixelAspectRatio": ("float", struct.pack("<f", 1.5)),
}


def test_a_layout_is_what_the_header_says() -> None:
    texts = {name: ("string", name.encode()) for name in ("name", "view", "type")}
    layout = layout_of({**PART, **texts})
    assert layout.windows == Windows(Window(-3, 5, 40, 30), Window(0, 0, 64, 48), 1.5)
    assert layout.channels == {"A": Channel(np.dtype("f2"), True), "id": Channel(np.dtype("u4"), False)}
    assert (layout.compression, layout.name, layout.view, layout.is_deep) == ("piz", "name", "view", False)
    assert layout.size == 40 * 30 * 6
    bare = layout_of(PART)
    assert (bare.name, bare.view) == ("", "")
    assert layout_of({**PART, "type": ("string", b"deeptile")}).is_deep


@pytest.mark.parametrize("name", PART)
def test_what_every_part_needs_is_asked_for(name: str) -> None:
    kind, value = PART[name]
    for damaged in (("string", value), (kind, value[:-1]), (kind, b""), (kind, value + b"\1")):
        with pytest.raises(ValueError, match="expected a complete header with"):
            layout_of({**PART, name: damaged})
    with pytest.raises(ValueError, match="expected a complete header with"):
        layout_of({each: PART[each] for each in PART if each != name})


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("compression", bytes([len(COMPRESSIONS)]), "expected a compression of none, rle, .*, got number 12"),
        ("dataWindow", box(Window(0, 0, 0, 5))[1], "expected at least one pixel, got a data window of 0x5 at 0,0"),
        ("channels", b"Z\0" + struct.pack("<iB3xii", 3, 0, 1, 1) + b"\0", "got number 3 in channel Z"),
        ("channels", b"Z\0" + struct.pack("<iB3xii", -1, 0, 1, 1) + b"\0", "got number -1 in channel Z"),
        ("channels", b"\xff\0" + bytes(17), "can't decode byte 0xff"),
    ],
)
def test_what_makes_no_sense_is_refused(name: str, value: bytes, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        layout_of({**PART, name: (PART[name][0], value)})
