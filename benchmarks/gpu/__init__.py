"""Measures everything on a GPU in one run, and computes what is possible on GPUs at best. See docs/gpu.md."""
