"""Devices: finding them, building kernels for them, laying out and binding memory."""
