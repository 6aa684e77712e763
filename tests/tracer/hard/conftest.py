"""The hard cases' fixtures, for those that are path traced."""

from __future__ import annotations

from tests.hard.conftest import variant

__all__ = ["variant"]
