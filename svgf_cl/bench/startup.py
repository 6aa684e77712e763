"""Times new processes from `import svgf_cl` to the first denoised frame, with empty caches and with full ones."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from svgf_cl.device.devices import VARIABLE, DeviceReport
from svgf_cl.errors import DeviceError
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Shape

WARM_STARTS = 3

FIRST_FRAME = """
import json, sys, time
begin = time.perf_counter()
import numpy as np
from svgf_cl import Denoiser, Frame
from svgf_cl.filters import FILTERS
shape = int(sys.argv[1]), int(sys.argv[2])
settings = FILTERS[sys.argv[3]](**json.loads(sys.argv[4]))
color, depth, motion = np.ones((*shape, 3), np.float32), np.ones(shape, np.float32), np.zeros((*shape, 3), np.float32)
frame = Frame(color=color, albedo=color, normal=color, depth=depth, motion=motion, id=np.ones(shape, np.uint32))
Denoiser(shape, settings=settings).denoise(frame)
print(time.perf_counter() - begin)
"""


def first_frames(report: DeviceReport, shape: Shape, settings: Filter) -> tuple[float, list[float]]:
    """Return the seconds to the first frame with empty compiler caches, and then with the caches that this filled."""
    with tempfile.TemporaryDirectory(prefix="svgf_cl-bench-") as folder:
        cold = first_frame(report, shape, settings, Path(folder))
        return cold, [first_frame(report, shape, settings, Path(folder)) for _ in range(WARM_STARTS)]


def first_frame(report: DeviceReport, shape: Shape, settings: Filter, caches: Path) -> float:
    """Return the seconds in a new process that keeps its caches in a folder; raise `DeviceError` if it fails."""
    # pyopencl's cache and this library's follow the first variable; each driver has its own.
    variables = ("XDG_CACHE_HOME", "POCL_CACHE_DIR", "CUDA_CACHE_PATH", "NEO_CACHE_DIR", "MESA_SHADER_CACHE_DIR")
    environment = os.environ | {name: str(caches) for name in variables} | {VARIABLE: report.selector}
    command = [sys.executable, "-c", FIRST_FRAME, *map(str, shape), settings.name, json.dumps(asdict(settings))]
    child = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if child.returncode:
        raise DeviceError(f"{report}: a new process could not denoise a frame:\n{child.stderr}")
    return float(child.stdout.splitlines()[-1])
