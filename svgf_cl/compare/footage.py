"""What filters are compared on: frames of a shot, and what some of them converge to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import entry_points
from typing import Protocol

from svgf_cl.compare.halves import Pair
from svgf_cl.errors import SvgfError, install_extra
from svgf_cl.frame import Frame, Shape

GROUP = "svgf_cl.footage"  # entry points of packages that render scenes; each is an `Opener`
NEEDED, HINT = "comparing on scenes needs the tracer", install_extra("tracer")


class Footage(Protocol):
    """A shot, and the truth about some of its frames.

    Attributes
    ----------
    name, note : str
        Of the scene, and a remark on how the frames were made; the note may be empty.
    shape : (int, int)
        (height, width) in pixels.
    jitter : bool
        Whether rays go through another point of the pixel in every frame, and the truth is the mean over the pixel.
    numbers : sequence of int
        Of all frames, in order.
    judged : sequence of int
        Of those whose truth is known.
    steps : int
        How often `truths` will call `advance`.
    identity : str
        Names all that frames and truths depend on.
    """

    @property
    def name(self) -> str: ...  # noqa: D102  # described above, as are all
    @property
    def note(self) -> str: ...  # noqa: D102
    @property
    def shape(self) -> Shape: ...  # noqa: D102
    @property
    def jitter(self) -> bool: ...  # noqa: D102
    @property
    def numbers(self) -> Sequence[int]: ...  # noqa: D102
    @property
    def judged(self) -> Sequence[int]: ...  # noqa: D102
    @property
    def steps(self) -> int: ...  # noqa: D102
    @property
    def identity(self) -> str: ...  # noqa: D102

    def frames(self) -> Iterator[Frame]:
        """The noisy frames."""

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        """Two independent estimates of each judged frame's truth, by number; twice the same where there is but one."""


@dataclass(frozen=True)
class Choice:
    """How scenes are to be rendered for a comparison.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    frames : int, optional
        By default as many as show the scene.
    judged : int, optional
        How many of the last frames are to have a truth; by default all but the first, whose history is short.
    spp : int, >= 2
        Samples per pixel of a truth.
    jitter : bool
        Whether rays are to go through another point of the pixel in every frame.
    """

    shape: Shape
    frames: int | None
    judged: int | None
    spp: int
    jitter: bool


Opener = Callable[[str, Choice], Footage]


def opener() -> Opener:
    """The function of an installed package that renders scenes.

    Raises
    ------
    SvgfError
        Where no such package is installed, or it cannot be imported.
    """
    for entry in entry_points(group=GROUP):
        try:
            found: Opener = entry.load()
        except ImportError as error:
            raise SvgfError(f"{NEEDED} ({error}): {HINT}") from error
        return found
    raise SvgfError(f"{NEEDED}: {HINT}")
