"""The tests for each OpenCL implementation, as arguments of pytest."""

from __future__ import annotations

# worksteal: tests of one file stay together, because each process makes for itself what they share, such as a compiled
# kernel or a rendered scene. `make test` has the same options.
PARALLEL = ("-n", "auto", "--maxprocesses", "8", "--dist", "worksteal")

# The same tests of kernels, on path-traced frames.
TRACED = "tests/tracer/test_kernels_on_traced.py"
# All tests that use a device; other tests have the same result everywhere.
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
# Tests of all variants of the kernels.
VARIANTS = ("tests/kernels", "tests/hard/test_variants.py", "-k", "follows_the_oracle or oclgrind")
KERNELS = (TRACED, *VARIANTS)
SUITES = {
    "PoCL": ("tests",),
    # A simulator takes a millisecond or more for each pixel, and traced frames have many pixels.
    "Oclgrind": ("-p", "tests.oclgrind", "tests/test_oclgrind.py", *VARIANTS),
}
# It has 2 GiB of memory, and would take minutes for 10 000 frames.
LEFT_OUT = {"rusticl": ("-k", "not 8k_follows and not 10000_frames")}


def suite(name: str, *, brief: bool) -> tuple[str, ...]:
    """The arguments of pytest for an implementation."""
    return SUITES.get(name) or (KERNELS if brief else (*ON_A_DEVICE, *LEFT_OUT.get(name, ())))
