"""What a tuning may be, and that a stored one is found again, for its device, driver and kernels only."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyopencl as cl
import pytest

from svgf_cl import Denoiser, DeviceError, Eaw, SvgfError, Tuning
from svgf_cl.device import tuning
from svgf_cl.device.launch import Grid
from svgf_cl.device.tuning import best_tuning, default_tuning, forget_tuning, store_tuning, stored_tuning
from svgf_cl.plan import fitting
from tests.denoising import vector_width
from tests.frames import wall

ODD = Tuning(vector_width=4, work_group=(8, 2), row_alignment=128, exponential="exp2", pinned_copies=True)


@dataclass
class FakeDevice:
    type: int = cl.device_type.CPU
    name: str = "a device"
    driver_version: str = "1.0"
    native_vector_width_float: int = 8
    max_work_group_size: int = 256
    max_work_item_sizes: tuple[int, int, int] = (256, 128, 64)
    platform: object = field(default_factory=lambda: SimpleNamespace(name="a platform", version="OpenCL 3.0"))


@pytest.fixture
def memory(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Where tunings are stored; nothing is yet."""
    monkeypatch.setattr(tuning, "cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache" / tuning.STORE


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("vector_width", 2),
        ("vector_width", "16"),
        ("work_group", (0, 1)),
        ("work_group", (16,)),
        ("work_group", [16, 1]),
        ("work_group", 16),
        ("row_alignment", 8),
        ("row_alignment", 24),
        ("row_alignment", 1024),
        ("exponential", "exp"),
        ("exponential", 2),
        ("pinned_copies", 1),
    ],
)
def test_values_out_of_range(field: str, value: object) -> None:
    with pytest.raises(SvgfError, match=f"Tuning.{field}: expected"):
        Tuning(**{"vector_width": 16, "work_group": (16, 1), field: value})


@pytest.mark.parametrize(("native", "width"), [(0, 1), (1, 1), (2, 4), (4, 8), (8, 16), (16, 16)])
def test_vectors_of_a_cpu(native: int, width: int) -> None:
    assert default_tuning(FakeDevice(native_vector_width_float=native)).vector_width == width


def test_a_gpu_treats_pixels_one_by_one() -> None:
    chosen = default_tuning(FakeDevice(cl.device_type.GPU, native_vector_width_float=4))
    assert chosen.vector_width == 1
    assert math.prod(chosen.work_group) % 64 == 0  # whole warps of any vendor
    assert chosen.exponential == "exp2"


@pytest.mark.parametrize("group", [(32, 16), (512, 1), (1, 129)])
def test_groups_too_large_for_the_device(group: tuple[int, int]) -> None:
    with pytest.raises(DeviceError, match="at most 256 work-items, 256 along a row and 128 down"):
        Tuning(vector_width=1, work_group=group).check(FakeDevice())


def test_a_denoiser_uses_the_tuning_given_stored_or_default(queue: cl.CommandQueue, memory: Path) -> None:
    device = queue.device
    assert Denoiser((3, 5)).tuning == default_tuning(device)
    assert store_tuning(device, ODD) == memory
    assert Denoiser((3, 5)).tuning == ODD
    assert Denoiser((3, 5), tuning=default_tuning(device)).tuning == default_tuning(device)
    forget_tuning(device)
    assert Denoiser((3, 5)).tuning == default_tuning(device)


def test_a_tuning_of_another_type() -> None:
    with pytest.raises(SvgfError, match="tuning=Tuning"):
        Denoiser((3, 5), tuning=16)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("group", "cut"),
    [((64, 1), (64, 1)), ((16, 4), (16, 4)), ((32, 4), (32, 2)), ((128, 2), (64, 1)), ((1, 99), (1, 64))],
)
def test_a_group_too_large_for_a_kernel_is_cut(group: Grid, cut: Grid, queue: cl.CommandQueue) -> None:
    greedy = SimpleNamespace(get_work_group_info=lambda name, device: 64)
    assert fitting(group, greedy, queue.device) == cut


def test_devices_and_drivers_are_kept_apart(memory: Path) -> None:
    store_tuning(FakeDevice(), ODD)
    other = Tuning(vector_width=8, work_group=(8, 1))
    store_tuning(FakeDevice(driver_version="2.0"), other)
    assert stored_tuning(FakeDevice()) == ODD
    assert stored_tuning(FakeDevice(driver_version="2.0")) == other
    assert stored_tuning(FakeDevice(name="another")) is None


def test_what_a_stored_tuning_does_not_say_is_the_usual(memory: Path) -> None:
    store_tuning(FakeDevice(), ODD)
    memory.write_text(memory.read_text().replace(',\n   "exponential": "exp2",\n   "pinned_copies": true', ""))
    assert stored_tuning(FakeDevice()) == replace(ODD, exponential="polynomial", pinned_copies=False)


def test_a_tuning_is_for_the_kernels_it_was_found_with(memory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store_tuning(FakeDevice(), ODD)
    monkeypatch.setattr(tuning, "kernels_digest", lambda: "others")
    assert stored_tuning(FakeDevice()) is None


DAMAGE = ("", "[]", "nested", "no JSON", '{"vector_width": 3}', "vector_width", "work_group", "exponential", "entry")


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_file_that_cannot_be_used_is_named_and_changes_nothing(damage: str, memory: Path) -> None:
    store_tuning(FakeDevice(), ODD)
    text = memory.read_text()
    broken = {
        "vector_width": text.replace('"vector_width": 4', '"vector_width": 3'),
        "work_group": text.replace("work_group", "group"),
        "exponential": text.replace('"exp2"', '"exp"'),
        "nested": "[" * 99999,
        "entry": json.dumps(dict.fromkeys(json.loads(text), 4)),
        '{"vector_width": 3}': text.replace("kernels", "colonels"),
    }
    memory.write_text(broken.get(damage, damage))
    with pytest.warns(UserWarning, match=f"{memory.name}: cannot be used .* 'svgf-cl tune' writes it again"):
        assert best_tuning(FakeDevice()) == default_tuning(FakeDevice())
    store_tuning(FakeDevice(), ODD)
    assert stored_tuning(FakeDevice()) == ODD


@pytest.mark.parametrize("chosen", [ODD, Tuning(vector_width=16, work_group=(1, 16), row_alignment=16)], ids=str)
def test_any_tuning_gives_the_same_picture(chosen: Tuning) -> None:
    noisy = wall((20, 50), color=np.random.default_rng(0).random((20, 50, 3), np.float32))
    with vector_width(16):
        expected = Denoiser((20, 50), settings=Eaw(iterations=1)).denoise(noisy)
    got = Denoiser((20, 50), settings=Eaw(iterations=1), tuning=chosen).denoise(noisy)
    np.testing.assert_allclose(got, expected, rtol=1e-4)
