from __future__ import annotations

import base64
from pathlib import Path

import pytest

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.gltf.resources import resource

DATA = b"\0\xff>>?? 1"  # its base64 has + and / and padding
TEXT = base64.b64encode(DATA).decode()


@pytest.mark.parametrize(
    ("uri", "name"),
    [
        ("my%20scene.bin", "my scene.bin"),
        ("my scene.bin", "my scene.bin"),
        ("%C3%BCber%23%25.bin", "über#%.bin"),
        ("über.bin", "über.bin"),
        ("100%.bin", "100%.bin"),
        ("a%20b.bin", "a%20b.bin"),  # an exporter that has left it as it was
        ("a+b.bin", "a+b.bin"),
        ("a%2Fb.bin", "a/b.bin"),
        ("./a/../a/b.bin", "a/b.bin"),
        ("data/a.bin", "data/a.bin"),
        ("data%5Ca.bin", "data/a.bin"),
        ("DATA\\A.bin", "data/a.bin"),
        ("u\u0308.bin", "\u00fc.bin"),
    ],
)
def test_a_file_beside_is_found_however_its_name_is_written(uri: str, name: str, tmp_path: Path) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_bytes(DATA)
    assert resource(tmp_path, uri) == DATA


def test_a_name_is_decoded_where_both_are_there(tmp_path: Path) -> None:
    (tmp_path / "a b").write_bytes(b"decoded")
    (tmp_path / "a%20b").write_bytes(b"as it stands")
    assert resource(tmp_path, "a%20b") == b"decoded"


@pytest.mark.parametrize(
    "uri",
    [
        f"data:application/octet-stream;base64,{TEXT}",
        f"data:application/gltf-buffer;base64,{TEXT}",
        f"data:;base64,{TEXT}",
        f"DATA:image/png;charset=utf-8;BASE64,{TEXT}",
        f"data:;base64,{TEXT.rstrip('=')}",
        f"data:;base64,{TEXT[:4]}\n {TEXT[4:]}",
        "data:;base64," + TEXT.replace("+", "%2B").replace("/", "%2F").replace("=", "%3D"),
        "data:,%00%FF%3E>??%201",
    ],
)
def test_data_is_read_out_of_the_uri_itself(uri: str, tmp_path: Path) -> None:
    assert resource(tmp_path, uri) == DATA


@pytest.mark.parametrize("uri", ["../a.bin", "%2e%2e/a.bin", "..%2Fa.bin", "x/../../a.bin", "/etc/passwd", "link"])
def test_nothing_outside_the_folder_is_read(uri: str, tmp_path: Path) -> None:
    (tmp_path / "a.bin").write_bytes(DATA)
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "link").symlink_to(tmp_path / "a.bin")
    with pytest.raises(SceneError, match="expected a file in the model's folder or below, found none called '"):
        resource(tmp_path / "inner", uri)


@pytest.mark.parametrize("uri", ["http://localhost:1/a.bin", "file:///etc/passwd", "none.bin", "", ".", "a\0b"])
def test_what_is_not_there_is_named(uri: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"expected a file in the model's folder or below, found none called '"):
        resource(tmp_path, uri)


@pytest.mark.parametrize(
    "uri", ["data:;base64,@@@@", "data:;base64,AAAA-_AA", "data:;base64,AAAAA", "data:", "data:AAAA"]
)
def test_damaged_data_is_refused(uri: str, tmp_path: Path) -> None:
    """Python leaves out what is no base64, and all that is behind moves up."""
    with pytest.raises(SceneError, match=r"expected data (in base64|behind a comma), found"):
        resource(tmp_path, uri)
