"""Registration, of drivers that are only files here, or only names."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace

import pytest

from svgf_cl.device import registration
from svgf_cl.device.drivers import INTEL, NVIDIA
from svgf_cl.io import cache


@pytest.fixture
def system(monkeypatch, tmp_path):
    """The system's folder of .icd files, with PoCL in it; Intel's runtime is installed and nothing is set."""
    vendors = tmp_path / "vendors"
    vendors.mkdir()
    (vendors / "pocl.icd").write_text("libpocl.so.2\n")
    monkeypatch.setattr(registration, "SYSTEM_VENDORS", vendors)
    monkeypatch.setattr(registration, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setenv(registration.VARIABLE, "to be restored")
    monkeypatch.delenv(registration.VARIABLE)
    install(monkeypatch, tmp_path, INTEL)
    return vendors


def install(monkeypatch, folder, *drivers, kernel=True):
    """Pretend that exactly these drivers are installed in a folder, and the kernel's part of all others, if asked."""
    module = folder / "module"
    module.touch()
    for driver in drivers:
        (folder / driver.library).touch()
    made = [replace(each, folders=lambda: iter([folder]), kernel=(str(module),)) for each in drivers]
    others = [replace(NVIDIA, folders=lambda: iter(()), kernel=(str(module),))] if kernel and not drivers else []
    monkeypatch.setattr(registration, "DRIVERS", (*made, *others))


def registered() -> dict[str, str]:
    """Names and contents of the .icd files that the loader is pointed at."""
    folder = os.environ[registration.VARIABLE]
    assert folder.endswith("/")
    return {name: open(folder + name).read().strip() for name in os.listdir(folder)}


def reasons(*platforms: str) -> dict[str, str]:
    return {driver.name: reason for driver, reason in registration.why_unlisted(platforms)}


def test_a_driver_is_listed_beside_the_systems(system, tmp_path):
    registration.register()
    assert registered() == {"pocl.icd": "libpocl.so.2", "svgf_cl-intel.icd": str(tmp_path / INTEL.library)}


def test_several_drivers_are_listed(system, tmp_path, monkeypatch):
    install(monkeypatch, tmp_path, INTEL, NVIDIA)
    registration.register()
    assert registered() == {
        "pocl.icd": "libpocl.so.2",
        "svgf_cl-intel.icd": str(tmp_path / INTEL.library),
        "svgf_cl-nvidia.icd": str(tmp_path / NVIDIA.library),
    }


def test_in_a_container_without_icd_files_the_driver_is_listed(system, tmp_path, monkeypatch):
    (system / "pocl.icd").unlink()
    system.rmdir()
    install(monkeypatch, tmp_path, NVIDIA)
    registration.register()
    assert registered() == {"svgf_cl-nvidia.icd": str(tmp_path / NVIDIA.library)}


def test_a_library_that_only_the_linker_knows_is_written_by_its_name(system, tmp_path, monkeypatch):
    install(monkeypatch, tmp_path, NVIDIA)
    (tmp_path / NVIDIA.library).unlink()
    monkeypatch.setattr("ctypes.util.find_library", lambda name: f"lib{name}.so.1")
    registration.register()
    assert registered()["svgf_cl-nvidia.icd"] == "libnvidia-opencl.so.1"


def test_drivers_that_come_and_go_are_followed(system, monkeypatch):
    registration.register()
    (system / "pocl.icd").unlink()
    (system / "nvidia.icd").write_text("libnvidia-opencl.so.1\n")
    monkeypatch.delenv(registration.VARIABLE)
    registration.register()
    assert set(registered()) == {"nvidia.icd", "svgf_cl-intel.icd"}


def test_two_environments_keep_apart(system, monkeypatch, tmp_path):
    registration.register()
    first = os.environ.pop(registration.VARIABLE)
    (tmp_path / "other").mkdir()
    install(monkeypatch, tmp_path / "other", INTEL)
    registration.register()
    assert os.environ[registration.VARIABLE] != first


def test_the_users_choice_stands(system, monkeypatch):
    monkeypatch.setenv(registration.VARIABLE, "/mine/")
    registration.register()
    assert os.environ[registration.VARIABLE] == "/mine/"
    assert "'/mine/'" in reasons("A")["intel"]


@pytest.mark.parametrize(("driver", "folder"), [(INTEL, "/opt/intel/"), (NVIDIA, "")])
def test_what_the_system_registers_is_not_loaded_twice(system, tmp_path, monkeypatch, driver, folder):
    install(monkeypatch, tmp_path, driver)
    (system / "its.icd").write_text(f"{folder}{driver.library}\n")
    registration.register()
    assert registration.VARIABLE not in os.environ
    assert f"is registered in {system}" in reasons("A")[driver.name]


def test_unreadable_registrations_are_skipped(system, tmp_path):
    (system / "gone.icd").symlink_to(tmp_path / "gone")
    (system / "folder.icd").mkdir()  # unreadable for root too
    registration.register()
    assert registration.VARIABLE in os.environ


def test_nothing_happens_where_none_is_installed(system, tmp_path, monkeypatch):
    install(monkeypatch, tmp_path, kernel=False)
    registration.register()
    assert registration.VARIABLE not in os.environ
    assert reasons("A") == {}


def test_a_driver_that_is_half_there_is_named_with_what_to_do(system, tmp_path, monkeypatch):
    install(monkeypatch, tmp_path, kernel=True)
    registration.register()
    assert registration.VARIABLE not in os.environ
    reason = reasons("Portable Computing Language")["nvidia"]
    for words in (str(tmp_path / "module"), "libnvidia-opencl.so.1", "NVIDIA_DRIVER_CAPABILITIES=compute,utility"):
        assert words in reason
    assert reasons("NVIDIA CUDA") == {}


def test_a_cache_that_cannot_be_written_is_done_without(system, tmp_path, monkeypatch, untold):
    (tmp_path / "cache").write_text("a file where the folder should be")
    (tmp_path / "instead").mkdir()
    monkeypatch.setattr(registration, "temporary_folder", lambda: tmp_path / "instead")
    registration.register()
    assert os.environ[registration.VARIABLE].startswith(str(tmp_path / "instead"))
    assert set(registered()) == {"pocl.icd", "svgf_cl-intel.icd"}
    with pytest.warns(UserWarning, match="cache: cannot be written"):
        cache.tell()


def test_where_there_is_no_temporary_folder_either_it_is_not_silent(system, tmp_path, monkeypatch, untold):
    def none():
        raise FileNotFoundError("No usable temporary directory found")

    (tmp_path / "cache").write_text("a file where the folder should be")
    monkeypatch.setattr(registration, "temporary_folder", none)
    with pytest.warns(UserWarning, match="libintelocl.so: not registered: No usable temporary directory"):
        registration.register()
    assert registration.VARIABLE not in os.environ


def test_the_folder_of_a_process_that_has_ended_is_made_anew(system, monkeypatch, tmp_path):
    registration.register()
    name = os.path.basename(os.environ[registration.VARIABLE].rstrip("/"))
    monkeypatch.setenv(registration.VARIABLE, f"{tmp_path / 'gone' / name}/")
    registration.register()
    assert set(registered()) == {"pocl.icd", "svgf_cl-intel.icd"}


def test_listed_too_early(system):
    registration.register()
    assert reasons(INTEL.platform) == {}
    assert "import svgf_cl first" in reasons("A")["intel"]


def test_importing_svgf_cl_registers_it(tmp_path):
    library = tmp_path / "user" / "lib" / INTEL.library
    library.parent.mkdir(parents=True)
    library.touch()
    environment = os.environ | {"PYTHONUSERBASE": str(tmp_path / "user"), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    environment.pop(registration.VARIABLE, None)
    code = f"import os, svgf_cl; print(os.environ['{registration.VARIABLE}'])"
    child = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    assert child.stdout.startswith(str(tmp_path / "cache"))
