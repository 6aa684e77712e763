"""The benchmark: times every kernel and the whole frame on every working device.

It also measures the device's limits and the filter's error. `cases` lists and names what is timed, `suite` runs it, and
`rig` times one denoiser. `cost` counts the bytes and operations of a kernel from its equation, `ceilings` measures the
device's limits, and `roofline` compares the two. `results` stores all of it as JSON; `compare` and `report` show it.
docs/benchmarks.md says how to read the results.
"""

from svgf_cl.bench.error import error_to_oracle

__all__ = ["error_to_oracle"]
