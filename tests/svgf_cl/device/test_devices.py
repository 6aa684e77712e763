"""Listing and choosing, on devices that do not exist; the real one only where it matters."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass, field, replace
from pathlib import Path

import pyopencl as cl
import pytest

from svgf_cl import DeviceError
from svgf_cl.cli import main
from svgf_cl.device import apart, devices, icd_files, probe, registration
from svgf_cl.device.drivers import INTEL as INTEL_RUNTIME
from svgf_cl.device.drivers import NVIDIA

POCL = "Portable Computing Language"
INTEL = INTEL_RUNTIME.platform
ROOT = Path(__file__).resolve().parents[3]


@dataclass(eq=False)
class FakeDevice:
    name: str
    type: int = cl.device_type.CPU
    reason: str = ""
    max_compute_units: int = 8
    max_clock_frequency: int = 1000
    host_unified_memory: bool = False
    native_vector_width_float: int = 16
    driver_version: str = "1.0"
    platform: FakePlatform | None = None


@dataclass(eq=False)
class FakePlatform:
    name: str
    devices: list[FakeDevice] = field(default_factory=list)
    version: str = "OpenCL 3.0"

    def __post_init__(self) -> None:
        for device in self.devices:
            device.platform = self

    def get_devices(self) -> list[FakeDevice]:
        return self.devices


@pytest.fixture(autouse=True)
def free_choice(monkeypatch):
    monkeypatch.delenv("PYOPENCL_CTX", raising=False)


@pytest.fixture
def machine(monkeypatch):
    """A function that pretends that exactly the given platforms are installed."""

    def install(*platforms: FakePlatform) -> None:
        monkeypatch.setattr(cl, "get_platforms", lambda: list(platforms))
        monkeypatch.setattr(registration, "DRIVERS", ())
        monkeypatch.setattr(icd_files, "faults", list)
        monkeypatch.setattr(probe, "reason", lambda device, *, refresh: device.reason)

    return install


def gpu(name: str, **properties) -> FakeDevice:
    return FakeDevice(name, cl.device_type.GPU, **properties)


def cl_error(kind: type[cl.Error], code: int) -> cl.Error:
    return kind(cl._cl._ErrorRecord(msg="the driver is unwell", code=code, routine="clSomething"))


@pytest.mark.parametrize(
    ("slower", "faster"),
    [
        (FakePlatform(POCL, [FakeDevice("slower", max_compute_units=512)]), FakePlatform("A", [gpu("faster")])),
        (FakePlatform("A", [FakeDevice("slower", cl.device_type.ACCELERATOR)]), FakePlatform("B", [gpu("faster")])),
        (
            FakePlatform("A", [gpu("slower", host_unified_memory=True, max_compute_units=96)]),
            FakePlatform("B", [gpu("faster", max_compute_units=28)]),
        ),
        (
            FakePlatform("A", [gpu("slower", max_compute_units=20, max_clock_frequency=1000)]),
            FakePlatform("B", [gpu("faster", max_compute_units=10, max_clock_frequency=2001)]),
        ),
        (
            FakePlatform(POCL, [FakeDevice("slower")]),
            FakePlatform(INTEL, [FakeDevice("faster", max_clock_frequency=0)]),
        ),
        (FakePlatform("rusticl", [FakeDevice("slower")]), FakePlatform(POCL, [FakeDevice("faster")])),
        (
            FakePlatform("Oclgrind", [FakeDevice("slower", cl.device_type.CPU | cl.device_type.GPU)]),
            FakePlatform("rusticl", [FakeDevice("faster")]),
        ),
        (
            FakePlatform("A", [gpu("slower", reason="it is broken")]),
            FakePlatform(POCL, [FakeDevice("faster")]),
        ),
    ],
    ids=["GPU", "accelerator", "discrete", "units x clock", "Intel", "known CPU", "simulator", "works"],
)
def test_fastest_working_device_is_chosen_in_either_order(machine, slower, faster):
    for platforms in ((slower, faster), (faster, slower)):
        machine(*platforms)
        assert devices.default_device().name == "faster"
        assert [report.device for report in devices.list_devices() if report.is_default] == ["faster"]


def test_the_loaders_order_breaks_ties(machine):
    machine(FakePlatform("A", [gpu("first"), gpu("second")]))
    assert devices.default_device().name == "first"


@pytest.mark.parametrize("name", ["1", "1:0", "other", "other:slow"])
def test_environment_names_the_device(machine, monkeypatch, name):
    machine(FakePlatform("A", [gpu("fast")]), FakePlatform("Other", [FakeDevice("slow")]))
    monkeypatch.setenv("PYOPENCL_CTX", name)
    assert devices.default_device().name == "slow"


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("0:1", "does not work"),
        ("nothing", "names no device"),
        ("0:7", "names no device"),
        ("0:0,1", "names 2 devices"),
    ],
)
def test_environment_names_no_usable_device(machine, monkeypatch, name, complaint):
    machine(FakePlatform("A", [gpu("good"), gpu("bad", reason="it is broken")]))
    monkeypatch.setenv("PYOPENCL_CTX", name)
    with pytest.raises(DeviceError, match=complaint) as error:
        devices.default_device()
    assert name in str(error.value)
    assert "it is broken" in str(error.value)
    assert not any(report.is_default for report in devices.list_devices())


def test_error_lists_every_device_and_what_to_install(machine):
    machine(
        FakePlatform("A", [gpu("one", reason="no memory")]), FakePlatform("B", [FakeDevice("two", reason="no CPU")])
    )
    with pytest.raises(DeviceError) as error:
        devices.default_device()
    for text in ("one", "no memory", "two", "no CPU", "pocl-opencl-icd", "svgf-cl[cpu]"):
        assert text in str(error.value)


def test_what_is_there_but_broken_is_to_be_repaired_and_not_installed(machine):
    reason = "error: unknown target CPU 'generic'"
    machine(FakePlatform(POCL, [FakeDevice("pthread", reason=reason)]))
    with pytest.raises(DeviceError) as error:
        devices.default_device()
    assert "apt-get" not in str(error.value)
    for text in (POCL, reason, "Repair or remove what fails, or install another", "svgf-cl[cpu]"):
        assert text in str(error.value)


def test_a_platform_without_devices_is_reported(machine):
    machine(FakePlatform(POCL), FakePlatform("A", [gpu("good")]))
    empty, good = devices.list_devices()
    assert (empty.selector, empty.platform, empty.reason) == ("0", POCL, "the driver lists no device")
    assert good.is_default
    machine(FakePlatform(POCL))
    with pytest.raises(DeviceError, match="lists no device") as error:
        devices.default_device()
    assert "apt-get" not in str(error.value)


def test_drivers_that_the_loader_passes_over_are_reported_where_none_works(machine, monkeypatch):
    machine()
    monkeypatch.setattr(icd_files, "faults", lambda: [("/etc/vendors/pocl.icd", "names libpocl.so, which is broken")])
    with pytest.raises(DeviceError, match=r"/etc/vendors/pocl.icd.*: names libpocl.so, which is broken") as error:
        devices.default_device()
    assert "apt-get" not in str(error.value)
    assert [report.reason for report in devices.list_devices(refresh=True)] == ["names libpocl.so, which is broken"]


def test_a_driver_that_would_end_this_process_is_not_loaded(machine, monkeypatch):
    def crash():
        raise apart.NoAnswerError("libbad.so: when it is loaded, the driver crashes (SIGBUS)")

    machine(FakePlatform("A", [gpu("good")]))
    monkeypatch.setattr(icd_files, "faults", crash)
    monkeypatch.delattr(cl, "get_platforms")
    with pytest.raises(DeviceError, match=r"libbad.so: .* repair or remove that driver, or name others in OCL_ICD"):
        devices.list_devices(refresh=True)


@pytest.mark.parametrize("name", ["", "0", "nothing", "9:9"])
def test_a_name_is_not_to_blame_where_there_is_no_device_at_all(machine, monkeypatch, name):
    machine()
    monkeypatch.setenv("PYOPENCL_CTX", name)
    with pytest.raises(DeviceError, match="no driver is installed"):
        devices.default_device()


@pytest.mark.parametrize("name", ["", " ", ":", "::", "-1", "0:-1", "0:x", "0:0:0", "0:0,0", "1e9", "\u0660"])
def test_any_name_chooses_a_device_or_is_refused(machine, monkeypatch, name):
    machine(FakePlatform("A", [gpu("one"), gpu("two")]), FakePlatform("B", [FakeDevice("three")]))
    monkeypatch.setenv("PYOPENCL_CTX", name)
    chosen = []
    try:
        chosen.append(devices.default_device().name)
    except DeviceError as error:
        chosen.append(str(error).partition(" name")[0])
    assert chosen[0] in ("one", "two", "three", f"PYOPENCL_CTX={name!r}")


def test_memory_is_doubted_before_giving_up(machine, monkeypatch):
    machine(FakePlatform("A", [gpu("repaired")]))
    monkeypatch.setattr(probe, "reason", lambda device, *, refresh: "" if refresh else "was broken")
    assert not devices.list_devices()[0].works
    assert devices.default_device().name == "repaired"


def test_a_named_device_is_doubted_before_giving_up(machine, monkeypatch):
    machine(FakePlatform("A", [gpu("good"), gpu("repaired")]))
    monkeypatch.setenv("PYOPENCL_CTX", "0:1")
    monkeypatch.setattr(
        probe, "reason", lambda device, *, refresh: "was broken" if device.name == "repaired" and not refresh else ""
    )
    assert devices.default_device().name == "repaired"


@pytest.mark.parametrize("name", ["0:7", "nothing", "0:0,1"])
def test_a_typo_probes_nothing_anew(machine, monkeypatch, name):
    def reason(device, *, refresh):
        assert not refresh
        return device.reason

    machine(FakePlatform("A", [gpu("good"), gpu("bad", reason="it hangs")]))
    monkeypatch.setattr(probe, "reason", reason)
    monkeypatch.setenv("PYOPENCL_CTX", name)
    with pytest.raises(DeviceError):
        devices.default_device()


def test_no_platform_at_all(machine, monkeypatch):
    machine()

    def none_found():
        raise cl_error(cl.LogicError, cl.status_code.PLATFORM_NOT_FOUND_KHR)

    monkeypatch.setattr(cl, "get_platforms", none_found)
    assert devices.list_devices() == []
    with pytest.raises(DeviceError, match="no device at all"):
        devices.default_device()


def test_a_platform_that_cannot_list_its_devices_does_not_hide_the_others(machine, monkeypatch):
    broken = FakePlatform("Broken")

    def fail():
        raise cl_error(cl.RuntimeError, cl.status_code.OUT_OF_HOST_MEMORY)

    monkeypatch.setattr(broken, "get_devices", fail)
    machine(broken, FakePlatform(POCL, [FakeDevice("good")]))
    listed = devices.list_devices()
    assert [report.works for report in listed] == [False, True]
    assert "unwell" in listed[0].reason
    assert listed[1].selector == "1:0"
    assert listed[1].is_default


def test_an_installed_but_unlisted_driver_is_reported(machine, monkeypatch):
    machine(FakePlatform(POCL, [FakeDevice("good")]))
    monkeypatch.setattr(registration, "why_unlisted", lambda names: [(INTEL_RUNTIME, f"unlike {sorted(names)}")])
    found = devices.list_devices()[-1]
    assert (found.platform, found.reason) == (INTEL, f"unlike {[POCL]}")


def test_command_names_a_gpu_of_which_the_driver_is_half_there(machine, monkeypatch, command, tmp_path):
    machine(FakePlatform(POCL, [FakeDevice("good")]))
    kernel = tmp_path / "nvidiactl"
    kernel.touch()
    half = replace(NVIDIA, kernel=(str(kernel),), folders=lambda: iter(()))
    monkeypatch.setattr("ctypes.util.find_library", lambda _: None)
    monkeypatch.setattr(registration, "DRIVERS", (half,))
    code, table, _ = command()
    assert code == 0
    shown = "".join(part.strip("│ ") for part in table.replace("\n", "│").split("│"))
    for words in ("NVIDIA CUDA", "libnvidia-opencl.so.1", "NVIDIA_DRIVER_CAPABILITIES=compute,utility"):
        assert words.replace(" ", "") in shown.replace(" ", "")


def test_this_machine_has_a_working_device(queue):
    works = [report.handle for report in devices.list_devices() if report.works]
    assert queue.device in works


def test_queues_have_profiling_and_share_their_devices_context(queue):
    assert queue.properties & cl.command_queue_properties.PROFILING_ENABLE
    other = devices.create_queue(queue.device)
    assert other != queue
    assert other.context == queue.context


# svgf-cl devices


@pytest.fixture
def command(monkeypatch, capsys):
    """A function that runs ``svgf-cl devices`` in a terminal of 80 columns: exit code, table, errors."""
    monkeypatch.setenv("COLUMNS", "80")

    def run() -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as left:
            main(["devices"])
        return int(left.value.code or 0), *capsys.readouterr()

    return run


def test_command_doubts_the_memory(machine, monkeypatch, command):
    machine(FakePlatform("A", [gpu("fast")]), FakePlatform(POCL, [FakeDevice("slow")]))
    monkeypatch.setattr(probe, "reason", lambda device, *, refresh: "" if refresh else "was broken")
    code, table, _ = command()
    assert code == 0
    assert "no" not in table
    assert "0:0 *" in table


def test_command_says_why_there_is_no_default(machine, monkeypatch, command):
    machine(FakePlatform("A", [gpu("good")]))
    monkeypatch.setenv("PYOPENCL_CTX", "9")
    code, table, errors = command()
    assert code == 2
    assert "good" in table
    assert errors.startswith("svgf-cl: PYOPENCL_CTX='9' names no device")


def test_command_says_what_to_install_where_nothing_works(machine, command):
    machine(FakePlatform("A", [gpu("bad", reason="it is broken")]))
    code, table, errors = command()
    assert code == 2
    assert "it is broken" in table
    assert "pocl-opencl-icd" in errors


def test_command_shows_names_and_reasons_whole(machine, command):
    name = "pthread-skylake-avx512-Intel(R) Xeon(R) CPU @ 2.20GHz"
    reason = "[/tmp/probe.cl] error: unknown target CPU 'generic'"  # rich would take it for markup
    machine(FakePlatform(POCL, [FakeDevice(name), FakeDevice("other", reason=reason)], version="OpenCL 3.0 PoCL LLVM"))
    _, table, _ = command()
    for text in (name, f"{POCL}, OpenCL 3.0, driver 1.0", reason):
        assert text in table


# make


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A checkout that is set up, on a machine where a device works while there is a file "driver".

    Its Python, its ``svgf-cl`` and the system's apt-get are pretences.
    """
    programs = {
        ".venv/bin/python": '[ -e driver ] && echo "$PYOPENCL_CTX"',
        ".venv/bin/pip": "exit 1",
        ".venv/bin/svgf-cl": "[ -e driver ]",
        "bin/apt-get": "touch driver",
        "bin/id": "echo 0",
    }
    for name, script in programs.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
    for name in ("Makefile", "pyproject.toml", "setup.py", "scripts/set_up"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / ".venv/.ready").touch()
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    return tmp_path


def make(folder: Path, target: str) -> str:
    child = subprocess.run(["make", target], cwd=folder, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    return child.stdout


def test_make_repairs_a_device_that_has_gone(checkout):
    assert "installing PoCL" in make(checkout, "demo")
    assert "installing" not in make(checkout, "demo")


def test_make_gpu_installs_nothing(checkout):
    child = subprocess.run(["make", "gpu"], cwd=checkout, capture_output=True, text=True)
    assert child.returncode  # no device works
    assert not (checkout / "driver").exists()  # apt-get would have made it
    (checkout / "driver").touch()
    assert "installing" not in make(checkout, "gpu")


def test_make_installs_nothing_because_of_a_wrong_name(checkout, monkeypatch):
    (checkout / "driver").touch()
    monkeypatch.setenv("PYOPENCL_CTX", "no such device")
    output = make(checkout, "demo")
    assert "installing" not in output
    assert "no such device" not in output
