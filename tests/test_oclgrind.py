"""What Oclgrind finds in a kernel fails the test that ran it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pyopencl as cl
import pytest

from svgf_cl.device.devices import SIMULATOR
from tests.oclgrind import findings

ROOT = Path(__file__).parents[1]

# A test as any other: four work-items, and two buffers of as many numbers, of which the host has written the first.
TEST = """
import numpy as np
import pyopencl as cl
from svgf_cl.device import devices

def test_kernel(queue=devices.default_queue()):
    a, b = (cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 16) for _ in range(2))
    cl.enqueue_copy(queue, a, np.ones(4, np.float32))
    source = "kernel void f(global float *a, global float *b) {{ int i = get_global_id(0); {} }}"
    cl.Kernel(cl.Program(queue.context, source).build(), "f")(queue, (4,), (4,), a, b)
    queue.finish()
"""


@pytest.mark.parametrize(
    ("code", "finding"),
    [
        ("b[i] = 2 * a[i];", ""),
        ("a[i] = a[i ^ 1];", "data race"),
        ("a[0] = 1;", "data race"),
        ("a[i] = b[i] > 0 ? 1 : 2;", "Uninitialized value"),
        ("b[i] = a[i + 1];", "Invalid read"),
        ("b[i - 1] = a[i];", "Invalid write"),
    ],
    ids=["right", "race of a read", "race of equal values", "uninitialised", "read outside", "write outside"],
)
def test_a_wrong_kernel_fails_its_test(code: str, finding: str, queue: cl.CommandQueue, tmp_path: Path) -> None:
    if queue.device.platform.name != SIMULATOR:
        pytest.skip("on Oclgrind alone; make test-all runs it there")
    (tmp_path / "test_kernel.py").write_text(TEST.format(code))
    command = [sys.executable, "-m", "pytest", "-p", "tests.oclgrind", "--rootdir", tmp_path, tmp_path]
    child = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert (child.returncode, finding in child.stdout) == (int(bool(finding)), True), child.stdout


def test_findings_among_other_lines() -> None:
    log = """a.py:3: UserWarning: Unrelated
  warn("unrelated")
\nInvalid read of size 4 at global memory address 0x1
\tKernel: f
\t
Oclgrind - OpenCL runtime error detected
\tFunction: clGetDeviceInfo
\tError:    CL_INVALID_VALUE
Oclgrind - OpenCL runtime error detected
\tFunction: clSetKernelArg
"""
    assert [found.splitlines()[-1].strip() for found in findings(log)] == ["", "Function: clSetKernelArg"]
