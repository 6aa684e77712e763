from __future__ import annotations

from tests.denoising import narrow_vectors  # noqa: F401
