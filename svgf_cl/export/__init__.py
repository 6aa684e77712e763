"""Writes plans: files from which a host in another language can denoise without Python. The format: docs/export.md."""
