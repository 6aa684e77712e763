from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl_tracer.folder import found_inside


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A model's folder with files in it, and one beside it that is none of its business."""
    root = tmp_path / "model"
    (root / "Tex").mkdir(parents=True)
    for name in ("Tex/Red Wall.PNG", "a.png", "A.png", "Tex/a.png", "T\u00fcr.png", "Tex/a.mtl"):
        (root / name).write_bytes(b"")
    (tmp_path / "secret.png").write_bytes(b"")
    (root / "link.png").symlink_to(tmp_path / "secret.png")
    (root / "loop.png").symlink_to("loop.png")
    return root


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("Tex/Red Wall.PNG", "Tex/Red Wall.PNG"),
        ("tex\\red wall.png", "Tex/Red Wall.PNG"),
        (".\\TEX\\red wall.png ", "Tex/Red Wall.PNG"),
        ('"Tex/Red Wall.PNG"', "Tex/Red Wall.PNG"),
        ("a.png", "a.png"),
        ("A.png", "A.png"),
        ("A.PNG", "A.png"),
        ("Tex/../a.png", "a.png"),
        ("Tu\u0308r.png", "T\u00fcr.png"),
        *((name, None) for name in ("b.png", "Tex", "", " ", ".", "a.png/b", "link.png", "loop.png")),
        *((name, None) for name in ("../secret.png", "Tex/../../secret.png", "..\\secret.png", "a\0.png", "x" * 5000)),
        *(
            (name, None)
            for name in ("C:\\a.png", "c:a.png", "/etc/passwd", "\\\\host\\a.png", "http://localhost/a.png")
        ),
    ],
)
def test_names_of_files(root: Path, name: str, file: str | None) -> None:
    found = found_inside(root, name, root)
    assert (found and found.resolve()) == (file and root / file)


def test_a_file_is_found_beside_the_one_that_names_it_and_else_beside_the_model(root: Path) -> None:
    assert found_inside(root, "a.png", root / "Tex") == root / "Tex" / "a.png"
    assert found_inside(root, "T\u00fcr.png", root / "Tex") == root / "T\u00fcr.png"
    assert found_inside(root, "../a.png", root / "Tex").resolve() == root / "a.png"
    assert found_inside(root, "../../secret.png", root / "Tex") is None


def test_an_absolute_name_of_the_model_itself_is_refused(root: Path) -> None:
    assert found_inside(root, str(root / "a.png"), root) is None
