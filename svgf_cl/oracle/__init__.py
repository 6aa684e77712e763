"""Filters restated in float64 NumPy, one file each: what kernels are held against."""
