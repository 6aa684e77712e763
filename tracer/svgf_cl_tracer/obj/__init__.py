"""OBJ files with their MTL materials, read here: small formats, and trimesh goes wrong where files are real.

It triangulates faces that are not convex as if they were, takes relative indices for counts from the end of the file,
loses images behind options or in other case, and says nothing of what it leaves out.
"""

from .model import load_obj

__all__ = ["load_obj"]
