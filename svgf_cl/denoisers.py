"""`Denoisers`: one denoiser for each light or guide of a frame; they share the memory of the device."""

from __future__ import annotations

import warnings
from collections.abc import Hashable

import numpy as np
import numpy.typing as npt

from svgf_cl.denoiser import Denoiser
from svgf_cl.device.devices import default_queue
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import Frame, Shape
from svgf_cl.tiled import TiledDenoiser, check_max_bytes, denoiser_for

Picture = npt.NDArray[np.float32]


class Denoisers:
    """Denoisers of frames of one size, made when they are needed.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    settings : Filter
        The same for all.
    share : float
        The share of the device's memory for each. If a whole frame does not fit into it, it is denoised in tiles.
    """

    def __init__(self, shape: Shape, settings: Filter, share: float = 1.0) -> None:
        self._shape, self._settings, self._share = shape, settings, share
        self._made: dict[Hashable, Denoiser | TiledDenoiser] = {}

    def __contains__(self, key: Hashable) -> bool:
        return key in self._made

    def denoise(self, key: Hashable, frame: Frame) -> Picture:
        """Denoise the next frame of the sequence called `key`; errors as in `Denoiser.denoise`."""
        if key not in self._made:
            self._made[key] = self._new(frame)
        picture: Picture = self._made[key].denoise(frame)
        return picture

    def update(self, settings: Filter) -> None:
        """Continue with other settings, as `Denoiser.update` does; sequences in tiles lose their history."""
        self._settings = settings
        for key, made in list(self._made.items()):
            if isinstance(made, TiledDenoiser):
                del self._made[key]
                made.close()
            else:
                made.update(settings)

    def has_stage(self, key: Hashable, name: str) -> bool:
        """Whether the last frame called `key` has an intermediate result of that name."""
        return key in self._made and name in self._made[key].stages

    def stage(self, key: Hashable, name: str) -> Picture:
        """Return an intermediate result of the last frame called `key`; errors as in `Denoiser.stage`."""
        return self._made[key].stage(name)

    def reset(self) -> None:
        """Discard all history, as at a cut."""
        for made in self._made.values():
            made.reset()

    def profile(self) -> dict[str, float]:
        """Return the milliseconds on the device of each pass of the last frame, summed over all denoisers."""
        total: dict[str, float] = {}
        for made in self._made.values():
            for name, time in made.profile().items():
                total[name] = total.get(name, 0.0) + time
        return total

    def _new(self, frame: Frame) -> Denoiser | TiledDenoiser:
        queue = default_queue()
        limit = int(self._share * check_max_bytes(None, queue.device))
        made = denoiser_for(self._shape, Inputs.of(frame), settings=self._settings, queue=queue, max_bytes=limit)
        if isinstance(made, TiledDenoiser) and not any(isinstance(each, TiledDenoiser) for each in self._made.values()):
            warnings.warn(made.reason, stacklevel=4)
        return made
