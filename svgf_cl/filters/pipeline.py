"""The classes that declare a filter: what buffers hold, and what each pass reads and writes.

The memory, the stages, the traffic, the macros by which kernels find planes, and the order of a kernel's arguments all
follow from a filter's `Pipeline`.
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
# The number of frames since the last cut, from 0; and the offset of a position in the data of the past, which differs
# from 0 in tiles only.
FRAME_SCALARS: Mapping[str, type[np.generic]] = dict.fromkeys(("frame_number", "past_x", "past_y"), np.int32)
PAST = ("past_x", "past_y")

Number = int | float


@dataclass(frozen=True)
class Quantity:
    """Something that a buffer holds for every pixel; all its planes are adjacent, signal by signal.

    Parameters
    ----------
    name : str
        Kernels find its first plane by the macro <KIND>_<NAME>, its channels by <KIND>_<NAME>_CHANNELS.
    channels : int
    signals : int
        The number of signals that have one each; 0 if all signals share it.
    format : Format
    stage : str
        The name by which `Denoiser.stage` shows it; empty if it is not shown.
    is_light : bool
        Whether its channels are stored as red, luminance and blue, and shown as red, green and blue.
    unknown : float, optional
        The value that means that nothing is known of the past. It is for kernels that do not use the frame's number,
        and is written before the first frame and after a cut.
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
        """Planes of all signals."""
        return self.channels * max(self.signals, 1)

    @property
    def nbytes(self) -> int:
        """Bytes per pixel."""
        return self.planes * self.format.nbytes


class Life(Enum):
    """How long a buffer is needed."""

    SCRATCH = "within one frame; other buffers may use its memory before and after"
    HISTORY = "until the next frame has read it, before that frame writes it again"
    PAIR = "until the next frame has read it, while that frame writes the other buffer of the pair"


@dataclass(frozen=True)
class Resource:
    """A buffer: quantities in 32 bits first, then those in 16.

    Parameters
    ----------
    name : str
        A name that no other buffer has.
    kind : str
        Buffers of one kind have the same quantities, or only the first few of them. Kernels name planes by the kind.
    quantities : tuple of Quantity
    life : Life
    over : str
        The name of a buffer whose memory this one may overwrite. The first pass that writes this buffer must read the
        other one at its own pixel only, and no later pass may read the other one. A pair may only overwrite a buffer
        that is written within the same frame.
    spacing : int
        The distance in pixels of the image between neighbouring pixels of the buffer, in both directions; 2 means every
        second pixel of every second row.
    """

    name: str
    kind: str
    quantities: tuple[Quantity, ...]
    life: Life = Life.SCRATCH
    over: str = ""
    spacing: int = 1

    def __hash__(self) -> int:
        # The name is unique, and hashes of all quantities took most of the time of making a pipeline.
        return hash(self.name)

    def __post_init__(self) -> None:
        sizes = [quantity.format.nbytes for quantity in self.quantities]
        narrow = sum(size < sizes[0] for size in sizes)
        if sizes != sorted(sizes, reverse=True) or (narrow and narrow < len(sizes) and narrow > 1):
            raise ValueError(
                f"{self.name}: expected quantities all in 32 bits, all in 16, or one in 16 behind those in 32"
            )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its quantities."""
        return tuple(quantity.name for quantity in self.quantities)

    def before(self, name: str) -> tuple[Quantity, ...]:
        """The quantities that come before this one."""
        return self.quantities[: self.names.index(name)]

    def first(self, name: str) -> int:
        """The number of planes before this quantity."""
        return sum(quantity.planes for quantity in self.before(name))

    def begin(self, name: str) -> int:
        """The number of bytes per pixel before this quantity."""
        return sum(quantity.nbytes for quantity in self.before(name))

    @property
    def planes(self) -> Planes:
        """The number of planes of each width."""
        full = sum(quantity.planes for quantity in self.quantities if quantity.format.nbytes == 4)
        return Planes(full, sum(quantity.planes for quantity in self.quantities) - full)

    @property
    def tells_unknown(self) -> bool:
        """Whether a value in the buffer marks pixels of which nothing is known of the past."""
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
    """A resource as a frame sees it: the one that it writes, or (of a pair) the one that the previous frame wrote."""

    resource: Resource
    previous: bool = False

    def __str__(self) -> str:
        return f"previous {self.resource.name}" if self.previous else self.resource.name


@dataclass(frozen=True)
class Use:
    """A quantity that a pass needs, and the pixels at which the pass needs it."""

    quantity: Quantity
    taps: Taps = HERE


@dataclass(frozen=True)
class Access:
    """A buffer or user's array as a kernel's argument, and the part of it that the pass needs in a steady state.

    Parameters
    ----------
    argument : str
        The kernel's name for it.
    of : Buffer or str
        A string names one of the user's arrays: a field of `Frame`, or `OUT`.
    uses : tuple of Use
    """

    argument: str
    of: Buffer | str
    uses: tuple[Use, ...]

    @property
    def resource(self) -> Resource:
        """The resource of the buffer; `ValueError` for a user's array."""
        if isinstance(self.of, str):
            raise ValueError(f"{self.argument}: expected a buffer, got the user's {self.of}")
        return self.of.resource


def history_of(resource: Resource) -> Buffer:
    """The buffer of a resource that a frame finds when it begins, as the previous frame left it."""
    return Buffer(resource, previous=resource.life is Life.PAIR)


def user(name: str, argument: str = "", channels: int = 0) -> Access:
    """An access to one of the user's arrays, or to its first `channels` channels."""
    usual = 3 if name == OUT else max(1, *CHANNELS[name])
    return Access(argument or name, name, (Use(Quantity(name, channels or usual)),))


def access(
    resource: Resource, argument: str = "", taps: Mapping[str, Taps] | None = None, *, previous: bool = False
) -> Access:
    """An access to the quantities that `taps` names; without `taps`, to all quantities at the pixel itself."""
    chosen = dict.fromkeys(resource.names, HERE) if taps is None else taps
    uses = tuple(Use(each, chosen[each.name]) for each in resource.quantities if each.name in chosen)
    usual = f"previous_{resource.name}" if previous else resource.name
    return Access(argument or usual, Buffer(resource, previous), uses)


def spacing_of(access: Access) -> int:
    """The distance in pixels between neighbouring pixels of the buffer or array."""
    return access.of.resource.spacing if isinstance(access.of, Buffer) else 1


@dataclass(frozen=True)
class Pass:
    """One kernel launch.

    The kernel's arguments are the size of the image, the size of its coarse buffers (if it has any), the size of the
    past (if it reads along motion), and then the arguments that the fields below name, in their order.

    Parameters
    ----------
    source : str
        A file in ``kernels/``, without its suffix.
    kernel : str
        The name of the kernel in this file.
    scalars : mapping of str to int or float
        Numbers that stay the same from frame to frame. A whole number is passed as int, any other number as float.
    per_frame : tuple of str
        Numbers that change from frame to frame, out of `FRAME_SCALARS`; `PAST` for a pass that reads along motion.
    arrays : mapping of str to array
        Constants in device memory, such as a network's weights.
    reads, writes : tuple of Access
    rarely : tuple of Taps
        Pixels at which it also reads any of its buffers, but not in a steady state: for example, where history is
        short.
    operations : float
        Floating-point operations per written pixel, counted from the equations (`svgf_cl.filters.operations`).
    level : int, optional
        The number of this pass among several of the same kernel, from 1.
    row_step : int
        The kernel processes rows that are this many apart one after the other; the work-items fill whole groups of
        rows.
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
        # copies, which the owner cannot change
        kept = {name: np.array(values, order="C") for name, values in self.arrays.items()}
        for values in kept.values():
            values.flags.writeable = False
        object.__setattr__(self, "arrays", kept)

    @property
    def path(self) -> tuple[str, ...]:
        """The kernel, and the level if there are several passes of this kernel."""
        return (self.kernel,) if self.level is None else (self.kernel, str(self.level))

    @property
    def label(self) -> str:
        """Its name in profiles."""
        return " ".join(self.path)

    @property
    def accesses(self) -> tuple[Access, ...]:
        """All reads, then all writes."""
        return (*self.reads, *self.writes)

    @property
    def spacing(self) -> int:
        """The spacing of the pixels that it writes."""
        return spacing_of(self.writes[0])

    @property
    def coarse_spacing(self) -> int:
        """The spacing of those of its buffers that do not hold every pixel; 1 if all of them do."""
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
        """The taps of an access, including the rare ones."""
        return (*(use.taps for use in access.uses), *self.rarely)

    @property
    def follows_motion(self) -> bool:
        """Whether it reads the previous frame along motion."""
        return any(use.taps.follow_motion for each in self.reads for use in each.uses)

    def reach(self, access: Access) -> int:
        """The distance in pixels of the image to the farthest tap of an access, without taps along motion."""
        steady = max((use.taps.reach for use in access.uses), default=0) * spacing_of(access)
        return max(steady, *(taps.reach for taps in self.rarely), 0)

    @property
    def arguments(self) -> tuple[str, ...]:
        """The kernel's names for its arguments, in order."""
        return (*self.sizes, *self.scalars, *self.per_frame, *self.arrays, *(each.argument for each in self.accesses))


@dataclass(frozen=True)
class Pipeline:
    """The passes of a frame, in order, and the macros that do not follow from the passes."""

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
            if resource.over:
                self._check_over(resource)

    def _check_over(self, resource: Resource) -> None:
        """Raise `ValueError` if a pass reads the overwritten buffer at another pixel, or after it was overwritten."""
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
        """All resources that the passes write, each once, in the order in which they are first written."""
        written = (each.of.resource for entry in self.passes for each in entry.writes if isinstance(each.of, Buffer))
        return tuple(dict.fromkeys(written))

    @property
    def lasting(self) -> tuple[Resource, ...]:
        """The resources that the next frame reads."""
        return tuple(resource for resource in self.resources if resource.life is not Life.SCRATCH)

    @cached_property
    def fields(self) -> tuple[str, ...]:
        """The names of the user's arrays that are read."""
        read = (each.of for entry in self.passes for each in entry.reads if isinstance(each.of, str))
        return tuple(dict.fromkeys(read))

    @cached_property
    def defines(self) -> dict[str, int]:
        """All macros that the pipeline passes to the kernels."""
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
        """Bytes per pixel of each of the user's arrays, including the result."""
        accesses = (each for entry in self.passes for each in entry.accesses)
        return {each.of: each.uses[0].quantity.nbytes for each in accesses if isinstance(each.of, str)}

    @property
    def widest(self) -> int:
        """The number of planes of the largest buffer."""
        return max(resource.planes.count for resource in self.resources)

    @property
    def reach(self) -> int:
        """The distance in pixels to the farthest tap of any pass."""
        return max(taps.reach for entry in self.passes for each in entry.reads for taps in entry.taps(each))

    def past_of(self, entry: Pass) -> tuple[Access, ...]:
        """The accesses of a pass to buffers that the previous frame wrote; user's arrays are not among them."""
        written = {each.of for earlier in self.passes[: self.passes.index(entry)] for each in earlier.writes}
        lasting = {history_of(resource) for resource in self.lasting}
        return tuple(each for each in entry.reads if each.of in lasting - written)

    def shown(self) -> Iterator[tuple[str, Resource, Quantity]]:
        """The name, resource and quantity of every stage, in the order in which the passes write them."""
        for entry in self.passes:
            for each in entry.writes:
                for use in each.uses:
                    if use.quantity.stage and isinstance(each.of, Buffer):
                        yield use.quantity.stage, each.of.resource, use.quantity

    def differs_in_scalars_alone(self, other: Pipeline) -> bool:
        """Whether another pipeline differs in numbers only, so that kernels, memory and launches are the same."""
        return self._without_scalars() == other._without_scalars() and all(
            same_arrays(mine.arrays, others.arrays) for mine, others in zip(self.passes, other.passes, strict=True)
        )

    def _without_scalars(self) -> Pipeline:
        blank = tuple(replace(entry, scalars=dict.fromkeys(entry.scalars, 0), arrays={}) for entry in self.passes)
        return replace(self, passes=blank)


def same_arrays(a: Mapping[str, np.ndarray], b: Mapping[str, np.ndarray]) -> bool:
    """Whether arrays have the same names, types, shapes and bits."""
    return list(a) == list(b) and all(
        a[name].dtype == b[name].dtype and a[name].shape == b[name].shape and a[name].tobytes() == b[name].tobytes()
        for name in a
    )
