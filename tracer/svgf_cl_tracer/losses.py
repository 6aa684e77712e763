"""What of a model's file is not shown, or not as the file has it."""

from __future__ import annotations

import warnings
from collections import Counter, defaultdict
from pathlib import Path

# Names in one line; a file may hold thousands that are not there.
MOST_NAMES = 8


class Losses:
    """Collects losses by their kind, and says each kind in one line."""

    def __init__(self) -> None:
        self._kinds: dict[str, Counter[str]] = defaultdict(Counter)

    def add(self, kind: str, what: str, times: int = 1) -> None:
        """Note that `what` was lost in a way that `kind` describes."""
        self._kinds[kind][what] += times

    def warn(self, path: Path) -> None:
        """Warn about the file at `path`: a warning a kind, with what was lost and how often."""
        for kind, counts in self._kinds.items():
            names = [what if times == 1 else f"{what} ({times} times)" for what, times in counts.items()]
            more = [f"{len(names) - MOST_NAMES} more"] if len(names) > MOST_NAMES else []
            warnings.warn(f"{path}: {kind}: {', '.join(names[:MOST_NAMES] + more)}", stacklevel=3)
