"""OBJ files made for tests."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.model import Model
from svgf_cl_tracer.obj import load_obj

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
FACE = "f 1/1 2/2 3/3 4/4\n"


def read(folder: Path, text: str | bytes, library: str | bytes | None = None) -> tuple[Model, list[str]]:
    """What is read of an OBJ file, ``a.mtl`` beside it, and the warnings without the file's name."""
    path = folder / "a.obj"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    if library is not None:
        (folder / "a.mtl").write_bytes(library.encode() if isinstance(library, str) else library)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = load_obj(path, np.eye(4))
    assert all(warning.category is UserWarning for warning in caught)
    lines = [str(warning.message) for warning in caught]
    assert all(line.startswith(f"{path}: ") and "\n" not in line for line in lines)
    return model, [line.removeprefix(f"{path}: ") for line in lines]


def instance_of(folder: Path, text: str | bytes) -> Instance:
    """The only object of a file of which nothing is lost."""
    model, lost = read(folder, text)
    (item,) = model.objects
    assert lost == []
    return item.instance


def square_of(folder: Path, library: str | bytes) -> tuple[Instance, list[str]]:
    """A square with the material ``m``, and what is lost of the file."""
    model, lost = read(folder, f"mtllib a.mtl\n{SQUARE}usemtl m\n{FACE}", library)
    (item,) = model.objects
    assert item.material == "m"
    return item.instance, lost


def material_of(folder: Path, statements: str) -> tuple[Material, list[str]]:
    """A material of these statements, and what is lost of the file."""
    instance, lost = square_of(folder, f"newmtl m\n{statements}\n")
    return instance.material, lost
