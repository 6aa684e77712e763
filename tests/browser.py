"""A headless Chromium that does what a reader of a page does: real keys, real pointers, a window of any width."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from select import select
from typing import Any

import pytest

OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe")
PATIENCE = 30  # seconds
# Keys that are no character: what Windows calls them, by which Chromium knows what a control does with them.
CODES = {"Tab": 9, "End": 35, "Home": 36, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}


def chromium() -> str:
    """The browser; where it is missing the test is skipped, but fails in CI, which installs it."""
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if found is None:
        missing = "no chromium here to look at the page with (apt-get install chromium)"
        if os.environ.get("CI"):
            pytest.fail(missing)
        pytest.skip(missing)
    return found


class Tab:
    """A tab of a browser, spoken to in the DevTools protocol."""

    def __init__(self, to: int, back: int) -> None:
        self._to, self._back = to, back
        self._unread = b""
        self._count = 0
        self._session: dict[str, str] = {}
        self.complaints: list[str] = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = {"sessionId": self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]}
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Have the browser do something; returns what it answers."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters} | self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while (answer := self._read()).get("id") != self._count:
            pass
        assert "error" not in answer, answer
        result: dict[str, Any] = answer["result"]
        return result

    def open(self, page: Path | str, width: int = 1400, height: int = 1000) -> None:
        """Open a page, a file or an address, in a window of that size, and wait until all of it is there."""
        self.resize(width, height)
        self.call("Page.navigate", url=page.as_uri() if isinstance(page, Path) else page)
        while self._read().get("method") != "Page.loadEventFired":
            pass

    def resize(self, width: int, height: int = 1000) -> None:
        """Make the window that wide and high; as narrow as a phone's, too."""
        self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )

    def settle(self) -> None:
        """Wait until what was changed is drawn."""
        self.ask("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))")

    def ask(self, script: str) -> Any:
        """Evaluate JavaScript in the page."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def press(self, key: str) -> None:
        """Press a key and let it go."""
        text = {} if key in CODES else {"text": key}
        code = CODES.get(key, 0)
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code)

    def mouse(self, what: str, x: float, y: float, **more: Any) -> None:
        """Let the mouse do something at a place in the window."""
        self.call("Input.dispatchMouseEvent", type=what, x=x, y=y, **more)

    def _read(self) -> dict[str, Any]:
        """Read the next answer or event, and note what the page complains of."""
        while b"\0" not in self._unread:
            assert select([self._back], [], [], PATIENCE)[0], "the browser does not answer"
            more = os.read(self._back, 2**16)
            assert more, "the browser is gone"
            self._unread += more
        text, _, self._unread = self._unread.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        if message.get("method") in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"):
            self.complaints.append(json.dumps(message["params"]))
        return message


@contextmanager
def browser(profile: Path) -> Iterator[Tab]:
    """Start a browser with one tab."""
    (theirs, to), (back, answers) = os.pipe(), os.pipe()
    # The browser listens on descriptor 3 and answers on 4.
    command = ["bash", "-c", f'exec "$@" 3<&{theirs} 4>&{answers}', "bash", chromium(), *OPTIONS]
    process = subprocess.Popen(
        [*command, f"--user-data-dir={profile}"], pass_fds=(theirs, answers), stderr=subprocess.DEVNULL
    )
    os.close(theirs)
    os.close(answers)
    try:
        yield Tab(to, back)
    finally:
        process.terminate()
        process.wait(timeout=PATIENCE)
        os.close(to)
        os.close(back)
