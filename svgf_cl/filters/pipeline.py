"""The words in which a filter is declared: what buffers hold, and which pass reads and writes what of them.

Memory, views of what lies between the passes, traffic, the macros by which kernels find a plane, and the order of a
kernel's arguments all follow from a filter's `Pipeline`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property

import numpy as np

from svgf_cl.filters.formats import Format, Planes
from svgf_cl.filters.taps import HERE, Taps
from svgf_cl.frame import CHANNELS

OUT = "out"  # the user's array for the result
# Since the last cut, from 0; and where a pixel of this frame lies in the past, from its own place.
FRAME_SCALARS: Mapping[str, type[np.generic]] = dict.fromkeys(("frame_number", "past_x", "past_y"), np.int32)
PAST = ("past_x", "past_y")

Number = int | float


@dataclass(frozen=True)
class Quantity:
    """Something that a buffer holds of every pixel; all its planes lie together, signal by signal.

    Parameters
    ----------
    name : str
        Kernels find its first plane by the macro <KIND>_<NAME>, its channels by <KIND>_<NAME>_CHANNELS.
    channels : int
    signals : int
        How many signals have one each; 0 where all share it.
    format : Format
    stage : str
        Name by which `Denoiser.stage` shows it; not shown where empty.
    is_light : bool
        Whether its channels are stored as red, luminance and blue, and shown as red, green and blue.
    unknown : float, optional
        What it holds where nothing is known of the past, for a kernel that does not go by the frame's number; written
        before the first frame and after a cut.
    """

    name: str
    channels: int = 1
    signals: int = 0
    format: Format = Format.FLOAT
    stage: str = ""
    is_light: bool = False
    unknown: float | None = None

    @property
    def planes(self) -> int:
        """Of all signals."""
        return self.channels * max(self.signals, 1)

    @property
    def nbytes(self) -> int:
        """Of a pixel."""
        return self.planes * self.format.nbytes


class Life(Enum):
    """How long a buffer is needed."""

    SCRATCH = "within a frame; its memory may serve others before and after"
    HISTORY = "into the next frame, which reads it before it writes it anew"
    PAIR = "into the next frame, which reads it while it writes another"


@dataclass(frozen=True)
class Resource:
    """A buffer: quantities in 32 bits first, then those in 16.

    Parameters
    ----------
    name : str
        Of this buffer alone.
    kind : str
        Buffers of one kind have the same quantities, or the first of them; kernels name planes by it.
    quantities : tuple of Quantity
    life : Life
    over : str
        Name of a buffer that it may be written over: the pass that begins to write this one reads that one at the pixel
        itself alone, and no later pass reads it. A pair may be written over one that was made within the frame.
    spacing : int
        Pixels of the image from one of its own to the next, along a row and down; 2 holds every second one.
    """

    name: str
    kind: str
    quantities: tuple[Quantity, ...]
    life: Life = Life.SCRATCH
    over: str = ""
    spacing: int = 1

    def __post_init__(self) -> None:
        sizes = [quantity.format.nbytes for quantity in self.quantities]
        narrow = sum(size < sizes[0] for size in sizes)
        if sizes != sorted(sizes, reverse=True) or (narrow and narrow < len(sizes) and narrow > 1):
            raise ValueError(
                f"{self.name}: expected quantities all in 32 bits, all in 16, or one in 16 behind those in 32"
            )

    @property
    def names(self) -> tuple[str, ...]:
        """Of its quantities."""
        return tuple(quantity.name for quantity in self.quantities)

    def before(self, name: str) -> tuple[Quantity, ...]:
        """The quantities in front of one."""
        return self.quantities[: self.names.index(name)]

    def first(self, name: str) -> int:
        """Planes in front of a quantity's."""
        return sum(quantity.planes for quantity in self.before(name))

    def begin(self, name: str) -> int:
        """Bytes a pixel in front of a quantity's."""
        return sum(quantity.nbytes for quantity in self.before(name))

    @property
    def planes(self) -> Planes:
        """How much memory it takes."""
        full = sum(quantity.planes for quantity in self.quantities if quantity.format.nbytes == 4)
        return Planes(full, sum(quantity.planes for quantity in self.quantities) - full)

    @property
    def tells_unknown(self) -> bool:
        """Whether it says by itself where nothing is known of the past."""
        return any(quantity.unknown is not None for quantity in self.quantities)

    @property
    def defines(self) -> dict[str, int]:
        """The macros by which kernels find its planes."""
        found: dict[str, int] = {}
        for quantity in self.quantities:
            macro = f"{self.kind}_{quantity.name}".upper()
            found |= {macro: self.first(quantity.name), f"{macro}_CHANNELS": quantity.channels}
        return found


@dataclass(frozen=True)
class Buffer:
    """A resource as one frame sees it: its own or, of a pair, that of the frame before."""

    resource: Resource
    previous: bool = False

    def __str__(self) -> str:
        return f"previous {self.resource.name}" if self.previous else self.resource.name


@dataclass(frozen=True)
class Use:
    """A quantity that a pass needs, and the pixels at which it does."""

    quantity: Quantity
    taps: Taps = HERE


@dataclass(frozen=True)
class Access:
    """A kernel's argument that is a buffer, and what a pass needs of it in a steady state, with a long history.

    Parameters
    ----------
    argument : str
        The kernel's name for it.
    of : Buffer or str
        A name is that of one of the user's arrays: a field of `Frame`, or `OUT`.
    uses : tuple of Use
    """

    argument: str
    of: Buffer | str
    uses: tuple[Use, ...]

    @property
    def resource(self) -> Resource:
        """Of a buffer; an array of the user's has none."""
        if isinstance(self.of, str):
            raise ValueError(f"{self.argument}: expected a buffer, got the user's {self.of}")
        return self.of.resource


def history_of(resource: Resource) -> Buffer:
    """What a frame finds of a lasting resource when it begins."""
    return Buffer(resource, previous=resource.life is Life.PAIR)


def user(name: str, argument: str = "", channels: int = 0) -> Access:
    """An access to one of the user's arrays, or to so many of its channels."""
    usual = 3 if name == OUT else max(1, *CHANNELS[name])
    return Access(argument or name, name, (Use(Quantity(name, channels or usual)),))


def access(
    resource: Resource, argument: str = "", taps: Mapping[str, Taps] | None = None, *, previous: bool = False
) -> Access:
    """An access to the quantities that `taps` names, or else to all at the pixel itself."""
    chosen = dict.fromkeys(resource.names, HERE) if taps is None else taps
    uses = tuple(Use(each, chosen[each.name]) for each in resource.quantities if each.name in chosen)
    usual = f"previous_{resource.name}" if previous else resource.name
    return Access(argument or usual, Buffer(resource, previous), uses)


def spacing_of(access: Access) -> int:
    """Pixels from one to the next of what is accessed."""
    return access.of.resource.spacing if isinstance(access.of, Buffer) else 1


@dataclass(frozen=True)
class Pass:
    """One kernel launch.

    Its arguments are the image's size, that of its coarse buffers if it has any, that of the past if it reads it along
    motion, then what the fields below name, in their order.

    Parameters
    ----------
    source : str
        A file in ``kernels/``, without its suffix.
    kernel : str
        The kernel in it.
    scalars : mapping of str to int or float
        Numbers that stay the same from frame to frame; kernels get a whole one as int, any other as float.
    per_frame : tuple of str
        Numbers that change with the frame, out of `FRAME_SCALARS`; `PAST` for a pass that reads along motion.
    arrays : mapping of str to array
        Constants in device memory, such as a network's weights.
    reads, writes : tuple of Access
    rarely : tuple of Taps
        Pixels at which it also reads any of its buffers, but not in a steady state: where history is short, say.
    operations : float
        Floating-point operations a pixel that it writes, counted from the equations (`svgf_cl.filters.operations`).
    level : int, optional
        Which of several like it, from 1.
    row_step : int
        The kernel deals its rows out so many apart, and wants whole rounds of them.
    """

    source: str
    kernel: str
    scalars: Mapping[str, Number] = field(default_factory=dict)
    per_frame: tuple[str, ...] = ()
    arrays: Mapping[str, np.ndarray] = field(default_factory=dict, compare=False)
    reads: tuple[Access, ...] = ()
    writes: tuple[Access, ...] = ()
    rarely: tuple[Taps, ...] = ()
    operations: float = field(default=0.0, compare=False)
    level: int | None = None
    row_step: int = 1

    def __post_init__(self) -> None:
        if len(set(self.arguments)) < len(self.arguments):
            raise ValueError(f"{self.label}: expected arguments of different names, got {', '.join(self.arguments)}")
        if len({spacing_of(each) for each in self.writes}) > 1 or len({*self._spacings} - {1}) > 1:
            raise ValueError(f"{self.label}: expected to write every pixel or every so many, got {self._spacings}")
        if self.follows_motion != set(PAST).issubset(self.per_frame):
            raise ValueError(f"{self.label}: expected {' and '.join(PAST)} if it reads along motion, and only then")
        kept = {name: np.array(values, order="C") for name, values in self.arrays.items()}  # apart from the owner's
        for values in kept.values():
            values.flags.writeable = False
        object.__setattr__(self, "arrays", kept)

    @property
    def path(self) -> tuple[str, ...]:
        """The kernel and, where there are several like it, the level."""
        return (self.kernel,) if self.level is None else (self.kernel, str(self.level))

    @property
    def label(self) -> str:
        """Its name in profiles."""
        return " ".join(self.path)

    @property
    def accesses(self) -> tuple[Access, ...]:
        """Reads, then writes."""
        return (*self.reads, *self.writes)

    @property
    def spacing(self) -> int:
        """Of the pixels that it writes."""
        return spacing_of(self.writes[0])

    @property
    def coarse_spacing(self) -> int:
        """Of its buffers that do not hold every pixel; 1 where all do."""
        return max(self._spacings)

    @property
    def _spacings(self) -> list[int]:
        return [1, *map(spacing_of, self.accesses)]

    @property
    def sizes(self) -> tuple[str, ...]:
        """The kernel's names for the layouts of its buffers."""
        coarse = ("coarse_size",) if self.coarse_spacing > 1 else ()
        return ("size", *coarse, *(("past_size",) if self.follows_motion else ()))

    def taps(self, access: Access) -> tuple[Taps, ...]:
        """Where it reads one of its accesses, rare taps included."""
        return (*(use.taps for use in access.uses), *self.rarely)

    @property
    def follows_motion(self) -> bool:
        """Whether it reads the past where pixels were then."""
        return any(use.taps.follow_motion for each in self.reads for use in each.uses)

    def reach(self, access: Access) -> int:
        """Pixels of the image from one that it writes to the farthest that it reads of an access around it."""
        steady = max((use.taps.reach for use in access.uses), default=0) * spacing_of(access)
        return max(steady, *(taps.reach for taps in self.rarely), 0)

    @property
    def arguments(self) -> tuple[str, ...]:
        """The kernel's names for its arguments, in order."""
        return (*self.sizes, *self.scalars, *self.per_frame, *self.arrays, *(each.argument for each in self.accesses))


@dataclass(frozen=True)
class Pipeline:
    """The passes of a frame, in order, and the macros of their kernels beside those that follow from the passes."""

    passes: tuple[Pass, ...]
    macros: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        there: set[Buffer | str] = {Buffer(each, previous=each.life is Life.PAIR) for each in self.lasting}
        for entry in self.passes:
            for each in entry.reads:
                if isinstance(each.of, Buffer) and each.of not in there:
                    raise ValueError(f"{entry.label}: expected a buffer that was written before, got {each.of}")
            there |= {each.of for each in entry.writes}
        for names in ([entry.label for entry in self.passes], [name for name, _, _ in self.shown()]):
            if len(set(names)) < len(names):
                raise ValueError(f"expected passes and stages of different names, got {', '.join(names)}")
        for resource in self.resources:
            self._check_over(resource)

    def _check_over(self, resource: Resource) -> None:
        """Raise `ValueError` if a buffer that this one may be written over is read beside the pixel, or later."""
        first = [Buffer(resource) in {each.of for each in entry.writes} for entry in self.passes].index(True)
        for entry in self.passes[first:]:
            for each in entry.reads:
                if not isinstance(each.of, Buffer) or each.of.resource.name != resource.over:
                    continue
                if entry is not self.passes[first] or any(use.taps != HERE for use in each.uses):
                    raise ValueError(
                        f"{entry.label}: expected {each.of} to be read before {self.passes[first].label} writes "
                        f"{resource.name} over it, or by that pass at the pixel itself alone"
                    )

    @cached_property
    def resources(self) -> tuple[Resource, ...]:
        """All that the passes write, each once, in the order of the first write."""
        written = (each.of.resource for entry in self.passes for each in entry.writes if isinstance(each.of, Buffer))
        return tuple(dict.fromkeys(written))

    @property
    def lasting(self) -> tuple[Resource, ...]:
        """The resources that the next frame reads."""
        return tuple(resource for resource in self.resources if resource.life is not Life.SCRATCH)

    @cached_property
    def fields(self) -> tuple[str, ...]:
        """The user's arrays that are read."""
        read = (each.of for entry in self.passes for each in entry.reads if isinstance(each.of, str))
        return tuple(dict.fromkeys(read))

    @cached_property
    def defines(self) -> dict[str, int]:
        """Every macro of the kernels that the pipeline decides."""
        found = dict(self.macros)
        for resource in self.resources:
            for name, value in resource.defines.items():
                if found.setdefault(name, value) != value:
                    raise ValueError(f"{resource.name}: expected {name} {found[name]} as in others, got {value}")
        return found

    @cached_property
    def unread(self) -> tuple[Resource, ...]:
        """The resources that no pass reads, in this frame or the next."""
        read = {each.of.resource for entry in self.passes for each in entry.reads if isinstance(each.of, Buffer)}
        return tuple(resource for resource in self.resources if resource not in read)

    @cached_property
    def user_nbytes(self) -> dict[str, int]:
        """Bytes a pixel of each of the user's arrays, the result included."""
        accesses = (each for entry in self.passes for each in entry.accesses)
        return {each.of: each.uses[0].quantity.nbytes for each in accesses if isinstance(each.of, str)}

    @property
    def widest(self) -> int:
        """Planes of the largest buffer."""
        return max(resource.planes.count for resource in self.resources)

    @property
    def reach(self) -> int:
        """Pixels by which the widest taps lie off their pixel."""
        return max(taps.reach for entry in self.passes for each in entry.reads for taps in entry.taps(each))

    def past_of(self, entry: Pass) -> tuple[Access, ...]:
        """What a pass reads of what the previous frame left; none is to the user's arrays."""
        written = {each.of for earlier in self.passes[: self.passes.index(entry)] for each in earlier.writes}
        lasting = {history_of(resource) for resource in self.lasting}
        return tuple(each for each in entry.reads if each.of in lasting - written)

    def shown(self) -> Iterator[tuple[str, Resource, Quantity]]:
        """Every stage: its name, and what it shows of which resource; in the order in which passes write them."""
        for entry in self.passes:
            for each in entry.writes:
                for use in each.uses:
                    if use.quantity.stage and isinstance(each.of, Buffer):
                        yield use.quantity.stage, each.of.resource, use.quantity

    def differs_in_scalars_alone(self, other: Pipeline) -> bool:
        """Whether it shares kernels, memory and launches with another."""
        return self._without_scalars() == other._without_scalars() and all(
            same_arrays(mine.arrays, others.arrays) for mine, others in zip(self.passes, other.passes, strict=True)
        )

    def _without_scalars(self) -> Pipeline:
        blank = tuple(replace(entry, scalars=dict.fromkeys(entry.scalars, 0), arrays={}) for entry in self.passes)
        return replace(self, passes=blank)


def same_arrays(a: Mapping[str, np.ndarray], b: Mapping[str, np.ndarray]) -> bool:
    """Whether arrays are the same by name, type, shape and every bit."""
    return list(a) == list(b) and all(
        a[name].dtype == b[name].dtype and a[name].shape == b[name].shape and a[name].tobytes() == b[name].tobytes()
        for name in a
    )
