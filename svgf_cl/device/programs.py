"""Builds the kernels of one source file for one device, with its compile-time constants, and keeps the result.

A source is ``kernels/<name>.cl``. The shared headers are put in front of it here, on the host, because ``#include``
does not work on remote and offline devices. ``#line`` makes build logs show each file's name and line numbers.
Across processes, the cache of the driver (PoCL, NVIDIA) or of pyopencl keeps the binaries.
"""

from __future__ import annotations

import functools
import math
import numbers
import os
import re
import threading
import warnings
from collections.abc import Mapping
from importlib import resources

import pyopencl as cl

from svgf_cl.device.layout import HALO
from svgf_cl.errors import DeviceError
from svgf_cl.filters.formats import HALF_MAX, SNORM_MAX
from svgf_cl.frame import LUMINANCE

HEADERS = (
    "vectors.clh",
    "layout.clh",
    "gathers.clh",
    "storage.clh",
    "light.clh",
    "albedo.clh",
    "interleaved.clh",
    "surface.clh",
)
# Headers that only some sources need. In the others, their macros would cause needless compilations.
MORE_HEADERS: Mapping[str, tuple[str, ...]] = {
    "temporal": ("motion.clh", "reprojection.clh"),
    "atrous": ("noise.clh",),
    "bilateral": ("noise.clh", "features.clh"),
    "network": ("noise.clh", "features.clh"),
    "predict": ("motion.clh", "reprojection.clh", "innovation.clh"),
    "taa": ("motion.clh",),
    "modulate": ("divisor.clh",),
    "confidence": ("divisor.clh",),
    "change": ("innovation.clh", "significance.clh"),
    "update": ("innovation.clh", "significance.clh"),
}
# Sources that depend neither on the layout nor on the vector width.
WITHOUT_HEADERS = ("strided_copy",)

# No fast-math: it would allow the compiler to drop the guards against NaN and infinity. Denormal numbers are slow, and
# only weights too small to matter are denormal: without them an a-trous level takes a seventh less time on traced
# frames.
OPTIONS = ("-cl-std=CL1.2", "-cl-mad-enable", "-cl-denorms-are-zero", "-w")

# If pyopencl's cache of binaries is damaged, pyopencl reads this variable. If it is empty, pyopencl warns and builds
# from source; if it is not set, pyopencl fails.
os.environ.setdefault("PYOPENCL_CACHE_FAILURE_FATAL", "")

Define = int | float | str

# Constants that kernels and host share, the same for all filters.
CONSTANTS: Mapping[str, Define] = {
    "HALO": HALO,
    "FLOAT16_MAX": HALF_MAX,
    "SNORM_MAX": float(SNORM_MAX),
    "LUMINANCE_RED": LUMINANCE[0],
    "LUMINANCE_GREEN": LUMINANCE[1],
    "LUMINANCE_BLUE": LUMINANCE[2],
}

_lock = threading.Lock()


def names() -> list[str]:
    """Return the names of all source files, sorted."""
    files = resources.files("svgf_cl.kernels").iterdir()
    return sorted(file.name.removesuffix(".cl") for file in files if file.name.endswith(".cl"))


@functools.cache
def source(name: str) -> str:
    """Return the text that is compiled for a source file: the headers, then the file itself."""
    kernels = resources.files("svgf_cl.kernels")
    headers = () if name in WITHOUT_HEADERS else (*HEADERS, *MORE_HEADERS.get(name, ()))
    files = (*headers, f"{name}.cl")
    return "\n".join(f'#line 1 "{file}"\n{(kernels / file).read_text(encoding="utf-8")}' for file in files)


def options(defines: Mapping[str, Define]) -> tuple[str, ...]:
    """Return the compiler's options for a set of macros, sorted by name."""
    return OPTIONS + tuple(f"-D{name}={_literal(value)}" for name, value in sorted(defines.items()))


def build(context: cl.Context, device: cl.Device, name: str, defines: Mapping[str, Define]) -> cl.Program:
    """Build a source file for a device, or return it from memory if it was built before.

    Parameters
    ----------
    context : pyopencl.Context
    device : pyopencl.Device
        One of the context's devices.
    name : str
        A file in ``kernels/``, without its suffix.
    defines : mapping of str to number or str
        Macros. A float becomes a single precision literal; a string is passed as it is.

    Raises
    ------
    DeviceError
        If the source does not compile. The message has the device, the driver, the file, the options and the log.
    """
    with _lock:
        return _build(context, device, name, options_of(name, defines))


def options_of(name: str, defines: Mapping[str, Define]) -> tuple[str, ...]:
    """Return the compiler's options for a source file, with its `macros`."""
    return options(macros(name, defines))


def macros(name: str, defines: Mapping[str, Define]) -> dict[str, str]:
    """Return the text of each macro of a source file: those of `CONSTANTS` and `defines` that the file mentions."""
    return {macro: _literal(value) for macro, value in mentioned(name, {**CONSTANTS, **defines}).items()}


@functools.lru_cache(maxsize=64)
def words(text: str) -> frozenset[str]:
    """Return the words of a source's code, without its comments."""
    return frozenset(re.findall(r"\w+", re.sub(r"//.*", "", text)))


def mentioned(name: str, defines: Mapping[str, Define]) -> dict[str, Define]:
    """Return the macros that a source file mentions; any other would only cause another compilation.

    A macro ``X_CHANNELS`` counts as mentioned if ``X`` is, because the kernels' `PLANE` builds its name from ``X``.
    """
    known = words(source(name))
    return {macro: value for macro, value in defines.items() if macro.removesuffix("_CHANNELS") in known}


@functools.lru_cache(maxsize=256)
def _build(context: cl.Context, device: cl.Device, name: str, flags: tuple[str, ...]) -> cl.Program:
    try:
        with warnings.catch_warnings():
            # Drivers write to their log even on success. pyopencl's own variable shows it.
            if not os.environ.get("PYOPENCL_COMPILER_OUTPUT"):
                warnings.simplefilter("ignore", cl.CompilerWarning)
            program: cl.Program = cl.Program(context, source(name)).build(options=list(flags), devices=[device])
            return program
    except cl.Error as error:
        raise DeviceError(
            f"{name}.cl does not build on this device\n"
            f"device:  {device.name} ({device.platform.name})\n"
            f"driver:  {device.driver_version}\n"
            f"options: {' '.join(flags)}\n"
            f"log:\n{_log(str(error))}"
        ) from error


def _log(message: str) -> str:
    # pyopencl puts devices and options around the compiler's log; a message without them is shown whole.
    log = message.partition(">:\n\n")[2] or message
    return log.partition("\n(options: ")[0].strip()


def _literal(value: Define) -> str:
    if isinstance(value, str):
        if not value or any(character.isspace() for character in value):
            raise ValueError(f"a macro's text must not be empty or contain spaces, got {value!r}")
        return value
    if isinstance(value, numbers.Integral):  # NumPy's integers too
        return str(int(value))
    if not math.isfinite(value):
        raise ValueError(f"a macro must be a finite number, got {value}")
    return f"{float(value)!r}f"
