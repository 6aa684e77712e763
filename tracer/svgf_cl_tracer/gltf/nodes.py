"""The nodes of a file: what hangs on what, and how each moves."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np

from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.motion import Keyframes, Motion, Track
from svgf_cl_tracer.vectors import Float64

from .file import Gltf, entry, name_of

# Where a node stands that says nothing of it.
REST = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}

# Of real ones a few dozen are below one another; what a node's place is made of grows with their number.
MAX_DEPTH = 256

# A node's index after those of its ancestors, outermost first.
Chain = tuple[int, ...]


class Nodes:
    """The nodes of a file's default scene. The first of its animations plays, once; other clips are left out.

    Parameters
    ----------
    gltf : Gltf
    to_world : (4, 4) float
        From the file's frame into the world's.
    """

    def __init__(self, gltf: Gltf, to_world: Float64) -> None:
        self._gltf, self._to_world = gltf, to_world
        self._animation: dict[str, Any] = next(iter(gltf.document.get("animations", [])), {"channels": []})
        self._links: dict[int, Keyframes | Float64] = {}
        self._channels: dict[int, dict[str, int]] = defaultdict(dict)
        for channel in self._animation["channels"]:
            target = channel["target"]
            if "node" in target and target["path"] in REST:  # a path beside these is for a morph target
                self._channels[target["node"]][target["path"]] = channel["sampler"]

    def chains(self) -> Iterator[Chain]:
        """Every node, parents before children, in the order of the file.

        Raises
        ------
        SceneError
            A node is not there or hangs on two others, or too many are below one another.
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
        """The nodes on which all others hang: those of the default scene, or of the file where it has no scenes."""
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
        """What the node and its ancestors are called, outermost first."""
        return tuple(name_of(self._gltf.item("nodes", index)) for index in chain)

    def motion(self, chain: Chain) -> Motion:
        """The node's way through the world.

        Raises
        ------
        SceneError
            It is animated in a way that is not read.
        """
        for index in chain:
            if index not in self._links:
                self._links[index] = self._link(index)
        return Motion([self._to_world, *(self._links[index] for index in chain)])

    def _link(self, index: int) -> Keyframes | Float64:
        """A node's transform into the frame of its parent; `Keyframes` where it moves."""
        node, channels = self._gltf.item("nodes", index), self._channels[index]
        if "matrix" in node and channels:
            raise SceneError(f"nodes[{index}]: expected no matrix on a node that is animated, found one")
        if "matrix" in node and REST.keys() & node.keys():
            raise SceneError(f"nodes[{index}]: expected a matrix or {', '.join(REST)}, found both; keep one of them")
        if "matrix" in node:
            matrix: Float64 = np.array(node["matrix"], np.float64).reshape(4, 4).T  # it is stored by columns
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
