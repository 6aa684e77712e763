"""`Check`: one check of frames, which measures each frame and judges the sum over frames."""

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
        The title of the check for users: ``"motion: direction, axes, unit"``.
    measure : callable
        Measures a frame, or the previous frame and a frame, and returns sums or counts; None if the frames do not allow
        the check.
    judge : callable
        Returns the mistakes and the open questions for the sum over frames; nothing if the check passed.
    silence : str
        Why frames may not allow the check.
    frames : int
        Number of consecutive frames that `measure` takes.
    trusts : tuple of str
        Fields that must be right for this check. It is not done if one of them is wrong.
    fields : tuple of str
        If the check looks at several fields, their names: the columns of its measurement. The first row of the
        measurement says how much of each field there was.
    """

    topic: str
    measure: Callable[..., Array | None]
    judge: Callable[[Array], Sequence[Finding | Unknown]]
    silence: str = ""
    frames: int = 1
    trusts: tuple[str, ...] = ()
    fields: tuple[str, ...] = ()

    def ask(self, views: Sequence[View]) -> Array | None:
        """Measure the last of some consecutive frames."""
        return self.measure(*views[-self.frames :]) if len(views) >= self.frames else None

    def verdict(self, total: Array | None, wrong: set[str], count: int) -> Sequence[Finding | Unknown]:
        """Judge the sum over frames, of which at most `count` are consecutive; the fields in `wrong` have mistakes."""
        first = [name for name in self.trusts if name in wrong]
        if first:
            return [Unknown(self.topic, f"correct {first[0]} first")]
        if count < self.frames:
            return [Unknown(self.topic, f"it needs {self.frames} consecutive frames")]
        return [Unknown(self.topic, self.silence)] if total is None else self.judge(total)

    def looked_at(self, total: Array) -> tuple[str, ...]:
        """Return the `fields` that the frames have."""
        return tuple(name for name, seen in zip(self.fields, total[0], strict=True) if seen)
