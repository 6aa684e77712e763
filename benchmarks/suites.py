"""Which tests run on an OpenCL implementation, as arguments of pytest."""

from __future__ import annotations

# The kernels once more, on path-traced frames.
TRACED = "tests/tracer/test_kernels_on_traced.py"
# All that touches a device; the rest is the same everywhere.
ON_A_DEVICE = (
    "tests/kernels",
    "tests/hard",
    TRACED,
    "tests/tracer/hard",
    "tests/svgf_cl/test_denoiser.py",
    *(f"tests/svgf_cl/device/test_{name}.py" for name in ("array_checks", "probe", "programs", "svm", "tuning")),
    "tests/svgf_cl/filters/test_stages.py",
    "tests/svgf_cl/oracle/test_accuracy.py",
)
# The kernels in all their variants.
VARIANTS = ("tests/kernels", "tests/hard/test_variants.py", "-k", "follows_the_oracle or oclgrind")
KERNELS = (TRACED, *VARIANTS)
SUITES = {
    "PoCL": ("tests",),
    # A simulator takes a millisecond and more for every pixel of a frame, and traced ones have many.
    "Oclgrind": ("-p", "tests.oclgrind", "tests/test_oclgrind.py", *VARIANTS),
}
# It has 2 GiB of memory, and takes minutes for 10 000 frames.
LEFT_OUT = {"rusticl": ("-k", "not 8k_follows and not 10000_frames")}


def suite(name: str, *, brief: bool) -> tuple[str, ...]:
    """What pytest is to run on an implementation."""
    return SUITES.get(name) or (KERNELS if brief else (*ON_A_DEVICE, *LEFT_OUT.get(name, ())))
