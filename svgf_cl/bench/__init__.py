"""The benchmark: every kernel and the whole frame, on every working device, beside the device's ceilings and the error.

`suite` says what is timed, under which name, and runs it; `rig` times one denoiser; `cost` counts bytes and operations
of a kernel from its equation, `ceilings` measures what the device can do, `roofline` sets one against the other;
`results` keeps it all as JSON, `compare` and `report` show it. How to read it: docs/benchmarks.md.
"""

from svgf_cl.bench.error import error_to_oracle

__all__ = ["error_to_oracle"]
