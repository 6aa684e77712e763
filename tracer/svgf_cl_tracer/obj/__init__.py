"""OBJ files and their MTL materials.

trimesh is not used for them. It triangulates all faces as if they were convex, and takes relative indices for counts
from the end of the file. It loses images that have options or names in another case, and says nothing about what it
leaves out.
"""

from .model import load_obj

__all__ = ["load_obj"]
