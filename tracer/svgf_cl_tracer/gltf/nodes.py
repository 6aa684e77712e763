"""The nodes of a file: their hierarchy and their motion."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.motion import Keyframes, Motion, Track
from svgf_cl_tracer.vectors import Float64

from .file import Gltf, entry, name_of

# The transform of a node that defines none.
REST = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}

# Real files have a few dozen levels of nodes; the cost of a node's transform grows with its level.
MAX_DEPTH = 256

# The indices of a node's ancestors, outermost first, and its own index.
Chain = tuple[int, ...]


class Nodes:
    """The nodes of a file's default scene. The first of its animations plays once; other animations are not used.

    Parameters
    ----------
    gltf : Gltf
    to_world : (4, 4) float
        From the file's frame into the world.
    """

    def __init__(self, gltf: Gltf, to_world: Float64) -> None:
        self._gltf, self._to_world = gltf, to_world
        self._animation: dict[str, Any] = next(iter(gltf.document.get("animations", [])), {"channels": []})
        self._links: dict[int, Keyframes | Float64] = {}
        self._channels: dict[int, dict[str, int]] = defaultdict(dict)
        for channel in self._animation["channels"]:
            target = channel["target"]
            if "node" in target and target["path"] in REST:  # other paths are for morph targets
                self._channels[target["node"]][target["path"]] = channel["sampler"]

    def chains(self) -> Iterator[Chain]:
        """All nodes, parents before children, in the order of the file.

        Raises
        ------
        SceneError
            If a node is missing or has two parents, or if the hierarchy is too deep.
        """
        waiting: list[Chain] = [(root,) for root in reversed(self._roots())]
        seen = set()
        while waiting:
            chain = waiting.pop()
            if chain[-1] in seen:
                raise SceneError(f"nodes: expected a tree, found node {chain[-1]} in two places")
            if len(chain) > MAX_DEPTH:
                raise SceneError(f"nodes: expected at most {MAX_DEPTH} of them below one another, found more")
            seen.add(chain[-1])
            yield chain
            waiting += [(*chain, child) for child in reversed(self.node(chain).get("children", []))]

    def _roots(self) -> list[int]:
        """The root nodes: those of the default scene, or of the file if it has no scenes."""
        document = self._gltf.document
        if "scene" in document or document.get("scenes"):
            roots: list[int] = self._gltf.item("scenes", document.get("scene", 0)).get("nodes", [])
            return roots
        nodes = document.get("nodes", [])
        below = {child for node in nodes for child in node.get("children", [])}
        return [index for index in range(len(nodes)) if index not in below]

    def node(self, chain: Chain) -> dict[str, Any]:
        """The node's JSON."""
        return self._gltf.item("nodes", chain[-1])

    def names(self, chain: Chain) -> tuple[str, ...]:
        """The names of the node's ancestors, outermost first, and its own name."""
        return tuple(name_of(self._gltf.item("nodes", index)) for index in chain)

    def motion(self, chain: Chain) -> Motion:
        """The node's motion in the world.

        Raises
        ------
        SceneError
            If it is animated in a way that is not supported.
        """
        for index in chain:
            if index not in self._links:
                self._links[index] = self._link(index)
        return Motion([self._to_world, *(self._links[index] for index in chain)])

    def _link(self, index: int) -> Keyframes | Float64:
        """The transform of a node into its parent's frame; `Keyframes` if it moves."""
        node, channels = self._gltf.item("nodes", index), self._channels[index]
        if "matrix" in node and channels:
            raise SceneError(f"nodes[{index}]: expected no matrix on a node that is animated, found one")
        if "matrix" in node and REST.keys() & node.keys():
            raise SceneError(f"nodes[{index}]: expected a matrix or {', '.join(REST)}, found both; keep one of them")
        if "matrix" in node:
            matrix: Float64 = np.array(node["matrix"], np.float64).reshape(4, 4).T  # it is stored column by column
            return matrix
        tracks = {path: Track([0.0], [node.get(path, rest)]) for path, rest in REST.items()}
        tracks |= {path: self._track(sampler) for path, sampler in channels.items()}
        link = Keyframes(**tracks)
        return link if channels else link.matrix(0.0)

    def _track(self, index: int) -> Track:
        sampler = entry(self._animation["samplers"], "animations[0].samplers", index)
        interpolation = sampler.get("interpolation", "LINEAR")
        if interpolation not in ("LINEAR", "STEP"):
            raise SceneError(
                f"animations[0].samplers[{index}]: expected LINEAR or STEP interpolation, found {interpolation}; "
                "export it with sampled animations"
            )
        times, values = self._gltf.numbers(sampler["input"]), self._gltf.numbers(sampler["output"])
        return Track(times[:, 0], values, step=interpolation == "STEP")
