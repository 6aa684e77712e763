"""How each extension of glTF is treated. All extensions that are not listed give a warning or an error."""

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

# If a file uses these without requiring them, it also has the same numbers or images without them.
WITH_FALLBACK = {DRACO, "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_texture_basisu", "MSFT_texture_dds"}

# These do not change the picture.
INVISIBLE = {
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "KHR_xmp",
    "KHR_xmp_json_ld",
}
