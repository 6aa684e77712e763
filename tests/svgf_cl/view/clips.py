"""Clips to test with, and a server that is stopped."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread

from svgf_cl import Frame, Kalman
from svgf_cl.errors import FileError
from svgf_cl.prefilter import Effort
from svgf_cl.view.clip import Clip, Item
from svgf_cl.view.player import Player
from svgf_cl.view.scenes import room
from svgf_cl.view.server import Server, Start

SHAPE = (18, 32)


class Listed:
    """A clip of frames that are there; those at some indices are damaged."""

    name, note, shape = "listed", "made for a test", SHAPE
    prefilter: Effort = "off"
    has_references = False

    def __init__(self, frames: list[Frame], cuts: tuple[int, ...] = (), damaged: tuple[int, ...] = ()) -> None:
        self.frames, self.cuts, self.damaged = frames, cuts, set(damaged)
        self.numbers = range(100, 100 + len(frames))
        self.read_so_far: list[int] = []

    def read(self, index: int) -> Item:
        self.read_so_far.append(index)
        if index in self.damaged:
            raise FileError(f"frame.{self.numbers[index]}.exr: expected an EXR file, found none")
        return Item(self.frames[index])

    def beginning(self) -> tuple[Item, Item]:
        return Item(self.frames[0]), Item(self.frames[1])


@contextmanager
def serving(clip: Clip | None = None, port: int = 0) -> Iterator[Server]:
    """A server of a clip, by default the room, that answers while this lasts."""
    player = Player(clip or room(SHAPE, 4), Kalman())
    with Server(port) as server:
        thread = Thread(target=server.play, args=(player, Start(Kalman(), 0.0, "a device"), 0.02))
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()
