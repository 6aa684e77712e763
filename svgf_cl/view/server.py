"""The server of the page, which answers requests from this machine only.

========  ========  ================================================================================================
request   path      answer
========  ========  ================================================================================================
GET       /         the page; its other files have their own paths (`FILES`)
GET       /clip     the clip, the filters with their settings, and the initial state; JSON
POST      /frame    for ``{"index": 3, "filter": "kalman", "settings": {}, "exposure": 0.0}``, the pictures of a frame:
                    noisy, denoised, and the reference if there is one, each 8-bit RGB, row by row from the top; the
                    header ``Frame`` has times and measures as JSON
========  ========  ================================================================================================

Pictures are not compressed. On a busy CPU with two cores, showing three pictures of 1280x720 takes 0.2 s without
compression, 0.8 s as PNG of the lowest level and 0.7 s as lossless WebP.

Errors in a request are answered as ``{"error": "..."}`` with status 400.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from threading import Lock
from typing import Any

from svgf_cl.errors import SvgfError, shown
from svgf_cl.filters.filter import Filter
from svgf_cl.io.display import MAX_STOPS, Bytes
from svgf_cl.view.controls import controls, filter_of, values
from svgf_cl.view.player import Player
from svgf_cl.view.screen import Screen

HOST = "127.0.0.1"
LARGEST = 2**16  # bytes of the largest request

# Package and content type of each file of the page.
FILES = {
    "/": ("svgf_cl.view", "page.html", "text/html"),
    "/page.css": ("svgf_cl.view", "page.css", "text/css"),
    "/page.js": ("svgf_cl.view", "page.js", "text/javascript"),
    "/controls.css": ("svgf_cl.compare", "controls.css", "text/css"),
    "/gestures.js": ("svgf_cl.compare", "gestures.js", "text/javascript"),
}
# The page may load nothing from elsewhere, and no other page may embed it.
HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; connect-src 'self'; script-src 'self'; style-src 'self';"
    " img-src data:; frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}


@dataclass(frozen=True)
class Start:
    """The initial state of the page.

    Parameters
    ----------
    settings : Filter
    exposure : float, stops
    device : str
        The device that filters run on, as text for the page.
    """

    settings: Filter
    exposure: float
    device: str


class Server(ThreadingHTTPServer):
    """Answers the page of one player, once `play` is called.

    Parameters
    ----------
    port : int
        0 for any free port. The port is opened at once.

    Raises
    ------
    SvgfError
        If the port is in use, or users may not open it.
    """

    daemon_threads = True

    def __init__(self, port: int) -> None:
        try:
            super().__init__((HOST, port), Handler)
        except OSError as error:
            raise SvgfError(f"--port: expected a free port, got {port} ({error.strerror}); choose another") from error

    def play(self, player: Player, start: Start, poll: float = 0.5) -> None:
        """Answer requests until `shutdown` is called, which takes effect within `poll` seconds."""
        self._player, self._start, self._screen, self._lock = player, start, Screen(), Lock()
        try:
            self.serve_forever(poll)
        finally:
            self._lock.acquire()  # never released: the device must be idle when the process ends

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://{HOST}:{self.server_port}/"

    @property
    def hosts(self) -> set[str]:
        """The names by which a browser on this machine may call this server.

        A request with another name may come from a page of another site (DNS rebinding).
        """
        return {f"{HOST}:{self.server_port}", f"localhost:{self.server_port}"}

    def clip(self) -> dict[str, Any]:
        """The clip, the filters, and the initial state."""
        clip, (height, width) = self._player.clip, self._player.clip.shape
        return {
            "name": clip.name,
            "note": clip.note,
            "width": width,
            "height": height,
            "numbers": list(clip.numbers),
            "has_references": clip.has_references,
            "device": self._start.device,
            "filters": controls(),
            "filter": self._start.settings.name,
            "settings": values(self._start.settings),
            "exposure": self._start.exposure,
        }

    def frame(self, wanted: object) -> tuple[dict[str, Any], list[Bytes]]:
        """Times and measures of a frame, and its pictures; `SvgfError` if it cannot be shown."""
        if not isinstance(wanted, Mapping):
            raise SvgfError(f"frame: expected index, filter, settings and exposure, got {shown(wanted)}")
        index, exposure = wanted.get("index"), wanted.get("exposure", 0.0)
        if not isinstance(index, int) or isinstance(index, bool):
            raise SvgfError(f"index: expected a whole number, got {shown(index)}")
        if not isinstance(exposure, int | float) or not -MAX_STOPS <= exposure <= MAX_STOPS:
            raise SvgfError(f"exposure: expected stops in -{MAX_STOPS}..{MAX_STOPS}, got {shown(exposure)}")
        settings = filter_of(wanted.get("filter"), wanted.get("settings", {}))
        with self._lock:
            item, made = self._player.show(index, settings)
            view = self._screen.show(index, item, made, float(exposure))
        about = {
            "index": index,
            "times": made.times,
            "psnr": {name: finite(value) for name, value in view.psnr.items()},
            "temporal": {name: finite(value) for name, value in view.temporal.items()},
            "pictures": list(view.pictures),
        }
        return about, list(view.pictures.values())

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore errors of connections that a closed tab has ended."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


def finite(value: float) -> float | None:
    """A number for JSON: None if it is infinite or NaN."""
    return value if math.isfinite(value) else None


def parsed(body: bytes) -> object:
    """Parse JSON; `SvgfError` if the text is not JSON."""
    try:
        return json.loads(body)
    except (ValueError, RecursionError) as error:
        raise SvgfError(f"expected JSON, got {shown(body)} ({error})") from error


class Handler(BaseHTTPRequestHandler):
    """Answers the requests of one connection."""

    protocol_version = "HTTP/1.1"  # keeps connections open
    server: Server

    def do_GET(self) -> None:
        """Send the page, one of its files, or the clip."""
        if not self._is_from_here():
            return
        if self.path == "/clip":
            self._send_json(self.server.clip())
        elif self.path in FILES:
            package, name, kind = FILES[self.path]
            self._send(f"{kind}; charset=utf-8", (resources.files(package) / name).read_bytes())
        else:
            self._refuse(HTTPStatus.NOT_FOUND, f"expected one of {', '.join(FILES)}, got {shown(self.path)}")

    def do_POST(self) -> None:
        """Send a frame."""
        body = self._body()
        if body is None or not self._is_from_here():
            return
        if self.path != "/frame":
            self._refuse(HTTPStatus.NOT_FOUND, f"expected /frame, got {shown(self.path)}")
            return
        try:
            about, pictures = self.server.frame(parsed(body))
        except (SvgfError, MemoryError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, str(error))
        else:
            self._send("application/octet-stream", *(picture.data for picture in pictures), Frame=json.dumps(about))

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing, because there would be a line for every frame."""

    def _is_from_here(self) -> bool:
        """Refuse requests from pages of another origin, and requests that use another name of this machine."""
        if self.headers.get("Host") not in self.server.hosts:
            self._refuse(HTTPStatus.FORBIDDEN, f"expected the host {self.server.url}")
            return False
        origin = self.headers.get("Origin")
        if origin is not None and origin.partition("://")[2] not in self.server.hosts:
            self._refuse(HTTPStatus.FORBIDDEN, f"expected a request of the page at {self.server.url}")
            return False
        return True

    def _body(self) -> bytes | None:
        """The body of the request; None if it was refused."""
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdecimal() or int(length) > LARGEST:
            self.close_connection = True  # because the rest is not read
            self._refuse(HTTPStatus.BAD_REQUEST, f"expected at most {LARGEST} bytes, got {shown(length)}")
            return None
        return self.rfile.read(int(length))

    def _refuse(self, status: HTTPStatus, complaint: str) -> None:
        self._send("application/json", json.dumps({"error": complaint}).encode(), status=status)

    def _send_json(self, content: object) -> None:
        self._send("application/json", json.dumps(content).encode())

    def _send(self, kind: str, *parts: bytes | memoryview, status: HTTPStatus = HTTPStatus.OK, **headers: str) -> None:
        """Send an answer that consists of these parts, in order."""
        self.send_response(status)
        size = sum(memoryview(part).nbytes for part in parts)
        for name, value in {**HEADERS, **headers, "Content-Type": kind, "Content-Length": str(size)}.items():
            self.send_header(name, value)
        self.end_headers()
        for part in parts:
            self.wfile.write(part)
