"""A plugin of pytest, ``-p tests.without_tracer``: as if neither the tracer nor what it is made of were installed."""

from __future__ import annotations

import sys

ABSENT = ("svgf_cl_tracer", "numba", "embreex", "mapbox_earcut", "trimesh")

for name in ABSENT:
    sys.modules[name] = None  # type: ignore[assignment]  # so Python marks what cannot be imported
