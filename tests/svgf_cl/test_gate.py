"""JUnit files: what they say, that they are valid whatever the names, and that they are whole."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from svgf_cl import gate
from svgf_cl.errors import FileError
from svgf_cl.gate import Check, write_junit

CHECKS = [Check("kalman.frame", "Alpha"), Check("kalman.atrous", "Beta", "1.20 times as long")]


def written(path: Path, suite_name: str, *checks: Check) -> ElementTree.Element:
    """The suite that a parser finds in the file."""
    write_junit(path, suite_name, checks)
    root = ElementTree.parse(path).getroot()
    assert root.tag == "testsuites"
    (suite,) = root
    return suite


def test_a_case_for_each_check(tmp_path: Path) -> None:
    suite = written(tmp_path / "junit.xml", "svgf-cl bench", *CHECKS)
    assert suite.attrib == {"name": "svgf-cl bench", "tests": "2", "failures": "1", "errors": "0"}
    passed, failed = suite.findall("testcase")
    assert passed.attrib == {"classname": "Alpha", "name": "kalman.frame"}
    assert len(passed) == 0
    assert failed.attrib == {"classname": "Beta", "name": "kalman.atrous"}
    (failure,) = failed
    assert failure.tag == "failure"
    assert failure.attrib == {"message": "1.20 times as long"}
    assert failure.text == "1.20 times as long"


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("<a> & \"b\" 'c'", "<a> & \"b\" 'c'"),
        ("tab\tand\nline", "tab\tand\nline"),
        ("Größe \U0001f600", "Größe \U0001f600"),
        ("bell \a, nothing \0, escape \x1b", r"bell \x07, nothing \x00, escape \x1b"),
        ("no text \udcff, no character \ufffe\uffff", r"no text \udcff, no character \ufffe\uffff"),
    ],
)
def test_any_name_is_valid_xml(name: str, read: str, tmp_path: Path) -> None:
    suite = written(tmp_path / "junit.xml", name, Check(name, name, name))
    (case,) = suite
    (failure,) = case
    assert [suite.attrib["name"], case.attrib["name"], case.attrib["classname"]] == [read] * 3
    assert [failure.attrib["message"], failure.text] == [read] * 2


def test_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "junit.xml"
    path.write_text("of before", encoding="utf-8")
    monkeypatch.setattr(gate.ElementTree.ElementTree, "write", full)
    with pytest.raises(FileError, match=r"junit\.xml: cannot be written \(No space left on device\)"):
        write_junit(path, "svgf-cl bench", CHECKS)
    assert path.read_text(encoding="utf-8") == "of before"
    assert [each.name for each in tmp_path.iterdir()] == ["junit.xml"]
