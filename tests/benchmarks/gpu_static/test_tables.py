"""Tables show every kernel, and in short its first variant."""

from __future__ import annotations

import json

from benchmarks.gpu_static import tables
from tests.benchmarks.gpu_static.made_up import row

ROWS = [row("atrous", "sm_90", 64), row("atrous", "sm_90", 32, variant="fast"), row("atrous", "gfx90a", 87)]


def test_the_document_holds_all() -> None:
    document = json.loads(tables.document(ROWS, {"clang": "19.1.7"}))
    assert document["about"] == {"clang": "19.1.7"}
    assert [each["occupancy"] for each in document["kernels"]] == [0.5, 1.0, 0.625]
    assert document["kernels"][0]["usage"]["registers"] == 64


def test_a_row_each() -> None:
    rows = tables.every(ROWS)
    assert {len(each) for each in rows} == {len(tables.COLUMNS) + len(tables.COUNTED)}
    assert rows[0] == ["atrous/atrous", "any", "sm_90", "64", "", "0", "0", "50%", "100", "10", "2", "30"]
    assert rows[2][4] == "20"


def test_the_first_variant_in_short() -> None:
    (shown,) = tables.usual(ROWS)
    assert shown == ["atrous/atrous", "", "64, 50%, 100", "", "", "87, 62%, 100"]


def test_the_share_of_integers_is_of_the_first_variant() -> None:
    assert tables.integer_share(ROWS, "atrous/atrous") == "sm_90 30%, gfx90a 30%"
