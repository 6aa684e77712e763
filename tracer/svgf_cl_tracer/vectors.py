"""Types of the arrays that vectors and colours are stored in, and the weights of luminance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Float32 = NDArray[np.float32]
Float64 = NDArray[np.float64]

# Rec. 709 weights of linear red, green and blue.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
