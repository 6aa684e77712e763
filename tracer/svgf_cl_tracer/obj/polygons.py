"""Divides polygons in space into triangles."""

from __future__ import annotations

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

from svgf_cl_tracer.vectors import Float64

from .text import Indices


def triangulate(points: Float64, counts: Indices) -> tuple[Indices, Indices]:
    """Triangles of polygons that may be concave and slightly bent.

    Parameters
    ----------
    points : (P, 3) float
        The corners of all polygons, one polygon after the other.
    counts : (N,) int
        The number of corners of each polygon, >= 3.

    Returns
    -------
    (T, 3) int
        Indices of the corners of each triangle, in the orientation of its polygon. A polygon that touches or crosses
        itself may give fewer triangles than its number of corners minus two.
    (T,) int
        The polygon of each triangle, ascending.
    """
    starts = np.cumsum(counts) - counts
    triangles, polygons = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)]
    for count in np.unique(counts):
        chosen = np.flatnonzero(counts == count)
        corners = starts[chosen, None] + np.arange(count)
        fits = _fan_fits(points[corners])
        fans = _fan(corners[fits])
        triangles.append(fans)
        polygons.append(chosen[fits].repeat(count - 2))
        for polygon, polygon_corners in zip(chosen[~fits], corners[~fits], strict=True):
            cut = polygon_corners[_cut(points[polygon_corners])]
            triangles.append(cut)
            polygons.append(np.full(len(cut), polygon))
    owners = np.concatenate(polygons)
    order = np.argsort(owners, kind="stable")
    return np.concatenate(triangles)[order], owners[order]


def _fan(corners: Indices) -> Indices:
    """Triangles from the first corner of each row to every edge: (rows * (corners - 2), 3)."""
    first = np.broadcast_to(corners[:, :1], (len(corners), corners.shape[1] - 2))
    return np.stack([first, corners[:, 1:-1], corners[:, 2:]], axis=-1).reshape(-1, 3)


def _fan_fits(points: Float64) -> NDArray[np.bool_]:
    """Whether all triangles of a fan over polygons (N, C, 3) face the polygon's side, so that they cover it once."""
    edges = points[:, 1:] - points[:, :1]
    areas = np.cross(edges[:, :-1], edges[:, 1:])
    return np.asarray((np.einsum("nti,ni->nt", areas, areas.sum(1)) >= 0.0).all(1))


def _cut(points: Float64) -> Indices:
    """Triangles (T, 3) of one polygon (C, 3) by ear clipping in its plane."""
    edges = points[1:] - points[0]
    normal = np.cross(edges[:-1], edges[1:]).sum(0)
    # Project to the two axes on which the polygon is largest; flip it if needed, so that it is counter-clockwise.
    axis = int(np.abs(normal).argmax())
    flat = np.roll(points - points[0], -axis, axis=1)[:, 1:]
    if normal[axis] < 0.0:
        flat[:, 0] *= -1.0
    cut = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], np.uint32)).reshape(-1, 3).astype(np.int64)
    (ux, uy), (vx, vy) = (flat[cut[:, 1]] - flat[cut[:, 0]]).T, (flat[cut[:, 2]] - flat[cut[:, 0]]).T
    turned = ux * vy < uy * vx
    cut[turned] = cut[turned, ::-1]
    return cut
