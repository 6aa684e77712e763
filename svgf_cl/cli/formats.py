"""``svgf-cl formats``: lists the supported renderers, and the passes from which each field is read."""

from __future__ import annotations

from svgf_cl.cli.console import show
from svgf_cl.io.readers import READERS
from svgf_cl.io.readers.reader import Reader


def formats() -> None:
    """List the renderers whose frames are read, and their passes.

    A file shows which renderer wrote it; if it does not, use --format NAME with denoise and check. Upper case, spaces
    and punctuation in the names of passes do not matter. Read the passes of any other renderer with --map FIELD=PASS.

    \b
    Examples:
      svgf-cl formats
      svgf-cl denoise shot -o out --format arnold --map albedo=diffuse_color
    """
    rows = [
        (reader.name, reader.title if not index else "", field, passes, reader.switches.get(field, ""))
        for reader in READERS.values()
        for index, (field, passes) in enumerate(sources(reader))
    ]
    show(
        "frames of these renderers are read", ("format", "renderer", "field", "passes", "how to have it"), rows, words=5
    )


def sources(reader: Reader) -> list[tuple[str, str]]:
    """Return each field with the passes from which it is read, the best first, and the light passes."""
    fields = [
        (field, ", ".join(name or "R G B" for candidate in candidates for name in candidate.names))
        for field, candidates in reader.passes.items()
    ]
    lights = [name for light in reader.lights for name in light.names]
    return [*fields, *([("light passes", ", ".join(lights))] if lights else [])]
