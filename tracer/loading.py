"""Scenes from glTF, GLB and OBJ files, through trimesh."""

from __future__ import annotations

import io
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import trimesh
from trimesh.resolvers import FilePathResolver

from .camera import Camera, CameraPath, vector
from .errors import SceneError
from .geometry import Instance
from .gltf import read_gltf
from .materials import Colour, Material
from .scene import Scene
from .textures import Image

WHITE = (1.0, 1.0, 1.0)
BLACK = (0.0, 0.0, 0.0)


def load_scene(path: str | PathLike[str], sky: Colour | None = None) -> Scene:
    """Load a .gltf, .glb or .obj file.

    Parameters
    ----------
    path : path
    sky : (r, g, b), optional
        Linear radiance >= 0 that comes from everywhere outside the scene.

    Returns
    -------
    Scene
        One instance for each node of the scene graph (trimesh makes a node of each glTF primitive), ids from 1. Its
        camera path is the file's camera standing still, else one that frames everything.

    Raises
    ------
    SceneError
        The file is missing or unreadable, holds no triangle, or nothing in it emits light and no sky is given.
    """
    path = Path(path)
    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    try:
        instances, camera_path = _contents(*_load(path))
        return Scene(instances, sky=sky, camera_path=camera_path)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
    # Files hold anything, and trimesh raises whatever comes of it: to the user the file is unreadable.
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise SceneError(f"{path}: cannot be read as glTF, GLB or OBJ ({reason})") from error


def _load(path: Path) -> tuple[trimesh.Scene, list[dict[str, Any]]]:
    """The file as trimesh sees it, and the JSON of its materials where it is a glTF."""
    kind = path.suffix.lower().removeprefix(".")
    if kind not in ("gltf", "glb"):
        return trimesh.load_scene(path), []
    data, documents = read_gltf(path)
    return trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=FilePathResolver(str(path))), documents


def _contents(loaded: trimesh.Scene, documents: list[dict[str, Any]]) -> tuple[list[Instance], CameraPath | None]:
    """Everything that can be hit, in its place, and the file's camera if it has one."""
    materials = _Materials(documents)
    instances = [
        _instance(loaded.geometry[geometry], transform, materials)
        for transform, geometry in (loaded.graph[node] for node in loaded.graph.nodes_geometry)
        if isinstance(loaded.geometry[geometry], trimesh.Trimesh)
    ]
    return instances, CameraPath.static(_camera(loaded)) if loaded.has_camera else None


def _instance(mesh: trimesh.Trimesh, transform: np.ndarray, materials: _Materials) -> Instance:
    """A mesh moved to its place in the world."""
    # A mirrored object turns its triangles over, and with them the side that emits light.
    faces = mesh.faces if np.linalg.det(transform[:3, :3]) > 0.0 else mesh.faces[:, ::-1]
    corners = trimesh.transform_points(mesh.vertices, transform)[faces]
    normals = None
    # trimesh makes up smooth normals for every mesh that is asked for them: only those of the file are in its cache.
    if "vertex_normals" in mesh._cache:
        normals = trimesh.unitize(mesh.vertex_normals @ _cofactors(transform[:3, :3]).T)[faces]
    uv = getattr(mesh.visual, "uv", None)
    return Instance(corners, materials.of(mesh), normals, None if uv is None else np.asarray(uv)[faces])


def _cofactors(matrix: np.ndarray) -> np.ndarray:
    """What turns normals, up to length and sign, where `matrix` moves points: a flattening one has no inverse."""
    a, b, c = matrix / (np.abs(matrix).max() or 1.0)  # else the products of a small scale are taken for zero
    return np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


class _Materials:
    """The materials of one file, each made once."""

    def __init__(self, documents: list[dict[str, Any]]) -> None:
        self._documents = documents
        self._made: dict[str, Material] = {}
        self._images: dict[int, Image] = {}

    def of(self, mesh: trimesh.Trimesh) -> Material:
        """The material of a mesh; grey, or the mesh's main vertex colour, where the file names none."""
        visual: Any = mesh.visual
        source = getattr(visual, "material", None)
        if source is None or source.name is None:
            return Material(_colour(visual.main_color / 255.0)) if visual.defined else Material()
        if source.name not in self._made:
            make = self._from_gltf if self._documents else self._from_obj
            self._made[source.name] = make(source)
        return self._made[source.name]

    def _from_gltf(self, source: Any) -> Material:
        document = self._documents[int(source.name)]
        reflection = document.get("pbrMetallicRoughness", {})
        extensions = document.get("extensions") or {}
        strength = (extensions.get("KHR_materials_emissive_strength") or {}).get("emissiveStrength", 1.0)
        emission = np.array(document.get("emissiveFactor", BLACK)) * strength
        for name, where in (("baseColorTexture", reflection), ("emissiveTexture", document)):
            if name in where and getattr(source, name) is None:
                raise SceneError(f"the {name} of material {document.get('name')!r} cannot be read")
        return Material(
            _colour(reflection.get("baseColorFactor", WHITE)),
            _colour(emission),
            self._image(source.baseColorTexture),
            self._image(source.emissiveTexture),
        )

    def _from_obj(self, source: Any) -> Material:
        known = source.kwargs
        base = known.get("kd", WHITE if source.image is not None else Material.base_colour)
        return Material(_colour(base), _colour(known.get("ke", BLACK)), self._image(source.image))

    def _image(self, image: PIL.Image.Image | None) -> Image | None:
        if image is None:
            return None
        if id(image) not in self._images:
            self._images[id(image)] = np.asarray(image.convert("RGB"))
        return self._images[id(image)]


def _colour(values: Any) -> Colour:
    """Three numbers from three or more, or from one that stands for all."""
    r, g, b = np.broadcast_to(np.ravel(values).astype(float)[:3], 3)
    return float(r), float(g), float(b)


def _camera(loaded: trimesh.Scene) -> Camera:
    """The file's camera: it looks along -z of its own frame."""
    _, y, z, position = loaded.camera_transform[:3].T
    return Camera(vector(position), vector(position - z), vector(y), float(loaded.camera.fov[1]))
