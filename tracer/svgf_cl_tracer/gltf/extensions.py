"""The extensions of glTF, by what becomes of a file that uses them. All others are named in a warning, or refused."""

from __future__ import annotations

LIGHTS = "KHR_lights_punctual"
INSTANCING = "EXT_mesh_gpu_instancing"
TEXTURE_TRANSFORM = "KHR_texture_transform"
WEBP = "EXT_texture_webp"
DRACO = "KHR_draco_mesh_compression"

READ = {
    LIGHTS,
    INSTANCING,
    TEXTURE_TRANSFORM,
    WEBP,
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_mesh_quantization",
}

# A file that does not require these holds the same numbers or images a second time, without them.
WITH_FALLBACK = {DRACO, "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_texture_basisu", "MSFT_texture_dds"}

# They change nothing in the picture.
INVISIBLE = {
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "KHR_xmp",
    "KHR_xmp_json_ld",
}
