"""A cache folder that cannot be written, is full, or is nowhere: it is said once, and everything works without it."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from collections import namedtuple
from pathlib import Path

import platformdirs
import pytest

from svgf_cl.errors import FileError
from svgf_cl.io import cache
from svgf_cl.io.atomic import written_whole
from svgf_cl.io.cache import NOWHERE, ROOM, is_usable, keeping, tell, users_folder

pytestmark = pytest.mark.usefixtures("untold")

Usage = namedtuple("Usage", "total used free")

# Denoises a frame, and prints how often the user was warned. What it is run with is a home of this machine's.
DENOISE = """
import warnings
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    import numpy as np
    from svgf_cl import Accumulation, Denoiser, Tuning
    from svgf_cl.io.synthetic import room_frames
    quick = {"settings": Accumulation(), "tuning": Tuning(vector_width=1, work_group=(1, 1))}
    for _ in range(2):
        picture = Denoiser((9, 16), **quick).denoise(*room_frames((9, 16), 1))
assert np.isfinite(picture).all()
ours = [str(warning.message) for warning in told if issubclass(warning.category, UserWarning)]
print(len(ours), *ours, sep="|")
"""


def not_absolute(*_: object, **__: object) -> Path:
    return Path("~/.cache/svgf_cl")


def no_home(*_: object, **__: object) -> Path:
    raise RuntimeError("could not determine the home directory")


def test_a_folder_can_be_written_be_it_there_or_not(tmp_path: Path) -> None:
    assert is_usable(tmp_path)
    assert is_usable(tmp_path / "a" / "b")
    assert not list(tmp_path.iterdir()), "trying leaves nothing"


@pytest.mark.parametrize("place", ["/proc/self/a", "/dev/null/a", "file", "file/a", "link", "link/a"])
def test_what_root_cannot_write_either(place: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    assert not is_usable(tmp_path / place)
    with pytest.warns(
        UserWarning, match=rf"{place}: cannot be written \(.+\); everything works without it, .* set XDG_CACHE"
    ):
        tell()


@pytest.mark.parametrize("code", [errno.EROFS, errno.EACCES, errno.ENOSPC, errno.EDQUOT])
def test_what_the_system_refuses(code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(tempfile, "TemporaryFile", refuse)
    assert not is_usable(tmp_path)
    with pytest.warns(UserWarning, match=os.strerror(code)):
        tell()


@pytest.mark.parametrize(("total", "free", "usable"), [(1 << 40, ROOM, True), (1 << 40, ROOM - 1, False), (0, 0, True)])
def test_a_disk_that_is_nearly_full(
    total: int, free: int, usable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 0 bytes in all are file systems that do not tell."""
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(total, total - free, free))
    assert is_usable(tmp_path) == usable


@pytest.mark.parametrize("answer", [not_absolute, no_home])
def test_a_user_without_a_home_has_no_cache(answer: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(platformdirs, "user_cache_path", answer)
    assert users_folder("svgf_cl") == NOWHERE / "svgf_cl"
    assert not is_usable(users_folder("svgf_cl"))


def test_it_is_said_once(tmp_path: Path) -> None:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        tell()
        assert not told, "there is nothing to say"
        for name in ("a", "b"):
            assert not is_usable(Path(os.devnull) / name)
            tell()
            with keeping(), written_whole(Path(os.devnull) / name):
                pytest.fail("there is nothing to write to")
    assert len(told) == 1
    assert str(told[0].message).startswith(f"{os.devnull}/a: cannot be written")


def test_keeping_hides_no_other_error() -> None:
    for error in (KeyboardInterrupt, ZeroDivisionError):
        with pytest.raises(error), keeping():
            raise error
    with pytest.warns(UserWarning, match="full"), keeping():
        raise FileError("full")


def test_a_temporary_folder_is_gone_with_its_process_and_not_with_a_fork_of_it(tmp_path: Path) -> None:
    program = (
        "import os\nfrom svgf_cl.io.cache import temporary_folder\nfolder = temporary_folder()\n"
        "(folder / 'a').mkdir()\nprint(folder, flush=True)\n"
        "if os.fork():\n    os.wait()\n    assert (folder / 'a').is_dir()\n"
    )
    child = subprocess.run(
        [sys.executable, "-c", program], env=os.environ | {"TMPDIR": str(tmp_path)}, capture_output=True, text=True
    )
    assert child.returncode == 0, child.stderr
    assert Path(child.stdout.splitlines()[0]).parent == tmp_path
    assert not list(tmp_path.iterdir())


def test_a_read_only_container_has_its_shared_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make = tempfile.mkdtemp

    def only_there(prefix: str, dir: str | None = None) -> str:
        if dir is None:
            raise FileNotFoundError("No usable temporary directory found")
        return make(prefix=prefix, dir=dir)

    monkeypatch.setattr(tempfile, "mkdtemp", only_there)
    monkeypatch.setattr(cache, "SHARED_MEMORY", str(tmp_path))
    folder = cache.temporary_folder.__wrapped__()
    assert folder.parent == tmp_path
    monkeypatch.setattr(cache, "SHARED_MEMORY", "/dev/null")
    with pytest.raises(OSError, match="/dev/null"):
        cache.temporary_folder.__wrapped__()


@pytest.mark.parametrize("home", [{"HOME": "/proc/self"}, {"XDG_CACHE_HOME": "/dev/null"}], ids=str)
def test_a_home_that_cannot_be_written(home: dict[str, str], tmp_path: Path) -> None:
    """Whatever the device: pyopencl, PoCL and Intel's runtime each want a place of their own there."""
    environment = os.environ | {"TMPDIR": str(tmp_path)} | home
    for name in ("XDG_CACHE_HOME", "POCL_CACHE_DIR", "OCL_ICD_VENDORS"):
        if name not in home:
            environment.pop(name, None)
    child = subprocess.run([sys.executable, "-c", DENOISE], env=environment, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    count, *told = child.stdout.strip().split("|")
    assert count == "1", told
    assert "cannot be written" in told[0]
    assert not list(tmp_path.iterdir()), "what stood in for the caches is gone"
