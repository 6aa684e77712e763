"""The tracer in a new process: the time until the first frame, and the memory.

Run as a module, this is that process; it prints its results as JSON.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import psutil

from benchmarks.tracing.watching import watched
from svgf_cl.errors import SvgfError
from svgf_cl.frame import Shape

STARTS = 4  # in the first one, nothing is compiled yet

SMALL = (16, 16)  # a first frame so small that rendering it takes no time

STATUS = Path("/proc/self/status")


@dataclass(frozen=True)
class Fresh:
    """The results of a new process.

    Parameters
    ----------
    load : float
        Seconds from the scene's name to the scene with its trees.
    trees : float
        Seconds of `load` in which Embree built the trees.
    first : float
        Seconds for a first frame that is tiny, so this is the time for compiling or for loading compiled code.
    libraries, scene : int
        Bytes in use before the scene was loaded, and additional bytes afterwards.
    peak : int
        The peak memory in bytes, including a frame of full size.
    """

    load: float
    trees: float
    first: float
    libraries: int
    scene: int
    peak: int


def in_new_process(scene: str, shape: Shape, caches: Path) -> Fresh:
    """Load a scene and render frames in a new process that caches compiled code in the folder `caches`.

    Raises
    ------
    SvgfError
        If it fails.
    """
    environment = os.environ | {"XDG_CACHE_HOME": str(caches)}
    command = [sys.executable, "-m", __name__, scene, *map(str, shape)]
    child = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if child.returncode:
        raise SvgfError(f"{scene}: a new process could not render it:\n{child.stderr}")
    return Fresh(**json.loads(child.stdout))


def starts(scene: str, shape: Shape, advance: Callable[[], None]) -> list[Fresh]:
    """The results of a new process with an empty cache of compiled code, and of later ones; `advance` after each."""
    found = []
    with tempfile.TemporaryDirectory(prefix="svgf_cl-bench-") as folder:
        for _ in range(STARTS):
            found.append(in_new_process(scene, shape, Path(folder)))
            advance()
    return found


def find_out(name: str, shape: Shape) -> Fresh:
    """The results of this process, which must not have rendered before."""
    from svgf_cl_tracer import Shot, render_frame
    from svgf_cl_tracer.cli.scenes import open_scene
    from svgf_cl_tracer.trees import Tree

    building: list[float] = []

    def build(real: Callable[..., None], *arguments: Any, **options: Any) -> None:
        begin = time.perf_counter()
        real(*arguments, **options)
        building.append(time.perf_counter() - begin)

    process = psutil.Process()
    libraries = process.memory_info().rss
    begin = time.perf_counter()
    with watched(Tree, "__init__", build):
        scene = open_scene(name, None)
        scene.around(Shot(scene, SMALL).origin(0))  # builds the trees
    loaded = time.perf_counter()
    held = process.memory_info().rss - libraries
    render_frame(Shot(scene, SMALL), 0)
    first = time.perf_counter() - loaded
    render_frame(Shot(scene, shape), 0)
    return Fresh(loaded - begin, sum(building), first, libraries, held, peak_memory())


def peak_memory() -> int:
    """The peak memory of this process in bytes."""
    if STATUS.exists():  # Linux: getrusage would give a new process the peak of its parent
        (line,) = (line for line in STATUS.read_text().splitlines() if line.startswith("VmHWM:"))
        return 1024 * int(line.split()[1])
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


if __name__ == "__main__":
    print(json.dumps(asdict(find_out(sys.argv[1], (int(sys.argv[2]), int(sys.argv[3]))))))
