"""Plans as files: what a host in another language needs to denoise, without Python. The format: docs/export.md."""
