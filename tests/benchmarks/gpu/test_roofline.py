"""The bounds are what a few passes counted by hand have, and the page shows the ones of now."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from benchmarks.gpu import roofline
from benchmarks.gpu.limits import GPUS
from svgf_cl import FileError, Kalman, Settings
from svgf_cl.bench.cost import cost
from svgf_cl.filters.pipeline import Quantity, Use
from svgf_cl.filters.taps import HERE, grid

ROOT = Path(__file__).parents[3]
H100 = GPUS[0]
HUGE = (20_000, 20_000)  # out of every cache


def test_a_pass_out_of_every_cache_takes_its_bytes_over_the_memorys_speed() -> None:
    first = roofline.bounded(Settings(), HUGE, H100)[0]
    # Read: colour, albedo, normal, depth, id: 44 bytes. Written: normal, depth, id, albedo's code, light: 36.
    assert first.entry.label == "demodulate"
    assert first.bound.seconds == pytest.approx(80 * 20_000**2 / H100.memory)
    assert first.bound.binds == "memory"


def test_a_frame_of_a_few_pixels_is_in_the_cache() -> None:
    found = roofline.bounded(Kalman(), (64, 64), H100)
    assert roofline.in_cache(found, H100) == "13 of 13 in cache"
    assert roofline.in_cache(roofline.bounded(Kalman(), HUGE, H100), H100) == "0 of 13 in cache"


def test_a_frame_takes_the_sum_of_its_passes() -> None:
    found = roofline.bounded(Kalman(), (1080, 1920), H100)
    assert roofline.seconds(Kalman(), (1080, 1920), H100) == sum(each.bound.seconds for each in found)


def test_octahedral_normals_take_a_plane_in_place_of_three() -> None:
    entry = next(each for each in Settings().pipeline(roofline.ROOM).passes if each.kernel == "temporal")
    before, after = cost(entry), cost(roofline.octahedral(entry))
    # This frame's normals at the pixel, and those of the frame before.
    assert before.bytes - after.bytes == 2 * 8
    assert before.flops == after.flops


def test_the_users_own_normals_stay_as_they_are() -> None:
    entry = Settings().pipeline(roofline.ROOM).passes[0]
    assert cost(entry).bytes - cost(roofline.octahedral(entry)).bytes == 8  # what is written, not what is read


def test_rows_that_are_a_step_apart_share_the_taps_of_that_step() -> None:
    near, far = (Use(Quantity("depth"), grid(1, step)) for step in (1, 8))
    assert roofline.distinct(near, 32, 4, 1) == 34 * 6
    assert roofline.distinct(far, 32, 4, 8) == 48 * 6
    assert roofline.distinct(far, 32, 4, 1) == 48 * 12  # rows -8..-5, 0..3 and 8..11
    assert roofline.distinct(Use(Quantity("depth"), HERE), 32, 4, 8) == 32 * 4


def test_a_work_group_reads_its_pixels_and_those_around_once() -> None:
    first = roofline.reuse().rows[0]
    planes = 10  # depth, normal, albedo's code, light, variance, guidance
    assert first[:3] == ("1", str(9 * 4 * planes), f"{4 * planes * 34 * 6 / (32 * 4):.0f}")
    assert first[-1] == f"{4e-3 * planes * 34 * 6:.1f}"


def test_the_page_is_up_to_date() -> None:
    page = (ROOT / "docs" / "gpu.md").read_text()
    made = roofline.text([*roofline.all_tables()])
    assert page == roofline.put(page, "docs/gpu.md", made), "run python -m benchmarks.gpu.roofline docs/gpu.md"


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(FileError, match="expected '<!-- From here"):
        roofline.put("no marks", "docs/gpu.md", "")


# Counts of benchmarks.gpu_static


def counted(variant: str, total: int, architecture: str = "sm_90") -> dict[str, object]:
    return {
        "source": "atrous",
        "kernel": "atrous",
        "variant": variant,
        "architecture": architecture,
        "instructions": {"total": total, "loads": 1},
    }


def test_counts_of_a_filter_by_default_are_taken_and_else_anyones(tmp_path: Path) -> None:
    file = tmp_path / "kernels.json"
    entries = [
        counted("svgf taps=5x5; color", 900),
        counted("kalman by default; color", 500),
        counted("eaw by default; color", 300, "gfx1100"),
    ]
    file.write_text(json.dumps({"about": {"clang": 19}, "kernels": entries}))
    found, about = roofline.read_counts(file)
    assert about == "clang 19"
    assert found["kalman", "atrous", "sm_90"] == 500
    assert found["svgf", "atrous", "sm_90"] == 900
    assert found["kalman", "atrous", "gfx1100"] == 300
    rows = roofline.instructions(Kalman(), found).rows
    level = next(row for row in rows if row[0] == "atrous 1")
    assert level[1] == "500"
    assert level[2].startswith(f"{1e6 * 500 * 1920 * 1080 / H100.instructions:.1f} / ")
    assert next(row for row in rows if row[0] == "predict")[1] == "-"


def test_a_frame_takes_the_longer_of_issuing_and_the_roofline_of_each_pass() -> None:
    counts = {("kalman", "atrous", "sm_90"): 10**6}
    last = roofline.instructions(Kalman(), counts).rows[-1]
    found = roofline.bounded(Kalman(), (1080, 1920), H100)
    others = sum(each.bound.seconds for each in found if each.entry.kernel != "atrous")
    levels = 4 * 10**6 * 1920 * 1080 / H100.instructions
    assert last[2] == f"{1e6 * (others + levels):.0f}"


@pytest.mark.parametrize("text", ["{}", "[]", "no JSON", '{"kernels": [{}]}', '{"kernels": 1}'])
def test_another_file_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(FileError, match=r"expected kernels.json of 'python -m benchmarks.gpu_static'"):
        roofline.read_counts(tmp_path / "other.json")


def test_the_command_writes_the_page(tmp_path: Path) -> None:
    import typer

    app = typer.Typer()
    app.command()(roofline.roofline)
    page = tmp_path / "page.md"
    page.write_text(f"before\n{roofline.MARKS[0].format('docs/gpu.md')}\nold\n{roofline.MARKS[1]}\nafter\n")
    assert CliRunner().invoke(app, [str(page)]).exit_code == 0
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "old" not in text
    assert "| predict |" in text
    counts = tmp_path / "kernels.json"
    counts.write_text(json.dumps({"about": {"clang": 19}, "kernels": [counted("kalman by default", 500)]}))
    assert CliRunner().invoke(app, [str(page), "--counts", str(counts)]).exit_code  # there are no marks for it
    mark = roofline.MARKS[0].format(f"docs/gpu.md {roofline.COUNTS}")
    page.write_text(f"{text}\n{mark}\n{roofline.MARKS[1]}\nend\n")
    assert CliRunner().invoke(app, [str(page), "--counts", str(counts)]).exit_code == 0
    assert "Compiled by clang 19." in page.read_text()
    printed = CliRunner().invoke(app, []).output
    assert "| predict |" in printed
