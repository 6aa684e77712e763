"""Finds OpenCL devices, builds kernels for them, and lays out and binds their memory."""
