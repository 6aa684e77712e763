"""The server: what it answers, to whom, and what it says of wrong requests."""

from __future__ import annotations

import http.client
import json
import socket
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from svgf_cl import Denoiser, SvgfError
from svgf_cl.io.synthetic import room_frames
from svgf_cl.view.screen import fast_bytes
from svgf_cl.view.server import FILES, Server
from tests.svgf_cl.view.clips import SHAPE, Listed, serving

FRAME = {"index": 0, "filter": "kalman", "settings": {}, "exposure": 0.0}


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serving() as server:
        yield server


class Answer:
    """The answer to a request."""

    def __init__(self, server: Server, method: str, path: str, body: Any = None, **headers: str) -> None:
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body if isinstance(body, str | None) else json.dumps(body), sent)
        answer = connection.getresponse()
        self.status, self.headers, self.body = answer.status, answer.headers, answer.read()
        connection.close()

    @property
    def complaint(self) -> str:
        assert self.status >= 400
        return str(json.loads(self.body)["error"])


@pytest.mark.parametrize("path", FILES)
def test_the_page_is_whole(path: str, server: Server) -> None:
    answer = Answer(server, "GET", path)
    assert answer.status == 200
    assert answer.body
    assert answer.headers["Content-Type"] == f"{FILES[path][2]}; charset=utf-8"
    assert answer.headers["Content-Security-Policy"].startswith("default-src 'none'; connect-src 'self'")


def test_the_page_asks_for_nothing_that_is_not_there(server: Server) -> None:
    page = Answer(server, "GET", "/").body.decode()
    assert {part.split('"')[0] for part in page.split('href="/')[1:] + page.split('src="/')[1:]} == {
        path[1:] for path in FILES if path != "/"
    }
    assert "http" not in page


def test_it_says_what_is_played(server: Server) -> None:
    clip = json.loads(Answer(server, "GET", "/clip").body)
    assert (clip["name"], clip["height"], clip["width"], clip["numbers"]) == ("room", *SHAPE, [0, 1, 2, 3])
    assert clip["has_references"]
    assert (clip["filter"], clip["settings"]["iterations"], clip["device"]) == ("kalman", 4, "a device")
    assert {"kalman", "svgf"} <= clip["filters"].keys()


def test_a_frame_is_its_pictures_one_behind_the_other(server: Server) -> None:
    answer = Answer(server, "POST", "/frame", {**FRAME, "exposure": 1.0})
    pictures = np.frombuffer(answer.body, np.uint8).reshape(3, *SHAPE, 3)
    (frame,) = room_frames(SHAPE, 1)
    with Denoiser(SHAPE) as den:
        expected = (frame.color, den.denoise(frame), np.float32(0.5) * frame.albedo)
    assert np.array_equal(pictures, [fast_bytes(picture, 1.0) for picture in expected])
    about = json.loads(answer.headers["Frame"])
    assert about["pictures"] == ["noisy", "denoised", "reference"]
    assert about["psnr"]["denoised"] > about["psnr"]["noisy"]
    assert "demodulate" in about["times"]


def test_frames_that_follow_have_a_temporal_error(server: Server) -> None:
    abouts = [json.loads(Answer(server, "POST", "/frame", {**FRAME, "index": n}).headers["Frame"]) for n in (0, 1)]
    assert abouts[0]["temporal"] == {}
    assert abouts[1]["temporal"]["denoised"] < abouts[1]["temporal"]["noisy"]


def test_a_picture_without_error_has_no_number_that_json_lacks() -> None:
    frames = list(room_frames(SHAPE, 2))
    with serving(Listed(frames)) as server:
        assert json.loads(Answer(server, "POST", "/frame", FRAME).headers["Frame"])["psnr"] == {}
    from svgf_cl.view.server import finite

    assert [finite(value) for value in (1.5, float("inf"), float("nan"))] == [1.5, None, None]


@pytest.mark.parametrize(
    ("words", "body"),
    [
        ("expected JSON, got b'{'", "{"),
        ("expected JSON, got ", "[" * 50_000),
        ("frame: expected index, filter, settings and exposure, got [1]", [1]),
        ("index: expected a whole number, got None", {}),
        ("index: expected a whole number, got True", {**FRAME, "index": True}),
        ("index: expected 0 to 3, got 4", {**FRAME, "index": 4}),
        ("filter: expected kalman or ", {**FRAME, "filter": "nlm"}),
        ("Kalman.iterations: expected a whole number in 1..5, got 9", {**FRAME, "settings": {"iterations": 9}}),
        ("exposure: expected stops in -64..64, got nan", {**FRAME, "exposure": float("nan")}),
        ("exposure: expected stops in -64..64, got '1'", {**FRAME, "exposure": "1"}),
        ("expected at most 65536 bytes, got '65537'", " " * 65537),
    ],
)
def test_a_wrong_request_is_refused_by_name(words: str, body: Any, server: Server) -> None:
    answer = Answer(server, "POST", "/frame", body)
    assert answer.status == 400
    assert words in answer.complaint
    assert Answer(server, "POST", "/frame", FRAME).status == 200, "the next one is answered"


@pytest.mark.parametrize(("method", "path"), [("GET", "/../server.py"), ("GET", "/frame"), ("POST", "/clip")])
def test_what_is_not_there_is_not_found(method: str, path: str, server: Server) -> None:
    answer = Answer(server, method, path, "" if method == "POST" else None)
    assert answer.status == 404
    assert "expected " in answer.complaint


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize("headers", [{"Host": "evil.example"}, {"Origin": "http://evil.example"}, {"Origin": "null"}])
def test_a_page_from_elsewhere_is_not_answered(method: str, headers: dict[str, str], server: Server) -> None:
    answer = Answer(server, method, "/frame" if method == "POST" else "/clip", FRAME, **headers)
    assert answer.status == 403
    assert f"127.0.0.1:{server.server_port}" in answer.complaint


def test_its_own_page_is_answered_by_either_name(server: Server) -> None:
    for host in server.hosts:
        assert Answer(server, "GET", "/clip", Host=host, Origin=f"http://{host}").status == 200


def test_no_other_machine_reaches_it(server: Server) -> None:
    assert server.server_address[0] == "127.0.0.1"


def test_a_used_port_is_refused(server: Server) -> None:
    with pytest.raises(
        SvgfError, match=rf"--port: expected a free port, got {server.server_port} \(.*\); choose another"
    ):
        Server(server.server_port)


def test_a_damaged_frame_is_told_and_the_next_one_shown() -> None:
    with serving(Listed(list(room_frames(SHAPE, 4)), damaged=(1,))) as server:
        statuses = [Answer(server, "POST", "/frame", {**FRAME, "index": n}) for n in range(4)]
        assert [each.status for each in statuses] == [200, 400, 200, 200]
        assert statuses[1].complaint == "frame.101.exr: expected an EXR file, found none"


def test_a_tab_that_is_closed_leaves_no_trace(server: Server, capfd: pytest.CaptureFixture[str]) -> None:
    with socket.create_connection(("127.0.0.1", server.server_port)) as tab:
        body = json.dumps(FRAME)
        head = f"POST /frame HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\nContent-Length: {len(body)}\r\n\r\n"
        tab.sendall(f"{head}{body}".encode())
        tab.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # a reset
    assert Answer(server, "POST", "/frame", FRAME).status == 200
    assert capfd.readouterr().err == ""
