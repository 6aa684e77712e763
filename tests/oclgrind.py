"""A pytest plugin for runs on Oclgrind (``-p tests.oclgrind``): what the simulator finds in a test fails the test.

It looks for reads and writes out of bounds, reads of uninitialised memory, data races, and wrong calls of OpenCL.
"""

from __future__ import annotations

import os
import re
from collections.abc import Generator, Iterator
from typing import Any

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import Tuning
from svgf_cl.device import tuning, user_arrays

CHECKS = ("OCLGRIND_DATA_RACES", "OCLGRIND_UNIFORM_WRITES", "OCLGRIND_UNINITIALIZED", "OCLGRIND_CHECK_API")
os.environ.update(dict.fromkeys(CHECKS, "1"))

# Oclgrind writes a line, and under it lines that a tab begins.
FINDING = re.compile(r"^\S.*\n(?:\t.*\n)+", re.MULTILINE)
# pyopencl asks every device for what only OpenCL 2 has, and takes the error for a no.
QUESTION = "Function: clGetDeviceInfo"


def findings(log: str) -> list[str]:
    """What Oclgrind found, from all that was written to the standard error."""
    return [found for found in FINDING.findall(log) if QUESTION not in found]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if found := findings(report.capstderr):
        report.outcome = "failed"
        report.longrepr = f"Oclgrind: {len(found)} findings, the first:\n{found[0]}"
    return report


@pytest.fixture(scope="session", autouse=True)
def worked_round() -> Iterator[None]:
    """Keep to what Oclgrind 21.10 follows: of what the host does to memory, writes alone, no fill and no use in place.

    Vectors are of 4 pixels where a test does not say, which takes half the time of single ones. Of 16 they cannot be:
    it takes any permutation of 16 values for uninitialised.
    """

    def fill(queue: cl.CommandQueue, buffer: cl.Buffer, value: Any, offset: int, nbytes: int) -> cl.Event:
        values = np.full(nbytes // value.itemsize, value)
        return cl.enqueue_copy(queue, buffer, values, dst_offset=offset, is_blocking=True)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cl, "enqueue_fill_buffer", fill)
        patch.setattr(user_arrays, "shares_memory", lambda device: False)
        patch.setattr(tuning, "default_tuning", lambda device: Tuning(vector_width=4, work_group=(8, 1)))
        yield
