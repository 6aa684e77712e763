"""Collects what a picture shows differently from a model's file."""

from __future__ import annotations

import warnings
from collections import Counter, defaultdict
from pathlib import Path

# The most names in one line; a file may refer to thousands of missing things.
MOST_NAMES = 8


class Losses:
    """Collects losses by kind, and reports each kind in one line."""

    def __init__(self) -> None:
        self._kinds: dict[str, Counter[str]] = defaultdict(Counter)

    def add(self, kind: str, what: str, times: int = 1) -> None:
        """Note that `what` was lost in the way that `kind` describes."""
        self._kinds[kind][what] += times

    def warn(self, path: Path) -> None:
        """Warn about the file at `path`: one warning for each kind, with what was lost and how often."""
        for kind, counts in self._kinds.items():
            names = [what if times == 1 else f"{what} ({times} times)" for what, times in counts.items()]
            more = [f"{len(names) - MOST_NAMES} more"] if len(names) > MOST_NAMES else []
            warnings.warn(f"{path}: {kind}: {', '.join(names[:MOST_NAMES] + more)}", stacklevel=3)
