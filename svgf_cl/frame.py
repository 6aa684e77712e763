"""`Frame`: the input for one image. docs/conventions.md defines shapes and meanings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from svgf_cl.errors import ArgumentError, FrameError
from svgf_cl.interchange import UserArray, as_array

# Luminance of linear Rec. 709 red, green and blue.
LUMINANCE: tuple[float, float, float] = (0.2126, 0.7152, 0.0722)

Shape = tuple[int, int]

# Possible numbers of channels of each field; 0 means an (H, W) array.
CHANNELS: dict[str, tuple[int, ...]] = {
    "color": (3,),
    "albedo": (3,),
    "normal": (3,),
    "depth": (0,),
    "motion": (2, 3),
    "id": (0,),
    "emission": (3,),
    "direct": (3,),
    "indirect": (3,),
    "diffuse": (3,),
    "specular": (3,),
    "roughness": (0,),
    "hit_distance": (2,),
}
# The fourth channel that `color` may have in addition; the result has it unchanged.
ALPHA = "color.alpha"
REQUIRED = ("normal", "depth", "motion")
# Fields that the denoiser checks but does not use: renderers write them, and future filters will need them.
CARRIED = ("diffuse", "specular", "roughness", "hit_distance")


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """One noisy image with its G-buffer.

    Every field is a `numpy.ndarray` or a `pyopencl.array.Array`, with row 0 at the top, x to the right and y down.
    `Frame.of` accepts arrays of other libraries, too.

    Parameters
    ----------
    color : (H, W, 3) or (H, W, 4) float32, optional
        Linear HDR radiance, scene-referred. It may be left out if `direct` and `indirect` are both given. A fourth
        channel is alpha: radiance is premultiplied by it (associated alpha), and the result has it unchanged.
    normal : (H, W, 3) float32
        World-space unit shading normal; 0 where nothing was hit.
    depth : (H, W) float32
        View-space distance along the camera's axis in scene units, > 0; inf where nothing was hit.
    motion : (H, W, 2) or (H, W, 3) float32
        Previous minus current position in pixels, without sub-pixel jitter: ``p_prev = p + motion``. A third
        component is the expected previous depth minus the current depth, in scene units.
    albedo : (H, W, 3) float32, optional
        Linear, 0..1; 1 where absent.
    id : (H, W) uint32, optional
        Instance id; 0 where nothing was hit.
    emission : (H, W, 3) float32, optional
        Directly visible emission (a lamp, the sky), which `color` contains; it is not filtered.
    direct, indirect : (H, W, 3) float32, optional
        Reflected radiance, split into two signals that are filtered separately; give both or neither. With them,
        ``color = direct + indirect + emission``, and `color` is not read.
    diffuse, specular : (H, W, 3) float32, optional
        Reflected radiance, split by the lobe of the first surface: ``color = diffuse + specular + emission``. The
        denoiser does not use these and the next two fields; future filters will.
    roughness : (H, W) float32, optional
        Perceptual roughness of the first surface, 0 (mirror) to 1; 1 where nothing was hit.
    hit_distance : (H, W, 2) float32, optional
        Length of the ray from the first surface on along its diffuse and its specular lobe, in scene units; 0 where
        the lobe was not sampled, inf where the ray left the scene.
    """

    color: Any = None
    normal: Any = None
    depth: Any = None
    motion: Any = None
    albedo: Any = None
    id: Any = None
    emission: Any = None
    direct: Any = None
    indirect: Any = None
    diffuse: Any = None
    specular: Any = None
    roughness: Any = None
    hit_distance: Any = None

    @classmethod
    def of(cls, **fields: Any) -> Frame:
        """Make a frame from arrays of any library.

        Only numbers in lists are copied.

        Parameters
        ----------
        **fields
            Fields by name. Each is an object with ``__dlpack__`` in memory that the CPU reads (PyTorch, JAX), an object
            with ``__array__``, nested lists of numbers, a pyopencl Array, or ``(buffer, shape)`` with a pyopencl Buffer
            that begins with the array's elements, float32 (`id`: uint32) in C order. Fields of three channels may have
            a fourth, as in float4; it is left out, except for alpha of `color`. None means that a field is missing.

        Raises
        ------
        FrameError
            If a value is none of these, or is in memory of CUDA or of another GPU interface. `Denoiser.denoise` checks
            shapes and types.

        Examples
        --------
        >>> frame = Frame.of(color=torch_tensor, normal=(cl_buffer, (height, width, 4)), depth=rows, motion=array)
        """
        given = {name: as_array(name, value, element_type(name)) for name, value in fields.items() if value is not None}
        return cls(**{name: without_fourth(name, value) for name, value in given.items()})

    def present(self) -> dict[str, Any]:
        """Return the fields that were given, by name."""
        return {name: value for name, value in vars(self).items() if value is not None}

    @property
    def shape(self) -> Shape:
        """(height, width), read from `depth`."""
        self.check_presence()
        check_array("depth", self.depth)
        shape = self.depth.shape
        if len(shape) != 2:
            raise FrameError("depth", "an array of shape (H, W)", f"shape {shape}")
        return int(shape[0]), int(shape[1])

    @property
    def has_alpha(self) -> bool:
        """Whether `color` has alpha; then the result has it, too."""
        return self.color is not None and len(self.color.shape) == 3 and self.color.shape[2] == 4

    @property
    def picture_shape(self) -> tuple[int, int, int]:
        """The shape of the result: (height, width, 3), or 4 channels if `color` has alpha."""
        return (*self.shape, 4 if self.has_alpha else 3)

    def layer(self, name: str) -> Any:
        """Return the array that filters use by this name: a field, `color` without alpha, or only alpha, (H, W)."""
        if name == ALPHA:
            return self.color[..., 3]
        return self.color[..., :3] if name == "color" and self.has_alpha else getattr(self, name)

    def check(self, shape: Shape) -> None:
        """Raise `FrameError` unless all needed fields are there, and all have this (height, width) and a right type."""
        self.check_presence()
        for name, value in self.present().items():
            check_field(name, value, shape)

    def check_presence(self) -> None:
        """Raise `FrameError` if a required field, or one of a pair, is missing."""
        for name in REQUIRED:
            if getattr(self, name) is None:
                raise FrameError(name, "an array", "nothing")
        if (self.direct is None) != (self.indirect is None):
            missing = "direct" if self.direct is None else "indirect"
            raise FrameError(missing, "both of direct and indirect, or neither", "nothing")
        if self.color is None and self.direct is None:
            raise FrameError("color", "an array (or direct and indirect instead)", "nothing")


def check_field(name: str, value: Any, shape: Shape) -> None:
    """Raise `FrameError` unless `value` can be field `name` of a frame of this (height, width)."""
    check_array(name, value)
    counts = CHANNELS[name] + ((4,) if name == "color" else ())
    allowed = [shape + ((channels,) if channels else ()) for channels in counts]
    if tuple(value.shape) not in allowed:
        raise FrameError(name, "shape " + " or ".join(map(str, allowed)), f"shape {tuple(value.shape)}")
    kinds, wanted = ("ui", "integers (uint32)") if name == "id" else ("f", "floating point (float32)")
    if value.dtype.kind not in kinds:
        raise FrameError(name, wanted, f"dtype {value.dtype}")
    if name == "id" and value.dtype.itemsize > 4 and isinstance(value, np.ndarray):
        check_ids(value)


def element_type(name: str) -> type[np.float32] | type[np.uint32]:
    """Return the type of a field's elements as kernels read them."""
    return np.uint32 if name == "id" else np.float32


def without_fourth(name: str, value: UserArray) -> UserArray:
    """Return an array without a fourth channel that its field does not have."""
    padded = CHANNELS.get(name) == (3,) and name != "color" and len(value.shape) == 3 and value.shape[2] == 4
    return value[..., :3] if padded else value


def check_ids(value: np.ndarray) -> None:
    """Raise `FrameError` if an id does not fit into 32 bits: two might become the same. Negative ids are allowed."""
    for extreme in (int(value.min(initial=0)), int(value.max(initial=0))):
        if not -(2**31) <= extreme < 2**32:
            raise FrameError("id", f"ids in 0..{2**32 - 1}, which fit into 32 bits", str(extreme))


def check_array(name: str, value: Any) -> None:
    """Raise the error of `wrong` unless the denoiser can read or write arrays of the type of `value`."""
    if not isinstance(value, UserArray):
        raise wrong(name, "a numpy.ndarray or pyopencl.array.Array", type(value).__name__)


def wrong(name: str, expected: str, got: str) -> FrameError | ArgumentError:
    """Return the error for an array of the user: `FrameError` for a frame's field, else `ArgumentError`."""
    if name in (*CHANNELS, ALPHA):
        return FrameError(name, expected, got)
    return ArgumentError(f"denoise({name})", expected, got)


def extent(shape: Shape) -> str:
    """Return (height, width) as text, width first: 640x360."""
    height, width = shape
    return f"{width}x{height}"
