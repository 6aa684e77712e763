"""Names for what lies in the device's planes between the passes, for debugging and for tests against the oracle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl.passes import Inputs, Pass, level_buffer

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)  # Rec. 709, of red, green and blue


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
    step : int
    illumination : bool
        Whether the planes are red, luminance and blue, as kernels keep light, and stand for red, green and blue.
    """

    buffer: str
    first: int
    signals: int
    channels: int
    step: int = 1
    illumination: bool = False

    def of(self, planes: np.ndarray) -> np.ndarray:
        """(n, H, W) planes of the buffer -> ([signals,] H, W[, channels]), a copy."""
        count = max(self.signals, 1) * self.channels
        chosen = planes[self.first :: self.step][:count]
        stack = chosen.reshape(max(self.signals, 1), self.channels, *planes.shape[1:])
        images = np.array(np.moveaxis(stack, 1, -1), order="C")
        if self.illumination:
            images[..., 1] = (images[..., 1] - images[..., ::2] @ LUMINANCE[::2]) / LUMINANCE[1]
        if self.channels == 1:
            images = images[..., 0]
        return images if self.signals else images[0]


def stage_views(passes: tuple[Pass, ...], inputs: Inputs, iterations: int) -> dict[str, StageView]:
    """Every stage of a pass table, by name, in the order of the pipeline."""
    signals = inputs.signals
    views = {
        "normal": StageView("guide", 0, 0, 3),
        "depth": StageView("guide", 3, 0, 1),
        "demodulated": StageView("demodulated", 0, signals, 3, illumination=True),
        "accumulated": StageView("accumulated", 0, signals, 3, illumination=True),
        "history_length": StageView("moments", 0, 0, 1),
        "mean": StageView("moments", 1, signals, 1, step=2),
        "moment_variance": StageView("moments", 2, signals, 1, step=2),
        "variance": StageView("accumulated", 3 * signals, signals, 1),
    }
    for level in range(1, iterations + 1):
        views[f"level_{level}"] = StageView(level_buffer(level), 0, signals, 3, illumination=True)
        views[f"level_{level}_variance"] = StageView(level_buffer(level), 3 * signals, signals, 1)
    if any(p.kernel == "taa" for p in passes):
        views["modulated"] = StageView("modulated", 0, 0, 3)
        views["antialiased"] = StageView("antialiased", 0, 0, 3)
    return views
