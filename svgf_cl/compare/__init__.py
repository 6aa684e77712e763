"""Measures how far pictures are from their references."""
