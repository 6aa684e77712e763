"""Reads Blender's OpenEXR MultiLayer files of Cycles: ``ViewLayer.Combined.R`` and so on.

The conventions were found numerically on frames of Blender 4.2 and 5.0. Vector is in pixels, y up: X and Y are the
previous position minus the current one, Z and W the current position minus the next. Depth is the camera's z of the
first sample, and 1e10 where nothing was hit. Normal is in world space, a mean over samples in which a miss counts as 0.
Denoising Albedo is the albedo of the reflected surface in a sharp mirror, and the emitted light on a lamp.
"""

from __future__ import annotations

import numpy as np

from svgf_cl.io.image import Image
from svgf_cl.io.readers.conversions import Array, depth_of_hits, hashes, reflected, without_edges, y_down
from svgf_cl.io.readers.passes import place
from svgf_cl.io.readers.reader import LightPasses, Pass, Reader, has_attribute

STAMP = {"Camera", "Frame", "RenderTime", "Scene"}  # attributes that Blender writes to every file


def recognises(image: Image) -> bool:
    """Whether the header is Blender's, or a view layer has a pass with Blender's name of the picture."""
    said = has_attribute(image, "BlenderMultiChannel") or image.parts[0].attributes.keys() >= STAMP
    return said or any(place(name).name == "combined" for name in image.planes)


def to_next(vector: Array) -> Array:
    """Return the motion to the next frame, (H, W, 2), y down."""
    moved: Array = vector[..., 2:4] * np.array([-1, 1], np.float32)
    return moved


BLENDER = Reader(
    name="blender",
    title="Blender (Cycles), OpenEXR MultiLayer",
    recognises=recognises,
    passes={
        "color": (Pass(("Combined", "Image", ""), 3),),  # "" is a compositor's file of one pass
        "albedo": (Pass(("Denoising Albedo",), 3, reflected),),
        "normal": (Pass(("Normal",), 3),),
        "depth": (Pass(("Depth",), 1, depth_of_hits),),
        "motion": (Pass(("Vector",), 2, y_down),),
        "motion_to_next": (Pass(("Vector",), 4, to_next),),
        "id": (Pass(("CryptoObject00",), 4, hashes), Pass(("IndexOB", "Object Index"), 1, without_edges)),
    },
    switches={
        "color": "write OpenEXR MultiLayer: Output Properties > Output > File Format",
        "albedo": "enable View Layer Properties > Passes > Data > Denoising Data",
        "normal": "enable View Layer Properties > Passes > Data > Normal",
        "depth": "enable View Layer Properties > Passes > Data > Z",
        "motion": "enable View Layer Properties > Passes > Data > Vector, and turn off Render > Motion Blur, with which"
        " Blender does not write it",
    },
    lights=(
        # First the names of Blender 5, then those of earlier versions.
        LightPasses(("Diffuse Direct", "Diffuse Indirect"), "Diffuse Color"),
        LightPasses(("Glossy Direct", "Glossy Indirect"), "Glossy Color", reflects=True),
        LightPasses(("Transmission Direct", "Transmission Indirect"), "Transmission Color", reflects=True),
        LightPasses(("Volume Direct", "Volume Indirect")),
        LightPasses(("Emission",), filtered=False),
        LightPasses(("Environment",), filtered=False, is_background=True),
        LightPasses(("DiffDir", "DiffInd"), "DiffCol"),
        LightPasses(("GlossDir", "GlossInd"), "GlossCol", reflects=True),
        LightPasses(("TransDir", "TransInd"), "TransCol", reflects=True),
        LightPasses(("VolumeDir", "VolumeInd")),
        LightPasses(("Emit",), filtered=False),
        LightPasses(("Env",), filtered=False, is_background=True),
    ),
)
