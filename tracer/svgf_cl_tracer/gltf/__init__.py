"""glTF and GLB files: trimesh decodes meshes and textures; nodes, motion, materials, lights, cameras are read here."""

from .model import load_gltf

__all__ = ["load_gltf"]
