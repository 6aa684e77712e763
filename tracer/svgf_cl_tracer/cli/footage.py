"""Scenes for ``svgf-cl compare``: noisy frames at 1 sample per pixel, and path-traced references."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from svgf_cl.compare.footage import Choice
from svgf_cl.compare.halves import Pair
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.display import Linear
from svgf_cl_tracer.cli.scenes import open_scene, require_tracer

if TYPE_CHECKING:
    from svgf_cl_tracer import Shot

FRAMES = 24  # for a scene that does not define its length
SETTLED = 8  # frames after which histories have nearly their full length


@dataclass(frozen=True)
class Traced:
    """A shot of a scene along its own camera path; all light is one signal.

    Each reference is rendered as two independent halves, whose difference is its own noise. The halves are stored in
    the user's cache folder while they are rendered.

    Parameters
    ----------
    scene : str
        The name of a built-in scene, a folder with a scene.json, or a scene's file.
    choice : Choice
    """

    scene: str
    choice: Choice

    @property
    def name(self) -> str:
        """The name of the scene, without folders."""
        return Path(self.scene).name if Path(self.scene).exists() else self.scene

    @property
    def note(self) -> str:
        """How it was rendered, as text."""
        rays = "rays move within the pixel" if self.jitter else "rays go through pixel centres"
        return f"1 sample per pixel, {rays}; truth of {self.choice.spp} samples per pixel"

    @property
    def shape(self) -> Shape:
        """As in `choice`."""
        return self.choice.shape

    @property
    def jitter(self) -> bool:
        """As in `choice`."""
        return self.choice.jitter

    @cached_property
    def numbers(self) -> Sequence[int]:
        """The numbers of the frames, from 0."""
        from svgf_cl_tracer import BUILTIN

        usual = BUILTIN[self.scene].frames if self.scene in BUILTIN else FRAMES
        return range(self.choice.frames or usual)

    @property
    def judged(self) -> Sequence[int]:
        """The numbers of the last frames, which are measured."""
        count = self.choice.judged or max(2, len(self.numbers) - SETTLED)
        return self.numbers[-count:]

    @property
    def steps(self) -> int:
        """The number of chunks to render: two halves of whole chunks for each frame."""
        from svgf_cl_tracer.references import chunks

        return len(self.judged) * 2 * chunks(self.choice.spp // 2)

    @property
    def identity(self) -> str:
        """The identity of the shot, with the number of samples of its references."""
        return f"{self.shot.identity} {list(self.judged)} {self.choice.spp} {self.jitter}"

    def frames(self) -> Iterator[Frame]:
        """Render the frames one by one."""
        from svgf_cl_tracer import render_sequence

        for frame in render_sequence(self.shot, jitter=self.jitter):
            yield replace(frame, direct=None, indirect=None)

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        """Render both halves of each measured frame, unless an earlier run has stored them."""
        return {number: (self._half(number, 0, advance), self._half(number, 1, advance)) for number in self.judged}

    @cached_property
    def shot(self) -> Shot:
        """The shot that is rendered."""
        import svgf_cl_tracer

        return svgf_cl_tracer.Shot(open_scene(self.scene, None), self.shape, len(self.numbers))

    def _half(self, number: int, half: int, advance: Callable[[], None]) -> Linear:
        from svgf_cl_tracer import References

        references = References(self.shot, seed=half, jitter=self.jitter)
        return references.picture(references.render(number, self.choice.spp // 2, advance))


def open_footage(scene: str, choice: Choice) -> Traced:
    """Open a scene for `svgf-cl compare`.

    Raises
    ------
    SvgfError
        If there is no such scene, or it cannot be used.
    """
    require_tracer(sys.stderr)  # the standard output may be read by a program
    footage = Traced(scene, choice)
    footage.identity  # noqa: B018  # opens the scene: what is wrong with it is said before anything is rendered
    return footage
