"""`Check`: one check of frames. It measures each frame, and judges the sum over frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from svgf_cl.check.finding import Finding, Unknown
from svgf_cl.check.view import Array, View


@dataclass(frozen=True, eq=False)
class Check:
    """One check for a kind of mistake.

    Parameters
    ----------
    topic : str
        What is looked at, as users read it: ``"motion: direction, axes, unit"``.
    measure : callable
        What a frame says, or the frame before and a frame: sums or counts. None where it says nothing.
    judge : callable
        From the sum over frames to what is wrong, and what cannot be told; neither where all is well.
    silence : str
        Why frames may say nothing.
    frames : int
        How many frames in a row `measure` takes.
    trusts : tuple of str
        Fields that it takes for right: where one is known to be wrong it would only tell of that again.
    fields : tuple of str
        What it looks at one by one, as columns of what it measures; the first row says how much of each there was.
    """

    topic: str
    measure: Callable[..., Array | None]
    judge: Callable[[Array], Sequence[Finding | Unknown]]
    silence: str = ""
    frames: int = 1
    trusts: tuple[str, ...] = ()
    fields: tuple[str, ...] = ()

    def ask(self, views: Sequence[View]) -> Array | None:
        """The measurement of the last of some consecutive frames."""
        return self.measure(*views[-self.frames :]) if len(views) >= self.frames else None

    def verdict(self, total: Array | None, wrong: set[str], count: int) -> Sequence[Finding | Unknown]:
        """Judge the sum over frames, of which at most `count` are consecutive; fields in `wrong` have mistakes."""
        first = [name for name in self.trusts if name in wrong]
        if first:
            return [Unknown(self.topic, f"correct {first[0]} first")]
        if count < self.frames:
            return [Unknown(self.topic, f"it needs {self.frames} consecutive frames")]
        return [Unknown(self.topic, self.silence)] if total is None else self.judge(total)

    def looked_at(self, total: Array) -> tuple[str, ...]:
        """The `fields` that the frames have."""
        return tuple(name for name, seen in zip(self.fields, total[0], strict=True) if seen)
