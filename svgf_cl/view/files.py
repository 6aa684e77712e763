"""The clip of a shot's files; the next files are read while a frame is played."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from threading import Lock

from svgf_cl.errors import FileError
from svgf_cl.frame import extent
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.sequence import number_of
from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.io.window import placed
from svgf_cl.prefilter import Effort
from svgf_cl.view.clip import Item, Picture, without_carried

MEMORY = 2**30  # bytes, for frames that stay in memory
AHEAD = 2  # frames that are read ahead while one is filtered


class FilesClip:
    """Frames of any renderer as a clip.

    Parameters
    ----------
    shot : Shot
    references : mapping of int to Path
        The pictures without noise, by the numbers of the frames.
    """

    prefilter: Effort = "auto"

    def __init__(self, shot: Shot, references: Mapping[int, Path]) -> None:
        self._shot, self._references = shot, references
        self.shape = shot.shape
        self.numbers = [number_of(path) for path in shot.paths]
        self.cuts: Collection[int] = shot.cuts
        self.has_references = bool(references)
        self._pool = ThreadPoolExecutor(AHEAD)
        self._lock = Lock()
        self._read: OrderedDict[int, Future[Item]] = OrderedDict()  # the most recently read frame is at the end

    @property
    def name(self) -> str:
        """The names of the folder and of its parent folder."""
        return "/".join(self._shot.paths[0].resolve().parent.parts[-2:])

    @property
    def note(self) -> str:
        """The renderer of the frames."""
        return f"frames of {self._shot.reading.reader.title}"

    def read(self, index: int) -> Item:
        """One frame; reading of the next ones is started.

        Raises
        ------
        FileError
            As in `Shot.read`; if a reference is damaged or has another size.
        """
        with self._lock:
            wanted = [(index + step) % len(self.numbers) for step in range(1 + AHEAD)]
            for each in reversed(wanted):
                self._begin(each)
            found = self._read[index]
        try:
            item = found.result()
        except BaseException:
            with self._lock:
                self._read.pop(index, None)  # a later call reads the file again, because it may have changed
            raise
        self._forget(item.nbytes)
        return item

    def beginning(self) -> tuple[Item, Item]:
        """The first two frames, as in `Clip`."""
        first, second = self._shot.beginning()
        return Item(first.frame, first.lights), Item(second.frame, second.lights)

    def _begin(self, index: int) -> None:
        if index not in self._read:
            self._read[index] = self._pool.submit(self._item, index)
        self._read.move_to_end(index)

    def _forget(self, nbytes: int) -> None:
        """Keep the frames of the last `read`, and as many others as fit into `MEMORY`, if each needs `nbytes`."""
        with self._lock:
            while len(self._read) > max(1 + AHEAD, MEMORY // nbytes):
                self._read.popitem(last=False)

    def _item(self, index: int) -> Item:
        source = self._shot.read(index)
        return Item(without_carried(source.frame), source.lights, self._reference(self.numbers[index], source))

    def _reference(self, number: int, source: ShotFrame) -> Picture | None:
        """The reference of a frame, placed in the window of the shot."""
        path = self._references.get(number)
        if path is None:
            return None
        picture, display = read_picture(path), source.image.windows.display
        if picture.shape[:2] != (display.height, display.width):
            expected, got = extent((display.height, display.width)), extent(picture.shape[:2])
            raise FileError(f"{path}: expected {expected} pixels as {source.path} has, got {got}")
        return placed(picture, display, self._shot.window, 0.0)
