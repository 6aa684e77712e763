from __future__ import annotations

import svgf_cl_tracer.api  # noqa: F401  # now: what it has compiled lies in the user's own cache folder, as in tests/tracer
from tests.denoising import narrow_vectors  # noqa: F401
