"""Scenes for ``svgf-cl compare``: noisy frames at 1 sample per pixel, and their path-traced truth."""

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

FRAMES = 24  # of a scene that does not say how many show it
SETTLED = 8  # frames: histories are nearly as long then as they get


@dataclass(frozen=True)
class Traced:
    """A shot of a scene along its own camera path; all light is one signal.

    Each truth is rendered as two independent halves: what they differ by is its own noise. They are kept in the user's
    cache folder as they grow.

    Parameters
    ----------
    scene : str
        A built-in scene's name, a folder with a scene.json, or a scene's file.
    choice : Choice
    """

    scene: str
    choice: Choice

    @property
    def name(self) -> str:
        """The scene's, without folders."""
        return Path(self.scene).name if Path(self.scene).exists() else self.scene

    @property
    def note(self) -> str:
        """How it was rendered."""
        rays = "rays move within the pixel" if self.jitter else "rays go through pixel centres"
        return f"1 sample per pixel, {rays}; truth of {self.choice.spp} samples per pixel"

    @property
    def shape(self) -> Shape:
        """As chosen."""
        return self.choice.shape

    @property
    def jitter(self) -> bool:
        """As chosen."""
        return self.choice.jitter

    @cached_property
    def numbers(self) -> Sequence[int]:
        """From 0."""
        from svgf_cl_tracer import BUILTIN

        usual = BUILTIN[self.scene].frames if self.scene in BUILTIN else FRAMES
        return range(self.choice.frames or usual)

    @property
    def judged(self) -> Sequence[int]:
        """The last ones."""
        count = self.choice.judged or max(2, len(self.numbers) - SETTLED)
        return self.numbers[-count:]

    @property
    def steps(self) -> int:
        """Two halves of whole chunks a frame."""
        from svgf_cl_tracer.references import chunks

        return len(self.judged) * 2 * chunks(self.choice.spp // 2)

    @property
    def identity(self) -> str:
        """The shot's, and how much of its truth there is."""
        return f"{self.shot.identity} {list(self.judged)} {self.choice.spp} {self.jitter}"

    def frames(self) -> Iterator[Frame]:
        """Render frame by frame."""
        from svgf_cl_tracer import render_sequence

        for frame in render_sequence(self.shot, jitter=self.jitter):
            yield replace(frame, direct=None, indirect=None)

    def truths(self, advance: Callable[[], None]) -> Mapping[int, Pair]:
        """Render both halves of each judged frame, as far as an earlier run has not."""
        return {number: (self._half(number, 0, advance), self._half(number, 1, advance)) for number in self.judged}

    @cached_property
    def shot(self) -> Shot:
        """What is rendered."""
        import svgf_cl_tracer

        return svgf_cl_tracer.Shot(open_scene(self.scene, None), self.shape, len(self.numbers))

    def _half(self, number: int, half: int, advance: Callable[[], None]) -> Linear:
        from svgf_cl_tracer import References

        references = References(self.shot, seed=half, jitter=self.jitter)
        return references.picture(references.render(number, self.choice.spp // 2, advance))


def open_footage(scene: str, choice: Choice) -> Traced:
    """The footage of a scene.

    Raises
    ------
    SvgfError
        Where there is no such scene, or it cannot be used.
    """
    require_tracer(sys.stderr)  # the standard output may be figures for a program
    footage = Traced(scene, choice)
    footage.identity  # noqa: B018  # opens the scene: what is wrong with it is said before anything is rendered
    return footage
