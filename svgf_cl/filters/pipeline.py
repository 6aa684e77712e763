"""The pipeline as a table: which kernel runs when, what it reads and what it writes.

Labels of the profiler, names of the stages a debugger can look at, and the sharing of memory all follow from this
table.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from svgf_cl.frame import Frame
from svgf_cl.settings import Settings

# Buffers that live from frame to frame. A pair is written anew every frame and read in the next as "previous ...".
PAIRS = ("guide", "moments", "antialiased")
PREVIOUS = "previous "
HISTORY = ("history",)
# What is made of what pixel by pixel, so that it may be written over it.
IN_PLACE = {"accumulated": "demodulated"}
# Where the user's result goes.
OUT = "out"


@dataclass(frozen=True)
class Inputs:
    """Which optional fields a frame has; kernels are built for exactly these, so what is absent costs nothing."""

    signals: int
    motion: int
    albedo: bool
    emission: bool
    id: bool

    @classmethod
    def of(cls, frame: Frame) -> Inputs:
        """The inputs that `frame` supplies."""
        return cls(
            signals=1 if frame.direct is None else 2,
            motion=int(frame.motion.shape[2]),
            albedo=frame.albedo is not None,
            emission=frame.emission is not None,
            id=frame.id is not None,
        )

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the frame's fields that are read."""
        optional = [name for name in ("albedo", "emission", "id") if getattr(self, name)]
        return (*self.radiance, "normal", "depth", "motion", *optional)

    @property
    def radiance(self) -> tuple[str, ...]:
        """The fields that are filtered."""
        return ("color",) if self.signals == 1 else ("direct", "indirect")

    @property
    def defines(self) -> dict[str, int]:
        """The kernels' macros."""
        return {
            "SIGNALS": self.signals,
            "MOTION": self.motion,
            "HAS_ALBEDO": int(self.albedo),
            "HAS_EMISSION": int(self.emission),
            "HAS_ID": int(self.id),
        }

    def __str__(self) -> str:
        return f"{', '.join(self.fields)} (motion of {self.motion} components)"

    def planes(self, buffer: str) -> int:
        """Number of planes of a device buffer."""
        light = 3 * self.signals
        with_variance = light + self.signals
        counts = {
            "guide": 5 if self.id else 4,
            "demodulated": light,
            "history": with_variance,
            "moments": 1 + 2 * self.signals,
            "accumulated": with_variance,
            "level": with_variance,
            "modulated": 3,
            "antialiased": 3,
        }
        return counts[kind_of(buffer)]


@dataclass(frozen=True)
class Pass:
    """One kernel launch. Its arguments are: size, step (of an a-trous level), the settings, the reads, the writes."""

    kernel: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    settings: tuple[str, ...] = ()
    level: int | None = None

    @property
    def name(self) -> str:
        """Label in profiles."""
        return self.kernel if self.level is None else f"{self.kernel} {self.level}"

    @property
    def stage(self) -> str:
        """Name of the kernel's source file; both ways through the albedo are one stage."""
        return "modulate" if self.kernel == "demodulate" else self.kernel

    @property
    def step(self) -> int | None:
        """Pixels between the taps of an a-trous level."""
        return None if self.level is None else 2 ** (self.level - 1)


def pipeline(inputs: Inputs, settings: Settings) -> tuple[Pass, ...]:
    """The passes of a frame, in order (Schied et al. 2017, figure 1)."""
    albedo = ("albedo",) if inputs.albedo else ()
    emission = ("emission",) if inputs.emission else ()
    id_ = ("id",) if inputs.id else ()
    mixed_in = emission if inputs.signals == 1 else ()  # a split leaves emission out
    passes = [
        Pass(
            "demodulate",
            reads=(*inputs.radiance, *albedo, *mixed_in, "normal", "depth", *id_),
            writes=("guide", "demodulated"),
        ),
        Pass(
            "temporal",
            reads=("motion", "guide", "demodulated", "previous guide", "history", "previous moments"),
            writes=("accumulated", "moments"),
            settings=("alpha_color", "alpha_moments", "depth_threshold", "normal_threshold"),
        ),
        Pass(
            "variance",
            reads=("guide", "moments"),
            writes=("accumulated",),
            settings=("sigma_depth", "sigma_normal", "depth_slope_floor"),
        ),
        *atrous_levels(settings.iterations),
        Pass(
            "modulate",
            reads=(*albedo, *emission, level_buffer(settings.iterations)),
            writes=("modulated" if settings.taa else OUT,),
        ),
    ]
    if settings.taa:
        passes.append(
            Pass(
                "taa",
                reads=("motion", "guide", "moments", "modulated", "previous antialiased"),
                writes=("antialiased", OUT),
                settings=("alpha_taa",),
            )
        )
    return tuple(passes)


def atrous_levels(iterations: int) -> Iterator[Pass]:
    """The wavelet levels; the first writes the colour history of the next frame (paper, section 4.1)."""
    for level in range(1, iterations + 1):
        yield Pass(
            "atrous",
            reads=("guide", level_buffer(level - 1)),
            writes=(level_buffer(level),),
            settings=("sigma_depth", "sigma_normal", "sigma_luminance", "depth_slope_floor"),
            level=level,
        )


def level_buffer(level: int) -> str:
    """Buffer that holds the illumination after so many a-trous levels."""
    return {0: "accumulated", 1: "history"}.get(level, f"level {level}")


def kind_of(buffer: str) -> str:
    """What a buffer holds: a pair's halves are of one kind, and so are all levels."""
    return buffer.removeprefix(PREVIOUS).partition(" ")[0]


def history_pairs(passes: tuple[Pass, ...]) -> list[str]:
    """The pairs that these passes write."""
    written = {name for p in passes for name in p.writes}
    return [name for name in PAIRS if name in written]
