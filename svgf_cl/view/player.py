"""`Player`: filters the frame that is shown, forward, backward or from anywhere."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

from svgf_cl.chunks import WARM_UP
from svgf_cl.errors import FileError, SvgfError
from svgf_cl.filters.filter import Filter
from svgf_cl.shot_denoiser import Method, ShotDenoiser
from svgf_cl.view.clip import Clip, Item, Picture

MEMORY = 2**28  # bytes, for pictures to which one can step back
SETTLED = WARM_UP // 2  # frames; pictures with a shorter history are not shown


@dataclass(frozen=True, eq=False)
class Filtered:
    """A filtered frame.

    Parameters
    ----------
    picture : (H, W, 3) float32
        Linear HDR radiance.
    times : mapping of str to float
        Milliseconds on the device, for each pass.
    """

    picture: Picture
    times: Mapping[str, float]


class Player:
    """Filters the frames of a clip as they are requested.

    A frame that follows the last one is filtered with the history so far. The first frame begins without history. A
    picture that was made since then with the current settings is shown again, as long as it is in memory. Any other
    frame needs a warm-up: the filter begins without history up to `WARM_UP` frames before it. Pictures of a warm-up are
    kept, too, except those with a short history.

    Parameters
    ----------
    clip : Clip
    settings : Filter
        The settings at the beginning.
    """

    def __init__(self, clip: Clip, settings: Filter) -> None:
        self.clip = clip
        self._settings = settings
        first, second = clip.beginning()
        method = Method(settings, prefilter=clip.prefilter)
        self._denoiser = ShotDenoiser(clip.shape, method, len(second.lights))
        self._denoiser.settle(second.frame, second.lights, first.frame)
        self._last: int | None = None  # the last frame in the denoiser's history
        self._kept: OrderedDict[int, Filtered] = OrderedDict()

    def show(self, index: int, settings: Filter) -> tuple[Item, Filtered]:
        """A frame, and the result of the filter.

        Parameters
        ----------
        index : int
            From 0.
        settings : Filter
            If they differ from the current settings, the filter continues with them, as after `Denoiser.update`.

        Raises
        ------
        SvgfError
            If the frame cannot be read or filtered. The next good frame begins without history.
        """
        if not 0 <= index < len(self.clip.numbers):
            raise SvgfError(f"index: expected 0 to {len(self.clip.numbers) - 1}, got {index}")
        if settings != self._settings:
            self._kept.clear()
            self._denoiser.update(settings)
            self._settings = settings
        item = self.clip.read(index)  # read it first: if this fails, a warm-up would be useless
        if index and index in self._kept:
            return item, self._kept[index]
        run_up = self._run_up(index)
        for each in run_up:
            self._skip(each, is_kept=each >= run_up.start + SETTLED or self._begins(run_up.start))
        return item, self._filter(index, item)

    def _run_up(self, index: int) -> range:
        """The frames to be filtered before this one; discards the history if it does not end before them."""
        if index and self._last == index - 1:
            return range(0)
        self._forget()
        begin = max((cut for cut in self.clip.cuts if cut <= index), default=0)
        return range(max(begin, index - WARM_UP), index)

    def _begins(self, index: int) -> bool:
        """Whether a frame has no earlier frames in the clip or shot."""
        return index == 0 or index in self.clip.cuts

    def _skip(self, index: int, *, is_kept: bool) -> None:
        """Filter a frame of a warm-up; after a frame that cannot be read, the filter begins without history."""
        try:
            item = self.clip.read(index)
        except FileError:
            self._forget()
            return
        self._filter(index, item)
        if not is_kept:
            self._kept.pop(index, None)

    def _filter(self, index: int, item: Item) -> Filtered:
        if index in self.clip.cuts:
            self._denoiser.reset()
        self._last = None  # until the frame is filtered
        picture = self._denoiser.denoise(item.frame, item.lights).picture
        made = Filtered(picture[..., :3], self._denoiser.profile())
        self._last = index
        self._keep(index, made)
        return made

    def _keep(self, index: int, made: Filtered) -> None:
        self._kept[index] = made
        while len(self._kept) > max(1, MEMORY // made.picture.nbytes):
            self._kept.popitem(last=False)

    def _forget(self) -> None:
        self._denoiser.reset()
        self._kept.clear()
        self._last = None
