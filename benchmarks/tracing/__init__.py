"""The tracer's benchmark: a frame against raw Embree, where its time goes, memory, start, noise.

`recording` takes down what one frame asks of Embree and of the shading loop; `rounds` times the frame against those
same rays; `split` says what the frame's CPU time is spent on; `fresh` starts new processes; `noise` tells the error
beside the speed; `suite` runs it all, `tables` and `picture` show it. How to read it: docs/benchmarks.md.
"""
