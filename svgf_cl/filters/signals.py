"""The parts of a frame's radiance that are filtered apart, and which other fields a frame has."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.errors import SvgfError, shown
from svgf_cl.frame import Frame


@dataclass(frozen=True)
class Signal:
    """Radiance that is filtered on its own.

    Parameters
    ----------
    name : str
        Kernels know its number by the macro SIGNAL_<NAME>.
    field : str
        Field of `Frame` that it comes from.
    divided_by : str or None
        Field that it is divided by before the filter, and multiplied by after it.
    holds_emission : bool
        Whether directly visible emission is part of the field, so that it is taken out first.
    carries : tuple of str
        What temporal accumulation keeps of it beside its light: quantities of the moments, in their order.
    """

    name: str
    field: str
    divided_by: str | None
    holds_emission: bool = False
    carries: tuple[str, ...] = ("mean", "variance")


COLOR = Signal("color", field="color", divided_by="albedo", holds_emission=True)
DIRECT = Signal("direct", field="direct", divided_by="albedo")
INDIRECT = Signal("indirect", field="indirect", divided_by="albedo")

# How radiance may be split, the finest first: a frame is filtered by the first split whose fields it has.
SPLITS: tuple[tuple[Signal, ...], ...] = ((DIRECT, INDIRECT), (COLOR,))


@dataclass(frozen=True, kw_only=True)
class Inputs:
    """What frames supply; kernels are built for exactly these fields, so what is absent costs nothing.

    Parameters
    ----------
    signals : tuple of Signal
        One of `SPLITS`.
    motion : int
        Components of motion, 2 or 3.
    albedo, emission, id : bool
        Whether frames have the field.
    """

    signals: tuple[Signal, ...] = (COLOR,)
    motion: int = 2
    albedo: bool = False
    emission: bool = False
    id: bool = False

    def __post_init__(self) -> None:
        if self.signals not in SPLITS:
            names = " or ".join(str(tuple(signal.name for signal in split)) for split in SPLITS)
            raise SvgfError(f"Inputs.signals: expected the signals {names}, got {shown(self.signals)}")
        if self.motion not in (2, 3):
            raise SvgfError(f"Inputs.motion: expected 2 or 3 components, got {shown(self.motion)}")

    @classmethod
    def of(cls, frame: Frame) -> Inputs:
        """What `frame` supplies."""
        given = frame.present()
        return cls(
            signals=next(split for split in SPLITS if all(signal.field in given for signal in split)),
            motion=int(frame.motion.shape[2]),
            albedo="albedo" in given,
            emission="emission" in given,
            id="id" in given,
        )

    @classmethod
    def every(cls) -> Inputs:
        """All that frames can supply at once, in the finest split."""
        return cls(signals=max(SPLITS, key=len), motion=3, albedo=True, emission=True, id=True)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the frame's fields."""
        optional = [name for name in ("albedo", "emission", "id") if getattr(self, name)]
        return (*(signal.field for signal in self.signals), "normal", "depth", "motion", *optional)

    @property
    def emission_signal(self) -> int:
        """Number of the signal that emission has to be taken out of; -1 if of none."""
        holders = [number for number, signal in enumerate(self.signals) if signal.holds_emission and self.emission]
        return holders[0] if holders else -1

    @property
    def divides_by_albedo(self) -> bool:
        """Whether light is divided by albedo; kernels divide all signals of a split, or none."""
        divisors = {signal.divided_by for signal in self.signals}
        if len(divisors) > 1 or not divisors <= {"albedo", None}:
            raise ValueError(f"expected signals that are all divided by albedo or none of them, got {divisors}")
        return self.albedo and divisors == {"albedo"}

    @property
    def defines(self) -> dict[str, int]:
        """The kernels' macros."""
        numbers = {f"SIGNAL_{signal.name.upper()}": number for number, signal in enumerate(self.signals)}
        return numbers | {
            "SIGNALS": len(self.signals),
            "MOTION": self.motion,
            "EMISSION_SIGNAL": self.emission_signal,
            "HAS_ALBEDO": int(self.divides_by_albedo),
            "HAS_EMISSION": int(self.emission),
            "HAS_ID": int(self.id),
        }

    def __str__(self) -> str:
        return f"{', '.join(self.fields)} (motion of {self.motion} components)"
