"""`Footage`: the frames of a shot on which filters are compared, and the references of some of them."""

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
    """A shot, and the truth (the converged picture) of some of its frames.

    Attributes
    ----------
    name, note : str
        The scene's name, and a remark on how the frames were made; the note may be empty.
    shape : (int, int)
        (height, width) in pixels.
    jitter : bool
        Whether rays go through another point of the pixel in every frame, and the truth is the mean over the pixel.
    numbers : sequence of int
        The numbers of all frames, in order.
    judged : sequence of int
        The numbers of the frames whose truth is known.
    steps : int
        How often `truths` will call `advance`.
    identity : str
        A text that changes with everything that frames and truths depend on.
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
        """Yield the noisy frames."""

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        """Return two independent estimates of each judged frame's truth, by number; the same twice if there is one."""


@dataclass(frozen=True)
class Choice:
    """How to render scenes for a comparison.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    frames : int, optional
        Number of frames; by default the scene decides.
    judged : int, optional
        How many of the last frames get a truth; by default all except the first ones, whose history is short.
    spp : int, >= 2
        Samples per pixel of a truth.
    jitter : bool
        Whether rays go through another point of the pixel in every frame.
    """

    shape: Shape
    frames: int | None
    judged: int | None
    spp: int
    jitter: bool


Opener = Callable[[str, Choice], Footage]


def opener() -> Opener:
    """Return the function of an installed package that renders scenes.

    Raises
    ------
    SvgfError
        If no such package is installed, or it cannot be imported.
    """
    for entry in entry_points(group=GROUP):
        try:
            found: Opener = entry.load()
        except ImportError as error:
            raise SvgfError(f"{NEEDED} ({error}): {HINT}") from error
        return found
    raise SvgfError(f"{NEEDED}: {HINT}")
