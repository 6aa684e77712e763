"""Errors for users. Every message says what was expected, what was found, and what to do next."""

LONGEST_SHOWN = 80  # characters of a wrong value that a message repeats


class SvgfError(ValueError):
    """Base of every error that svgf_cl and its tracer raise on purpose; the command line prints it and exits with 2."""


class FrameError(SvgfError):
    """A frame's field is missing, of the wrong shape or of the wrong type."""

    def __init__(self, field: str, expected: str, got: str) -> None:
        super().__init__(field, expected, got)  # as they are: another process makes it anew from them
        self.field = field

    def __str__(self) -> str:
        return "Frame.{}: expected {}, got {}".format(*self.args)


class ArgumentError(SvgfError):
    """An argument of a call is wrong that is not a field: the array for the result, or events to wait for."""

    def __init__(self, argument: str, expected: str, got: str) -> None:
        super().__init__(argument, expected, got)

    def __str__(self) -> str:
        return "{}: expected {}, got {}".format(*self.args)


class SettingsError(SvgfError):
    """A setting is out of its range."""


class DeviceError(SvgfError):
    """No OpenCL device works, or the one in use cannot build a kernel, has too little memory, or failed."""


class FileError(SvgfError):
    """A file is missing, unreadable, cannot be written, or does not fit the others."""


class SchedulerError(SvgfError):
    """No Dask scheduler answers, it has no worker, or its workers cannot do the work."""


def install_extra(extra: str) -> str:
    """The command that installs what an optional part of svgf_cl needs, for a message; it works in any environment."""
    return f"pip install 'svgf-cl[{extra}]'"


def one_line(message: object) -> str:
    """`message` without its line breaks, because our errors are one line."""
    return " ".join(str(message).split())


def shown(value: object) -> str:
    """A value for a message: on one line, shortened, and also if it has no text of its own."""
    try:
        text = one_line(repr(value))
    except Exception:  # a whole number of 5000 digits, say
        return f"one of type {type(value).__name__} that cannot be shown"
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."
