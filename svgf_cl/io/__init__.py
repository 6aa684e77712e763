"""Reads and writes files: frames, pictures, and the cache on this machine."""
