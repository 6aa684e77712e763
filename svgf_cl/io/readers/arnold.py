"""Arnold's multichannel EXR: R G B A (RGBA), and a layer for each AOV; the header has the camera's matrices.

N is in world space, Z the distance along the camera's axis. motionvector is the way that a point moves during the
shutter interval: with an interval of a whole frame it is minus our motion, as far as things move evenly. Its unit and
axes were taken to be pixels, y up; no frame of Arnold with it was at hand. So where there are positions and the
header's cameras, motion of what stands still can be had from them: leave motionvector out.
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
