"""Errors for users. Every message says what was expected, what was found, and what to do next."""

LONGEST_SHOWN = 80  # characters of a wrong value in a message


class SvgfError(ValueError):
    """Base of every error that svgf_cl and its tracer raise on purpose; the command line prints it and exits with 2."""


class FrameError(SvgfError):
    """A frame's field is missing, or has the wrong shape or type."""

    def __init__(self, field: str, expected: str, got: str) -> None:
        super().__init__(field, expected, got)  # unchanged, because another process makes the error again from them
        self.field = field

    def __str__(self) -> str:
        return "Frame.{}: expected {}, got {}".format(*self.args)


class ArgumentError(SvgfError):
    """An argument of a call that is no field is wrong, such as the array for the result, or events to wait for."""

    def __init__(self, argument: str, expected: str, got: str) -> None:
        super().__init__(argument, expected, got)

    def __str__(self) -> str:
        return "{}: expected {}, got {}".format(*self.args)


class SettingsError(SvgfError):
    """A setting is out of its range."""


class DeviceError(SvgfError):
    """No OpenCL device works, or the one in use cannot build a kernel, has too little memory, or failed."""


class FileError(SvgfError):
    """A file is missing, cannot be read or written, or does not match the others."""


class SchedulerError(SvgfError):
    """No Dask scheduler answers, it has no worker, or its workers cannot do the work."""


def install_extra(extra: str) -> str:
    """Return, for a message, the command that installs the packages of an extra; it works in any environment."""
    return f"pip install 'svgf-cl[{extra}]'"


def one_line(message: object) -> str:
    """Return a message without line breaks, because our errors have one line."""
    return " ".join(str(message).split())


def shown(value: object) -> str:
    """Return a value as text for a message: on one line, and shortened. It works even if the value has no text."""
    try:
        text = one_line(repr(value))
    except Exception:  # for example a whole number of 5000 digits
        return f"one of type {type(value).__name__} that cannot be shown"
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."
