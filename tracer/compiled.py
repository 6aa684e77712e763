"""How the tracer's inner loops are compiled: by Numba, at their first call, kept on disk for the next process."""

from __future__ import annotations

import glob
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core.caching import IndexDataCacheFile

from svgf_cl.cache import cache_folder
from svgf_cl.files import written_whole

Function = TypeVar("Function", bound=Callable[..., object])


def _digest() -> str:
    """Names the state of the tracer's sources: what one function compiles to hangs on all those that it calls."""
    sources = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        sources.update(source.read_bytes())
    return sources.hexdigest()[:16]


class Sealed(IndexDataCacheFile):
    """The files in which Numba keeps a compiled function, under a checksum.

    Without one, Numba fails on files that are damaged, or runs what they hold. With it they are made again.
    """

    def load(self, key: object) -> object:
        """What was kept under `key`; None where there is nothing, or something is damaged."""
        if Path(self._index_path).exists() and not self._is_whole():
            self.flush()  # type: ignore[no-untyped-call]
        return super().load(key)  # type: ignore[no-untyped-call]

    def save(self, key: object, data: object) -> None:
        """Keep `data` under `key`."""
        super().save(key, data)  # type: ignore[no-untyped-call]
        with written_whole(self._seal) as aside:
            aside.write_bytes(self._checksum())

    @property
    def _seal(self) -> Path:
        return Path(self._index_path).with_suffix(".sha256")

    def _is_whole(self) -> bool:
        return self._seal.exists() and self._seal.read_bytes() == self._checksum()

    def _checksum(self) -> bytes:
        index = Path(self._index_path)
        checksum = hashlib.sha256(index.read_bytes())
        for data in sorted(index.parent.glob(f"{glob.escape(index.stem)}.*.nbc")):
            checksum.update(data.read_bytes())
        return checksum.digest()


FOLDER = cache_folder() / "compiled" / _digest()


OPTIONS: dict[str, Any] = {
    "nogil": True,
    "cache": True,
    "error_model": "numpy",
    "forceinline": True,
    "_nrt": False,
    "fastmath": {"arcp", "nsz"},
}


def compiled(function: Function) -> Function:
    """Compile `function` to machine code that lets other threads run; it must not allocate arrays.

    It is inlined wherever another compiled function calls it: a scene's tables, hundreds of words, would be copied at
    each call. Without allocation no array needs its references counted, which took most of the time. Arithmetic
    follows IEEE 754 as written, but a quotient may be the product with a reciprocal, and the sign of zero is not kept:
    a picture is the same with any number of threads.
    """
    others = vars(numba.config)["CACHE_DIR"]
    vars(numba.config)["CACHE_DIR"] = str(FOLDER)
    try:
        result: Any = numba.njit(function, **OPTIONS)
    finally:
        vars(numba.config)["CACHE_DIR"] = others
    kept = result._cache
    place = (kept._cache_path, kept._impl.filename_base, kept._impl.locator.get_source_stamp())
    kept._cache_file = Sealed(*place)  # type: ignore[no-untyped-call]
    return cast(Function, result)


def was_compiled() -> bool:
    """Whether a process before this one has compiled anything: if not, the first picture takes some twenty seconds."""
    return any(FOLDER.rglob("*.nbi"))
