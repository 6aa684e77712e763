"""The page in a real browser: all is drawn, nothing is missing, nothing is fetched."""

from __future__ import annotations

import html
import json
import re
import struct
import subprocess
import zlib
from pathlib import Path
from typing import Any

from svgf_cl.bench import report
from svgf_cl.bench.report import Section, inline_png
from svgf_cl.bench.tables import Table
from tests.browser import chromium
from tests.svgf_cl.bench.runs import device, result, run, whole_run

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"

# What a look at the page would tell, put into it for --dump-dom to print.
LOOK = """<script>
addEventListener("load", () => {
  const seen = {
    images: [...document.images].map(image => image.complete ? image.naturalWidth : 0),
    drawings: [...document.querySelectorAll("svg")].map(svg => [svg.getBoundingClientRect().width, svg.textContent]),
    headings: [...document.querySelectorAll("h2")].map(heading => heading.textContent),
    tables: [...document.querySelectorAll("table")].map(
      table => [...table.rows].map(row => [...row.cells].map(cell => cell.textContent))),
    ink: getComputedStyle(document.querySelector("svg text")).fill,
    text: getComputedStyle(document.body).color,
    overflow: document.documentElement.scrollWidth - innerWidth,
    fetched: performance.getEntriesByType("resource").map(entry => entry.name).filter(name => !/^data:/.test(name)),
  };
  document.body.innerHTML = "<pre></pre>";
  document.querySelector("pre").textContent = JSON.stringify(seen);
});
</script>"""


def look_at(page: Path, profile: Path) -> tuple[dict[str, Any], list[str]]:
    """What a browser shows of a page, and what it complains of."""
    text = page.read_text(encoding="utf-8")
    assert POLICY in text, "the page itself forbids to fetch anything"
    page.write_text(text.replace(POLICY, f"{POLICY}; script-src 'unsafe-inline'") + LOOK, encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", f"--user-data-dir={profile}"]
    options += ["--enable-logging=stderr", "--window-size=1200,800", "--virtual-time-budget=5000", "--dump-dom"]
    browser = subprocess.run([chromium(), *options, page.as_uri()], capture_output=True, text=True, timeout=120)
    told = re.search(r"<pre>(.*)</pre>", browser.stdout, re.DOTALL)
    assert told, browser.stderr
    complaints = [line for line in browser.stderr.splitlines() if ":CONSOLE" in line]
    return json.loads(html.unescape(told[1])), complaints


def png(width: int, height: int) -> bytes:
    """A grey picture."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    rows = zlib.compress((b"\0" + b"\x80" * width) * height)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def test_a_browser_shows_all_of_it(tmp_path: Path) -> None:
    old = run(result("temporal", "event", 13.0))
    more = Section("Speed against error", inline_png(png(31, 7), "a plot"), [Table("t", ("a", "b"), [("1", "<2>")])])
    first = Section("Bars", tables=[Table("bars", ("bar", ""), [(f"bar {n}", "holds") for n in range(6)])])
    report.write(whole_run(), tmp_path, old=old, first=[first], more=[more])
    seen, complaints = look_at(tmp_path / "report.html", tmp_path / "profile")
    assert complaints == []
    assert seen["fetched"] == []
    assert seen["images"] == [31]
    assert seen["headings"] == [
        "Bars",
        "Devices",
        "A frame, pass by pass",
        "Roofline: Alpha",
        "Scaling over pixels",
        "Scaling over iterations",
        "Scaling over cores",
        "Benchmarks",
        "Scaling",
        "Comparison",
        "Left out",
        "Speed against error",
    ]
    assert len(seen["drawings"]) == 5
    assert all(width > 300 for width, _ in seen["drawings"])
    assert "frame: 20 %, bound by arithmetic" in seen["drawings"][1][1]
    assert seen["ink"] == seen["text"], "plots follow the page's colour, dark or light"
    assert seen["overflow"] <= 0, "wide tables scroll by themselves"
    by_first_cell = {row[0]: row for table in seen["tables"] for row in table}
    assert by_first_cell["device"] == ["device", "a <CPU>"]
    assert by_first_cell["svgf.temporal.1280x720"][-1] == "2.00", "the comparison comes last"
    assert by_first_cell["1"] == ["1", "<2>"]
    assert [len(table) - 1 for table in seen["tables"]] == [6, 12, 2, 15, 2, 2, 2, 2, 2, 1]


def test_a_run_of_one_stage_has_a_report_too(tmp_path: Path) -> None:
    report.write(run(result("temporal", "host", 1.0)), tmp_path)
    assert "svgf.temporal.1280x720" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert (tmp_path / "summary.png").read_bytes().startswith(b"\x89PNG")


def test_what_is_empty_is_left_out() -> None:
    empty, full = Table("no rows", ("a",), []), Table("rows", ("a",), [("1",)])
    page = report.render(
        run(),
        [
            Section("Nothing"),
            Section("Empty table", tables=[empty]),
            Section("Both", tables=[empty, full]),
            Section("Note", notes=["a note"]),
            Section("Figure", inline_png(png(1, 1), "a plot")),
        ],
    )
    assert re.findall("<h2>(.*)</h2>", page) == ["Both", "Note", "Figure"]
    assert re.findall("<h3>(.*)</h3>", page) == ["rows"]


def test_a_run_without_ceilings_says_nothing_of_rooflines(tmp_path: Path) -> None:
    report.write(run(result("frame", "event", 1.0), devices=(device(ceilings=None),)), tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "svgf.frame.1280x720" in page
    assert "roofline" not in page.lower()
    assert "GFLOP" not in page


def test_the_same_run_gives_the_same_page(tmp_path: Path) -> None:
    pages = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        report.write(whole_run(), folder)
        pages.append((folder / "report.html").read_text(encoding="utf-8"))
    assert pages[0] == pages[1]
