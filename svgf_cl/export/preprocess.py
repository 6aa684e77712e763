"""Expands the macros of kernels, so that the files that are written need no macros."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from svgf_cl.errors import SvgfError, install_extra

if TYPE_CHECKING:
    from pcpp import Preprocessor


def preprocessed(source: str, macros: Mapping[str, str]) -> str:
    """Expand the macros of a source and evaluate its conditions, so that it can be compiled without -D options.

    Pragmas stay. Conditions that only the device's compiler can evaluate stay, too, such as ``__OPENCL_VERSION__`` and
    ``cl_khr_fp16``.

    Parameters
    ----------
    source : str
    macros : mapping of str to str
        The value of each macro that is set from outside.

    Raises
    ------
    SvgfError
        If the package pcpp is missing.
    ValueError
        If a directive is wrong, or a condition uses a macro that is not defined.
    """
    preprocessor = _preprocessor()
    for name, text in macros.items():
        preprocessor.define(f"{name} {text}")
    preprocessor.parse(source)
    written = io.StringIO()
    preprocessor.write(written)
    lines = (line.rstrip() for line in written.getvalue().splitlines())
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip() + "\n"


def check_preprocessor() -> None:
    """Raise `SvgfError` where the package pcpp is missing."""
    _preprocessor()


def _preprocessor() -> Preprocessor:
    """A strict preprocessor: anything that it does not understand is an error."""
    try:
        from pcpp import Preprocessor
    except ImportError as error:
        raise SvgfError(f"export needs pcpp ({error}): {install_extra('export')}") from error

    class Strict(Preprocessor):  # type: ignore[misc]  # pcpp has no types
        def on_error(self, file: str, line: int, message: str) -> None:
            raise ValueError(f"line {line}: {message}")

        def on_unknown_macro_in_defined_expr(self, token: Any) -> bool | None:
            return None if is_compilers(token.value) else False

        def on_unknown_macro_in_expr(self, name: str) -> int | None:
            if is_compilers(name):
                return None
            raise ValueError(f"expected a value for the macro {name}, got none")

        def on_directive_unknown(self, directive: Any, tokens: Any, *state: Any) -> bool | None:
            if directive.value == "error":
                raise ValueError(f"#error {''.join(token.value for token in tokens)}")
            return True if directive.value == "line" else None  # line numbers are those of the written file

    preprocessor = Strict()
    preprocessor.line_directive = None
    return preprocessor


def is_compilers(macro: str) -> bool:
    """Whether the compiler defines a macro itself: a macro of the language or of an extension."""
    return macro.startswith("__") or macro.lower().startswith("cl_")
