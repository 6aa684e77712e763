"""Converts materials of an OBJ file to the tracer's."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.losses import Losses
from svgf_cl_tracer.materials import Colour, Material
from svgf_cl_tracer.textures import Image

from .library import Definition, Statement
from .maps import Maps
from .text import clean, is_number, uncommented

WHITE = (1.0, 1.0, 1.0)

# Opacity below which a surface is invisible or has a hole.
CUTOFF = 0.5

# The refractive index of a surface with a roughness, as in glTF.
IOR = 1.5

GLOSS = ("pr", "pm", "map_pr", "map_pm")
READ = {"kd", "ke", "d", "tr", "map_kd", "map_ke", "map_d", *GLOSS}
# Statements that do not affect the picture on their own: ambient light, and the sharpness of gloss that is not read.
INVISIBLE = {"ka", "map_ka", "ni", "ns", "map_ns", "sharpness", "map_aat"}
# Illumination models for glass; for other models the colours are enough.
GLASS = {"4", "6", "7", "9"}


class Materials:
    """The materials of one file; each is made once.

    Parameters
    ----------
    root : Path
        The folder of the OBJ file.
    definitions : mapping of Definition
        By name.
    losses : Losses
        Collects what is shown differently from the files.
    """

    def __init__(self, root: Path, definitions: Mapping[str, Definition], losses: Losses) -> None:
        self._definitions, self._losses = definitions, losses
        self._maps = Maps(root, losses)
        self._made: dict[str, Material | None] = {}

    def of(self, name: str, *, coloured: bool) -> tuple[str, Material | None]:
        """The material `name`, for a surface that may have its own colours; None for an invisible material.

        The complete name is tried first, because a comment may follow it in the file.

        Raises
        ------
        SceneError
            If its definition or an image is invalid.
        """
        if name not in self._definitions:
            name = clean(uncommented(name))
        if name not in self._definitions:
            if name:
                self._losses.add("materials that no library defines, shown in a plain colour", shown(name))
            return name, Material(WHITE) if coloured else Material()
        definition = self._definitions[name]
        if name not in self._made:
            try:
                self._made[name] = self._make(name, definition)
            except SceneError as error:
                raise SceneError(f"{definition.library.name}: material {shown(name)}: {error}") from error
        return name, self._made[name]

    def placed(self, name: str, uv: NDArray[np.floating] | None) -> NDArray[np.floating] | None:
        """Texture coordinates (..., 2), NaN where there are none, as placed by the material `name`."""
        material = self._made.get(name)
        if material is None:
            return None if uv is None else np.nan_to_num(uv)
        textured = material.base_texture is not None or material.emission_texture is not None
        if textured and (uv is None or np.isnan(uv).any()):
            kind = "materials with an image on faces without texture coordinates (vt), which show one texel of it"
            self._losses.add(kind, shown(name))
        return None if uv is None else self._maps.placed(self._definitions[name], np.nan_to_num(uv))

    def _make(self, name: str, definition: Definition) -> Material | None:
        for statement in filter(_is_lost, definition.statements.values()):
            self._losses.add("parts of materials that are not read", statement.keyword)
        opacity = _opacity(definition.statements)
        if opacity < CUTOFF:
            self._losses.add("materials with an opacity (d, Tr) below one half, not shown", shown(name))
            return None
        texture, masked = self._maps.base(definition)
        glow = self._maps.pixels(definition, "map_ke")
        glossy = any(keyword in definition.statements for keyword in GLOSS)
        return Material(
            self._colour(definition, "kd", Material.base_colour if texture is None else WHITE),
            self._colour(definition, "ke", Material.emission if glow is None else WHITE),
            texture,
            glow,
            metallic=self._share(definition, "pm", 0.0),
            roughness=self._share(definition, "pr", 1.0),
            ior=IOR if glossy else Material.ior,
            alpha_cutoff=CUTOFF / opacity if masked else None,
        )

    def _colour(self, definition: Definition, keyword: str, default: Colour) -> Colour:
        statement = definition.statements.get(keyword)
        if statement is None:
            return default
        if statement.text.split()[:1] in (["spectral"], ["xyz"]):
            self._losses.add("parts of materials that are not read", f"{statement.keyword} {statement.text.split()[0]}")
            return default
        red, green, blue, *_ = 3 * statement.numbers(1, 3)
        return red, green, blue

    def _share(self, definition: Definition, keyword: str, default: float) -> float:
        """The product of a number in 0..1 and the mean of its image; `default` if there is neither."""
        statement, image = definition.statements.get(keyword), self._maps.pixels(definition, f"map_{keyword}")
        share = statement.numbers(1)[0] if statement else default if image is None else 1.0
        return share * _mean(image)


def _opacity(statements: Mapping[str, Statement]) -> float:
    """The opacity from `d` or from its opposite `Tr`; 1 if there is neither."""
    if "d" in statements:
        words = uncommented(statements["d"].text).split()
        return statements["d"]._replace(text=" ".join(word for word in words if word != "-halo")).numbers(1)[0]
    return 1.0 - statements["tr"].numbers(1)[0] if "tr" in statements else 1.0


def _mean(image: Image | None) -> float:
    return 1.0 if image is None else float(image[..., :3].mean()) / 255.0


def _is_lost(statement: Statement) -> bool:
    """Whether a statement that is not read would have changed the picture."""
    keyword, words = statement.keyword.lower(), uncommented(statement.text).split()
    if keyword == "illum":
        return bool(GLASS.intersection(words))
    if keyword in READ | INVISIBLE:
        return "-halo" in words
    neutral = 1.0 if keyword == "tf" else 0.0  # light that is let through, or light that is reflected
    return not all(is_number(word) and float(word) == neutral for word in words)
