from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numba
import pytest

import tracer.compiled
from svgf_cl.cache import cache_folder
from tracer.compiled import FOLDER, compiled


def double(x: float) -> float:
    return 2.0 * x


def test_what_is_compiled_is_kept_on_disk_for_the_next_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tracer.compiled, "FOLDER", tmp_path)
    first, second = compiled(double), compiled(double)
    assert first(3.0) == second(3.0) == 6.0
    assert list(tmp_path.rglob("*.nbc"))
    assert not first.stats.cache_hits
    assert second.stats.cache_hits


def damaged(content: bytes) -> bytes:
    """Another byte in the middle."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 255]) + content[middle + 1 :]


@pytest.mark.parametrize("kind", ["nbi", "nbc", "sha256"])
@pytest.mark.parametrize(
    "damage", [damaged, lambda content: content[: len(content) // 2], lambda _: b"", lambda _: b"junk" * 9]
)
def test_what_is_damaged_is_compiled_again(
    kind: str, damage: Callable[[bytes], bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tracer.compiled, "FOLDER", tmp_path)
    assert compiled(double)(3.0) == 6.0
    (file,) = tmp_path.rglob(f"*.{kind}")
    file.write_bytes(damage(file.read_bytes()))
    again, whole = compiled(double), compiled(double)
    assert again(3.0) == 6.0
    assert not again.stats.cache_hits
    assert whole(3.0) == 6.0
    assert whole.stats.cache_hits


def test_a_file_that_is_gone_is_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tracer.compiled, "FOLDER", tmp_path)
    assert compiled(double)(3.0) == 6.0
    for kind in ("nbi", "nbc", "sha256"):
        next(tmp_path.rglob(f"*.{kind}")).unlink()
        assert compiled(double)(3.0) == 6.0
        assert next(tmp_path.rglob(f"*.{kind}")).stat().st_size


def test_the_folder_is_named_by_the_state_of_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert FOLDER.is_relative_to(cache_folder())
    sources = shutil.copytree(Path(tracer.compiled.__file__).parent, tmp_path / "tracer")
    monkeypatch.setattr(tracer.compiled, "__file__", str(sources / "compiled.py"))
    assert tracer.compiled._digest() == FOLDER.name
    with (sources / "vec3.py").open("a") as file:
        file.write("# another state\n")
    assert tracer.compiled._digest() != FOLDER.name


def test_numbas_own_folder_stays_what_it_was() -> None:
    before = numba.config.CACHE_DIR
    compiled(double)
    assert before == numba.config.CACHE_DIR
