"""The page in a real browser, played by a real server."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest

from svgf_cl import Denoiser, Kalman, Settings
from svgf_cl.io.synthetic import room_frames
from svgf_cl.view.controls import controls
from svgf_cl.view.scenes import room
from tests.browser import Tab, browser
from tests.svgf_cl.view.clips import Listed, serving

SHAPE = (90, 160)
WITHIN = 20  # seconds


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browser(tmp_path_factory.mktemp("profile")) as tab:
        yield tab


@pytest.fixture(scope="module", autouse=True)
def built() -> None:
    """All kernels are built before the page waits for them, which may take longer than `WITHIN`."""
    (frame,) = room_frames(SHAPE, 1)
    for settings in (Kalman(), Kalman(iterations=2), Settings()):
        with Denoiser(SHAPE, settings=settings) as den:
            den.denoise(frame)


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(room(SHAPE, 6)) as server:
        yield server.url


@pytest.fixture
def tab(chromium: Tab, url: str) -> Iterator[Tab]:
    """The page, playing."""
    chromium.complaints.clear()
    chromium.open(url)
    until(chromium, "document.querySelector('#frame').value")
    yield chromium
    assert chromium.complaints == []


def until(tab: Tab, script: str) -> Any:
    """Wait until a script gives something, and return that."""
    found = tab.ask(
        f"""(async () => {{
          for (const end = performance.now() + {1000 * WITHIN}; performance.now() < end;) {{
            const found = {script};
            if (found) return found;
            await new Promise(done => setTimeout(done, 20));
          }}
        }})()"""
    )
    assert found, f"not within {WITHIN} s: {script}"
    return found


def text(tab: Tab, selector: str) -> str:
    return str(tab.ask(f"document.querySelector('{selector}').textContent"))


def frame(tab: Tab) -> int:
    """The number of the frame that is shown."""
    return int(text(tab, "#frame").split()[1])


def pause(tab: Tab) -> None:
    """Stop playing, and wait until the last frame that was asked for is drawn."""
    if text(tab, "#play") == "Pause":
        tab.press(" ")
    before = -1
    while before != frame(tab):
        before = frame(tab)
        tab.ask("new Promise(done => setTimeout(done, 300))")


def go(tab: Tab, key: str, number: int) -> None:
    tab.press(key)
    until(tab, f"document.querySelector('#frame').value.startsWith('frame {number} ')")


def mean(tab: Tab, picture: str) -> list[float]:
    """Mean and standard deviation of a picture's red."""
    found: list[float] = tab.ask(
        f"""(() => {{
          const canvas = document.querySelector('[data-picture={picture}] canvas');
          const size = [canvas.width, canvas.height], often = {{ willReadFrequently: true }};
          const copy = new OffscreenCanvas(...size).getContext('2d', often);
          copy.drawImage(canvas, 0, 0);
          const pixels = copy.getImageData(0, 0, ...size).data;
          const red = pixels.filter((_, index) => index % 4 === 0), mean = red.reduce((a, b) => a + b) / red.length;
          return [mean, Math.sqrt(red.reduce((sum, each) => sum + (each - mean) ** 2, 0) / red.length)];
        }})()"""
    )
    return found


def test_it_plays_on_and_round_and_shows_times_and_errors(tab: Tab) -> None:
    until(tab, "document.querySelector('#rate').value.endsWith(' fps')")
    seen = {frame(tab)}
    for _ in range(200):
        seen.add(frame(tab))
        if seen == set(range(6)):
            break
        tab.ask("new Promise(done => setTimeout(done, 50))")
    assert seen == set(range(6))
    assert text(tab, "#time").endswith(" ms")
    assert "demodulate" in text(tab, "#times")
    denoised = until(tab, "document.querySelector('[data-picture=denoised] output').value.includes('temporal') && "
        "document.querySelector('[data-picture=denoised] output').value")  # fmt: skip
    assert " dB, temporal error 0." in denoised
    assert text(tab, "#name") == "room"


def test_pictures_are_drawn(tab: Tab) -> None:
    pause(tab)
    noisy, denoised, reference = (mean(tab, name) for name in ("noisy", "denoised", "reference"))
    assert denoised[0] == pytest.approx(reference[0], abs=5)
    assert noisy[1] > 1.5 * denoised[1]


def test_keys_pause_and_step_in_both_directions(tab: Tab) -> None:
    pause(tab)
    assert text(tab, "#play") == "Play"
    go(tab, "Home", 0)
    for number in (1, 2, 3):
        go(tab, "ArrowRight", number)
    first = text(tab, "[data-picture=denoised] output").split()[0]
    go(tab, "ArrowLeft", 2)
    go(tab, "ArrowRight", 3)
    assert text(tab, "[data-picture=denoised] output").split()[0] == first, "shown as it was"
    tab.press(" ")
    until(tab, "document.querySelector('#frame').value.startsWith('frame 5 ')")


def test_another_filter_has_other_settings_and_other_passes(tab: Tab) -> None:
    assert "change threshold" in text(tab, "#settings")
    tab.press("f")
    until(tab, "document.querySelector('#times').textContent.includes('temporal')")
    assert tab.ask("document.querySelector('[name=filter]').value") == "svgf"
    assert "change threshold" not in text(tab, "#settings")
    assert text(tab, "#play") == "Pause", "it plays on"


def test_a_setting_is_changed_while_it_plays(tab: Tab) -> None:
    change = """(() => {
      const field = document.querySelector('[data-name=iterations] input[type=number]');
      field.value = VALUE;
      field.dispatchEvent(new Event('input', { bubbles: true }));
    })()"""
    until(tab, "document.querySelector('#times').textContent.includes('atrous 4')")
    tab.ask(change.replace("VALUE", "2"))
    until(tab, "!document.querySelector('#times').textContent.includes('atrous 3')")
    assert tab.ask("document.querySelector('[data-name=iterations]').className") == "setting changed"
    (reason,) = (each["reason"] for each in controls()["kalman"] if each["name"] == "iterations")
    assert tab.ask("document.querySelector('[data-name=iterations]').title") == reason
    tab.ask(change.replace("VALUE", "99"))
    tab.ask("document.querySelector('#defaults').click()")
    until(tab, "document.querySelector('#times').textContent.includes('atrous 4')")
    assert text(tab, "#play") == "Pause", "a value that is out of range was not sent"
    assert text(tab, "#complaint") == ""


def test_exposure_changes_a_picture_that_stands_still(tab: Tab) -> None:
    pause(tab)
    before = mean(tab, "reference")[0]
    for _ in range(4):
        tab.press("]")
    until(tab, "document.querySelector('[name=exposure]').value === '2'")
    tab.ask("new Promise(done => setTimeout(done, 500))")
    assert mean(tab, "reference")[0] > before + 20


def test_zoom_and_drag_move_all_pictures_alike(tab: Tab) -> None:
    pause(tab)
    places = """[...document.querySelectorAll('canvas')].map(canvas => {
      const inner = canvas.getBoundingClientRect(), outer = canvas.parentElement.getBoundingClientRect();
      return [inner.width / canvas.width, inner.x - outer.x, inner.y - outer.y].map(each => Math.round(each * 8) / 8);
    })"""
    tab.ask("document.querySelector('[name=zoom][value=\"4\"]').click()")
    before = tab.ask(places)
    assert [each[0] for each in before] == [4, 4, 4]
    assert before[0] == before[1] == before[2]
    x, y = tab.ask("(() => { const box = document.querySelector('.pane').getBoundingClientRect(); "
        "return [box.x + box.width / 2, box.y + box.height / 2]; })()")  # fmt: skip
    tab.mouse("mousePressed", x, y, button="left")
    tab.mouse("mouseMoved", x - 30, y, button="left", buttons=1)
    tab.mouse("mouseReleased", x - 30, y, button="left")
    after = tab.ask(places)
    assert after[0] == after[1] == after[2] == [4, pytest.approx(before[0][1] - 30, abs=1), before[0][2]]
    assert tab.ask("document.querySelector('#pixel').value").startswith("pixel ")
    tab.press("0")
    assert tab.ask("document.querySelector('[name=zoom]:checked').value") == "0"


def test_two_pictures_lie_on_each_other_with_a_divider(tab: Tab) -> None:
    shown = (
        "[...document.querySelectorAll('figure')].filter(each => each.clientWidth).map(each => each.dataset.picture)"
    )
    assert tab.ask(shown) == ["noisy", "denoised", "reference"]
    tab.press("1")
    assert tab.ask(shown) == ["denoised", "reference"]
    tab.press("w")
    assert tab.ask(shown) == ["noisy", "denoised"]
    tab.ask("document.querySelector('#divider').focus()")
    tab.press("Home")
    tab.press("ArrowRight")
    tab.settle()
    edge = "document.querySelector('.right .pane').computedStyleMap().get('clip-path').toString()"
    assert "1%" in tab.ask(edge)


def repeat(tab: Tab, how: str) -> None:
    tab.ask(f"document.querySelector('[name=repeat]').value = '{how}'")


def test_without_loop_it_stops_at_the_end_and_begins_anew(tab: Tab) -> None:
    repeat(tab, "once")
    until(tab, "document.querySelector('#play').textContent === 'Play'")
    assert frame(tab) == 5
    tab.press(" ")
    until(tab, "document.querySelector('#frame').value.startsWith('frame 2 ')")


def test_ping_pong_plays_backward_from_the_end(tab: Tab) -> None:
    repeat(tab, "ping-pong")
    numbers = tab.ask(
        """new Promise(done => {
          const number = document.querySelector('#frame'), seen = [];
          new MutationObserver(() => seen.push(number.value.split(' ')[1]) > 24 && done(seen))
            .observe(number, { childList: true });
        })"""
    )
    steps = [int(after) - int(before) for before, after in pairwise(numbers)]
    assert set(steps) == {-1, 1}
    turns = [number for number, (before, after) in zip(numbers[1:], pairwise(steps), strict=False) if before != after]
    assert set(turns) == {"0", "5"}


def test_a_damaged_frame_stops_it_with_a_message(chromium: Tab) -> None:
    with serving(Listed(list(room_frames((18, 32), 4)), damaged=(2,))) as server:
        chromium.open(server.url)
        until(chromium, "!document.querySelector('#complaint').hidden")
        assert text(chromium, "#complaint") == "frame.102.exr: expected an EXR file, found none"
        assert text(chromium, "#play") == "Play"
        assert frame(chromium) == 101
        assert chromium.ask("document.querySelector('[value=reference]').disabled"), "there is none"
        chromium.press("ArrowRight")
        until(chromium, "document.querySelector('#frame').value.startsWith('frame 103 ')")
        assert chromium.ask("document.querySelector('#complaint').hidden")


def test_a_server_that_is_gone_is_told(tab: Tab) -> None:
    def connect(offline: bool) -> None:
        unlimited = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
        tab.call("Network.emulateNetworkConditions", offline=offline, **unlimited)

    tab.call("Network.enable")
    connect(offline=True)
    try:
        until(tab, "document.querySelector('#complaint').textContent.startsWith('svgf-cl view has ended')")
        assert text(tab, "#play") == "Play"
    finally:
        connect(offline=False)
        tab.call("Network.disable")
    tab.complaints.clear()  # the browser's own, of a request that failed
    tab.press(" ")
    until(tab, "document.querySelector('#complaint').hidden")


def test_a_phone_need_not_scroll_sideways(tab: Tab) -> None:
    tab.resize(390, 844)
    tab.settle()
    assert tab.ask("[innerWidth, document.documentElement.scrollWidth]") == [390, 390]
