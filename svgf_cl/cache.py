"""Where svgf_cl keeps what it learnt about this machine, and how it writes there: whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import platformdirs


def cache_dir() -> Path:
    """Return the platform's per-user cache directory of svgf_cl; it need not exist."""
    return platformdirs.user_cache_path("svgf_cl", appauthor=False)


def write_whole(path: Path, text: str) -> None:
    """Write a file so that a reader, or a crash half-way, sees the old text or the new one and nothing between."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise
