"""The tracer's benchmark: a frame compared with raw Embree, the split of its time, memory, start, noise.

`recording` records the queries to Embree and the calls of the shading loop in one frame. `rounds` times the frame and
the same rays in raw Embree. `split` divides the frame's CPU time. `fresh` starts new processes. `noise` measures the
error. `suite` runs everything; `tables` and `picture` show the results. docs/benchmarks.md explains them.
"""
