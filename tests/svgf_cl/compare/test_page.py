"""The page of rivals: what it says, what it leaves out, and that it works by keyboard in a real browser."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from svgf_cl.compare.measures import Measure
from svgf_cl.compare.page import Cell, Entry, Page, Scene, best, data, data_uri, render, table, write
from tests.browser import Tab, browser

NASTY = "</script><b>&\"'\u2028"
FLIP = Measure("flip", "FLIP", "", ".3f", -1, None, "An eye's error.")
PSNR = Measure("psnr", "PSNR", "dB", ".1f", 1, None, "Peak over error.")
BIAS = Measure("bias", "Bias", "%", "+.1f", 0, 0.0, "Mean error.")
NEITHER = Measure("spread", "Spread", "", ".1f", 0, None, "Neither more nor less of it is better.")
POLICY = "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"

rng = np.random.default_rng(3)


def picture(height: int = 18, width: int = 32, frames: int = 1) -> bytes:
    """An image like no other."""
    images = [Image.fromarray(each) for each in rng.integers(0, 255, (frames, height, width, 3), np.uint8)]
    file = io.BytesIO()
    images[0].save(file, "WEBP" if frames > 1 else "PNG", save_all=frames > 1, append_images=images[1:])
    return file.getvalue()


def entry(rival: str, ms: float | None = None, flip: float | None = None, **values: float | None) -> Entry:
    """An entry with all that there can be."""
    curve = [] if flip is None else [flip, None, flip + 0.1, float("nan")]
    return Entry(
        rival,
        {"flip": flip, **values},
        {"flip": curve},
        ms,
        picture(),
        None if flip is None else picture(),
        picture(8, 8, 3),
        picture(4),
    )


def scene(name: str, *entries: Entry) -> Scene:
    """A scene of four frames, with a noisy input and a reference."""
    return Scene(
        name,
        "",
        (0, 1, 2, 3),
        2,
        (18, 32),
        (4, 5, 8, 8),
        9,
        [entry("noisy"), *entries, entry("reference")],
        "reference",
    )


def bare(whole: Scene) -> Scene:
    """The same with pictures alone."""
    entries = [replace(each, values={}, curves={}, milliseconds=None) for each in whole.entries]
    entries = [replace(each, heat=None, clip=None, profile=None) for each in entries]
    return replace(whole, entries=entries, crop=None, row=None)


@pytest.fixture(scope="module")
def page() -> Page:
    """Two scenes, three rivals of which one is in the first alone."""
    first = scene("one", entry("a", 1.0, 0.2), entry(NASTY, 2.0, 0.1), entry("c", 30.0, 0.05))
    second = scene(NASTY, entry("a", 1.2, 0.2), entry(NASTY, 2.0, 0.3))
    return Page("Rivals", {"device": NASTY}, [FLIP, PSNR], [first, second])


def marked(values: Mapping[str, float | None], measure: Measure) -> list[str]:
    """Who is marked as the best, where rivals have these values."""
    entries = [Entry(rival, {measure.key: value}, {}, None, b"", None, None, None) for rival, value in values.items()]
    judged = replace(scene("s"), entries=entries, noisy="noisy")
    return [rival for rival, (cell,) in table([judged], [measure]).rows.items() if cell.best]


@pytest.mark.parametrize(
    ("measure", "values", "expected"),
    [
        pytest.param(PSNR, {"a": 1.0, "b": 2.0, "c": -3.0}, ["b"], id="more is better"),
        pytest.param(FLIP, {"a": 1.0, "b": 2.0, "c": 3.0}, ["a"], id="less is better"),
        pytest.param(BIAS, {"a": -1.0, "b": 0.5, "c": 3.0}, ["b"], id="near the ideal"),
        pytest.param(BIAS, {"a": -1.0, "b": 1.0, "c": 3.0}, ["a", "b"], id="as near from either side"),
        pytest.param(NEITHER, {"a": 1.0, "b": 2.0}, [], id="neither"),
        pytest.param(PSNR, {"a": 30.01, "b": 30.04, "c": 3.0}, ["a", "b"], id="the same as written"),
        pytest.param(PSNR, {"a": 30.0, "b": float("inf")}, ["b"], id="without error"),
        pytest.param(PSNR, {"a": float("nan"), "b": 2.0, "c": 1.0, "d": None}, ["b"], id="not measured"),
        pytest.param(PSNR, {"a": 2.0, "b": float("nan")}, [], id="no choice"),
        pytest.param(PSNR, {"a": 1.0, "b": 2.0, "reference": 9.0, "noisy": 9.0}, ["b"], id="out of competition"),
    ],
)
def test_the_best_is_marked(measure: Measure, values: dict[str, float | None], expected: list[str]) -> None:
    assert marked(values, measure) == expected


def test_who_was_not_in_all_scenes_is_not_the_best_of_them(page: Page) -> None:
    rows = table(page.scenes, page.measures).rows
    assert list(rows) == ["a", NASTY, "c"]
    assert [cells[0] for cells in rows.values()] == [
        Cell("0.200", best=True),
        Cell("0.200", best=True),
        Cell("0.050", note="1 of 2 scenes"),
    ]
    assert "1 of 2 scenes" in render(page)


def test_a_measure_that_nobody_has_is_no_column(page: Page) -> None:
    assert [measure.key for measure in table(page.scenes, page.measures).measures] == ["flip", "milliseconds"]
    assert best({}, FLIP) == set()


def test_names_cannot_break_out(page: Page) -> None:
    text = render(page)
    assert "</script><b>" not in text
    assert text.count("</script>") == 2, "of the data and of the script"
    (stored,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert json.loads(stored) == json.loads(json.dumps(data(page), allow_nan=False))
    assert json.loads(stored)["rivals"] == ["noisy", "a", NASTY, "c", "reference"]


def test_every_image_is_in_the_page_once(page: Page) -> None:
    text = render(page)
    entries = [each for scene in page.scenes for each in scene.entries]
    images = [image for e in entries for image in (e.picture, e.heat, e.clip, e.profile) if image]
    assert [text.count(str(data_uri(image))) for image in images] == [1] * len(images)
    assert text.count("base64,") == len(images)


def test_nothing_may_be_fetched(page: Page) -> None:
    text = render(page)
    assert f'content="{POLICY}"' in text
    assert not re.search(r"(src|href)=\"(?!data:)", text)


PARTS = ("Summary", "Speed and error", "Animated crops", "Temporal profiles", "Over frames", "Error map", "Measures")


def test_what_there_is_no_data_for_is_left_out(page: Page) -> None:
    def shown(page: Page) -> list[str]:
        text = re.sub(r"<(style|script).*?</\1>", "", render(page), flags=re.DOTALL)
        return [part for part in PARTS if f">{part}<" in text]

    assert shown(page) == list(PARTS)
    assert shown(replace(page, scenes=page.scenes[:1])) == list(PARTS[:-1]), "its table is the summary"
    assert shown(replace(page, scenes=[bare(each) for each in page.scenes])) == []
    single = [replace(each, frames=(0,)) for each in page.scenes]
    assert "Over frames" not in shown(replace(page, scenes=single))


def test_it_is_written(page: Page, tmp_path: Path) -> None:
    write(page, tmp_path / "new" / "page.html")
    assert (tmp_path / "new" / "page.html").read_text(encoding="utf-8") == render(page)


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    """A browser for all tests here."""
    with browser(tmp_path_factory.mktemp("profile")) as tab:
        yield tab


@pytest.fixture
def tab(chromium: Tab, page: Page, tmp_path: Path) -> Iterator[Tab]:
    """The page in a browser, which must not complain of anything."""
    write(page, tmp_path / "page.html")
    chromium.open(tmp_path / "page.html")
    yield chromium
    assert chromium.complaints == []


def focus(tab: Tab, selector: str) -> None:
    """Put the focus on a control that the Tab key would reach."""
    control = f"document.querySelector({json.dumps(selector)})"
    assert tab.ask(f"{control}.tabIndex === 0 && ({control}.focus(), document.activeElement === {control})")


def shown(tab: Tab, selector: str) -> list[dict[str, Any]]:
    """What is to be seen of some elements: text, and place from the window's edges."""
    found: list[dict[str, Any]] = tab.ask(
        f"""[...document.querySelectorAll({json.dumps(selector)})].map(each => {{
          const {{ x, y, width, height }} = each.getBoundingClientRect();
          return {{ text: each.textContent, src: each.src, x, y, width, height }};
        }}).filter(each => each.width > 1)"""
    )
    return found


def views(tab: Tab) -> list[list[float]]:
    """How each picture is transformed in its pane: scale, and left and top edge in widths and heights."""
    found: list[list[float]] = tab.ask(
        """[...document.querySelectorAll(".pane")].filter(pane => pane.clientWidth).map(pane => {
          const outer = pane.getBoundingClientRect(), inner = pane.querySelector(".film").getBoundingClientRect();
          return [inner.width / outer.width, (inner.x - outer.x) / outer.width, (inner.y - outer.y) / outer.height];
        })"""
    )
    return found


def test_keys_move_all_pictures_alike(tab: Tab) -> None:
    assert views(tab) == [[1, 0, 0]] * 5
    focus(tab, ".stage")
    for key in ("+", "+", "ArrowRight", "ArrowDown", "ArrowDown"):
        tab.press(key)
    assert np.allclose(views(tab), [[2, -0.6, -0.7]] * 5, atol=1e-3)
    tab.press("-")
    assert np.allclose(np.array(views(tab))[:, 0], 2**0.5, atol=1e-3)
    tab.press("0")
    assert views(tab) == [[1, 0, 0]] * 5


def test_wheel_and_mouse_move_all_pictures_alike(tab: Tab) -> None:
    pane = tab.ask(
        """(() => {
          document.querySelector(".stage").scrollIntoView({ block: "center" });
          return document.querySelectorAll(".pane")[1].getBoundingClientRect().toJSON();
        })()"""
    )
    across, down = 8.5 / 32, 9.5 / 18  # the middle of a pixel
    x, y = pane["x"] + pane["width"] * across, pane["y"] + pane["height"] * down
    tab.mouse("mouseMoved", x, y)
    tab.mouse("mouseWheel", x, y, deltaX=0, deltaY=-100)
    assert tab.ask("document.querySelector('[name=pixel]').value") == "pixel 8, 9"
    scale = np.exp(0.4)
    assert np.allclose(views(tab), [[scale, (1 - scale) * across, (1 - scale) * down]] * 5, atol=1e-2)
    tab.mouse("mousePressed", x, y, button="left")
    tab.mouse("mouseMoved", x - pane["width"] / 10, y, button="left", buttons=1)
    tab.mouse("mouseReleased", x - pane["width"] / 10, y, button="left")
    assert np.allclose(views(tab), [[scale, (1 - scale) * across - 0.1, (1 - scale) * down]] * 5, atol=1e-2)
    assert tab.ask("document.querySelector('[name=pixel]').value") == "pixel 8, 9", "it comes along"


def test_two_fingers_zoom_all_pictures_alike(tab: Tab) -> None:
    def touch(what: str, *places: float) -> None:
        fingers = enumerate(pane["x"] + place * pane["width"] for place in places)
        points = [{"x": x, "y": pane["y"] + 50, "id": number} for number, x in fingers]
        tab.call("Input.dispatchTouchEvent", type=what, touchPoints=points)

    tab.ask("document.querySelector('.stage').scrollIntoView({ block: 'center' })")
    pane = shown(tab, ".pane")[1]
    touch("touchStart", 0.4)
    touch("touchStart", 0.4, 0.6)
    touch("touchMove", 0.3, 0.7)
    touch("touchEnd")
    assert np.allclose(np.array(views(tab))[:, :2], [[2, -0.5]] * 5, atol=1e-2)


def test_the_divider_is_moved_by_keys(tab: Tab) -> None:
    focus(tab, "[value=slider]")
    tab.press(" ")
    assert [each["text"] for each in shown(tab, ".stage figcaption b")] == ["noisy", "a"]
    focus(tab, "#divider")
    edge = "document.querySelector('.right .pane').computedStyleMap().get('clip-path').toString()"
    for key, expected in (("ArrowRight", "51%"), ("Home", "0%"), ("End", "100%"), ("ArrowLeft", "99%")):
        tab.press(key)
        tab.settle()
        assert expected in tab.ask(edge), key
    focus(tab, "[name=right]")
    for letter in "ref":
        tab.press(letter)
    assert [each["text"] for each in shown(tab, ".stage figcaption b")] == ["noisy", "reference"]


def test_another_scene_shows_its_pictures(tab: Tab, page: Page) -> None:
    def pictures() -> list[str]:
        return [each["src"] for each in shown(tab, ".picture")]

    assert pictures() == [data_uri(each.picture) for each in page.scenes[0].entries]
    focus(tab, "[name=scene]")
    tab.press("ArrowRight")
    assert pictures() == [data_uri(each.picture) for each in page.scenes[1].entries]
    assert tab.ask("[...tools.elements.left.options].filter(each => each.disabled).map(each => each.text)") == ["c"]
    focus(tab, "[name=rival]")
    tab.press(" ")
    assert pictures() == [data_uri(each.picture) for each in page.scenes[1].entries[1:]]
    assert len(shown(tab, ".clip img")) == len(shown(tab, ".profile img")) == 3, "these follow too"


def test_error_maps_take_the_pictures_place(tab: Tab, page: Page) -> None:
    focus(tab, ".stage")
    tab.press("e")
    assert [each["src"] for each in shown(tab, ".heat")] == [data_uri(e.heat) for e in page.scenes[0].entries if e.heat]
    assert len(shown(tab, ".picture")) == 2, "of those that have no error"


def test_animations_start_together(tab: Tab) -> None:
    started = """new Promise(done => {
      const clips = [...document.querySelectorAll(".scene:not([hidden]) .clip img")];
      let count = 0;
      for (const clip of clips) clip.addEventListener("load", () => { if (++count === clips.length) done(count); });
      document.querySelector(".together").click();
    })"""
    assert tab.ask(started) == 5


def test_who_wants_no_motion_sees_none(chromium: Tab, page: Page, tmp_path: Path) -> None:
    write(page, tmp_path / "page.html")
    chromium.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    chromium.open(tmp_path / "page.html")
    assert chromium.ask("[...document.querySelectorAll('.part')].map(part => part.open)") == [False, False]
    chromium.call("Emulation.setEmulatedMedia", features=[])


def test_plots_are_drawn_and_read(tab: Tab) -> None:
    tab.settle()
    (speed,) = shown(tab, "#speed svg")
    assert all(name in speed["text"] for name in ("a", NASTY, "c", "ms per frame", "FLIP (less is better)"))
    assert [each["text"] for each in shown(tab, ".legend li")] == ["a", NASTY, "c"]
    lines = "[...document.querySelectorAll('.scene:not([hidden]) .chart path[fill=none]')]"
    dashes = tab.ask(f"{lines}.map(each => each.getAttribute('stroke-dasharray'))")
    assert len(set(dashes)) == len(dashes) == 3


@pytest.mark.parametrize("layout", ["grid", "slider"])
def test_a_phone_need_not_scroll_sideways(tab: Tab, layout: str) -> None:
    tab.ask(f"document.querySelector('[value={layout}]').click()")
    tab.resize(390, 844)
    tab.settle()
    assert tab.ask("[innerWidth, document.documentElement.scrollWidth]") == [390, 390]


def test_without_a_script_pictures_and_tables_are_there(chromium: Tab, page: Page, tmp_path: Path) -> None:
    write(page, tmp_path / "page.html")
    chromium.call("Emulation.setScriptExecutionDisabled", value=True)
    try:
        chromium.open(tmp_path / "page.html")
        assert len(shown(chromium, ".picture")) == 9
        assert len(shown(chromium, ".heat")) == 5
        assert len(shown(chromium, "table")) == 3
        assert shown(chromium, "form, .chart, input, button") == []
    finally:
        chromium.call("Emulation.setScriptExecutionDisabled", value=False)
