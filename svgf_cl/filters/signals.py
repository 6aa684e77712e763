"""The parts of the light that are filtered separately (signals), and the fields of a frame."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.errors import SvgfError, shown
from svgf_cl.frame import Frame


@dataclass(frozen=True)
class Signal:
    """A part of the light that is filtered separately.

    Parameters
    ----------
    name : str
        Kernels know the number of the signal by the macro SIGNAL_<NAME>.
    field : str
        The field of `Frame` that holds it.
    divided_by : str or None
        The field that it is divided by before the filter, and multiplied by afterwards.
    holds_emission : bool
        Whether the field contains directly visible emission, which is subtracted before the filter.
    carries : tuple of str
        The quantities that temporal accumulation keeps of it in addition to its light, in the order of the moments.
    """

    name: str
    field: str
    divided_by: str | None
    holds_emission: bool = False
    carries: tuple[str, ...] = ("mean", "variance")


COLOR = Signal("color", field="color", divided_by="albedo", holds_emission=True)
DIRECT = Signal("direct", field="direct", divided_by="albedo")
INDIRECT = Signal("indirect", field="indirect", divided_by="albedo")

# All ways to split radiance, the finest first. A frame is filtered by the first split for which it has all fields.
SPLITS: tuple[tuple[Signal, ...], ...] = ((DIRECT, INDIRECT), (COLOR,))


@dataclass(frozen=True, kw_only=True)
class Inputs:
    """The fields that frames have. Kernels are built for exactly these fields, so a missing field costs nothing.

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
        """The fields of `frame`."""
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
        """All fields that a frame can have at once, with the finest split."""
        return cls(signals=max(SPLITS, key=len), motion=3, albedo=True, emission=True, id=True)

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the fields."""
        optional = [name for name in ("albedo", "emission", "id") if getattr(self, name)]
        return (*(signal.field for signal in self.signals), "normal", "depth", "motion", *optional)

    @property
    def emission_signal(self) -> int:
        """The number of the signal from which emission is subtracted; -1 if there is none."""
        holders = [number for number, signal in enumerate(self.signals) if signal.holds_emission and self.emission]
        return holders[0] if holders else -1

    @property
    def divides_by_albedo(self) -> bool:
        """Whether light is divided by albedo; kernels divide either all signals of a split or none."""
        divisors = {signal.divided_by for signal in self.signals}
        if len(divisors) > 1 or not divisors <= {"albedo", None}:
            raise ValueError(f"expected signals that are all divided by albedo or none of them, got {divisors}")
        return self.albedo and divisors == {"albedo"}

    @property
    def defines(self) -> dict[str, int]:
        """The macros of the kernels."""
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
