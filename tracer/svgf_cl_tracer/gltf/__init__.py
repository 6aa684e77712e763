"""glTF and GLB files: meshes, nodes, motion, materials, lights and cameras; what is lost of a file is named."""

from .model import load_gltf

__all__ = ["load_gltf"]
