"""glTF and GLB files: meshes, nodes, motion, materials, lights and cameras; warnings name what is not shown."""

from .model import load_gltf

__all__ = ["load_gltf"]
