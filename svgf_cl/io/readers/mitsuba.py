"""Reads files of Mitsuba 3's `aov` integrator: R G B, and a layer for each name that the user chose.

``dd:depth`` gives ``dd.T``, ``nn:sh_normal`` gives ``nn.X Y Z``, ``pp:position`` gives ``pp.X Y Z``, and
``idx:shape_index`` gives ``idx.I``. Depth is the distance along the ray. There are no motion vectors: motion is
computed from positions and cameras. The shape index is not read, because Mitsuba numbers the shapes again when it loads
the scene of the next frame.
"""

from __future__ import annotations

from svgf_cl.io.readers.reader import Pass, Reader, text_attribute

MITSUBA = Reader(
    name="mitsuba",
    title="Mitsuba 3, integrator aov",
    recognises=lambda image: text_attribute(image, "generatedBy").startswith("Mitsuba"),
    passes={
        "color": (Pass(("", "img", "image"), 3),),
        "albedo": (Pass(("albedo", "alb"), 3),),
        "normal": (Pass(("nn", "sh_normal", "shn", "ns", "normal", "normals", "n", "gn", "geo_normal"), 3),),
        "distance": (Pass(("dd", "depth", "dist", "distance", "t", "z"), 1),),
        "position": (Pass(("pp", "position", "pos", "p"), 3),),
    },
    switches={
        "albedo": "add albedo:albedo to the aovs of the integrator",
        "normal": "add nn:sh_normal to the aovs of the integrator",
        "depth": "add pp:position to the aovs of the integrator",
        "motion": "add pp:position to the aovs of the integrator",
    },
)
