"""What is written is read again bit by bit; what is damaged is noticed, said and not used."""

from __future__ import annotations

import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from svgf_cl_tracer.checkpoints import Checkpoints
from svgf_cl_tracer.estimate import Estimate, Step
from tests.disk import files_up_to

NOTHING = Estimate.nothing(7)


def estimate(spp: int) -> Estimate:
    random = np.random.default_rng(spp)
    history = tuple(Step(each, random.random()) for each in range(16, spp + 1, 16))
    light, squares = (random.random(values.shape, np.float32) for values in (NOTHING.light, NOTHING.squares))
    return Estimate(spp, light, squares, history)


def assert_same(found: Estimate, expected: Estimate) -> None:
    assert (found.spp, found.history) == (expected.spp, expected.history)
    np.testing.assert_array_equal(found.light, expected.light)
    np.testing.assert_array_equal(found.squares, expected.squares)


def test_nothing_is_kept_at_first(tmp_path: Path) -> None:
    assert Checkpoints(tmp_path / "none", 0).latest(NOTHING, lambda _: True) is NOTHING


def test_the_latest_usable_one_is_read_bit_by_bit(tmp_path: Path) -> None:
    checkpoints = Checkpoints(tmp_path / "made", 3)
    for spp in (32, 16, 2048):
        checkpoints.replace(NOTHING, estimate(spp))
    assert_same(checkpoints.latest(NOTHING, lambda _: True), estimate(2048))
    assert_same(checkpoints.latest(NOTHING, lambda kept: kept.spp < 100), estimate(32))
    assert checkpoints.latest(NOTHING, lambda kept: kept.spp < 10) is NOTHING
    assert Checkpoints(tmp_path / "made", 4).latest(NOTHING, lambda _: True) is NOTHING


def test_a_finer_estimate_takes_the_place_of_the_one_it_was_made_from(tmp_path: Path) -> None:
    checkpoints = Checkpoints(tmp_path, 3)
    checkpoints.replace(NOTHING, estimate(16))
    checkpoints.replace(NOTHING, estimate(48))
    checkpoints.replace(estimate(16), estimate(32))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0003.000032.npz", "0003.000048.npz"]


def test_what_cannot_be_written_is_said_once_and_ends_nothing(tmp_path: Path, untold: None) -> None:
    checkpoints = Checkpoints(tmp_path, 3)
    checkpoints.replace(NOTHING, estimate(16))
    with files_up_to(100):
        with pytest.warns(UserWarning, match=r"0003.000032.npz: cannot be written \(File too large\)"):
            checkpoints.replace(estimate(16), estimate(32))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            checkpoints.replace(estimate(16), estimate(48))
    assert_same(checkpoints.latest(NOTHING, lambda _: True), estimate(16))
    assert len(list(tmp_path.iterdir())) == 1


def flipped(content: bytes) -> bytes:
    """One bit of a value, in the middle of the file."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


@pytest.mark.parametrize(
    "damage", [lambda content: content[:-40], lambda content: b"", lambda content: b"text" * 99, flipped]
)
def test_a_damaged_file_is_deleted_with_a_warning(damage: Callable[[bytes], bytes], tmp_path: Path) -> None:
    checkpoints = Checkpoints(tmp_path, 3)
    checkpoints.replace(NOTHING, estimate(16))
    checkpoints.replace(NOTHING, estimate(32))
    path = tmp_path / "0003.000032.npz"
    path.write_bytes(damage(path.read_bytes()))
    with pytest.warns(UserWarning, match=r"0003\.000032\.npz: damaged"):
        assert_same(checkpoints.latest(NOTHING, lambda _: True), estimate(16))
    assert not path.exists()


def test_no_bit_can_be_wrong_unnoticed(tmp_path: Path) -> None:
    checkpoints, rng = Checkpoints(tmp_path, 3), np.random.default_rng(0)
    checkpoints.replace(NOTHING, estimate(32))
    (path,) = tmp_path.iterdir()
    content = path.read_bytes()
    noticed = 0
    for _ in range(1500):
        damaged = np.frombuffer(content, np.uint8).copy()
        # Most of them where sizes, methods and names are.
        ends = np.concatenate([np.arange(200), np.arange(len(content) - 330, len(content))])
        places = rng.choice(ends if rng.random() < 0.7 else len(content), rng.integers(1, 4))
        damaged[places] ^= (1 << rng.integers(0, 8, len(places))).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = checkpoints.latest(NOTHING, lambda _: True)
        if found is NOTHING:
            noticed += 1
        else:
            assert_same(found, estimate(32))
    assert noticed > 1000


@pytest.mark.parametrize(
    "light",
    [
        np.array([{}, object()], object),
        b"\x93NUMPY\x01\x00\x76\x00"
        + b"%-117s\n" % b"{'descr': '<f4', 'fortran_order': False, 'shape': (9999999999999,), }",
    ],
    ids=["objects", "huge"],
)
def test_nothing_is_unpickled_and_no_room_made_for_a_claim(light: np.ndarray | bytes, tmp_path: Path) -> None:
    path = tmp_path / "0003.000032.npz"
    with zipfile.ZipFile(path, "w") as archive, archive.open("light.npy", "w") as file:
        if isinstance(light, bytes):
            file.write(light)
        else:
            np.lib.format.write_array(file, light)
    with pytest.warns(UserWarning, match=r"0003\.000032\.npz: damaged \((Object arrays cannot|Unable to allocate)"):
        assert Checkpoints(tmp_path, 3).latest(NOTHING, lambda _: True) is NOTHING
    assert not path.exists()


def test_a_file_of_another_picture_is_not_used(tmp_path: Path) -> None:
    checkpoints = Checkpoints(tmp_path, 3)
    checkpoints.replace(NOTHING, estimate(16))
    with pytest.warns(UserWarning, match=r"light: expected float32 of shape \(8, 5, 3\), got float32 of \(7, 5, 3\)"):
        assert checkpoints.latest(Estimate.nothing(8), lambda _: True).spp == 0


def test_what_a_kill_leaves_of_a_write_is_not_read(tmp_path: Path) -> None:
    checkpoints = Checkpoints(tmp_path, 3)
    checkpoints.replace(NOTHING, estimate(16))
    (tmp_path / ".0003.000032.npz.4242.tmp").write_bytes(b"half a fi")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert checkpoints.latest(NOTHING, lambda _: True).spp == 16
