"""Finds out whether a listed OpenCL device works, by building and running a tiny kernel on it.

A broken driver may crash or hang, so the kernel runs in a separate process. That takes a fraction of a second. The
answer is kept in the cache directory; its key contains everything that may change the answer. A crash or a hang is kept
only as long as this process lives, as the machine may have been busy.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Iterator

import numpy as np
import pyopencl as cl

from svgf_cl.device import apart
from svgf_cl.device.programs import OPTIONS
from svgf_cl.io.atomic import read_json, write_text
from svgf_cl.io.cache import cache_folder, device_key, keeping

# Part of the key of cached answers: increase it whenever the probe checks more.
VERSION = 1
STORE = "probes.json"

KERNEL = """
kernel void probe(global const float4 *in, global float4 *out, const float scale)
{
    const size_t i = get_global_id(0);
    out[i] = fma((float4)(scale), in[i], sqrt(in[i]));
}
"""


_heard: dict[str, str] = {}  # answers in this process, also crashes and those that cannot be written to the cache


def reason(device: cl.Device, *, refresh: bool = False) -> str:
    """Return why a device does not work, in one line; empty if it works.

    Parameters
    ----------
    device : pyopencl.Device
        Any listed device.
    refresh : bool
        Probe again if the cached answer says that the device does not work.

    Returns
    -------
    str
    """
    name = key(device)
    known = (_recall() | _heard).get(name)
    if known is None or (refresh and known):
        return _ask(name)
    return known


def key(device: cl.Device) -> str:
    """Return the key of a device, its driver and this probe; equal devices have the same key.

    Parameters
    ----------
    device : pyopencl.Device

    Returns
    -------
    str
    """
    return f"{device_key(device)} | probe {VERSION}"


def run(device: cl.Device) -> str:
    """Probe a device in this process; the result is like that of `reason`.

    Parameters
    ----------
    device : pyopencl.Device

    Returns
    -------
    str
    """
    numbers = np.arange(1, 65, dtype=np.float32)
    result = np.zeros_like(numbers)
    try:
        context = cl.Context([device])
        queue = cl.CommandQueue(context, properties=cl.command_queue_properties.PROFILING_ENABLE)
        program = cl.Program(context, KERNEL).build(options=list(OPTIONS))
        source = cl.Buffer(context, cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR, hostbuf=numbers)
        target = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, numbers.nbytes)
        program.probe(queue, (numbers.size // 4,), None, source, target, np.float32(3))
        cl.enqueue_copy(queue, result, target)
    except cl.Error as error:
        return apart.summary(str(error))
    if not np.allclose(result, 3 * numbers + np.sqrt(numbers), rtol=1e-6):
        return "computes wrong numbers"
    return ""


def _ask(name: str) -> str:
    try:
        _heard[name] = _run_apart(name)
    except apart.NoAnswerError as failure:
        _heard[name] = str(failure)
    else:
        _remember(_recall() | {name: _heard[name]})
    return _heard[name]


def _run_apart(wanted: str) -> str:
    environment = os.environ | {
        # Use the modules of this process, and none that happen to lie in the current folder.
        "PYTHONPATH": os.pathsep.join(path or os.curdir for path in sys.path),
        "PYTHONSAFEPATH": "1",
        # Do not use pyopencl's cache of binaries: the probe is to test the compiler.
        "PYOPENCL_NO_CACHE": "1",
    }
    return apart.ask([sys.executable, "-W", "ignore", "-m", "svgf_cl.device.probe", wanted], environment)


def _listed() -> Iterator[cl.Device]:
    for platform in cl.get_platforms():
        with contextlib.suppress(cl.Error):  # svgf_cl.device.devices reports it
            yield from platform.get_devices()


def _recall() -> dict[str, str]:
    try:
        known = read_json(cache_folder() / STORE)
    except (OSError, ValueError):
        return {}  # no such file, unreadable or damaged: probe the device
    entries = known.items() if isinstance(known, dict) else ()
    return {name: answer for name, answer in entries if isinstance(answer, str)}


def _remember(answers: dict[str, str]) -> None:
    with keeping():
        write_text(cache_folder() / STORE, json.dumps(answers, indent=1))


def _main(wanted: str) -> None:
    device = next((device for device in _listed() if key(device) == wanted), None)
    if device is None:
        sys.exit("the loader does not list the device in a separate process")
    print(f"\n{apart.answer(run(device))}", flush=True)


if __name__ == "__main__":
    _main(sys.argv[1])
