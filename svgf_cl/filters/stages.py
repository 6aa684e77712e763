"""Names for what lies in the device's planes between the passes, for debugging and for tests against the oracle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl.filters.pipeline import Inputs, Pass, level_buffer
from svgf_cl.oracle.taps import REC709
from svgf_cl.settings import Settings


@dataclass(frozen=True)
class StageView:
    """Which planes of a buffer make up a stage.

    Parameters
    ----------
    buffer : str
        Name in the pass table.
    first, step : int
        The planes are first, first + step, ...
    signals : int
        Length of the result's leading axis; 0 for a quantity that all signals share.
    channels : int
        3 for a colour or a vector, 1 for a number a pixel.
    dtype : type
        Of the planes, and the unit that `first` counts in; whole numbers stand for -1..1.
    illumination : bool
        Whether the planes are red, luminance and blue, as kernels keep light, and stand for red, green and blue.
    root : bool
        Whether the planes hold the square root of what they stand for, as kernels keep a variance in 16 bits.
    """

    buffer: str
    first: int
    signals: int
    channels: int
    step: int = 1
    dtype: type[np.floating | np.integer] = np.float32
    illumination: bool = False
    root: bool = False

    def of(self, planes: np.ndarray) -> np.ndarray:
        """(n, H, W) planes of the buffer -> ([signals,] H, W[, channels]) float32, a copy."""
        count = max(self.signals, 1) * self.channels
        chosen = planes[self.first :: self.step][:count]
        stack = chosen.reshape(max(self.signals, 1), self.channels, *planes.shape[1:])
        images = np.array(np.moveaxis(stack, 1, -1), np.float32, order="C")
        if np.issubdtype(self.dtype, np.integer):
            images /= 32767  # UNIT of storage.clh
        if self.root:
            images *= images
        if self.illumination:
            images[..., 1] = (images[..., 1] - images[..., ::2] @ REC709[::2]) / REC709[1]
        if self.channels == 1:
            images = images[..., 0]
        return images if self.signals else images[0]


def stage_views(passes: tuple[Pass, ...], inputs: Inputs, settings: Settings) -> dict[str, StageView]:
    """Every stage of a pass table, by name, in the order of the pipeline."""
    signals = inputs.signals
    half = settings.half_history
    stored: type[np.floating] = np.float16 if half else np.float32

    def light(buffer: str) -> StageView:
        return StageView(buffer, 0, signals, 3, dtype=stored, illumination=True)

    def variance(buffer: str, first: int, step: int = 1) -> StageView:
        return StageView(buffer, first, signals, 1, step, stored, root=half)

    shared = 1 + inputs.id  # 32-bit planes in front of the guide's normals
    unit = StageView("guide", 2 * shared, 0, 3, dtype=np.int16) if settings.half_guides else None
    views = {
        "normal": unit or StageView("guide", shared, 0, 3),
        "depth": StageView("guide", 0, 0, 1),
        "demodulated": light("demodulated"),
        "accumulated": light("accumulated"),
        "history_length": StageView("moments", 0, 0, 1, dtype=stored),
        "mean": StageView("moments", 1, signals, 1, 2, stored),
        "moment_variance": variance("moments", 2, step=2),
        "variance": variance("accumulated", 3 * signals),
    }
    for level in range(1, settings.iterations + 1):
        views[f"level_{level}"] = light(level_buffer(level))
        views[f"level_{level}_variance"] = variance(level_buffer(level), 3 * signals)
    if any(p.kernel == "taa" for p in passes):
        views["modulated"] = StageView("modulated", 0, 0, 3)
        views["antialiased"] = StageView("antialiased", 0, 0, 3)
    return views
