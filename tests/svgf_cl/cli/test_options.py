"""Texts of the command line become values of the right type."""

from __future__ import annotations

from svgf_cl import Settings
from svgf_cl.cli.options import parse_settings, settings_help


def test_settings_are_read_by_their_own_type() -> None:
    texts = ["iterations=3", "sigma_depth=2", "taa=on", "alpha_color=0"]
    assert parse_settings(texts) == Settings(iterations=3, sigma_depth=2.0, taa=True, alpha_color=0.0)
    assert parse_settings([]) == Settings()


def test_help_lists_every_setting() -> None:
    assert all(f"{name}: " in settings_help() for name in vars(Settings()))
