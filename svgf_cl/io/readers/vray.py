"""Reads V-Ray's multichannel EXR: R G B A, and a layer for each render element, with the names of Maya or 3ds Max.

``diffuse.red`` in Maya is ``VRayDiffuseFilter.R`` in 3ds Max. Z-depth is the distance along the camera's axis. Velocity
is the movement of a point until the next frame, in pixels, y up. Normals are in screen space, so they change when the
camera turns: then the filter separates surfaces a little less well, and ``svgf-cl check`` reports it.
"""

from __future__ import annotations

from svgf_cl.io.image import Image
from svgf_cl.io.readers.conversions import against_time, along_time, depth_of_hits, hashes, without_edges
from svgf_cl.io.readers.reader import LightPasses, Pass, Reader, has_attribute


def recognises(image: Image) -> bool:
    """Whether the header is V-Ray's, or a channel has a name that only V-Ray uses."""
    named = any(name.startswith("VRay") or name.endswith(".red") for name in image.planes)
    return named or has_attribute(image, "vray")


VRAY = Reader(
    name="vray",
    title="V-Ray, multichannel EXR",
    recognises=recognises,
    passes={
        "color": (Pass(("", "rgba", "RGB_color"), 3),),
        "albedo": (Pass(("diffuse", "VRayDiffuseFilter", "diffuse_filter"), 3),),
        "normal": (Pass(("normals", "VRayNormals", "bump_normals", "VRayBumpNormals"), 3),),
        "depth": (Pass(("z_depth", "zDepth", "VRayZDepth", "Z"), 1, depth_of_hits),),
        "position": (Pass(("world_position", "world_positions", "position"), 3),),
        "motion": (Pass(("velocity", "VRayVelocity"), 2, against_time),),
        "motion_to_next": (Pass(("velocity", "VRayVelocity"), 2, along_time),),
        "id": (
            Pass(("cryptomatte00", "VRayCryptomatte00"), 4, hashes),
            Pass(("render_id", "VRayRenderID", "node_id", "VRayNodeID", "object_id", "VRayObjectID"), 1, without_edges),
        ),
    },
    switches={
        "albedo": "add the render element Diffuse (VRayDiffuseFilter)",
        "normal": "add the render element Normals",
        "depth": "add the render element Z-depth, without clamping",
        "motion": "add the render element Velocity, without clamping, and turn motion blur off",
    },
    lights=(
        LightPasses(
            ("lighting", "gi", "specular", "reflection", "refraction", "sss", "caustics", "atmospheric_effects")
        ),
        LightPasses(("VRayLighting", "VRayGlobalIllumination", "VRaySpecular", "VRayReflection", "VRayRefraction")),
        LightPasses(("VRaySSS", "VRayCaustics", "VRayAtmosphere")),
        LightPasses(("self_illumination", "background", "VRaySelfIllumination", "VRayBackground"), filtered=False),
    ),
)
