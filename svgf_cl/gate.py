"""Checks of values against limits, and their results as a JUnit XML file for CI services."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from svgf_cl.io.atomic import written_whole

# Characters that XML 1.0 does not allow, not even escaped.
NO_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True)
class Check:
    """One value that was compared with a limit.

    Parameters
    ----------
    name : str
        The name of the value.
    group : str
        The thing that it belongs to, such as a device; JUnit calls it the class.
    complaint : str
        What is wrong; empty if the check passed.
    """

    name: str
    group: str
    complaint: str = ""


def write_junit(path: Path, suite_name: str, checks: Sequence[Check]) -> None:
    """Write checks as a JUnit file with one suite, completely or not at all.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    failures = sum(bool(check.complaint) for check in checks)
    counts = {"tests": str(len(checks)), "failures": str(failures), "errors": "0"}
    root = ElementTree.Element("testsuites", counts)
    suite = ElementTree.SubElement(root, "testsuite", {"name": xml_text(suite_name)} | counts)
    suite.extend([case_element(check) for check in checks])
    ElementTree.indent(root)
    with written_whole(path) as aside:
        ElementTree.ElementTree(root).write(aside, encoding="utf-8", xml_declaration=True)


def case_element(check: Check) -> ElementTree.Element:
    """Return the element of one check; CI services show the failure's message, its text, or both."""
    case = ElementTree.Element("testcase", {"classname": xml_text(check.group), "name": xml_text(check.name)})
    if check.complaint:
        complaint = xml_text(check.complaint)
        ElementTree.SubElement(case, "failure", {"message": complaint}).text = complaint
    return case


def xml_text(text: str) -> str:
    """Escape characters that XML does not allow, as Python does; names of files may contain them."""
    return NO_XML.sub(lambda match: ascii(match[0])[1:-1], text)
