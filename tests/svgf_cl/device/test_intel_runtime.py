"""Registration, of a runtime that is only a file here and of drivers that are only names."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from svgf_cl.device import intel_runtime
from svgf_cl.io import cache


@pytest.fixture
def system(monkeypatch, tmp_path):
    """The system's folder of .icd files, with PoCL in it; the runtime is installed and nothing is set."""
    vendors = tmp_path / "vendors"
    vendors.mkdir()
    (vendors / "pocl.icd").write_text("libpocl.so.2\n")
    library = tmp_path / intel_runtime.LIBRARY
    library.touch()
    monkeypatch.setattr(intel_runtime, "SYSTEM_VENDORS", vendors)
    monkeypatch.setattr(intel_runtime, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(intel_runtime, "find", lambda: library)
    monkeypatch.setenv(intel_runtime.VARIABLE, "to be restored")
    monkeypatch.delenv(intel_runtime.VARIABLE)
    return vendors


def registered() -> dict[str, str]:
    """Names and contents of the .icd files that the loader is pointed at."""
    folder = os.environ[intel_runtime.VARIABLE]
    assert folder.endswith("/")
    return {name: open(folder + name).read().strip() for name in os.listdir(folder)}


def test_the_runtime_is_listed_beside_the_systems_drivers(system, tmp_path):
    intel_runtime.register()
    assert registered() == {"pocl.icd": "libpocl.so.2", "svgf_cl-intel.icd": str(tmp_path / intel_runtime.LIBRARY)}


def test_drivers_that_come_and_go_are_followed(system, monkeypatch):
    intel_runtime.register()
    (system / "pocl.icd").unlink()
    (system / "nvidia.icd").write_text("libnvidia-opencl.so.1\n")
    monkeypatch.delenv(intel_runtime.VARIABLE)
    intel_runtime.register()
    assert set(registered()) == {"nvidia.icd", "svgf_cl-intel.icd"}


def test_two_environments_keep_apart(system, monkeypatch, tmp_path):
    intel_runtime.register()
    first = os.environ.pop(intel_runtime.VARIABLE)
    monkeypatch.setattr(intel_runtime, "find", lambda: tmp_path / "other" / intel_runtime.LIBRARY)
    intel_runtime.register()
    assert os.environ[intel_runtime.VARIABLE] != first


def test_the_users_choice_stands(system, monkeypatch):
    monkeypatch.setenv(intel_runtime.VARIABLE, "/mine/")
    intel_runtime.register()
    assert os.environ[intel_runtime.VARIABLE] == "/mine/"
    assert "'/mine/'" in intel_runtime.why_unlisted({"A"})


def test_a_runtime_that_the_system_registers_is_not_loaded_twice(system):
    (system / "intel.icd").write_text(f"/opt/intel/{intel_runtime.LIBRARY}\n")
    intel_runtime.register()
    assert intel_runtime.VARIABLE not in os.environ


def test_unreadable_registrations_are_skipped(system, tmp_path):
    (system / "gone.icd").symlink_to(tmp_path / "gone")
    (system / "folder.icd").mkdir()  # unreadable for root too
    intel_runtime.register()
    assert intel_runtime.VARIABLE in os.environ


def test_a_users_site_that_is_out_of_bounds_is_skipped(monkeypatch):
    def forbid(path, **_):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(os, "stat", forbid)
    assert intel_runtime.find() is None


def test_nothing_happens_where_it_is_not_installed(system, monkeypatch):
    monkeypatch.setattr(intel_runtime, "find", lambda: None)
    intel_runtime.register()
    assert intel_runtime.VARIABLE not in os.environ
    assert intel_runtime.why_unlisted({"A"}) == ""


def test_a_cache_that_cannot_be_written_is_done_without(system, tmp_path, monkeypatch, untold):
    (tmp_path / "cache").write_text("a file where the folder should be")
    (tmp_path / "instead").mkdir()
    monkeypatch.setattr(intel_runtime, "temporary_folder", lambda: tmp_path / "instead")
    intel_runtime.register()
    assert os.environ[intel_runtime.VARIABLE].startswith(str(tmp_path / "instead"))
    assert set(registered()) == {"pocl.icd", "svgf_cl-intel.icd"}
    with pytest.warns(UserWarning, match="cache: cannot be written"):
        cache.tell()


def test_where_there_is_no_temporary_folder_either_it_is_not_silent(system, tmp_path, monkeypatch, untold):
    def none():
        raise FileNotFoundError("No usable temporary directory found")

    (tmp_path / "cache").write_text("a file where the folder should be")
    monkeypatch.setattr(intel_runtime, "temporary_folder", none)
    with pytest.warns(UserWarning, match="stays unlisted: No usable temporary directory"):
        intel_runtime.register()
    assert intel_runtime.VARIABLE not in os.environ


def test_the_folder_of_a_process_that_has_ended_is_made_anew(system, monkeypatch, tmp_path):
    intel_runtime.register()
    name = os.path.basename(os.environ[intel_runtime.VARIABLE].rstrip("/"))
    monkeypatch.setenv(intel_runtime.VARIABLE, f"{tmp_path / 'gone' / name}/")
    intel_runtime.register()
    assert set(registered()) == {"pocl.icd", "svgf_cl-intel.icd"}


def test_listed_too_early(system):
    intel_runtime.register()
    assert intel_runtime.why_unlisted({intel_runtime.PLATFORM}) == ""
    assert "import svgf_cl first" in intel_runtime.why_unlisted({"A"})


def test_importing_svgf_cl_registers_it(tmp_path):
    library = tmp_path / "user" / "lib" / intel_runtime.LIBRARY
    library.parent.mkdir(parents=True)
    library.touch()
    environment = os.environ | {"PYTHONUSERBASE": str(tmp_path / "user"), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    environment.pop(intel_runtime.VARIABLE, None)
    code = f"import os, svgf_cl; print(os.environ['{intel_runtime.VARIABLE}'])"
    child = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    assert child.stdout.startswith(str(tmp_path / "cache"))
