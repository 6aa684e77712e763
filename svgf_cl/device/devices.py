"""Lists all OpenCL devices, says which of them work, and chooses the one to use.

Not every listed device works, so only devices that passed the probe (`svgf_cl.device.probe`) are chosen.
"""

from __future__ import annotations

import functools
import os
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import pyopencl as cl

from svgf_cl.device import apart, driver_caches, icd_files, probe, registration
from svgf_cl.device.drivers import INTEL
from svgf_cl.device.process import check_process
from svgf_cl.errors import DeviceError, install_extra
from svgf_cl.io import cache

# When this module is imported, as `import svgf_cl` does: a loader reads the environment variables only once, when a
# program first lists the platforms.
driver_caches.do_without()
registration.register()

# pyopencl's own variable, so that it means the same in every program.
VARIABLE = "PYOPENCL_CTX"

POCL = "Portable Computing Language"

# CPU drivers, fastest first, in the order of docs/extending.md. On a CPU the driver's compiler decides the speed:
# all drivers report the same compute units, and Intel's reports a clock of 0.
CPU_PLATFORMS = (INTEL.platform, POCL)

# This simulator reports all device types at once. It is for finding bugs, and thousands of times slower than a driver.
SIMULATOR = "Oclgrind"

# How to install each driver. The key holds words that appear in the list of platforms if the driver is there already.
INSTALLATION = {
    ("pocl", POCL.lower()): "Debian, Ubuntu:       apt-get install pocl-opencl-icd",
    ("intel",): f"x86-64 Linux, no root: {install_extra('cpu')}",
    ("gpu",): "a GPU:                its vendor's driver with OpenCL",
}

_lock = threading.Lock()  # so that threads that make their first queue at the same time share one context


@dataclass(frozen=True)
class DeviceReport:
    """A device as its driver describes it, and whether it works.

    Attributes
    ----------
    selector : str
        The value of ``PYOPENCL_CTX`` that chooses this device: platform number, colon, device number.
    platform, version : str
        The OpenCL implementation.
    device, driver : str
        The device and its driver's version.
    kind : str
        ``GPU``, ``accelerator``, ``CPU``, ``simulator`` or ``other``.
    reason : str
        Why the device does not work; empty if it works.
    is_default : bool
        Whether `default_device` returns this device.
    handle : pyopencl.Device, optional
        The device itself; None if the driver could not list any.
    """

    selector: str
    platform: str
    version: str
    device: str
    driver: str
    kind: str
    reason: str
    is_default: bool = False
    handle: cl.Device | None = field(default=None, repr=False, compare=False)

    @property
    def works(self) -> bool:
        """Whether the device built and ran the probe."""
        return not self.reason

    def __str__(self) -> str:
        return f"{self.selector}  {self.device} ({self.platform}, {self.driver}): {self.reason or 'works'}"


def list_devices(*, refresh: bool = False) -> list[DeviceReport]:
    """Return every device of every platform, in the loader's order.

    Parameters
    ----------
    refresh : bool
        Probe the devices again that are cached as not working.

    Returns
    -------
    list of DeviceReport
        At most one has `is_default` set; none has it if `choose` raises an error.
    """
    check_process()
    reports = _survey(refresh=refresh)
    try:
        default = choose(reports)
    except DeviceError:
        return reports
    return [replace(report, is_default=report is default) for report in reports]


def choose(reports: Sequence[DeviceReport]) -> DeviceReport:
    """Return the report on the device that ``PYOPENCL_CTX`` names, else on the fastest working one.

    The order is: GPUs, accelerators, CPUs. Among GPUs, and among accelerators, discrete devices come before integrated
    ones, then the device with the most compute units times clock. CPU drivers come in the order of `CPU_PLATFORMS`.
    The loader's order breaks ties.

    Parameters
    ----------
    reports : sequence of DeviceReport
        The result of `list_devices`.

    Returns
    -------
    DeviceReport

    Raises
    ------
    DeviceError
        No device works, or ``PYOPENCL_CTX`` names none that does.
    """
    if working := [report for report in _candidates(reports) if report.works]:
        return min(working, key=_rank)
    if VARIABLE in os.environ and any(report.handle for report in reports):
        raise DeviceError(f"{VARIABLE}={os.environ[VARIABLE]!r} names a device that does not work")
    raise DeviceError(_what_to_do(reports))


def default_device() -> cl.Device:
    """Return the device that ``PYOPENCL_CTX`` names, else the fastest working one; see `choose`.

    Returns
    -------
    pyopencl.Device

    Raises
    ------
    DeviceError
        No device works, or ``PYOPENCL_CTX`` names none that does. The message lists every device's reason.
    """
    reports = _survey()
    try:
        if not any(report.works for report in _candidates(reports)):
            # Somebody may have repaired a driver or granted a permission since: probe again before giving up.
            reports = _survey(refresh=True)
        chosen = choose(reports)
    except DeviceError as error:
        raise DeviceError(f"{error}\nThe OpenCL loader lists:\n{_table(reports)}") from error
    assert chosen.handle is not None
    return chosen.handle


def default_queue() -> cl.CommandQueue:
    """Return a new queue, with profiling, on the default device; see `default_device`.

    Returns
    -------
    pyopencl.CommandQueue

    Raises
    ------
    DeviceError
        As `default_device`.
    """
    return create_queue(default_device())


def create_queue(device: cl.Device) -> cl.CommandQueue:
    """Return a new queue, with profiling, on a device. All queues made here for one device share one context.

    Parameters
    ----------
    device : pyopencl.Device

    Returns
    -------
    pyopencl.CommandQueue
    """
    check_process()
    with _lock:
        context = _context(device)
    return cl.CommandQueue(context, device, properties=cl.command_queue_properties.PROFILING_ENABLE)


@functools.cache
def _context(device: cl.Device) -> cl.Context:
    return cl.Context([device])


def _survey(*, refresh: bool = False) -> list[DeviceReport]:
    cache.tell()
    unusable = _unusable_drivers() if refresh else []
    reports = []
    platforms = _platforms()
    for index, platform in enumerate(platforms):
        try:
            devices = platform.get_devices()
        except cl.Error as error:
            reports.append(_unlisted(str(index), platform.name, apart.summary(str(error)), platform.version))
            continue
        if not devices:
            reports.append(_unlisted(str(index), platform.name, "the driver lists no device", platform.version))
        reports += [_report(f"{index}:{number}", device, refresh) for number, device in enumerate(devices)]
    listed = {platform.name for platform in platforms}
    reports += [_unlisted("-", driver.platform, reason) for driver, reason in registration.why_unlisted(listed)]
    return [*reports, *unusable]


def _unusable_drivers() -> list[DeviceReport]:
    """Return reports on the drivers that the loader skips; raise `DeviceError` if one would crash this process."""
    try:
        return [_unlisted("-", name, fault) for name, fault in icd_files.faults()]
    except apart.NoAnswerError as error:
        raise DeviceError(f"{error}; repair or remove that driver, or name others in {icd_files.VARIABLE}") from error


def _platforms() -> list[cl.Platform]:
    try:
        return list(cl.get_platforms())
    except cl.LogicError as error:
        if error.code == cl.status_code.PLATFORM_NOT_FOUND_KHR:
            return []
        raise


def _report(selector: str, device: cl.Device, refresh: bool) -> DeviceReport:
    return DeviceReport(
        selector=selector,
        platform=device.platform.name,
        version=device.platform.version,
        device=device.name,
        driver=device.driver_version,
        kind=_kind(device),
        reason=probe.reason(device, refresh=refresh),
        handle=device,
    )


def _unlisted(selector: str, platform: str, reason: str, version: str = "") -> DeviceReport:
    return DeviceReport(selector, platform, version, "no device", "unknown", "other", reason)


def _kind(device: cl.Device) -> str:
    if device.platform.name == SIMULATOR:
        return "simulator"
    types = {"GPU": cl.device_type.GPU, "accelerator": cl.device_type.ACCELERATOR, "CPU": cl.device_type.CPU}
    return next((kind for kind, bit in types.items() if device.type & bit), "other")


def _candidates(reports: Sequence[DeviceReport]) -> list[DeviceReport]:
    """Return the reports that `choose` may choose from: only the device that the user named, else all."""
    name = os.environ.get(VARIABLE)
    if name is None or not any(report.handle for report in reports):
        return list(reports)
    try:
        devices = cl.choose_devices(interactive=False, answers=name.split(":"))
    except (cl.Error, RuntimeError) as error:
        raise DeviceError(f"{VARIABLE}={name!r} names no device: {error}") from error
    if len(devices) != 1:
        raise DeviceError(f"{VARIABLE}={name!r} names {len(devices)} devices, expected one")
    return [report for report in reports if report.handle == devices[0]]


def _rank(report: DeviceReport) -> tuple[int, int, bool, int]:
    device = report.handle
    assert device is not None
    kind = ("GPU", "accelerator", "CPU", "other", "simulator").index(report.kind)
    if report.kind == "CPU":
        known = report.platform in CPU_PLATFORMS
        return kind, CPU_PLATFORMS.index(report.platform) if known else len(CPU_PLATFORMS), False, 0
    return kind, 0, device.host_unified_memory, -device.max_compute_units * device.max_clock_frequency


def _what_to_do(reports: Sequence[DeviceReport]) -> str:
    """Return the error message if no device works: repair a driver that is there, or install one."""
    there = sorted({report.platform for report in reports})
    known = " ".join((*there, *(report.reason for report in reports))).lower()
    others = [how for words, how in INSTALLATION.items() if not any(word in known for word in words)]
    if there:
        reasons = (
            f"the reasons are given for {', '.join(there)}. Repair or remove what fails, or install another driver"
        )
    else:
        reasons = "no driver is installed. Install one of"
    return "\n  ".join((f"No OpenCL device works; {reasons}:", *others))


def _table(reports: Sequence[DeviceReport]) -> str:
    return "\n".join(f"  {report}" for report in reports) or "  no device at all"
