"""Reads Arnold's multichannel EXR: R G B A (RGBA), and a layer for each AOV; the header has the camera's matrices.

N is in world space, and Z is the distance along the camera's axis. motionvector is the path of a point during the
shutter interval. If the interval is a whole frame and objects move evenly, it is our motion with the opposite sign. We
assume that it is in pixels, y up, as we had no frame of Arnold that contains it. If files have positions, and cameras
in their headers, motion of static objects can be computed from these: leave motionvector out then.
"""

from __future__ import annotations

from svgf_cl.io.readers.conversions import against_time, along_time, depth_of_hits, hashes
from svgf_cl.io.readers.reader import LightPasses, Pass, Reader, has_attribute

ARNOLD = Reader(
    name="arnold",
    title="Arnold, multichannel EXR",
    recognises=lambda image: has_attribute(image, "arnold/"),
    passes={
        "color": (Pass(("", "RGBA", "beauty"), 3),),
        "albedo": (Pass(("albedo", "denoise_albedo", "diffuse_albedo"), 3),),
        "normal": (Pass(("N", "denoise_normal", "normal"), 3),),
        "depth": (Pass(("Z", "depth"), 1, depth_of_hits),),
        "position": (Pass(("P",), 3),),
        "motion": (Pass(("motionvector",), 2, against_time),),
        "motion_to_next": (Pass(("motionvector",), 2, along_time),),
        "id": (Pass(("crypto_object00",), 4, hashes),),
    },
    switches={
        "albedo": "add the AOV albedo",
        "normal": "add the AOV N",
        "depth": "add the AOV Z",
        "motion": "add the AOV P, or motionvector (Camera > Instantaneous Shutter for Motion Vectors)",
    },
    lights=(
        LightPasses(("diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect")),
        LightPasses(("coat_direct", "coat_indirect", "sheen_direct", "sheen_indirect")),
        LightPasses(("transmission_direct", "transmission_indirect", "sss_direct", "sss_indirect")),
        LightPasses(("volume_direct", "volume_indirect")),
        LightPasses(("emission", "background"), filtered=False),
    ),
)
