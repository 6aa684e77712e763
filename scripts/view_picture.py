"""Writes docs/view.webp, the picture of `svgf-cl view`, from the output of `svgf-cl demo` in out/demo.

Needs Chromium.
"""

from __future__ import annotations

import base64
import io
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO

import numpy as np
from PIL import Image

from svgf_cl.compare.imagery import encoded
from svgf_cl.io.atomic import written_whole
from svgf_cl_tracer.cli.demo import viewing
from tests.browser import browser

DEMO = Path("out/demo")
TARGET = Path("docs/view.webp")
FRAME = 15  # a frame with a reference
SIZE = 1400, 840

QUALITY = 75  # of the WebP; text stays sharp

# Play up to the frame FRAME.
PLAYED = f"""new Promise(done => {{
  const number = document.querySelector("#frame");
  const wait = () => number.value.startsWith("frame {FRAME} ") ? done() : requestAnimationFrame(wait);
  wait();
}})"""


def main() -> None:
    """Let the page show a frame, and write a screenshot."""
    with served() as url, TemporaryDirectory() as profile, browser(Path(profile)) as tab:
        tab.open(url, *SIZE)
        tab.ask(PLAYED)
        shot = base64.b64decode(tab.call("Page.captureScreenshot", format="png")["data"])
    picture = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"))
    with written_whole(TARGET) as aside:
        aside.write_bytes(encoded(picture, QUALITY))
    print(f"{TARGET}: {TARGET.stat().st_size / 1000:.0f} kB")


@contextmanager
def served() -> Iterator[str]:
    """Serve the page, and yield its address."""
    command = [sys.executable, "-m", "svgf_cl", *viewing(DEMO)[1:], "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield address(process.stdout)
        finally:
            process.terminate()


def address(said: IO[str]) -> str:
    """The address in the output of `svgf-cl view`."""
    return next(word for line in said for word in line.split() if word.startswith("http://"))


if __name__ == "__main__":
    main()
