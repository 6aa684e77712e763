"""Compiles the kernels for GPUs and checks limits, on machines without a GPU."""
